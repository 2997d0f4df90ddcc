#pragma once

#include "report/html_report.h"
#include "study/validation.h"

namespace alabaster {

/// What was measured on meshes: errors by cause, images, times. Nothing when there is none.
void add_mesh_sections(HtmlReport& report, const ValidationResult& result);

}  // namespace alabaster

#pragma once

#include "report/html_report.h"
#include "study/validation.h"

namespace alabaster {

/// What was measured on flat scenes: errors, images, kernels, footprints, times. Nothing when there is none.
void add_planar_sections(HtmlReport& report, const ValidationResult& result);

}  // namespace alabaster

#pragma once

#include "report/html_report.h"
#include "study/validation.h"

namespace alabaster {

/// The whole report as one HTML page that needs no other file and no network.
HtmlReport validation_page(const ValidationResult& result, const ValidationOptions& options);

}  // namespace alabaster

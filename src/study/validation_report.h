#pragma once

#include <string>

#include "study/validation.h"

namespace alabaster {

/// The whole report as one HTML page that needs no other file and no network.
std::string validation_page(const ValidationResult& result, const ValidationOptions& options);

}  // namespace alabaster

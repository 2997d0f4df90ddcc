#pragma once

#include <filesystem>

#include "study/validation.h"

namespace alabaster {

/// results.json (an array of rows, one per scene and method), results.csv, footprint.csv, and every image as
/// EXR in a folder per scene.
void write_validation(const ValidationResult& result, const ValidationOptions& options);

/// File name of a method or scene: what file systems dislike becomes '-'.
std::string file_name_of(const std::string& name);

}  // namespace alabaster

#pragma once

#include "study/response.h"

namespace alabaster {

/// response.csv and response.json (one row per scene, exit, method, distance and contrast, where the
/// reference or the method has light), and response.html.
void write_response(const std::vector<ResponseResult>& results, const ValidationOptions& options);

}  // namespace alabaster

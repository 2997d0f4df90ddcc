#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace alabaster {

/// Checks what the parser behind it takes on trust: version, required extensions, that every index points
/// at something, that buffer views lie inside their buffers, and that nodes form trees. Throws InputError;
/// extensions that are used but not supported become remarks.
void validate_gltf(const std::string& file, const nlohmann::json& root, std::vector<std::string>& remarks);

}  // namespace alabaster

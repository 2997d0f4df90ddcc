#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf_document.h"

namespace alabaster {

/// An accessor's elements as floats, `components` per element; normalized integers are mapped to [0, 1] or
/// [-1, 1] (glTF 2.0, section 3.11), sparse values are put in place.
struct AccessorValues {
  std::size_t count = 0;
  int components = 0;
  std::vector<float> values;

  const float* operator[](std::size_t i) const {
    return values.data() + i * static_cast<std::size_t>(components);
  }
};

/// `place` names the use in messages ("meshes[0].primitives[1].POSITION"). Throws InputError when data lie
/// outside their buffer or are of a type that glTF does not allow there.
AccessorValues read_values(const GltfDocument& document, int accessor, const std::string& place);
/// Unsigned integers: indices and joints (`components` per element, flattened).
std::vector<uint32_t> read_integers(const GltfDocument& document, int accessor, const std::string& place);

}  // namespace alabaster

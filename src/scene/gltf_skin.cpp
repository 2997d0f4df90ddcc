#include "scene/gltf_skin.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include "core/error.h"
#include "scene/gltf_accessor.h"

namespace alabaster {

std::vector<Mat4> joint_matrices(const GltfDocument& document, const tinygltf::Skin& skin,
                                 const std::vector<Mat4>& node_to_world, const std::string& place) {
  std::vector<Mat4> result;
  for (const int joint : skin.joints) result.push_back(node_to_world[static_cast<std::size_t>(joint)]);
  if (skin.inverseBindMatrices < 0) return result;
  const AccessorValues bind = read_values(document, skin.inverseBindMatrices, place + ".inverseBindMatrices");
  if (bind.components != 16 || bind.count < result.size())
    throw InputError(document.file, place + ".inverseBindMatrices",
                     fmt::format("must be {} matrices; export it again", result.size()));
  for (std::size_t j = 0; j < result.size(); ++j) {
    Mat4 inverse;
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r) inverse[c][r] = bind[j][4 * c + r];
    result[j] = result[j] * inverse;
  }
  return result;
}

std::vector<Mat4> skin_transforms(const GltfDocument& document, const GltfPrimitive& primitive,
                                  const std::vector<Mat4>& joints, const std::string& place) {
  std::vector<Mat4> result(primitive.positions.size(), Mat4(0.0));
  for (std::size_t v = 0; v < result.size(); ++v) {
    double total = 0;
    for (std::size_t set = 0; set < primitive.joints.size(); ++set) {
      for (int k = 0; k < 4; ++k) {
        const double weight = primitive.weights[set][v][k];
        const uint32_t joint = primitive.joints[set][4 * v + static_cast<std::size_t>(k)];
        if (!(weight > 0)) continue;
        if (joint >= joints.size())
          throw InputError(document.file, place,
                           fmt::format("vertex {} follows joint {}, but there are {}; export it again", v,
                                       joint, joints.size()));
        result[v] += weight * joints[joint];
        total += weight;
      }
    }
    // Weights ought to sum to 1; a vertex that follows nothing stays where it is.
    result[v] = total > 0 ? result[v] / total : Mat4(1.0);
  }
  return result;
}

}  // namespace alabaster

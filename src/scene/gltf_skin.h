#pragma once

#include <string>
#include <vector>

#include "core/vec.h"
#include "scene/gltf_primitive.h"

namespace tinygltf {
struct Skin;
}

namespace alabaster {

/// Joint matrices of a skin in the pose that the nodes stand in: world matrix of each joint times its inverse
/// bind matrix.
std::vector<Mat4> joint_matrices(const GltfDocument& document, const tinygltf::Skin& skin,
                                 const std::vector<Mat4>& node_to_world, const std::string& place);

/// One matrix per vertex: the joints' matrices blended by the vertex's weights (glTF 2.0, section 3.7.3.3).
std::vector<Mat4> skin_transforms(const GltfDocument& document, const GltfPrimitive& primitive,
                                  const std::vector<Mat4>& joints, const std::string& place);

}  // namespace alabaster

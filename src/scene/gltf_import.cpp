#include "scene/gltf_import.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <utility>

#include "core/error.h"
#include "scene/gltf_document.h"
#include "scene/gltf_materials.h"
#include "scene/gltf_mesh.h"
#include "scene/gltf_primitive.h"
#include "scene/gltf_skin.h"

namespace alabaster {

namespace {

Mat4 local_transform(const tinygltf::Node& node) {
  Mat4 matrix(1.0);
  if (node.matrix.size() == 16) {
    for (int c = 0; c < 4; ++c)
      for (int r = 0; r < 4; ++r) matrix[c][r] = node.matrix[static_cast<std::size_t>(4 * c + r)];
    return matrix;
  }
  if (node.rotation.size() == 4) {
    const glm::dquat q(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    const double length = glm::length(q);
    if (length > 0) matrix = glm::mat4_cast(q / length);
  }
  if (node.scale.size() == 3)
    for (int c = 0; c < 3; ++c) matrix[c] *= node.scale[static_cast<std::size_t>(c)];
  if (node.translation.size() == 3)
    matrix[3] = Vec4(node.translation[0], node.translation[1], node.translation[2], 1);
  return matrix;
}

bool finite(const Mat4& m) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(m[c][r])) return false;
  return true;
}

class Importer {
 public:
  explicit Importer(const std::filesystem::path& path)
      : document_(read_gltf(path)), model_(*document_.model) {}

  GltfScene run() {
    scene_.warnings = document_.remarks;
    scene_.mesh_count = model_.meshes.size();
    scene_.texture_count = model_.textures.size();
    scene_.image_count = model_.images.size();
    materials_ = read_materials(document_);
    scene_.warnings.insert(scene_.warnings.end(), materials_.warnings.begin(), materials_.warnings.end());
    if (materials_.materials.size() > std::numeric_limits<uint16_t>::max())
      throw InputError(document_.file, "has more than 65,535 materials; merge some");
    place_nodes();
    for (const std::size_t node : shown_) add_node(node);
    if (skipped_primitives_ > 0)
      warn(fmt::format("{} primitives of points or lines are left out", skipped_primitives_));
    drop_unused_default();
    scene_.materials = std::move(materials_.materials);
    return std::move(scene_);
  }

 private:
  void warn(std::string text) { scene_.warnings.push_back(std::move(text)); }

  std::vector<int> roots() const {
    if (!model_.scenes.empty()) {
      const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
      return model_.scenes[static_cast<std::size_t>(scene)].nodes;
    }
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const auto& node : model_.nodes)
      for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
    std::vector<int> result;
    for (std::size_t i = 0; i < is_child.size(); ++i)
      if (!is_child[i]) result.push_back(static_cast<int>(i));
    return result;
  }

  /// World matrices of all nodes of the scene, parents before children.
  void place_nodes() {
    node_to_world_.assign(model_.nodes.size(), Mat4(1.0));
    std::vector<bool> placed(model_.nodes.size(), false);
    std::vector<std::pair<int, Mat4>> stack;
    const std::vector<int> first = roots();
    for (auto it = first.rbegin(); it != first.rend(); ++it) stack.emplace_back(*it, Mat4(1.0));
    while (!stack.empty()) {
      const auto [index, parent] = stack.back();
      stack.pop_back();
      const auto i = static_cast<std::size_t>(index);
      if (placed[i]) continue;  // named twice by the scene
      placed[i] = true;
      const auto& node = model_.nodes[i];
      node_to_world_[i] = parent * local_transform(node);
      if (!finite(node_to_world_[i]))
        throw InputError(document_.file, gltf_place("nodes", i, node.name),
                         "has a transform that is not finite; export it again");
      shown_.push_back(i);
      for (auto it = node.children.rbegin(); it != node.children.rend(); ++it)
        stack.emplace_back(*it, node_to_world_[i]);
    }
  }

  void add_node(std::size_t index) {
    const auto& node = model_.nodes[index];
    if (node.mesh >= 0) add_mesh(index);
    if (node.camera >= 0) add_camera(index);
    const auto light = node.extensions.find("KHR_lights_punctual");
    if (light != node.extensions.end() && light->second.Has("light"))
      add_light(index, static_cast<std::size_t>(light->second.Get("light").GetNumberAsInt()));
  }

  void add_mesh(std::size_t index) {
    const auto& node = model_.nodes[index];
    const auto& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
    const std::string mesh_place = gltf_place("meshes", static_cast<std::size_t>(node.mesh), mesh.name);
    const std::string name = !node.name.empty()   ? node.name
                             : !mesh.name.empty() ? mesh.name
                                                  : fmt::format("node {}", index);
    std::vector<Mat4> joints;
    if (node.skin >= 0)
      joints = joint_matrices(document_, model_.skins[static_cast<std::size_t>(node.skin)], node_to_world_,
                              fmt::format("skins[{}]", node.skin));
    GltfMeshBuilder builder;
    std::size_t tangent_uv_set = no_index, left_over = 0;
    bool morphed = false, skinned = false;
    for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
      const auto& source = mesh.primitives[p];
      if (!has_triangles(source)) {
        ++skipped_primitives_;
        continue;
      }
      const std::string place = fmt::format("{}.primitives[{}]", mesh_place, p);
      const GltfPrimitive primitive =
          read_primitive(document_, source, node.weights.empty() ? mesh.weights : node.weights, place);
      std::vector<Mat4> transforms{node_to_world_[index]};
      if (!joints.empty() && !primitive.joints.empty()) {
        // The node's own transform does not count for a skinned mesh.
        transforms = skin_transforms(document_, primitive, joints, place);
        skinned = true;
      }
      const std::size_t material =
          source.material >= 0 ? static_cast<std::size_t>(source.material) : materials_.materials.size() - 1;
      default_material_used_ = default_material_used_ || source.material < 0;
      if (const auto& normal_map = materials_.materials[material].normal)
        tangent_uv_set = normal_map->mapping().uv_set;
      if (!transforms.empty())
        builder.add(primitive, transforms, static_cast<uint16_t>(material),
                    materials_.primary_uv_set[material]);
      morphed = morphed || primitive.morphed;
      left_over += primitive.left_over_indices;
    }
    const GltfMeshBuilder::Counts counts = builder.counts();
    SceneObject object;
    object.name = name;
    object.mesh = std::move(builder).finish(tangent_uv_set);
    if (object.mesh.triangle_count() == 0)
      warn(fmt::format("object '{}' has no triangles and is left out", name));
    else
      scene_.objects.push_back(std::move(object));
    remark_on(name, counts, left_over, morphed, skinned);
  }

  void remark_on(const std::string& name, const GltfMeshBuilder::Counts& counts, std::size_t left_over,
                 bool morphed, bool skinned) {
    if (skinned) warn(fmt::format("object '{}' is skinned; it is shown in its rest pose", name));
    if (morphed)
      warn(fmt::format("object '{}' has morph targets; it is shown with its default weights", name));
    if (counts.flat_primitives > 0)
      warn(fmt::format("object '{}' comes without normals; it is shaded flat", name));
    if (left_over > 0)
      warn(fmt::format("object '{}': {} indices at the end make no triangle and are left out", name,
                       left_over));
    if (counts.non_finite_triangles > 0)
      warn(fmt::format("object '{}': {} triangles with positions that are not finite are left out", name,
                       counts.non_finite_triangles));
    if (counts.bad_normals > 0)
      warn(fmt::format("object '{}': {} corners with normals of no length are shaded flat", name,
                       counts.bad_normals));
    if (counts.non_finite_uvs > 0)
      warn(fmt::format("object '{}': {} texture coordinates are not finite; taken as 0", name,
                       counts.non_finite_uvs));
  }

  /// Position and axes of a node without its scale.
  struct Pose {
    Vec3 position, forward, up;
  };
  Pose pose(std::size_t index) const {
    const Mat4& m = node_to_world_[index];
    const Vec3 forward = -Vec3(m[2]), up = Vec3(m[1]);
    Pose result{Vec3(m[3]), Vec3(0, 0, -1), Vec3(0, 1, 0)};
    if (glm::length(forward) > 0) result.forward = glm::normalize(forward);
    if (glm::length(glm::cross(result.forward, up)) > 0) result.up = glm::normalize(up);
    return result;
  }

  void add_camera(std::size_t index) {
    const auto& node = model_.nodes[index];
    const auto& source = model_.cameras[static_cast<std::size_t>(node.camera)];
    const Pose where = pose(index);
    Camera camera;
    camera.name = !node.name.empty()     ? node.name
                  : !source.name.empty() ? source.name
                                         : fmt::format("camera {}", scene_.cameras.size());
    camera.alias = source.name;
    camera.position = where.position;
    camera.direction = where.forward;
    camera.up = where.up;
    if (source.type == "orthographic") {
      camera.orthographic_height = 2 * std::abs(source.orthographic.ymag);
      if (!(camera.orthographic_height > 0) || !std::isfinite(camera.orthographic_height))
        return warn(fmt::format("camera '{}' has no height and is left out", camera.name));
    } else {
      camera.vertical_fov = source.perspective.yfov * 180 / pi;
      if (!(camera.vertical_fov > 0 && camera.vertical_fov < 180))
        return warn(fmt::format("camera '{}' has an impossible field of view and is left out", camera.name));
    }
    scene_.cameras.push_back(std::move(camera));
  }

  void add_light(std::size_t node, std::size_t index) {
    if (index >= model_.lights.size()) return;
    const auto& source = model_.lights[index];
    const Pose where = pose(node);
    Rgb colour(1);
    if (source.color.size() >= 3) colour = Rgb(source.color[0], source.color[1], source.color[2]);
    const Rgb intensity = colour * source.intensity;
    if (!intensity.is_finite() || intensity.min() < 0)
      return warn(fmt::format("lights[{}] has an impossible intensity and is left out", index));
    if (source.type == "directional") {
      scene_.lights.push_back(DirectionalLight{where.forward, intensity});
    } else if (source.type == "point") {
      scene_.lights.push_back(PointLight{where.position, intensity});
    } else if (source.type == "spot") {
      const double outer = source.spot.outerConeAngle;
      scene_.lights.push_back(SpotLight{where.position, where.forward, intensity,
                                        std::min(source.spot.innerConeAngle, outer), outer});
    } else {
      warn(fmt::format("lights[{}] is of unknown type '{}' and is left out", index, source.type));
    }
  }

  /// The default material stands last: it goes when nothing uses it.
  void drop_unused_default() {
    if (!default_material_used_) materials_.materials.pop_back();
  }

  GltfDocument document_;
  const tinygltf::Model& model_;
  GltfScene scene_;
  GltfMaterials materials_;
  std::vector<Mat4> node_to_world_;
  std::vector<std::size_t> shown_;
  std::size_t skipped_primitives_ = 0;
  bool default_material_used_ = false;
};

}  // namespace

GltfScene import_gltf(const std::filesystem::path& path) {
  return Importer(path).run();
}

}  // namespace alabaster

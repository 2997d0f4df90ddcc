#include "scene/gltf_primitive.h"

#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <numeric>
#include <optional>

#include "core/error.h"
#include "scene/gltf_accessor.h"

namespace alabaster {

namespace {

class PrimitiveReader {
 public:
  PrimitiveReader(const GltfDocument& document, const tinygltf::Primitive& source, const std::string& place)
      : document_(document), source_(source), place_(place) {}

  GltfPrimitive read(const std::vector<double>& morph_weights) {
    const auto positions = attribute("POSITION", 3);
    if (!positions) fail("has no POSITION; there is nothing to draw, export it again");
    count_ = positions->count;
    GltfPrimitive result;
    result.positions = vectors(*positions);
    if (const auto normals = attribute("NORMAL", 3)) result.normals = vectors(*normals);
    if (const auto tangents = attribute("TANGENT", 4); tangents && !result.normals.empty())
      for (std::size_t i = 0; i < count_; ++i) result.tangents.push_back(vector4(*tangents, i));
    read_uv_sets(result);
    read_colours(result);
    read_joints(result);
    apply_morph_targets(result, morph_weights);
    read_triangles(result);
    return result;
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(document_.file, place_, problem);
  }

  /// Nothing when the primitive lacks it. `components` is the least the use needs.
  std::optional<AccessorValues> attribute(const std::string& name, int components) const {
    const auto it = source_.attributes.find(name);
    if (it == source_.attributes.end()) return std::nullopt;
    return checked(it->second, name, components);
  }

  AccessorValues checked(int accessor, const std::string& name, int components) const {
    AccessorValues values = read_values(document_, accessor, place_ + "." + name);
    if (values.components < components)
      fail(fmt::format("{} has {} components instead of {}; export it again", name, values.components,
                       components));
    if (count_ > 0 && values.count != count_)
      fail(fmt::format("{} has {} elements, POSITION has {}; export it again", name, values.count, count_));
    return values;
  }

  static std::vector<Vec3> vectors(const AccessorValues& values) {
    std::vector<Vec3> result;
    result.reserve(values.count);
    for (std::size_t i = 0; i < values.count; ++i)
      result.emplace_back(values[i][0], values[i][1], values[i][2]);
    return result;
  }
  static Vec4 vector4(const AccessorValues& values, std::size_t i) {
    return {values[i][0], values[i][1], values[i][2], values[i][3]};
  }

  void read_uv_sets(GltfPrimitive& result) const {
    constexpr int most_sets = 8;
    for (int set = 0; set < most_sets; ++set) {
      const auto values = attribute(fmt::format("TEXCOORD_{}", set), 2);
      if (!values) continue;
      result.uv_sets.resize(static_cast<std::size_t>(set) + 1);
      auto& uv = result.uv_sets.back();
      uv.reserve(count_);
      for (std::size_t i = 0; i < count_; ++i) uv.emplace_back((*values)[i][0], (*values)[i][1]);
    }
  }

  void read_colours(GltfPrimitive& result) const {
    const auto values = attribute("COLOR_0", 3);
    if (!values) return;
    for (std::size_t i = 0; i < count_; ++i) {
      const float* c = (*values)[i];
      result.colours.emplace_back(c[0], c[1], c[2], values->components > 3 ? c[3] : 1.0f);
    }
  }

  void read_joints(GltfPrimitive& result) const {
    for (int set = 0;; ++set) {
      const auto joints = source_.attributes.find(fmt::format("JOINTS_{}", set));
      const auto weights = attribute(fmt::format("WEIGHTS_{}", set), 4);
      if (joints == source_.attributes.end() || !weights) return;
      result.joints.push_back(read_integers(document_, joints->second, place_ + "." + joints->first));
      if (result.joints.back().size() != 4 * count_)
        fail(joints->first + " must have four components per vertex; export it again");
      auto& list = result.weights.emplace_back();
      for (std::size_t i = 0; i < count_; ++i) list.push_back(vector4(*weights, i));
    }
  }

  void apply_morph_targets(GltfPrimitive& result, const std::vector<double>& weights) const {
    for (std::size_t t = 0; t < std::min(weights.size(), source_.targets.size()); ++t) {
      result.morphed = true;
      if (weights[t] == 0) continue;
      for (const auto& [name, accessor] : source_.targets[t]) {
        if (name != "POSITION" && name != "NORMAL" && name != "TANGENT") continue;
        const AccessorValues delta = checked(accessor, fmt::format("targets[{}].{}", t, name), 3);
        for (std::size_t i = 0; i < count_; ++i) {
          const Vec3 step = weights[t] * Vec3(delta[i][0], delta[i][1], delta[i][2]);
          if (name == "POSITION") result.positions[i] += step;
          if (name == "NORMAL" && !result.normals.empty()) result.normals[i] += step;
          if (name == "TANGENT" && !result.tangents.empty()) result.tangents[i] += Vec4(step, 0);
        }
      }
    }
    result.morphed = result.morphed || !source_.targets.empty();
  }

  void read_triangles(GltfPrimitive& result) const {
    std::vector<uint32_t> order;
    if (source_.indices >= 0) {
      order = read_integers(document_, source_.indices, place_ + ".indices");
      const auto largest = std::max_element(order.begin(), order.end());
      if (largest != order.end() && *largest >= count_)
        fail(fmt::format("indices name vertex {}, but there are {}; export it again", *largest, count_));
    } else {
      order.resize(count_);
      std::iota(order.begin(), order.end(), 0u);
    }
    const std::size_t n = order.size();
    if (source_.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      // Every other triangle is wound the other way round (glTF 2.0, section 3.7.2.1).
      for (std::size_t i = 0; i + 2 < n; ++i)
        result.triangles.push_back({order[i], order[i + 1 + i % 2], order[i + 2 - i % 2]});
    } else if (source_.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      for (std::size_t i = 1; i + 1 < n; ++i) result.triangles.push_back({order[0], order[i], order[i + 1]});
    } else {
      for (std::size_t i = 0; i + 2 < n; i += 3)
        result.triangles.push_back({order[i], order[i + 1], order[i + 2]});
      result.left_over_indices = n % 3;
    }
  }

  const GltfDocument& document_;
  const tinygltf::Primitive& source_;
  const std::string& place_;
  std::size_t count_ = 0;
};

}  // namespace

bool has_triangles(const tinygltf::Primitive& primitive) {
  return primitive.mode == -1 || primitive.mode == TINYGLTF_MODE_TRIANGLES ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP || primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

GltfPrimitive read_primitive(const GltfDocument& document, const tinygltf::Primitive& primitive,
                             const std::vector<double>& morph_weights, const std::string& place) {
  return PrimitiveReader(document, primitive, place).read(morph_weights);
}

}  // namespace alabaster

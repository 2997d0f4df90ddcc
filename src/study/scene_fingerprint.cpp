#include "study/scene_fingerprint.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <type_traits>

#include "core/rng.h"

namespace alabaster {

namespace {

/// Two 64-bit hashes of everything that is added, side by side.
class ContentHash {
 public:
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; i += 8) {
      uint64_t word = 0;
      std::memcpy(&word, bytes + i, std::min<std::size_t>(8, size - i));
      add_word(word);
    }
    add_word(size);
  }
  template <class Plain>
  void add(const Plain& value) {
    static_assert(std::is_trivially_copyable_v<Plain>);
    add_bytes(&value, sizeof value);
  }
  template <class Plain>
  void add(const std::vector<Plain>& values) {
    static_assert(std::is_trivially_copyable_v<Plain>);
    add_bytes(values.data(), values.size() * sizeof(Plain));
  }
  std::string text() const { return fmt::format("{:016x}{:016x}", first_, second_); }

 private:
  void add_word(uint64_t word) {
    first_ = hash_combine(first_, word);
    second_ = hash_combine(second_ ^ 0x5851f42d4c957f2dULL, word);
  }
  uint64_t first_ = 1, second_ = 2;
};

void add_texture(ContentHash& hash, const std::shared_ptr<const Texture>& texture) {
  hash.add(texture != nullptr);
  if (!texture) return;
  const TextureMapping& m = texture->mapping();
  hash.add(m.wrap_u), hash.add(m.wrap_v), hash.add(m.filter), hash.add(m.uv_set);
  hash.add(m.offset), hash.add(m.scale), hash.add(m.rotation);
  hash.add(texture->texels().width), hash.add(texture->texels().texels);
}

void add_material(ContentHash& hash, const Material& m) {
  hash.add(m.base_colour_factor), hash.add(m.metallic_factor), hash.add(m.roughness_factor);
  hash.add(m.normal_scale), hash.add(m.emission), hash.add(m.alpha_mode), hash.add(m.alpha_cutoff);
  hash.add(m.double_sided), hash.add(m.ior), hash.add(m.transmission), hash.add(m.medium.has_value());
  if (m.medium) hash.add(m.medium->mean_free_path), hash.add(m.medium->g), hash.add(m.medium->eta);
  hash.add(m.albedo.meaning), hash.add(m.albedo.factor), hash.add(m.albedo.vertex_colours);
  hash.add(m.albedo.strength);
  for (const auto& texture : {m.base_colour, m.metallic_roughness, m.normal, m.emissive, m.albedo.texture,
                              m.albedo.strength_texture, m.subsurface_map, m.density_map})
    add_texture(hash, texture);
}

void add_object(ContentHash& hash, const SceneObject& object) {
  const TriangleMesh& mesh = object.mesh;
  hash.add(mesh.positions), hash.add(mesh.corners), hash.add(mesh.attributes), hash.add(mesh.normals);
  for (const auto& set : mesh.uv_sets) hash.add(set);
  hash.add(mesh.tangents), hash.add(mesh.colours), hash.add(mesh.materials);
  if (!object.albedo) return;
  for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
    hash.add(object.albedo->at(mesh.surface_point(t, Vec2(1.0 / 3))));
}

void add_environment(ContentHash& hash, const Environment* environment) {
  hash.add(environment != nullptr);
  if (environment == nullptr) return;
  // A Fibonacci spiral: even over the sphere.
  constexpr int directions = 4096;
  for (int i = 0; i < directions; ++i) {
    const double z = 1 - (2 * i + 1.0) / directions, r = std::sqrt(1 - z * z), phi = 2.399963229728653 * i;
    hash.add(environment->radiance({r * std::cos(phi), r * std::sin(phi), z}));
  }
}

}  // namespace

std::string scene_fingerprint(const Scene& scene) {
  ContentHash hash;
  for (const SceneObject& object : scene.objects) add_object(hash, object);
  for (const Material& material : scene.materials) add_material(hash, material);
  for (const Light& light : scene.lights) {
    hash.add(light.index());
    std::visit([&](const auto& l) { hash.add(l); }, light);
  }
  add_environment(hash, scene.environment.get());
  const Camera& camera = scene.cameras.front();
  hash.add(camera.position), hash.add(camera.direction), hash.add(camera.up);
  hash.add(camera.vertical_fov), hash.add(camera.orthographic_height);
  return hash.text();
}

std::string scene_fingerprint(const PlanarScene& scene) {
  ContentHash hash;
  hash.add(scene.albedo->width), hash.add(scene.albedo->texels), hash.add(scene.tile);
  hash.add(scene.medium.mean_free_path), hash.add(scene.medium.g), hash.add(scene.medium.eta);
  const PlanarLight& light = scene.light;
  hash.add(light.shape), hash.add(light.centre), hash.add(light.radius), hash.add(light.radiance);
  const PlanarView& view = scene.view;
  hash.add(view.centre), hash.add(view.size), hash.add(view.width), hash.add(view.height);
  hash.add(view.towards), hash.add(view.radiosity);
  return hash.text();
}

}  // namespace alabaster

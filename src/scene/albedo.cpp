#include "scene/albedo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <span>

#include "optics/profile_store.h"
#include "texture/material_map.h"
#include "texture/seam_gutters.h"
#include "texture/surface_albedo.h"
#include "texture/vertex_albedo.h"

namespace alabaster {

namespace {

/// Multi-scatter colours obey the same limit as reflectances; albedos are taken as they are.
double largest_value(const AlbedoSource& source) {
  return source.meaning == AlbedoSource::Meaning::albedo ? 1 : max_reflectance;
}

bool needs_bake(const Material& material) {
  return material.albedo.meaning == AlbedoSource::Meaning::reflectance &&
         !profile_is_baked(material.medium->g, material.medium->eta);
}

ReflectanceToAlbedo inversion(const Material& material) {
  switch (material.albedo.meaning) {
    case AlbedoSource::Meaning::albedo:
      return [](double value, int) { return value; };
    case AlbedoSource::Meaning::multiscatter:
      return [g = material.medium->g](double value, int) { return albedo_from_multiscatter(value, g); };
    case AlbedoSource::Meaning::reflectance:
      break;
  }
  return [profile = profile_for(material.medium->g, material.medium->eta)](double value, int) {
    return profile->albedo_from_reflectance(value);
  };
}

Rgb convert(const Rgb& value, const ReflectanceToAlbedo& to_albedo, double largest) {
  Rgb albedo;
  for (int c = 0; c < 3; ++c)
    albedo[c] = std::clamp(to_albedo(value[c] > 0 ? std::min(value[c], largest) : 0, c), 0.0, 1.0);
  return albedo;
}

/// The multi-scatter colour times the strength texture's alpha, where both share their texels.
TexelArray scaled_by_strength(const Texture& colour, const Texture& strength, bool& exact) {
  TexelArray result = colour.texels();
  const TexelArray& alpha = strength.texels();
  exact = alpha.width == result.width && alpha.height == result.height &&
          colour.mapping().uv_set == strength.mapping().uv_set;
  double mean = 0;
  for (const Vec4f& t : alpha.texels) mean += t.a / static_cast<double>(alpha.texels.size());
  for (std::size_t i = 0; i < result.texels.size(); ++i)
    result.texels[i] *= Vec4f(Vec3f(exact ? alpha.texels[i].a : static_cast<float>(mean)), 1);
  return result;
}

std::string share_text(double share) {
  if (share >= 1) return "all";
  return share >= 0.1 ? fmt::format("{:.0f} %", 100 * share) : fmt::format("{:.2g} %", 100 * share);
}

/// Whether some triangle is so large in texture space that it shows every texel: a circle inside it holds a
/// square of one period. Tiled textures need no raster then.
bool shows_every_texel(const TriangleMesh& mesh, const std::vector<uint32_t>& triangles,
                       const TextureMapping& mapping) {
  if (mapping.wrap_u == Wrap::clamp || mapping.wrap_v == Wrap::clamp) return false;
  const bool mirrored = mapping.wrap_u == Wrap::mirror || mapping.wrap_v == Wrap::mirror;
  const double least_radius = (mirrored ? 2 : 1) * std::sqrt(0.5);
  return std::any_of(triangles.begin(), triangles.end(), [&](uint32_t t) {
    const Vec2 a = mapping.transform(mesh.uv(t, {0, 0}, mapping.uv_set));
    const Vec2 b = mapping.transform(mesh.uv(t, {1, 0}, mapping.uv_set)) - a;
    const Vec2 c = mapping.transform(mesh.uv(t, {0, 1}, mapping.uv_set)) - a;
    const double twice_area = std::abs(b.x * c.y - b.y * c.x);
    const double perimeter = glm::length(b) + glm::length(c) + glm::length(c - b);
    return twice_area > least_radius * perimeter && std::isfinite(perimeter);
  });
}

Vec3 mean_vertex_colour(const TriangleMesh& mesh, const std::vector<uint32_t>& triangles) {
  Vec3 sum(0);
  double weight = 0;
  for (const uint32_t t : triangles) {
    const double area = mesh.area(t);
    for (const uint32_t corner : mesh.attributes[t]) sum += area * Vec3(mesh.colours[corner]) / 3.0;
    weight += area;
  }
  return weight > 0 ? sum / weight : Vec3(1);
}

class AlbedoBuilder {
 public:
  AlbedoBuilder(Scene& scene, Purpose purpose)
      : scene_(scene), purpose_(purpose), statistics_(scene.materials.size()) {}

  void run() {
    for (SceneObject& object : scene_.objects) {
      object.albedo = build(object);
      if (object.albedo && purpose_ == Purpose::render) add_pyramids(object);
      object.density = build_density(object);
    }
    finish();
  }

 private:
  struct Statistics {
    double weight = 0;  // texels, or 1 for a constant
    Rgb sum;
    double clamped = 0;
  };

  bool knows_albedo(const Material& material) const {
    return purpose_ == Purpose::render || !needs_bake(material);
  }

  /// Where albedos stay unknown, one that counts and clamps alike.
  ReflectanceToAlbedo inversion_for(const Material& material) const {
    if (knows_albedo(material)) return inversion(material);
    return [](double value, int) { return value; };
  }

  std::unique_ptr<AlbedoField> build(const SceneObject& object) {
    std::map<uint16_t, std::vector<uint32_t>> triangles;
    for (uint32_t t = 0; t < object.mesh.triangle_count(); ++t)
      triangles[object.mesh.materials[t]].push_back(t);
    std::vector<std::unique_ptr<AlbedoField>> fields(scene_.materials.size());
    std::size_t count = 0;
    for (const auto& [material, list] : triangles) {
      if (!scene_.materials[material].medium) continue;
      fields[material] = build(object, material, list);
      ++count;
    }
    if (count == 0) return nullptr;
    if (triangles.size() == 1) return std::move(fields[triangles.begin()->first]);
    return std::make_unique<ObjectAlbedo>(object.mesh, std::move(fields));
  }

  /// Values above 1 count as 1: what a picture holds is a share.
  std::unique_ptr<AlbedoField> build_density(const SceneObject& object) const {
    std::map<uint16_t, std::vector<uint32_t>> triangles;
    for (uint32_t t = 0; t < object.mesh.triangle_count(); ++t)
      triangles[object.mesh.materials[t]].push_back(t);
    std::vector<std::unique_ptr<AlbedoField>> fields(scene_.materials.size());
    bool any = false;
    for (const auto& [index, list] : triangles) {
      const Material& material = scene_.materials[index];
      if (!material.medium) continue;
      if (!material.density_map) {
        fields[index] = std::make_unique<ConstantAlbedo>(Rgb(1));
        continue;
      }
      any = true;
      const Texture& map = *material.density_map;
      TexelArray texels = map.texels();
      for (Vec4f& t : texels.texels) t = Vec4f(Vec3f(std::clamp(t.r, 0.0f, 1.0f)), 1);
      const Coverage coverage =
          texel_coverage(object.mesh, object.atlas, list, map.mapping(), texels.width, texels.height);
      fields[index] = std::make_unique<TextureAlbedo>(object.mesh, list, texels, coverage, map.mapping());
    }
    if (!any) return nullptr;
    return std::make_unique<ObjectAlbedo>(object.mesh, std::move(fields));
  }

  std::unique_ptr<AlbedoField> build(const SceneObject& object, uint16_t index,
                                     const std::vector<uint32_t>& triangles) {
    const Material& material = scene_.materials[index];
    const AlbedoSource& source = material.albedo;
    const TriangleMesh& mesh = object.mesh;
    const Rgb factor = source.factor * source.strength;
    const bool coloured = source.vertex_colours && has_colours(mesh, triangles);
    if (!mesh.uv_sets.empty() && (source.texture || (coloured && holds_a_picture(object))))
      return build_textured(object, index, triangles, coloured);
    const Rgb plain = factor * value_without_uvs(source);
    const ReflectanceToAlbedo to_albedo = inversion_for(material);
    if (!coloured) {
      const Rgb albedo = convert(plain, to_albedo, largest_value(source));
      count(index, albedo, 1, plain.max() > largest_value(source) ? 1 : 0);
      return std::make_unique<ConstantAlbedo>(albedo);
    }
    std::vector<Rgb> albedo;
    for (const Vec4f& colour : mesh.colours)
      albedo.push_back(convert(plain * Rgb(colour.r, colour.g, colour.b), to_albedo, largest_value(source)));
    auto field = std::make_unique<VertexAlbedo>(mesh, triangles, std::move(albedo));
    for (const uint32_t t : triangles) {
      SurfacePoint middle;
      middle.triangle = t;
      middle.barycentric = Vec2(1.0 / 3);
      count(index, field->at(middle), mesh.area(t), 0);
    }
    return field;
  }

  std::unique_ptr<AlbedoField> build_textured(const SceneObject& object, uint16_t index,
                                              const std::vector<uint32_t>& triangles, bool coloured) {
    const Material& material = scene_.materials[index];
    const AlbedoSource& source = material.albedo;
    constexpr int baked_side = 1024;
    const TextureMapping mapping = source.texture ? source.texture->mapping() : TextureMapping{};
    TexelArray own;  // only when texels differ from the file's
    const TexelArray* texels = source.texture ? &source.texture->texels() : &own;
    if (!source.texture) {
      own = {baked_side, baked_side, std::vector<Vec4f>(std::size_t{baked_side} * baked_side, Vec4f(1))};
    } else if (source.strength_texture) {
      bool exact = false;
      own = scaled_by_strength(*source.texture, *source.strength_texture, exact);
      texels = &own;
      if (!exact)
        warn(material, "its scatter strength texture differs in size from its colour; its mean is used");
    }
    const bool everywhere = shows_every_texel(object.mesh, triangles, mapping);
    if (coloured) {
      if (texels != &own) own = *texels;
      texels = &own;
      multiply_vertex_colours(object, material, triangles, mapping, everywhere, own);
    }
    Coverage coverage;
    if (everywhere)
      coverage.weights.assign(texels->texels.size(), 1.0f);
    else
      coverage = texel_coverage(object.mesh,
                                mapping.uv_set == 0 ? object.atlas : UvAtlas(object.mesh, mapping.uv_set),
                                triangles, mapping, texels->width, texels->height);
    AlbedoTexels albedo = albedo_texels(*texels, source.factor * source.strength, coverage.weights,
                                        inversion_for(material), largest_value(source));
    count_texels(index, albedo, coverage.weights);
    if (!everywhere) fill_gutters(object.mesh, triangles, mapping, albedo.texels, coverage);
    return std::make_unique<TextureAlbedo>(object.mesh, triangles, albedo.texels, coverage, mapping);
  }

  /// Pyramids over space, one per medium, unless one albedo or the texture's own pyramid does it all.
  void add_pyramids(SceneObject& object) const {
    const TriangleMesh& mesh = object.mesh;
    if (dynamic_cast<const ConstantAlbedo*>(object.albedo.get()) != nullptr) return;
    std::vector<uint32_t> all;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
      if (scene_.materials[mesh.materials[t]].medium) all.push_back(t);
    const bool one_material = std::all_of(
        all.begin(), all.end(), [&](uint32_t t) { return mesh.materials[t] == mesh.materials[all.front()]; });
    if (one_material && is_affine(mesh, object.atlas, all)) return;
    std::vector<std::shared_ptr<const SurfacePyramid>> pyramids(scene_.materials.size());
    for (std::size_t m = 0; m < pyramids.size(); ++m) {
      if (pyramids[m] || !scene_.materials[m].medium) continue;
      std::vector<uint32_t> triangles;
      for (const uint32_t t : all)
        if (scene_.materials[mesh.materials[t]].medium == scene_.materials[m].medium) triangles.push_back(t);
      if (triangles.empty() || shows_one_albedo(object, triangles)) continue;
      const auto pyramid = std::make_shared<const SurfacePyramid>(mesh, triangles, *object.albedo,
                                                                  finest_sigma(object, triangles));
      for (const uint32_t t : triangles) pyramids[mesh.materials[t]] = pyramid;
    }
    object.albedo = std::make_unique<SurfaceAlbedo>(mesh, std::move(object.albedo), std::move(pyramids));
  }

  /// Whether no texture and no vertex colour tells these triangles apart: nothing to average then.
  bool shows_one_albedo(const SceneObject& object, const std::vector<uint32_t>& triangles) const {
    const TriangleMesh& mesh = object.mesh;
    if (has_colours(mesh, triangles)) return false;
    const auto albedo = [&](uint32_t t) { return object.albedo->at(mesh.surface_point(t, Vec2(1.0 / 3))); };
    const Rgb first = albedo(triangles.front());
    return std::all_of(triangles.begin(), triangles.end(), [&](uint32_t t) {
      const AlbedoSource& source = scene_.materials[mesh.materials[t]].albedo;
      return !source.texture && !source.strength_texture && albedo(t) == first;
    });
  }

  /// What the finest of the materials' textures can show, within the memory they take.
  double finest_sigma(const SceneObject& object, const std::vector<uint32_t>& triangles) const {
    const TriangleMesh& mesh = object.mesh;
    std::map<uint16_t, std::vector<uint32_t>> of_material;
    for (const uint32_t t : triangles) of_material[mesh.materials[t]].push_back(t);
    double finest = std::numeric_limits<double>::infinity();
    std::size_t texels = 0;
    for (const auto& [m, list] : of_material) {
      const AlbedoSource& source = scene_.materials[m].albedo;
      double size = 0.5 * std::sqrt(surface_area(mesh) / static_cast<double>(mesh.triangle_count()));
      if (source.texture && !mesh.uv_sets.empty()) {
        const TextureMapping& mapping = source.texture->mapping();
        const int width = source.texture->texels().width, height = source.texture->texels().height;
        const UvAtlas other = mapping.uv_set == 0 ? UvAtlas() : UvAtlas(mesh, mapping.uv_set);
        size = texel_size(mesh, mapping.uv_set == 0 ? object.atlas : other, list, mapping, width, height);
        texels += source.texture->texels().texels.size();
      }
      finest = std::min(finest, size);
    }
    return finest_pyramid_sigma(mesh, triangles, finest, texels);
  }

  void multiply_vertex_colours(const SceneObject& object, const Material& material,
                               const std::vector<uint32_t>& triangles, const TextureMapping& mapping,
                               bool tiled, TexelArray& texels) {
    if (tiled) {
      const Vec4f mean(Vec3f(mean_vertex_colour(object.mesh, triangles)), 1);
      for (Vec4f& texel : texels.texels) texel *= mean;
      warn(material, "vertex colours cannot be told apart on a tiled texture; their mean is used");
      return;
    }
    const double disputed = bake_vertex_colours(object.mesh, triangles, mapping, texels);
    if (disputed > 0.01)
      warn(material, "vertex colours disagree on " + share_text(disputed) +
                         " of the texels that triangles share; their mean is used");
  }

  static bool has_colours(const TriangleMesh& mesh, const std::vector<uint32_t>& triangles) {
    if (mesh.colours.empty()) return false;
    return std::any_of(triangles.begin(), triangles.end(), [&](uint32_t t) {
      const Index3& a = mesh.attributes[t];
      return std::any_of(a.begin(), a.end(), [&](uint32_t i) { return Vec3f(mesh.colours[i]) != Vec3f(1); });
    });
  }

  /// Whether the UVs could hold a picture of the surface: every place its own texel.
  static bool holds_a_picture(const SceneObject& object) {
    const UvAtlas& atlas = object.atlas;
    return atlas.overlap_fraction < 0.01 && atlas.zero_area_triangles == 0 && atlas.out_of_range_corners == 0;
  }

  static Rgb value_without_uvs(const AlbedoSource& source) {
    Rgb value(1);
    if (source.texture) {
      const Vec4 t = source.texture->evaluate(Vec2(0));
      value = Rgb(t.r, t.g, t.b);
    }
    if (source.strength_texture) value *= source.strength_texture->evaluate(Vec2(0)).a;
    return value;
  }

  void count(uint16_t index, const Rgb& albedo, double weight, double clamped) {
    Statistics& s = statistics_[index];
    s.sum += albedo * weight;
    s.weight += weight;
    s.clamped += clamped;
  }

  void count_texels(uint16_t index, const AlbedoTexels& albedo, const std::vector<float>& weights) {
    Rgb sum;
    double covered = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (!(weights[i] > 0)) continue;
      const Vec4f& t = albedo.texels.texels[i];
      sum += Rgb(t.r, t.g, t.b);
      covered += 1;
    }
    Statistics& s = statistics_[index];
    s.sum += sum;
    s.weight += covered;
    s.clamped += static_cast<double>(albedo.clamped);
  }

  void finish() {
    for (std::size_t i = 0; i < statistics_.size(); ++i) {
      const Statistics& s = statistics_[i];
      Material& material = scene_.materials[i];
      if (s.weight > 0 && knows_albedo(material)) material.mean_albedo = s.sum / s.weight;
      if (s.clamped > 0)
        warn(material, fmt::format("asks for a reflectance above {} on {} of it, which is clamped",
                                   max_reflectance, share_text(s.clamped / s.weight)));
    }
  }

  void warn(const Material& material, const std::string& text) {
    scene_.warnings.push_back("material '" + material.name + "': " + text);
  }

  Scene& scene_;
  Purpose purpose_;
  std::vector<Statistics> statistics_;
};

}  // namespace

void build_albedo_fields(Scene& scene, Purpose purpose) {
  AlbedoBuilder(scene, purpose).run();
}

}  // namespace alabaster

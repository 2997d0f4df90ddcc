#pragma once

#include <memory>

#include "core/rgb.h"
#include "texture/texture.h"

namespace alabaster {

/// A homogeneous-density scattering medium with spatially varying albedo. Materials of one object whose mean
/// free path, g and eta agree share one medium, and light passes between them.
struct Medium {
  Rgb mean_free_path{0.001};  // m, 1/sigma_t per channel
  double g = 0.3;             // Henyey-Greenstein mean cosine, (-1, 1)
  double eta = 1.5;           // relative index of refraction, >= 1

  Rgb sigma_t() const { return Rgb(1) / mean_free_path; }
  bool operator==(const Medium&) const = default;
};

/// What the albedo of a medium is made from: factor x texture x vertex colour, texel by texel.
struct AlbedoSource {
  enum class Meaning {
    reflectance,   // wanted multiple-scattering reflectance; the simulated A(alpha) is inverted
    multiscatter,  // glTF's multi-scatter colour; the inversion of KHR_materials_scatter
    albedo,        // alpha itself
  };
  Meaning meaning = Meaning::reflectance;
  Rgb factor{1};
  std::shared_ptr<const Texture> texture;
  bool vertex_colours = false;                      // times COLOR_0
  double strength = 1;                              // multiscatter: scales the colour
  std::shared_ptr<const Texture> strength_texture;  // multiscatter: its alpha channel scales it too
};

/// Reflectances above this are clamped: alpha beyond 1 - 9e-6 has no use in a picture.
inline constexpr double max_reflectance = 0.98;

/// Single-scattering albedo of a multi-scatter colour by the drafts KHR_materials_volume_scatter and
/// KHR_materials_scatter (Kulla and Conty 2017, with similarity in g; index-matched boundary).
double albedo_from_multiscatter(double colour, double g);

}  // namespace alabaster

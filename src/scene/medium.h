#pragma once

#include <memory>

#include "core/rgb.h"
#include "texture/albedo_field.h"

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

}  // namespace alabaster

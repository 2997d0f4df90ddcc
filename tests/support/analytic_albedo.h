#pragma once

#include <algorithm>
#include <cmath>

#include "core/vec.h"
#include "texture/albedo_field.h"

/// alpha = mean + amplitude cos(2 pi frequency . uv), per channel mean and amplitude: its average under a
/// Gaussian is known exactly. Amplitude 0 is the constant field.
class CosineAlbedo final : public alabaster::AlbedoField {
 public:
  CosineAlbedo(const alabaster::Rgb& mean, const alabaster::Rgb& amplitude = {},
               alabaster::Vec2 frequency = {1, 0})
      : mean_(mean), amplitude_(amplitude), frequency_(frequency) {}
  alabaster::Rgb at(const alabaster::SurfacePoint& point) const override { return value(point.uv, 0); }
  alabaster::Rgb filtered(const alabaster::KernelFootprint& footprint) const override {
    const alabaster::Vec2 per_metre = glm::transpose(footprint.uv_from_surface) * frequency_;
    const double sigma = 2 * alabaster::pi * footprint.sigma;
    return value(footprint.uv, 0.5 * sigma * sigma * glm::dot(per_metre, per_metre));
  }
  alabaster::Rgb max() const override {
    return {mean_.r + std::abs(amplitude_.r), mean_.g + std::abs(amplitude_.g),
            mean_.b + std::abs(amplitude_.b)};
  }

 private:
  alabaster::Rgb value(alabaster::Vec2 uv, double attenuation) const {
    const double wave = std::cos(2 * alabaster::pi * glm::dot(frequency_, uv)) * std::exp(-attenuation);
    return {std::max(0.0, mean_.r + wave * amplitude_.r), std::max(0.0, mean_.g + wave * amplitude_.g),
            std::max(0.0, mean_.b + wave * amplitude_.b)};
  }
  alabaster::Rgb mean_, amplitude_;
  alabaster::Vec2 frequency_;
};

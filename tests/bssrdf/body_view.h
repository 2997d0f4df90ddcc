#pragma once

#include <vector>

#include "body_transfer.h"
#include "optics/light_aim.h"
#include "optics/path_tally.h"

namespace alabaster {

/// A body by equations before a far camera: exits spread over what is seen of it (what hides what is left
/// out, for walks and bases alike), each with its share of the image.
struct BodyView {
  AnalyticBody body;
  Vec3 camera, key;
  std::vector<Vec3> exits;
  std::vector<double> share;  // of the image
};

/// As the sky of the study scenes.
struct Sky {
  double ambient, strength;
  Vec3 direction;
  double radiance(const Vec3& w) const {
    const double c = std::max(0.0, glm::dot(w, direction));
    return ambient + strength * c * c * c * c;
  }
};

/// Outgoing light over T(cos)/(pi c)'s, by cosine: straight lines through the bins' middles.
struct Lobe {
  std::vector<double> value = std::vector<double>(PathTally::cosine_bins, 1.0);
  double at(double cosine) const {
    const double x = std::clamp(cosine * PathTally::cosine_bins - 0.5, 0.0, PathTally::cosine_bins - 1.001);
    const auto i = static_cast<std::size_t>(x);
    return value[i] + (x - static_cast<double>(i)) * (value[i + 1] - value[i]);
  }
  static Lobe of(const PathTally& tally, double albedo) {
    const std::vector<Estimate> ratio = exit_lobe_ratio(tally, albedo, 1.5);
    Lobe lobe;
    for (std::size_t k = 0; k < ratio.size(); ++k) lobe.value[k] = ratio[k].value;
    return lobe;
  }
};

/// Irradiance that enters over pi c, by the cosine between normal and key.
struct Entering {
  std::vector<double> value;
  double at(double cosine) const {
    const double x = std::clamp(32 * (cosine + 1), 0.0, 63.999);
    const auto i = static_cast<std::size_t>(x);
    return value[i] + (x - static_cast<double>(i)) * (value[i + 1] - value[i]);
  }
  Entering(const Sky& sky, const Lobe& lobe) {
    for (int k = 0; k <= 64; ++k) {
      const double along = k / 32.0 - 1, across = std::sqrt(std::max(0.0, 1 - along * along));
      Sky turned = sky;
      turned.direction = Vec3(across, 0, along);
      double sum = 0, norm = 0;
      for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
          const double mu = std::sqrt((i + 0.5) / 64), phi = 2 * pi * (j + 0.5) / 64;
          const double s = std::sqrt(1 - mu * mu);
          const double weight = 1 - fresnel_dielectric(mu, 1.5);
          norm += weight;
          sum += weight * lobe.at(mu) * turned.radiance(Vec3(s * std::cos(phi), s * std::sin(phi), mu));
        }
      value.push_back(sum / norm);
    }
  }
};

inline Vec3 refracted_inwards(const Vec3& viewer, const Vec3& n, double eta) {
  const Vec3 along = (glm::dot(viewer, n) * n - viewer) / eta;
  return glm::normalize(along - std::sqrt(std::max(0.0, 1 - glm::dot(along, along))) * n);
}
inline Vec3 refracted_outwards(const Vec3& inside, const Vec3& n, double eta) {
  const Vec3 along = eta * (inside - glm::dot(inside, n) * n);
  return glm::normalize(along + std::sqrt(std::max(0.0, 1 - glm::dot(along, along))) * n);
}

/// Directions spread evenly over the sphere, for light of a sky that is aimed.
class SkyDirections {
 public:
  explicit SkyDirections(const Sky& sky) {
    constexpr int count = 400;
    for (int k = 0; k < count; ++k) {
      const double z = 1 - 2 * (k + 0.5) / count, s = std::sqrt(1 - z * z), azimuth = 2.399963229728653 * k;
      const Vec3 w(s * std::cos(azimuth), s * std::sin(azimuth), z);
      directions_.push_back({w, sky.radiance(w)});
    }
  }
  /// The mean of the aim over the irradiance that enters, of the sky's light or of uniform light.
  double mean(const LightAim& aim, bool lit_by_sky, const Vec3& normal) const {
    double sum = 0, norm = 0;
    for (const auto& [w, radiance] : directions_) {
      const double cosine = glm::dot(w, normal);
      if (cosine <= 0) continue;
      const double light = cosine * (1 - fresnel_dielectric(cosine, 1.5)) * (lit_by_sky ? radiance : 1);
      sum += light * aim.at(w).r;
      norm += light;
    }
    return sum / norm;
  }

 private:
  std::vector<std::pair<Vec3, double>> directions_;
};

/// Walks back from the exit, along the camera's ray or as from uniform radiance; score(order, normal and
/// direction outside where light came in).
template <typename Score>
void walk_pixel(const BodyView& view, const Vec3& exit, bool diffuse, int photons, uint64_t seed,
                const Score& score) {
  const WalkMedium medium;
  const Vec3 n = view.body.normal(exit);
  const Frame frame(-n);
  Rng rng(seed, diffuse ? 1 : 2);
  for (int k = 0; k < photons; ++k) {
    Photon photon;
    photon.position = exit;
    photon.direction = diffuse ? frame.to_world(sample_diffuse_entry(medium.eta, rng))
                               : refracted_inwards(view.camera, n, medium.eta);
    const WalkEnd end =
        walk(view.body, medium, photon, rng, [](const Photon& p, Rng&) { return p.order < 2000; });
    if (end == WalkEnd::stopped || photon.order == 0) continue;
    const Vec3 normal = view.body.normal(photon.position);
    score(photon.order, normal, refracted_outwards(photon.direction, normal, medium.eta));
  }
}

inline BodyView make_view(const AnalyticBody& body, const Vec3& camera, const Vec3& key, int count) {
  BodyView view{body, glm::normalize(camera), glm::normalize(key), {}, {}};
  Rng rng(11);
  while (static_cast<int>(view.exits.size()) < count) {
    const auto& patch = body.patches[rng.next() % body.patches.size()];
    const Vec2 s(rng.uniform(), rng.uniform());
    const Vec3 p = patch(s);
    const double step = 1e-5;
    const double area =
        glm::length(glm::cross(patch(s + Vec2(step, 0)) - p, patch(s + Vec2(0, step)) - p) / (step * step));
    const double facing = glm::dot(body.normal(p), view.camera);
    if (facing <= 0.02) continue;
    view.exits.push_back(body.onto(p));
    view.share.push_back(area * facing);
  }
  return view;
}

}  // namespace alabaster

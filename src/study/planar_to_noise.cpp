#include "study/planar_to_noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "scene/film.h"

namespace alabaster {

namespace {

constexpr uint32_t least_samples = 2;        // a variance needs two
constexpr uint32_t most_samples = 1u << 20;  // of one pixel

/// The root mean square of one sample's value by the exit's distance from the light's centre.
class RadialPilot {
 public:
  RadialPilot(const PlanarIntegrator& integrator, const PlanarModel& model, uint64_t seed)
      : centre_(model.scene().light.centre), reach_(model.scene().light.radius) {
    const PlanarView& view = model.scene().view;
    const double farthest = glm::length(glm::abs(view.centre - centre_) + 0.5 * view.size);
    rms_.resize(1 + ring_of(farthest));
    Sampler sampler(SamplerKind::independent, seed);
    for (std::size_t ring = 0; ring < rms_.size(); ++ring) {
      double squares = 0;
      for (int i = 0; i < samples; ++i) {
        sampler.start(-1, static_cast<int>(ring), static_cast<uint32_t>(i));
        const Vec2 u = sampler.get_2d(Dimension::pixel);
        const double r = reach_ * (static_cast<double>(ring) + u.x) / rings_per_radius;
        // A golden section apart: the angles of a ring are spread evenly.
        const double angle = 2 * pi * (i * 0.6180339887498949 + u.y / samples);
        const BssrdfPoint exit = model.point(centre_ + r * Vec2(std::cos(angle), std::sin(angle)));
        const Rgb value = integrator.radiance(exit, sampler);
        squares += (value * value).mean();
      }
      rms_[ring] = std::sqrt(squares / samples);
    }
  }

  double rms(Vec2 exit) const {
    return rms_[std::min(ring_of(glm::distance(exit, centre_)), rms_.size() - 1)];
  }

 private:
  static constexpr int samples = 64, rings_per_radius = 6;
  std::size_t ring_of(double distance) const {
    return static_cast<std::size_t>(distance / reach_ * rings_per_radius);
  }

  Vec2 centre_;
  double reach_;
  std::vector<double> rms_;
};

std::vector<double> pixel_shares(const PlanarIntegrator& integrator, const PlanarModel& model,
                                 uint64_t seed) {
  const PlanarView& view = model.scene().view;
  std::vector<double> shares(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height), 1);
  if (model.scene().light.shape == PlanarLight::Shape::plane) return shares;
  const RadialPilot pilot(integrator, model, seed);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const auto width = static_cast<std::size_t>(view.width);
    const Vec2 pixel(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
    shares[i] = pilot.rms(view.point(pixel));
  }
  return shares;
}

/// An image that grows where its shares say.
class SharedOut {
 public:
  SharedOut(const PlanarIntegrator& integrator, std::vector<double> shares, uint64_t seed)
      : integrator_(integrator),
        shares_(std::move(shares)),
        seed_(seed),
        film_(integrator.width(), integrator.height(), SamplerKind::sobol) {
    total_share_ = std::accumulate(shares_.begin(), shares_.end(), 0.0);
  }

  /// Brings every pixel to its share of `samples`.
  void grow(double samples) {
    const auto width = static_cast<std::size_t>(integrator_.width());
    parallel_for(shares_.size(), 64, [&](std::size_t begin, std::size_t end) {
      Sampler sampler(SamplerKind::sobol, seed_);
      for (std::size_t i = begin; i < end && !cancellation_requested(); ++i) {
        const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
        const double wanted = total_share_ > 0 ? std::ceil(samples * shares_[i] / total_share_) : 0;
        const auto target = static_cast<uint32_t>(std::clamp<double>(wanted, least_samples, most_samples));
        for (uint32_t k = film_.count(x, y); k < target; ++k) {
          sampler.start(x, y, k);
          film_.add(x, y, integrator_.sample(x, y, sampler).radiance, 1, nullptr);
        }
      }
    });
  }

  const Film& film() const { return film_; }

 private:
  const PlanarIntegrator& integrator_;
  std::vector<double> shares_;
  double total_share_ = 0;
  uint64_t seed_;
  Film film_;
};

}  // namespace

TimedImage render_planar_to_noise(const PlanarScene& scene, const PlanarMethod& method,
                                  const ProfileTable& profile, double noise, uint64_t seed) {
  const double wall = wall_seconds(), cpu = cpu_seconds();
  const PlanarModel model(scene, method.model, profile, method.options);
  const PlanarIntegrator integrator(model, method.sampling);
  SharedOut image(integrator, pixel_shares(integrator, model, seed + 0x9e3779b97f4a7c15ULL), seed);
  TimedImage result;
  double samples = 2.0 * integrator.width() * integrator.height();
  for (;;) {
    image.grow(samples);
    result.image = image.film().develop();
    const double now = noise_of(result.image);
    if (now <= noise || cancellation_requested()) break;
    // Noise falls at least as 1 / sqrt(samples); a little less than what that asks for, then look again.
    const double factor = std::clamp(0.8 * std::pow(now / noise, 2), 1.1, 8.0);
    if (samples * factor > most_samples * static_cast<double>(integrator.width())) break;
    samples *= factor;
  }
  result.samples = image.film().total_count();
  result.seconds = wall_seconds() - wall;
  result.cpu_seconds = cpu_seconds() - cpu;
  return result;
}

}  // namespace alabaster

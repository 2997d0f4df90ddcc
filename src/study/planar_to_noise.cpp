#include "study/planar_to_noise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/sampler.h"

namespace alabaster {

namespace {

constexpr double most_samples = 1u << 20;  // of a pixel, in the mean

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
        const BssrdfPoint exit = model.exit(centre_ + r * Vec2(std::cos(angle), std::sin(angle)));
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

/// An image that grows where its shares say. A pixel's samples are two independently scrambled sets, equally
/// long and as long as possible: the integral over the light is smooth but for the texture, so that their
/// error falls faster than that of many short ones; the noise follows from the differences of the two over
/// all pixels.
class SharedOut {
 public:
  SharedOut(const PlanarIntegrator& integrator, std::vector<double> shares, uint64_t seed)
      : integrator_(integrator), shares_(std::move(shares)), seed_(seed), pixels_(shares_.size()) {
    total_share_ = std::accumulate(shares_.begin(), shares_.end(), 0.0);
  }

  /// Brings every pixel to its share of `samples`.
  void grow(double samples) {
    const auto width = static_cast<std::size_t>(integrator_.width());
    parallel_for(pixels_.size(), 64, [&](std::size_t begin, std::size_t end) {
      Sampler sampler(SamplerKind::sobol, seed_);
      for (std::size_t i = begin; i < end && !cancellation_requested(); ++i) {
        const double wanted = total_share_ > 0 ? 0.5 * samples * shares_[i] / total_share_ : 0;
        const uint32_t length = length_of_set(wanted);
        Pixel& pixel = pixels_[i];
        const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
        for (; pixel.length < length; ++pixel.length)
          for (uint32_t set = 0; set < 2; ++set) {
            sampler.start(x, y, first_sample + set * longest_set + pixel.length);
            pixel.sums[set] += integrator_.sample(x, y, sampler).radiance;
          }
      }
    });
  }

  uint64_t samples() const {
    uint64_t total = 0;
    for (const Pixel& pixel : pixels_) total += 2 * pixel.length;
    return total;
  }

  Image develop() const {
    const int width = integrator_.width(), height = integrator_.height();
    Image image(width, height, {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B", "samples.Y"});
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const Pixel& pixel = pixels_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                                     static_cast<std::size_t>(x)];
        const double length = std::max<uint32_t>(pixel.length, 1);
        const Rgb half_difference = (pixel.sums[0] - pixel.sums[1]) / (2 * length);
        image.set_rgb(0, x, y, (pixel.sums[0] + pixel.sums[1]) / (2 * length));
        image.at(3, x, y) = 1;
        image.set_rgb(4, x, y, half_difference * half_difference);
        image.at(7, x, y) = static_cast<float>(2 * pixel.length);
      }
    return image;
  }

 private:
  // Two scrambled sets of the sampler that are longer than any pixel will ask for.
  static constexpr uint32_t size_class = 14, longest_set = 4u << size_class,
                            first_sample = 16 * 4 * ((1u << size_class) - 1);
  struct Pixel {
    std::array<Rgb, 2> sums;
    uint32_t length = 0;  // of either set so far
  };

  /// At least `wanted`: two leading binary digits and zeros, of which the points are stratified best.
  static uint32_t length_of_set(double wanted) {
    const auto least = static_cast<uint32_t>(std::clamp(std::ceil(wanted), 1.0, double{longest_set}));
    const uint32_t step = std::max(std::bit_floor(least) / 2, 1u);
    return std::min((least + step - 1) / step * step, longest_set);
  }

  const PlanarIntegrator& integrator_;
  std::vector<double> shares_;
  double total_share_ = 0;
  uint64_t seed_;
  std::vector<Pixel> pixels_;
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
    result.image = image.develop();
    const double now = noise_of(result.image);
    if (now <= noise || cancellation_requested()) break;
    // Noise falls at least as 1 / sqrt(samples), mostly faster; then look again.
    const double factor = std::clamp(std::pow(now / noise, 1.6), 1.1, 8.0);
    if (samples * factor > most_samples * integrator.width() * integrator.height()) break;
    samples *= factor;
  }
  result.samples = image.samples();
  result.seconds = wall_seconds() - wall;
  result.cpu_seconds = cpu_seconds() - cpu;
  return result;
}

}  // namespace alabaster

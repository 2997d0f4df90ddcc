#include "image/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"

namespace alabaster {

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

std::optional<ColourChannels> variance_channels(const Image& image, const ColourChannels& colour) {
  return find_layer(image, colour.layer.empty() ? "variance" : colour.layer + ".variance");
}

// Values of both pictures side by side, one entry per compared channel of a pixel.
struct Samples {
  std::vector<double> a, b, variance_a, variance_b;  // variances empty where unknown
  std::size_t pixels = 0;
  bool finite = true;
  bool grey = true;  // the channels of a are copies of one

  bool has_variances() const { return !variance_a.empty() && !variance_b.empty(); }
  /// How many values repeat each independent one.
  double repeats() const { return grey ? 3 : 1; }
};

ColourChannels colour_of(const Image& image, const std::string& name) {
  const auto colour = find_colour(image);
  if (!colour) throw InputError(name, "has no channels R, G and B to compare");
  return *colour;
}

Samples collect(const Image& a, const Image& b, const CompareOptions& options, const std::string& name_a,
                const std::string& name_b) {
  if (a.width() != b.width() || a.height() != b.height())
    throw InputError(name_a, std::to_string(a.width()) + " x " + std::to_string(a.height()) +
                                 " pixels cannot be compared with " + name_b + ": " +
                                 std::to_string(b.width()) + " x " + std::to_string(b.height()) +
                                 "; render both at one size");
  const ColourChannels colour_a = colour_of(a, name_a), colour_b = colour_of(b, name_b);
  const auto variance_a = variance_channels(a, colour_a), variance_b = variance_channels(b, colour_b);
  Samples samples;
  std::size_t pixel = 0;
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x, ++pixel) {
      if (!options.mask.empty() && !options.mask[pixel]) continue;
      const Rgb va = colour_a.get(a, x, y), vb = colour_b.get(b, x, y);
      const Rgb da = variance_a ? variance_a->get(a, x, y) : Rgb(0),
                db = variance_b ? variance_b->get(b, x, y) : Rgb(0);
      if (!(va.is_finite() && vb.is_finite() && da.is_finite() && db.is_finite())) {
        samples.finite = false;
        continue;
      }
      ++samples.pixels;
      samples.grey &= va.r == va.g && va.g == va.b;
      for (int c = 0; c < 3; ++c) {
        samples.a.push_back(va[c]);
        samples.b.push_back(vb[c]);
        if (variance_a) samples.variance_a.push_back(da[c]);
        if (variance_b) samples.variance_b.push_back(db[c]);
      }
    }
  if (samples.pixels == 0) throw InputError(name_a, "has no finite pixel inside the mask to compare");
  return samples;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

// Multiplies a so that |a - b|^2 is least.
double fit_scale(Samples& samples) {
  double ab = 0, aa = 0;
  for (std::size_t i = 0; i < samples.a.size(); ++i) {
    ab += samples.a[i] * samples.b[i];
    aa += samples.a[i] * samples.a[i];
  }
  const double scale = aa > 0 ? ab / aa : 1;
  for (double& v : samples.a) v *= scale;
  for (double& v : samples.variance_a) v *= scale * scale;
  return scale;
}

constexpr double two_sided_95 = 1.96;

void add_log_ratio(const Samples& samples, Metrics& metrics) {
  const double cap = std::log(1000.0);
  const double largest = *std::max_element(samples.b.begin(), samples.b.end());
  double sum = 0, variance = 0;
  std::size_t count = 0, bright = 0, bright_kept = 0;
  for (std::size_t i = 0; i < samples.b.size(); ++i) {
    const double a = samples.a[i], b = samples.b[i];
    const double error = samples.variance_b.empty() ? 0 : std::sqrt(std::max(0.0, samples.variance_b[i]));
    const bool keep = b > 0 && b > 10 * error;
    if (b > 1e-4 * largest) {
      ++bright;
      if (keep) ++bright_kept;
    }
    if (!keep) continue;
    ++count;
    sum += a > 0 ? std::min(cap, std::abs(std::log(a / b))) : cap;
    if (samples.has_variances())
      variance += (a > 0 ? samples.variance_a[i] / (a * a) : 0) + samples.variance_b[i] / (b * b);
  }
  metrics.mean_abs_log_ratio = count > 0 ? sum / static_cast<double>(count) : not_a_number;
  if (samples.has_variances() && count > 0)
    metrics.log_interval =
        two_sided_95 * std::sqrt(samples.repeats() * variance) / static_cast<double>(count);
  metrics.kept = bright > 0 ? static_cast<double>(bright_kept) / static_cast<double>(bright) : 0;
}

// The intervals of bias and mean_bias. `power` is the mean square of b.
void add_intervals(const Samples& samples, double power, Metrics& metrics) {
  double variance = 0, spread = 0;
  for (std::size_t i = 0; i < samples.a.size(); ++i) {
    const double d = samples.a[i] - samples.b[i], v = samples.variance_a[i] + samples.variance_b[i];
    variance += v;
    // Variance of d^2 where d is normal around its mean: 4 mean^2 v + 2 v^2, mean^2 estimated by d^2 - v.
    spread += std::max(0.0, 4 * d * d * v - 2 * v * v);
  }
  const auto count = static_cast<double>(samples.a.size());
  const double x_interval = two_sided_95 * std::sqrt(samples.repeats() * spread) / (count * power);
  // d sqrt(x) = dx / (2 sqrt(x)), but no more than sqrt(dx) where x is lost in it.
  metrics.bias_interval =
      std::min(x_interval / (2 * std::max(std::abs(*metrics.bias), 1e-12)), std::sqrt(x_interval));
  metrics.mean_bias_interval =
      two_sided_95 * std::sqrt(samples.repeats() * variance) / (count * metrics.mean_b);
}

}  // namespace

Metrics compare_images(const Image& a, const Image& b, const CompareOptions& options,
                       const std::string& name_a, const std::string& name_b) {
  Samples samples = collect(a, b, options, name_a, name_b);
  Metrics metrics;
  if (options.fit_scale) metrics.scale = fit_scale(samples);
  metrics.pixels = samples.pixels;
  metrics.finite = samples.finite;
  metrics.mean_a = mean(samples.a);
  metrics.mean_b = mean(samples.b);

  double squared = 0, power = 0, relative = 0;
  const double floor = 0.01 * metrics.mean_b * metrics.mean_b;
  for (std::size_t i = 0; i < samples.a.size(); ++i) {
    const double difference = samples.a[i] - samples.b[i], b2 = samples.b[i] * samples.b[i];
    squared += difference * difference;
    power += b2;
    relative += difference == 0 ? 0 : difference * difference / (b2 + floor);
  }
  const auto count = static_cast<double>(samples.a.size());
  squared /= count;
  power /= count;
  // Two equal black pictures do not differ; anything differs infinitely from a black one.
  const auto over_power = [&](double x) { return x == 0 ? 0 : x / power; };
  metrics.rel_mse = relative / count;
  metrics.rmse_over_rms = std::sqrt(over_power(squared));
  metrics.rmse_over_mean = squared == 0 ? 0 : std::sqrt(squared) / std::abs(metrics.mean_b);
  metrics.mean_bias = metrics.mean_a == metrics.mean_b ? 0 : metrics.mean_a / metrics.mean_b - 1;
  if (samples.has_variances()) {
    const double variance = mean(samples.variance_a) + mean(samples.variance_b);
    const double x = over_power(squared - variance);
    metrics.bias = std::copysign(std::sqrt(std::abs(x)), x);
    metrics.noise = std::sqrt(over_power(variance));
    if (power > 0) add_intervals(samples, power, metrics);
  }
  add_log_ratio(samples, metrics);
  return metrics;
}

bool has_variance(const Image& image) {
  const auto colour = find_colour(image);
  return colour && variance_channels(image, *colour);
}

}  // namespace alabaster

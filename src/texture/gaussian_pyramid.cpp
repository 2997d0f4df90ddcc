#include "texture/gaussian_pyramid.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstring>

#include "core/parallel.h"

namespace alabaster {

namespace {

// Four floats that the compiler keeps in one register (GCC and Clang vector extension).
using Float4 = float __attribute__((vector_size(16)));

// Spacings: level 1 has 2 texels per sample, further ones sqrt(2.5) times more each, so that all of them
// together are 0.42 of the texture. Every sample averages a Gaussian of 0.4 spacings squared, and the kernel
// that reads a level has between 0.4 and 1.6: the alias of the pair is at most exp(-0.4 pi^2) = 1.9 % of a
// sinusoid of the worst frequency.
constexpr double first_spacing = 2, spacing_ratio = 1.58113883008419;
constexpr double level_blur = 0.4, narrowest_kernel = 0.4, widest_kernel = 3.2;
constexpr int margin = 5;
constexpr int max_taps = 10;
// Sums of weights below this are too far from any covered texel to be meant.
constexpr float least_weight = 1e-6f;
// Below it the finest level's own reconstruction is blended with this kernel.
constexpr double bell_from = 0.45;

double reconstruction_variance(Filter filter) {
  return filter == Filter::nearest ? 1.0 / 12 : 1.0 / 6;  // box; tent, averaged over the texel
}

// Weights of `taps` neighbouring samples around a position `fraction` of a spacing after the middle pair's
// first, for a kernel of that variance (spacings squared): a bell that falls to exactly 0 at taps / 2, so
// that the sum is continuous when the taps move on by one.
template <int taps>
void bell_weights(float fraction, float variance, float* weights) {
  constexpr float reach = taps / 2;
  const float t = 8 * variance / (reach * reach);
  // Subtracting the pedestal narrows the bell; this widens it again (a fit, within 0.1 % for t <= 1.05).
  const float nominal = variance * (1 + t * t * t * (-0.0867341f + t * (0.1663139f + t * 0.1145253f)));
  // (1 - x^2 / (67 v))^32 has variance v and is all but Gaussian (excess kurtosis -0.09).
  const float scale = 1 / (67 * nominal);
  const auto bell = [scale](float x) {
    float b = std::max(0.0f, 1 - x * x * scale);
    b *= b, b *= b, b *= b, b *= b;
    return b * b;
  };
  const float pedestal = bell(reach);
  float sum = 0;
  for (int i = 0; i < taps; ++i) {
    weights[i] = std::max(0.0f, bell(static_cast<float>(i + 1) - reach - fraction) - pedestal);
    sum += weights[i];
  }
  const float normalise = 1 / sum;
  for (int i = 0; i < taps; ++i) weights[i] *= normalise;
}

template <int taps>
Float4 gather_taps(const Vec4f* corner, std::size_t stride, const float* u_weights, const float* v_weights) {
  Float4 sum{};
  for (int j = 0; j < taps; ++j, corner += stride) {
    Float4 row{};
    for (int i = 0; i < taps; ++i) {
      Float4 texel;
      std::memcpy(&texel, corner + i, sizeof texel);
      row += texel * u_weights[i];
    }
    sum += row * v_weights[j];
  }
  return sum;
}

// A texture coordinate brought into [0, 1]; NaN becomes 0.
double wrap_coordinate(double s, Wrap wrap) {
  if (wrap == Wrap::clamp) return s > 0 ? std::min(s, 1.0) : 0.0;
  if (wrap == Wrap::mirror) {
    s -= 2 * std::floor(0.5 * s);
    if (s > 1) s = 2 - s;
  } else {
    s -= std::floor(s);
  }
  return s >= 0 && s <= 1 ? s : 0;
}

// Index into a row for the margin of a level: -1 where there is no surface.
int margin_index(int i, int size, Wrap wrap) {
  return wrap == Wrap::clamp && (i < 0 || i >= size) ? -1 : wrap_index(i, size, wrap);
}

// One sample of a coarser axis as a sum over the finer one.
struct Resampling {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Resampling> gaussian_resampling(int from, int to, double variance) {
  std::vector<Resampling> rows(static_cast<std::size_t>(to));
  const double ratio = static_cast<double>(from) / to, reach = 4.6 * std::sqrt(variance);
  for (int j = 0; j < to; ++j) {
    Resampling& row = rows[static_cast<std::size_t>(j)];
    if (from == to) {
      row = {j, {1.0f}};
      continue;
    }
    const double centre = (j + 0.5) * ratio - 0.5;
    row.first = static_cast<int>(std::ceil(centre - reach));
    const int last = static_cast<int>(std::floor(centre + reach));
    double sum = 0;
    for (int i = row.first; i <= last; ++i) sum += std::exp(-0.5 * (i - centre) * (i - centre) / variance);
    for (int i = row.first; i <= last; ++i)
      row.weights.push_back(
          static_cast<float>(std::exp(-0.5 * (i - centre) * (i - centre) / variance) / sum));
  }
  return rows;
}

// The next coarser extent of an axis. It stays when too few samples would be left, or when the step would be
// too small for a Gaussian sampled on the finer grid.
int coarser_extent(int finest, int current, double spacing, Wrap wrap) {
  const int least = wrap == Wrap::repeat ? 4 : 2;
  const int next = std::max(least, static_cast<int>(std::ceil(finest / spacing)));
  const bool worth_it = 1.8 * next * next <= static_cast<double>(current) * current;
  return next < current && worth_it ? next : current;
}

}  // namespace

const Vec4f* GaussianPyramid::Level::sample(int x, int y) const {
  return texels.data() + static_cast<std::size_t>(y + margin) * stride + static_cast<std::size_t>(x + margin);
}
Vec4f* GaussianPyramid::Level::sample(int x, int y) {
  return texels.data() + static_cast<std::size_t>(y + margin) * stride + static_cast<std::size_t>(x + margin);
}

GaussianPyramid::Level GaussianPyramid::allocate(int width, int height) {
  Level level;
  level.extent[0] = width;
  level.extent[1] = height;
  level.stride = static_cast<std::size_t>(width + 2 * margin);
  level.texels.assign(level.stride * static_cast<std::size_t>(height + 2 * margin), Vec4f(0));
  return level;
}

void GaussianPyramid::fill_margin(Level& level) const {
  const int w = level.extent[0], h = level.extent[1];
  for (int y = -margin; y < h + margin; ++y) {
    const int from_y = margin_index(y, h, wrap_[1]);
    const bool inner_row = y >= 0 && y < h;
    for (int x = -margin; x < w + margin; ++x) {
      if (inner_row && x == 0) x = w;
      const int from_x = margin_index(x, w, wrap_[0]);
      *level.sample(x, y) = from_x < 0 || from_y < 0 ? Vec4f(0) : *level.sample(from_x, from_y);
    }
  }
}

GaussianPyramid::GaussianPyramid(const TexelArray& texels, std::vector<float> coverage, Wrap wrap_u,
                                 Wrap wrap_v, Filter filter)
    : wrap_{wrap_u, wrap_v}, filter_(filter) {
  assert(texels.width > 0 && texels.height > 0);
  assert(coverage.empty() || coverage.size() == texels.texels.size());
  if (std::none_of(coverage.begin(), coverage.end(), [](float c) { return c > 0; })) coverage.clear();
  Level finest = allocate(texels.width, texels.height);
  for (std::size_t axis = 0; axis < 2; ++axis) finest.samples_per_texel[axis] = 1;
  Vec4 sum(0);
  max_ = Rgb(-std::numeric_limits<double>::infinity());
  for (int y = 0, i = 0; y < texels.height; ++y)
    for (int x = 0; x < texels.width; ++x, ++i) {
      const float weight = coverage.empty() ? 1.0f : coverage[static_cast<std::size_t>(i)];
      if (!(weight > 0)) continue;
      const Vec4f& texel = texels.at(x, y);
      const Vec4f weighted(texel.x * weight, texel.y * weight, texel.z * weight, weight);
      *finest.sample(x, y) = weighted;
      sum += Vec4(weighted);
      for (int c = 0; c < 3; ++c) max_[c] = std::max(max_[c], static_cast<double>(texel[c]));
    }
  mean_ = Vec4f(sum / (static_cast<double>(texels.width) * texels.height));
  fill_margin(finest);
  levels_.push_back(std::move(finest));
  add_coarser_levels();
}

GaussianPyramid::Level GaussianPyramid::coarser(const Level& level, int width, int height) const {
  const int extent[2] = {width, height};
  Level result = allocate(width, height);
  std::array<std::vector<Resampling>, 2> rows;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const int from = level.extent[axis], to = extent[axis];
    const double spacing = static_cast<double>(from) / to;  // of the finer level's samples
    result.samples_per_texel[axis] = level.samples_per_texel[axis] / spacing;
    result.blur[axis] = from == to ? level.blur[axis] : level_blur;
    rows[axis] = gaussian_resampling(from, to, level_blur * spacing * spacing - level.blur[axis]);
  }
  const auto filter_axis = [](const std::vector<Resampling>& taps, int size, Wrap wrap, int j, auto&& read) {
    const Resampling& row = taps[static_cast<std::size_t>(j)];
    Vec4 sum(0);
    for (std::size_t k = 0; k < row.weights.size(); ++k)
      if (const int i = margin_index(row.first + static_cast<int>(k), size, wrap); i >= 0)
        sum += static_cast<double>(row.weights[k]) * Vec4(*read(i));
    return Vec4f(sum);
  };
  Level narrow = allocate(width, level.extent[1]);  // filtered along u alone
  parallel_for(static_cast<std::size_t>(level.extent[1]), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width; ++x)
        *narrow.sample(x, y) =
            filter_axis(rows[0], level.extent[0], wrap_[0], x, [&](int i) { return level.sample(i, y); });
  });
  parallel_for(static_cast<std::size_t>(height), 16, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < width; ++x)
        *result.sample(x, y) =
            filter_axis(rows[1], level.extent[1], wrap_[1], y, [&](int i) { return narrow.sample(x, i); });
  });
  fill_margin(result);
  return result;
}

void GaussianPyramid::add_coarser_levels() {
  double spacing = first_spacing;
  const int longest = std::max(width(), height());
  for (; spacing < 2.0 * longest; spacing *= spacing_ratio) {
    const Level& last = levels_.back();
    const int w = coarser_extent(width(), last.extent[0], spacing, wrap_[0]);
    const int h = coarser_extent(height(), last.extent[1], spacing, wrap_[1]);
    if (w == last.extent[0] && h == last.extent[1]) continue;
    Level next = coarser(last, w, h);
    for (std::size_t axis = 0; axis < 2; ++axis)
      if (next.extent[axis] != last.extent[axis])
        next.first_variance =
            std::max(next.first_variance, (level_blur + narrowest_kernel) /
                                              (next.samples_per_texel[axis] * next.samples_per_texel[axis]));
    levels_.push_back(std::move(next));
  }
  const Level& coarsest = levels_.back();
  for (std::size_t axis = 0; axis < 2; ++axis)
    mean_from_ =
        std::max(mean_from_, (coarsest.blur[axis] + widest_kernel) /
                                 (coarsest.samples_per_texel[axis] * coarsest.samples_per_texel[axis]));
}

Rgb GaussianPyramid::mean() const {
  return Rgb(mean_.x, mean_.y, mean_.z) / mean_.w;
}

std::size_t GaussianPyramid::memory_bytes() const {
  std::size_t bytes = sizeof *this;
  for (const Level& level : levels_) bytes += sizeof level + level.texels.size() * sizeof(Vec4f);
  return bytes;
}

Vec4f GaussianPyramid::gather(Vec2 st, double variance) const {
  const double total = variance + reconstruction_variance(filter_);
  std::size_t k = 0;
  while (k + 1 < levels_.size() && total >= levels_[k + 1].first_variance) ++k;
  const Level& level = levels_[k];

  int first[2];
  float fraction[2], kernel[2];
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double q = wrap_coordinate(st[static_cast<int>(axis)], wrap_[axis]) * level.extent[axis] - 0.5;
    const double below = std::floor(q);
    first[axis] = static_cast<int>(below);
    fraction[axis] = static_cast<float>(q - below);
    const double scale = level.samples_per_texel[axis];
    kernel[axis] = static_cast<float>(std::min(total * scale * scale - level.blur[axis], widest_kernel));
  }
  alignas(16) float weights[2][max_taps + 2];
  const auto gather_bell = [&]<int taps>(std::integral_constant<int, taps>) {
    for (std::size_t axis = 0; axis < 2; ++axis)
      bell_weights<taps>(fraction[axis], kernel[axis], weights[axis]);
    return gather_taps<taps>(level.sample(first[0] - taps / 2 + 1, first[1] - taps / 2 + 1), level.stride,
                             weights[0], weights[1]);
  };
  const float widest = std::max(kernel[0], kernel[1]);
  Float4 sum;
  if (widest > 2.0f) {
    sum = gather_bell(std::integral_constant<int, 10>());
  } else if (widest > 1.1f) {
    sum = gather_bell(std::integral_constant<int, 8>());
  } else if (widest > static_cast<float>(bell_from)) {
    sum = gather_bell(std::integral_constant<int, 6>());
  } else {
    // Between the finest level's own reconstruction and the narrowest bell, by variance.
    const double own = reconstruction_variance(filter_);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      float* w = weights[axis];
      bell_weights<4>(fraction[axis], static_cast<float>(bell_from), w);
      const auto share = static_cast<float>(std::clamp((kernel[axis] - own) / (bell_from - own), 0.0, 1.0));
      for (int i = 0; i < 4; ++i) w[i] *= share;
      const float upper = filter_ == Filter::linear ? fraction[axis] : (fraction[axis] < 0.5f ? 0.0f : 1.0f);
      w[1] += (1 - share) * (1 - upper);
      w[2] += (1 - share) * upper;
    }
    sum = gather_taps<4>(level.sample(first[0] - 1, first[1] - 1), level.stride, weights[0], weights[1]);
  }
  Vec4f result;
  std::memcpy(&result, &sum, sizeof result);
  if (total > mean_from_) {
    const auto share = static_cast<float>(std::min(total / mean_from_ - 1, 1.0));
    result = (1 - share) * result + share * mean_;
  }
  return result;
}

Rgb GaussianPyramid::resolve(Vec2 st, double sigma_texels, const Vec4f& sum) const {
  if (sum.w > least_weight) return Rgb(sum.x, sum.y, sum.z) / sum.w;
  // No covered texel near: widen until there is one.
  const double whole = 4.0 * std::max(width(), height());
  for (double sigma = std::max(1.0, 2 * sigma_texels); sigma < whole; sigma *= 2)
    if (const Vec4f wider = gather(st, sigma * sigma); wider.w > least_weight)
      return Rgb(wider.x, wider.y, wider.z) / wider.w;
  return mean();
}

Rgb GaussianPyramid::at(Vec2 st) const {
  const Level& level = levels_.front();
  int first[2];
  float weights[2][2];
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double q = wrap_coordinate(st[static_cast<int>(axis)], wrap_[axis]) * level.extent[axis] - 0.5;
    const double below = std::floor(q);
    const auto fraction = static_cast<float>(q - below);
    first[axis] = static_cast<int>(below);
    weights[axis][1] = filter_ == Filter::linear ? fraction : (fraction < 0.5f ? 0.0f : 1.0f);
    weights[axis][0] = 1 - weights[axis][1];
  }
  const Float4 sum = gather_taps<2>(level.sample(first[0], first[1]), level.stride, weights[0], weights[1]);
  Vec4f result;
  std::memcpy(&result, &sum, sizeof result);
  return resolve(st, 0, result);
}

Rgb GaussianPyramid::filtered(Vec2 st, double sigma_texels) const {
  if (!(sigma_texels > 0)) return at(st);
  return resolve(st, sigma_texels, gather(st, sigma_texels * sigma_texels));
}

Rgb GaussianPyramid::filtered(Vec2 st, const Mat2& covariance) const {
  const double a = covariance[0][0], b = 0.5 * (covariance[0][1] + covariance[1][0]), c = covariance[1][1];
  const double middle = 0.5 * (a + c), radius = std::hypot(0.5 * (a - c), b);
  double narrow = std::max(0.0, middle - radius);
  const double wide = middle + radius;
  if (!(wide > 0) || !std::isfinite(wide)) return wide > 0 ? mean() : at(st);
  double extra = wide - narrow;
  if (extra < 0.02 * wide) return filtered(st, std::sqrt(middle));

  // Long axis: eigenvector of the larger eigenvalue, from the better conditioned row.
  Vec2 axis = a >= c ? Vec2(wide - c, b) : Vec2(b, wide - a);
  axis = glm::normalize(axis) / Vec2(width(), height());
  Vec4f sum(0);
  const auto tap = [&](double offset, double weight) {
    sum += static_cast<float>(weight) * gather(st + offset * axis, narrow);
  };
  const double blur = narrow + reconstruction_variance(filter_);
  if (extra <= 1.1 * blur) {
    // Three-point Gauss-Hermite quadrature: right up to the fifth moment.
    const double offset = std::sqrt(3 * extra);
    tap(-offset, 1.0 / 6);
    tap(0, 2.0 / 3);
    tap(offset, 1.0 / 6);
    return resolve(st, std::sqrt(wide), sum);
  }
  // Evenly spaced taps, no farther apart than the blur of one can hide.
  constexpr int most_each_side = 4;
  constexpr double closeness = 1.8, reach = 2.5;
  const double deviation = std::sqrt(extra);
  int each_side = static_cast<int>(std::ceil(reach * deviation / (closeness * std::sqrt(blur))));
  if (each_side > most_each_side) {
    each_side = most_each_side;
    const double needed = reach * deviation / (closeness * most_each_side);
    narrow = std::max(narrow, needed * needed - reconstruction_variance(filter_));
  }
  const double spacing = reach / each_side;  // in deviations
  double weight_sum = 0;
  for (int i = -each_side; i <= each_side; ++i) weight_sum += std::exp(-0.5 * (i * spacing) * (i * spacing));
  for (int i = -each_side; i <= each_side; ++i)
    tap(i * spacing * deviation, std::exp(-0.5 * (i * spacing) * (i * spacing)) / weight_sum);
  return resolve(st, std::sqrt(wide), sum);
}

}  // namespace alabaster

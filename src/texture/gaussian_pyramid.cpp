#include "texture/gaussian_pyramid.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "texture/pyramid_levels.h"

namespace alabaster {

namespace {

constexpr int margin = 5;
constexpr int most_taps = 10;
constexpr std::size_t tile_side = 8;
// Sums of weights below this are too far from any covered texel to be meant.
constexpr float least_weight = 1e-6f;

double reconstruction_variance(Filter filter) {
  return filter == Filter::nearest ? 1.0 / 12 : 1.0 / 6;  // box; tent, averaged over the texel
}

// Weights of up to twelve taps along one axis, not normalised.
struct alignas(16) Weights {
  Float4 block[3];
  float operator[](int i) const { return block[i / 4][i % 4]; }
};

Float8 both(float low, float high) {
  return Float8{low, low, low, low, high, high, high, high};
}

// Weights of `taps` neighbouring samples along either axis around a position `fraction` of a spacing after
// the middle pair's first, not normalised: the two axes share a register.
template <int taps>
void bell_weights(const float (&fraction)[2], const float (&variance)[2], Weights (&weights)[2],
                  float (&sums)[2]) {
  constexpr auto reach = static_cast<float>(taps / 2);
  const Bell u = Bell::of<taps>(variance[0]),
             v = variance[1] == variance[0] ? u : Bell::of<taps>(variance[1]);
  const Float8 scale = both(u.scale, v.scale), pedestal = both(u.pedestal, v.pedestal);
  // Offsets of the first taps.
  Float8 x = Float8{0, 1, 2, 3, 0, 1, 2, 3} + both(1 - reach - fraction[0], 1 - reach - fraction[1]), sum{};
  for (int i = 0; i < (taps + 3) / 4; ++i, x += 4.0f) {
    Float8 above = Bell::power(x, scale) - pedestal;
    above = above > 0 ? above : Float8{};
    std::memcpy(&weights[0].block[i], &above, sizeof(Float4));
    std::memcpy(&weights[1].block[i], reinterpret_cast<const char*>(&above) + sizeof(Float4), sizeof(Float4));
    sum += above;
  }
  sums[0] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
  sums[1] = (sum[4] + sum[5]) + (sum[6] + sum[7]);
}

// The finest level's own reconstruction (tent or box) convolved with a tent of variance `blur` <= 1/4, which
// stands for the Gaussian: exact at kinks within 2.3 % of what the blur does there.
Float4 blurred_tent_weights(float fraction, float blur) {
  const float width = std::sqrt(6 * blur);
  const auto corner = [width](float x) {  // what blurring adds to a ramp that starts x away
    const float inside = std::max(0.0f, width - x);
    return inside > 0 ? inside * inside * inside / (6 * width * width) : 0.0f;
  };
  const float low = corner(fraction), high = corner(1 - fraction);
  return Float4{low, 1 - fraction + high - 2 * low, fraction + low - 2 * high, high};
}

Float4 blurred_box_weights(float fraction, float blur) {
  const float width = std::sqrt(6 * blur);
  const auto step = [width](float x) {  // the blurred step at x
    if (x <= -width) return 0.0f;
    if (x >= width) return 1.0f;
    const float inside = width - std::abs(x), tail = inside * inside / (2 * width * width);
    return x < 0 ? tail : 1 - tail;
  };
  const float edges[3] = {step(-0.5f - fraction), step(0.5f - fraction), step(1.5f - fraction)};
  return Float4{edges[0], edges[1] - edges[0], edges[2] - edges[1], 1 - edges[2]};
}

// The weighted sum over taps x taps texels, two neighbours at a time: of codes times weights and weights, or
// of codes and largest_code where all weights are that.
template <int taps, bool everywhere>
Float4 gather_taps(const PackedTexel* corner, std::size_t stride, const Weights& u_weights,
                   const Weights& v_weights) {
  Float8 pair_weights[taps / 2];
  for (int i = 0; i < taps / 2; ++i) {
    const float a = u_weights[2 * i], b = u_weights[2 * i + 1];
    pair_weights[i] = Float8{a, a, a, a, b, b, b, b};
  }
  Float8 sum{};
  for (int j = 0; j < taps; ++j, corner += stride) {
    Float8 row{};
    for (int i = 0; i < taps / 2; ++i) {
      const Float8 pair = load_pair(corner + std::ptrdiff_t{2} * i);
      row += everywhere ? pair * pair_weights[i] : weighted_pair(pair, pair_weights[i]);
    }
    sum += row * v_weights[j];
  }
  Float4 halves[2];
  std::memcpy(halves, &sum, sizeof halves);
  return halves[0] + halves[1];
}

// The same from `first` on, the sample below the place along either axis, times `scale`.
template <int taps, class Level>
Vec4f sum_of_taps(const Level& level, const int (&first)[2], const Weights (&weights)[2], float scale) {
  const int x = first[0] - taps / 2 + 1, y = first[1] - taps / 2 + 1;
  const PackedTexel* corner = level.sample(x, y);
  Float4 sum;
  if (level.is_full(x, y)) {
    const float weight = scale * level.weight_unit * largest_code;
    sum = gather_taps<taps, true>(corner, level.stride, weights[0], weights[1]) *
          Float4{weight, weight, weight, scale * level.weight_unit};
  } else {
    sum =
        gather_taps<taps, false>(corner, level.stride, weights[0], weights[1]) * (scale * level.weight_unit);
  }
  Vec4f result;
  std::memcpy(&result, &sum, sizeof result);
  return result;
}

// A texture coordinate brought into [0, 1]; NaN becomes 0.
double wrap_coordinate(double s, Wrap wrap) {
  // A little inside the far edge: there the nearest texel is the last, not the one after.
  if (wrap == Wrap::clamp) return s > 0 ? std::min(s, 1 - 1e-6) : 0.0;
  if (wrap == Wrap::mirror) {
    s -= 2 * std::floor(0.5 * s);
    if (s > 1) s = 2 - s;
  } else {
    s -= std::floor(s);
  }
  return s >= 0 && s <= 1 ? s : 0;
}

// The samples of an axis that are computed; the others repeat them. Past a clamped edge, where there is no
// surface, a coarser level still holds what its Gaussians see of the inside.
struct Range {
  int begin, end;
};
Range computed_range(int size, Wrap wrap) {
  return wrap == Wrap::clamp ? Range{-margin, size + margin} : Range{0, size};
}

// Index into the computed samples of an axis, or nothing.
std::optional<int> computed_index(int i, int size, Wrap wrap) {
  if (wrap != Wrap::clamp) return wrap_index(i, size, wrap);
  if (i < -margin || i >= size + margin) return std::nullopt;
  return i;
}

}  // namespace

template <class Texel>
std::size_t GaussianPyramid::Samples<Texel>::index(int x, int y) const {
  return static_cast<std::size_t>(y + margin) * stride + static_cast<std::size_t>(x + margin);
}

GaussianPyramid::Draft GaussianPyramid::allocate(int width, int height) {
  Draft level;
  level.extent[0] = width;
  level.extent[1] = height;
  level.stride = static_cast<std::size_t>(width + 2 * margin);
  level.texels.assign(level.stride * static_cast<std::size_t>(height + 2 * margin), Vec4f(0));
  return level;
}

void GaussianPyramid::fill_margin(Draft& level) const {
  const int w = level.extent[0], h = level.extent[1];
  const Range u = computed_range(w, wrap_[0]), v = computed_range(h, wrap_[1]);
  for (int y = -margin; y < h + margin; ++y)
    for (int x = -margin; x < w + margin; ++x) {
      if (y >= v.begin && y < v.end && x == u.begin) x = u.end;
      if (x < w + margin)
        *level.sample(x, y) = *level.sample(*computed_index(x, w, wrap_[0]), *computed_index(y, h, wrap_[1]));
    }
}

GaussianPyramid::GaussianPyramid(const TexelArray& texels, std::vector<float> coverage, Wrap wrap_u,
                                 Wrap wrap_v, Filter filter)
    : wrap_{wrap_u, wrap_v}, filter_(filter) {
  assert(texels.width > 0 && texels.height > 0);
  assert(coverage.empty() || coverage.size() == texels.texels.size());
  if (std::none_of(coverage.begin(), coverage.end(), [](float c) { return c > 0; })) coverage.clear();
  Draft finest = allocate(texels.width, texels.height);
  for (double& samples : finest.samples_per_texel) samples = 1;
  Vec4 sum(0);
  max_ = Rgb(-std::numeric_limits<double>::infinity());
  Rgb least(std::numeric_limits<double>::infinity());
  for (int y = 0, i = 0; y < texels.height; ++y)
    for (int x = 0; x < texels.width; ++x, ++i) {
      const float weight = coverage.empty() ? 1.0f : coverage[static_cast<std::size_t>(i)];
      if (!(weight > 0)) continue;
      const Vec4f& texel = texels.at(x, y);
      const Vec4f weighted(texel.x * weight, texel.y * weight, texel.z * weight, weight);
      *finest.sample(x, y) = weighted;
      sum += Vec4(weighted);
      for (int c = 0; c < 3; ++c) {
        max_[c] = std::max(max_[c], static_cast<double>(texel[c]));
        least[c] = std::min(least[c], static_cast<double>(texel[c]));
      }
    }
  range_ = PackedRange(least, max_);
  const Vec4f mean(sum / (static_cast<double>(texels.width) * texels.height));
  mean_ = Vec4f(range_.codes(mean) * mean.w, mean.w);
  fill_margin(finest);
  add_coarser_levels(std::move(finest));
}

void GaussianPyramid::add(const Draft& draft) {
  Level level;
  std::copy_n(draft.extent, 2, level.extent);
  std::copy_n(draft.samples_per_texel, 2, level.samples_per_texel);
  std::copy_n(draft.blur, 2, level.blur);
  level.stride = draft.stride;
  level.texels.resize(draft.texels.size());
  float largest = 0;
  for (const Vec4f& texel : draft.texels) largest = std::max(largest, texel.w);
  level.weight_unit = largest / largest_code;
  parallel_for(draft.texels.size(), 16384, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      level.texels[i] = range_.pack(draft.texels[i], largest_code / largest);
  });
  find_full_tiles(level);
  levels_.push_back(std::move(level));
}

bool GaussianPyramid::Level::is_full(int x, int y) const {
  return full[static_cast<std::size_t>(y + margin) / tile_side * tiles_per_row +
              static_cast<std::size_t>(x + margin) / tile_side] != 0;
}

void GaussianPyramid::find_full_tiles(Level& level) {
  const std::size_t width = level.stride, height = level.texels.size() / width;
  level.tiles_per_row = (width + tile_side - 1) / tile_side;
  const std::size_t rows = (height + tile_side - 1) / tile_side;
  level.full.assign(level.tiles_per_row * rows, 0);
  parallel_for(level.full.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) {
      const std::size_t x0 = tile % level.tiles_per_row * tile_side,
                        y0 = tile / level.tiles_per_row * tile_side;
      // Beyond the last sample nothing is ever read.
      const std::size_t x1 = std::min(x0 + tile_side - 1 + most_taps, width),
                        y1 = std::min(y0 + tile_side - 1 + most_taps, height);
      bool all = true;
      for (std::size_t y = y0; y < y1 && all; ++y)
        for (std::size_t x = x0; x < x1 && all; ++x)
          all = level.texels[y * width + x][3] == std::numeric_limits<uint16_t>::max();
      level.full[tile] = all ? 1 : 0;
    }
  });
}

GaussianPyramid::Draft GaussianPyramid::coarser(const Draft& level, int width, int height) const {
  const int extent[2] = {width, height};
  Draft result = allocate(width, height);
  double variance[2];  // of the Gaussian that leads from the finer level to this one, in its spacings
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double spacing = static_cast<double>(level.extent[axis]) / extent[axis];
    result.samples_per_texel[axis] = level.samples_per_texel[axis] / spacing;
    result.blur[axis] = spacing == 1 ? level.blur[axis] : level_blur;
    variance[axis] = level_blur * spacing * spacing - level.blur[axis];
  }
  const auto filter_axis = [&](std::size_t axis, int j, auto&& read) {
    const int from = level.extent[axis];
    const Resampling row = gaussian_resampling(from, extent[axis], j, variance[axis]);
    for (std::size_t k = 0; k < row.weights.size(); ++k)
      if (const auto i = computed_index(row.first + static_cast<int>(k), from, wrap_[axis]))
        read(*i, row.weights[k]);
  };
  const Range u = computed_range(width, wrap_[0]), v = computed_range(height, wrap_[1]);
  const Range finer_v = computed_range(level.extent[1], wrap_[1]);
  Draft narrow = allocate(width, level.extent[1]);  // filtered along u alone
  parallel_for(static_cast<std::size_t>(u.end - u.begin), 8, [&](std::size_t begin, std::size_t end) {
    for (int x = u.begin + static_cast<int>(begin); x < u.begin + static_cast<int>(end); ++x)
      filter_axis(0, x, [&](int i, float weight) {
        for (int y = finer_v.begin; y < finer_v.end; ++y)
          *narrow.sample(x, y) += weight * *level.sample(i, y);
      });
  });
  parallel_for(static_cast<std::size_t>(v.end - v.begin), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = v.begin + static_cast<int>(begin); y < v.begin + static_cast<int>(end); ++y)
      filter_axis(1, y, [&](int i, float weight) {
        for (int x = u.begin; x < u.end; ++x) *result.sample(x, y) += weight * *narrow.sample(x, i);
      });
  });
  fill_margin(result);
  return result;
}

void GaussianPyramid::add_coarser_levels(Draft last) {
  add(last);
  double spacing = first_spacing;
  const int longest = std::max(width(), height());
  for (; spacing < 2.0 * longest; spacing *= spacing_ratio) {
    const int w = coarser_extent(width(), last.extent[0], spacing, wrap_[0]);
    const int h = coarser_extent(height(), last.extent[1], spacing, wrap_[1]);
    if (w == last.extent[0] && h == last.extent[1]) continue;
    Draft next = coarser(last, w, h);
    level_from_.push_back(served_from(next, last));
    add(next);
    last = std::move(next);
  }
  const Level& coarsest = levels_.back();
  for (std::size_t axis = 0; axis < 2; ++axis)
    mean_from_ =
        std::max(mean_from_, (coarsest.blur[axis] + widest_kernel) /
                                 (coarsest.samples_per_texel[axis] * coarsest.samples_per_texel[axis]));
}

Rgb GaussianPyramid::mean() const {
  return range_.mean(mean_);
}

std::size_t GaussianPyramid::memory_bytes() const {
  std::size_t bytes = sizeof *this;
  for (const Level& level : levels_)
    bytes += sizeof level + level.texels.size() * sizeof(PackedTexel) + level.full.size();
  return bytes;
}

Vec4f GaussianPyramid::gather(Vec2 st, double variance) const {
  const double total = variance + reconstruction_variance(filter_);
  std::size_t k = 0;
  while (k < level_from_.size() && total >= level_from_[k]) ++k;
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
  Weights weights[2];
  float sums[2];
  const auto gather_bell = [&]<int taps>(std::integral_constant<int, taps>) {
    bell_weights<taps>(fraction, kernel, weights, sums);
    return sum_of_taps<taps>(level, first, weights, 1 / (sums[0] * sums[1]));
  };
  const float widest = std::max(kernel[0], kernel[1]);
  Vec4f result;
  if (widest > 1.8f) {
    result = gather_bell(std::integral_constant<int, 10>());
  } else if (widest > 0.95f) {
    result = gather_bell(std::integral_constant<int, 8>());
  } else if (widest > 0.45f) {
    result = gather_bell(std::integral_constant<int, 6>());
  } else {
    const auto own = static_cast<float>(reconstruction_variance(filter_));
    float scale = 1;  // for weights that are not normalised
    if (widest >= narrowest_bell) bell_weights<4>(fraction, kernel, weights, sums);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (kernel[axis] >= narrowest_bell)
        scale /= sums[axis];
      else
        weights[axis].block[0] = filter_ == Filter::linear
                                     ? blurred_tent_weights(fraction[axis], kernel[axis] - own)
                                     : blurred_box_weights(fraction[axis], kernel[axis] - own);
    }
    result = sum_of_taps<4>(level, first, weights, scale);
  }
  if (total > mean_from_) {
    const auto share = static_cast<float>(std::min(total / mean_from_ - 1, 1.0));
    result = (1 - share) * result + share * mean_;
  }
  return result;
}

Rgb GaussianPyramid::resolve(Vec2 st, double variance, const Vec4f& sum) const {
  if (sum.w > least_weight) return range_.mean(sum);
  // No covered texel near: widen until there is one.
  const double whole = 16.0 * std::max(width(), height()) * std::max(width(), height());
  for (double wider = std::max(1.0, 4 * variance); wider < whole; wider *= 4)
    if (const Vec4f found = gather(st, wider); found.w > least_weight) return range_.mean(found);
  return mean();
}

Rgb GaussianPyramid::at(Vec2 st) const {
  const Level& level = levels_.front();
  int first[2];
  Weights weights[2];
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double q = wrap_coordinate(st[static_cast<int>(axis)], wrap_[axis]) * level.extent[axis] - 0.5;
    const double below = std::floor(q);
    const auto fraction = static_cast<float>(q - below);
    first[axis] = static_cast<int>(below);
    const float upper = filter_ == Filter::linear ? fraction : (fraction < 0.5f ? 0.0f : 1.0f);
    weights[axis].block[0] = Float4{1 - upper, upper, 0, 0};
  }
  return resolve(st, 0, sum_of_taps<2>(level, first, weights, 1));
}

Rgb GaussianPyramid::filtered(Vec2 st, double sigma_texels) const {
  if (!(sigma_texels > 0)) return at(st);
  const double variance = sigma_texels * sigma_texels;
  return resolve(st, variance, gather(st, variance));
}

Rgb GaussianPyramid::filtered(Vec2 st, const Mat2& covariance) const {
  const double a = covariance[0][0], b = 0.5 * (covariance[0][1] + covariance[1][0]), c = covariance[1][1];
  const double middle = 0.5 * (a + c), radius = std::sqrt(0.25 * (a - c) * (a - c) + b * b);
  const double narrow = std::max(0.0, middle - radius), wide = middle + radius, extra = wide - narrow;
  if (!(wide > 0) || !std::isfinite(wide)) return wide > 0 ? mean() : at(st);
  const double total = wide + reconstruction_variance(filter_);
  // As round as makes no difference: at most 0.6 % of contrast at an edge.
  if (extra < 0.1 * total) return resolve(st, wide, gather(st, middle));

  // Long axis: eigenvector of the larger eigenvalue, from the better conditioned row.
  const Vec2 axis = glm::normalize(a >= c ? Vec2(wide - c, b) : Vec2(b, wide - a)) / Vec2(width(), height());
  if (extra < 0.4 * total) {
    const double offset = std::sqrt(extra);
    return resolve(st, wide,
                   0.5f * (gather(st - offset * axis, narrow) + gather(st + offset * axis, narrow)));
  }
  if (extra <= 1.1 * (total - extra)) {
    // Three-point Gauss-Hermite quadrature: right up to the fifth moment.
    const double offset = std::sqrt(3 * extra);
    return resolve(st, wide,
                   (1.0f / 6) * (gather(st - offset * axis, narrow) + gather(st + offset * axis, narrow)) +
                       (2.0f / 3) * gather(st, narrow));
  }
  return resolve(st, wide, gather_along(st, axis, narrow, extra));
}

Vec4f GaussianPyramid::gather_along(Vec2 st, Vec2 axis, double narrow, double extra) const {
  // Evenly spaced taps, no farther apart than the blur of one can hide.
  constexpr int most_each_side = 8;
  constexpr double closeness = 1.8, reach = 2.5;  // deviations
  const double wide = narrow + extra, own = reconstruction_variance(filter_);
  int each_side = static_cast<int>(std::ceil(reach * std::sqrt(extra / (narrow + own)) / closeness));
  if (each_side > most_each_side) {
    each_side = most_each_side;
    const double shortest = reach / (closeness * most_each_side);  // blur over extra, as deviations
    narrow = std::max(narrow, shortest * shortest * extra - own);
    extra = wide - narrow;
  }
  const double spacing = reach / each_side;
  double weights[2 * most_each_side + 1], total = 0, variance = 0;
  for (int i = -each_side; i <= each_side; ++i) {
    const double weight = std::exp(-0.5 * (i * spacing) * (i * spacing));
    weights[i + each_side] = weight;
    total += weight;
    variance += weight * i * i;
  }
  const double step = std::sqrt(extra * total / variance);  // so that what was cut off does not narrow it
  Vec4f sum(0);
  for (int i = -each_side; i <= each_side; ++i)
    sum += static_cast<float>(weights[i + each_side] / total) * gather(st + (i * step) * axis, narrow);
  return sum;
}

}  // namespace alabaster

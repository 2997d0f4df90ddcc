#include "texture/plane_pyramid.h"

#include <cassert>
#include <cstring>
#include <limits>

#include "texture/pyramid_levels.h"

namespace alabaster {

namespace {

// Registers of four and eight numbers (GCC and Clang vector extension).
using Row = float __attribute__((vector_size(32)));
using HalfRow = float __attribute__((vector_size(16)));
constexpr int taps = 8, margin = 5;
constexpr double reconstruction_variance = 1.0 / 6;  // of bilinear interpolation, averaged over the texel
constexpr float widest_of_eight = 1.8f, widest_of_six = 0.95f, widest_of_four = 0.45f;

inline Row load(const float* from) {
  Row v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline float sum_of(Row v) {
  HalfRow half = __builtin_shufflevector(v, v, 0, 1, 2, 3) + __builtin_shufflevector(v, v, 4, 5, 6, 7);
  half += __builtin_shufflevector(half, half, 2, 3, 0, 1);
  half += __builtin_shufflevector(half, half, 1, 0, 3, 2);
  return half[0];
}

bool is_grey(const TexelArray& texels) {
  return std::all_of(texels.texels.begin(), texels.texels.end(),
                     [](const Vec4f& t) { return t.x == t.y && t.y == t.z; });
}

// Where a Gaussian is read.
struct Place {
  std::size_t level = 0;
  int first[2] = {0, 0};  // the sample below it
  float fraction[2] = {0, 0}, kernel[2] = {1, 1};

  bool served() const {
    return std::min(kernel[0], kernel[1]) >= narrowest_bell &&
           std::max(kernel[0], kernel[1]) <= widest_of_eight;
  }
};

// The bells of four places, u then v.
struct Bells {
  float scale[8], pedestal[8];

  explicit Bells(const Place (&p)[4]) {
    const Row kernel{p[0].kernel[0], p[1].kernel[0], p[2].kernel[0], p[3].kernel[0],
                     p[0].kernel[1], p[1].kernel[1], p[2].kernel[1], p[3].kernel[1]};
    const Row other = __builtin_shufflevector(kernel, kernel, 4, 5, 6, 7, 0, 1, 2, 3);
    const Row widest = kernel > other ? kernel : other, none{};
    // Half the taps, and 8 over its square.
    const Row reach = widest > widest_of_six ? none + 4 : (widest > widest_of_four ? none + 3 : none + 2);
    const Row per_reach =
        widest > widest_of_six ? none + 0.5f : (widest > widest_of_four ? none + 8.0f / 9 : none + 2);
    const Row scales = 1 / (67 * Bell::nominal_variance(kernel, per_reach));
    const Row pedestals = Bell::power(reach, scales);
    std::memcpy(scale, &scales, sizeof scales);
    std::memcpy(pedestal, &pedestals, sizeof pedestals);
  }
  /// Weights of eight neighbouring samples, not normalised, 0 beyond the bell's own taps.
  Row weights(std::size_t bell, float fraction) const {
    const Row x = Row{-3, -2, -1, 0, 1, 2, 3, 4} - fraction;
    const Row above = Bell::power(x, Row{} + scale[bell]) - pedestal[bell];
    return above > 0 ? above : Row{};
  }
};

}  // namespace

/// A level while the next coarser one is made of it.
struct PlanePyramid::Draft {
  Draft(int width, int height, std::size_t channels) : extent{width, height}, stride(width + 2 * margin) {
    const auto size = static_cast<std::size_t>(stride) * static_cast<std::size_t>(height + 2 * margin);
    planes.assign(channels, std::vector<float>(size));
  }
  int extent[2];
  double samples_per_texel[2] = {1, 1}, blur[2] = {0, 0};
  int stride;
  std::vector<std::vector<float>> planes;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y + margin) * static_cast<std::size_t>(stride) +
           static_cast<std::size_t>(x + margin);
  }
};

void PlanePyramid::fill_margin(Draft& draft) {
  const int w = draft.extent[0], h = draft.extent[1];
  for (auto& plane : draft.planes)
    for (int y = -margin; y < h + margin; ++y)
      for (int x = -margin; x < w + margin; ++x)
        if (x < 0 || x >= w || y < 0 || y >= h)
          plane[draft.index(x, y)] =
              plane[draft.index(wrap_index(x, w, Wrap::repeat), wrap_index(y, h, Wrap::repeat))];
}

PlanePyramid::Draft PlanePyramid::coarser(const Draft& finer, int width, int height) {
  const std::size_t channels = finer.planes.size();
  Draft narrow(width, finer.extent[1], channels),
      result(width, height, channels);  // filtered along u alone; both
  double variance[2];  // of the Gaussian that leads from the finer level to this one, in its spacings
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double spacing = static_cast<double>(finer.extent[axis]) / result.extent[axis];
    result.samples_per_texel[axis] = finer.samples_per_texel[axis] / spacing;
    result.blur[axis] = spacing == 1 ? finer.blur[axis] : level_blur;
    variance[axis] = level_blur * spacing * spacing - finer.blur[axis];
  }
  for (std::size_t c = 0; c < channels; ++c) {
    for (int x = 0; x < width; ++x) {
      const Resampling along = gaussian_resampling(finer.extent[0], width, x, variance[0]);
      for (std::size_t k = 0; k < along.weights.size(); ++k) {
        const int i = wrap_index(along.first + static_cast<int>(k), finer.extent[0], Wrap::repeat);
        for (int y = 0; y < finer.extent[1]; ++y)
          narrow.planes[c][narrow.index(x, y)] += along.weights[k] * finer.planes[c][finer.index(i, y)];
      }
    }
    for (int y = 0; y < height; ++y) {
      const Resampling down = gaussian_resampling(finer.extent[1], height, y, variance[1]);
      for (std::size_t k = 0; k < down.weights.size(); ++k) {
        const int j = wrap_index(down.first + static_cast<int>(k), finer.extent[1], Wrap::repeat);
        for (int x = 0; x < width; ++x)
          result.planes[c][result.index(x, y)] += down.weights[k] * narrow.planes[c][narrow.index(x, j)];
      }
    }
  }
  fill_margin(result);
  return result;
}

void PlanePyramid::add(const Draft& draft) {
  Level level;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    level.extent[axis] = draft.extent[axis];
    level.square_of_samples[axis] = draft.samples_per_texel[axis] * draft.samples_per_texel[axis];
    level.blur[axis] = draft.blur[axis];
  }
  level.stride = draft.stride;
  level.plane = static_cast<std::ptrdiff_t>(draft.planes.front().size());
  level.origin = static_cast<std::ptrdiff_t>(samples_.size() + draft.index(0, 0));
  for (std::size_t c = 0; c < channels_; ++c)
    for (const float sample : draft.planes[c])
      samples_.push_back(range_.nearest(sample, static_cast<int>(c)));
  levels_.push_back(level);
}

PlanePyramid::PlanePyramid(const TexelArray& texels) : channels_(is_grey(texels) ? 1 : 3) {
  assert(texels.width > 0 && texels.height > 0);
  level_from_.fill(std::numeric_limits<double>::infinity());
  Draft last(texels.width, texels.height, channels_);
  for (std::size_t c = 0; c < channels_; ++c)
    for (int y = 0; y < texels.height; ++y)
      for (int x = 0; x < texels.width; ++x)
        last.planes[c][last.index(x, y)] = texels.at(x, y)[static_cast<int>(c)];
  Rgb least(std::numeric_limits<double>::infinity()), largest = -1 * least;
  for (const Vec4f& texel : texels.texels)
    for (int c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], static_cast<double>(texel[c]));
      largest[c] = std::max(largest[c], static_cast<double>(texel[c]));
    }
  range_ = PackedRange(least, largest);
  fill_margin(last);
  add(last);
  const double longest = std::max(texels.width, texels.height);
  for (double spacing = first_spacing; spacing < 2 * longest && levels_.size() <= most_levels;
       spacing *= spacing_ratio) {
    const int w = coarser_extent(texels.width, last.extent[0], spacing, Wrap::repeat);
    const int h = coarser_extent(texels.height, last.extent[1], spacing, Wrap::repeat);
    if (w == last.extent[0] && h == last.extent[1]) continue;
    Draft next = coarser(last, w, h);
    level_from_[levels_.size() - 1] = served_from(next, last);
    add(next);
    last = std::move(next);
  }
}

Rgb PlanePyramid::sum(std::span<const Gaussian> gaussians, const GaussianPyramid& otherwise) const {
  assert(gaussians.size() <= most_at_once);
  Place places[most_at_once];
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    Place& place = places[i];
    const double total = gaussians[i].sigma * gaussians[i].sigma + reconstruction_variance;
    for (const double from : level_from_) place.level += total >= from ? 1 : 0;  // no jump to guess
    const Level& level = levels_[place.level];
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double s = gaussians[i].st[static_cast<int>(axis)],
                   q = (s - std::floor(s)) * level.extent[axis] - 0.5, below = std::floor(q);
      place.first[axis] = static_cast<int>(below);
      place.fraction[axis] = static_cast<float>(q - below);
      place.kernel[axis] = static_cast<float>(total * level.square_of_samples[axis] - level.blur[axis]);
    }
  }
  const Bells bells(places);
  Row sums[3] = {};
  Rgb others;
  for (std::size_t i = 0; i < gaussians.size(); ++i) {
    const Place& place = places[i];
    if (!place.served()) {
      others += gaussians[i].weight * otherwise.filtered(gaussians[i].st, gaussians[i].sigma);
      continue;
    }
    const Row u = bells.weights(i, place.fraction[0]), v = bells.weights(i + 4, place.fraction[1]);
    const Row along = u * (static_cast<float>(gaussians[i].weight) / (sum_of(u) * sum_of(v)));
    float down[taps];
    std::memcpy(down, &v, sizeof v);
    const Level& level = levels_[place.level];
    const float* corner = samples_.data() + level.origin + (place.first[1] - taps / 2 + 1) * level.stride +
                          (place.first[0] - taps / 2 + 1);
    for (std::size_t c = 0; c < channels_; ++c, corner += level.plane) {
      const float* row = corner;
      Row sum{};
      for (int j = 0; j < taps; ++j, row += level.stride) sum += load(row) * down[j];
      sums[c] += sum * along;
    }
  }
  if (channels_ == 1) return others + Rgb(static_cast<double>(sum_of(sums[0])));
  return others + Rgb(static_cast<double>(sum_of(sums[0])), static_cast<double>(sum_of(sums[1])),
                      static_cast<double>(sum_of(sums[2])));
}

}  // namespace alabaster

#include "scene/film.h"

#include <algorithm>
#include <cassert>

namespace alabaster {

namespace {

double plain_variance(double squares, double sum, double count) {
  return std::max(0.0, squares - sum * sum / count) / (count - 1);
}

}  // namespace

/// Where a sample stands among the groups of its size.
struct Film::Place {
  uint32_t size;            // of the group
  uint32_t finished;        // groups of this size before it
  uint32_t index_in_group;  // 0 .. size - 1
  bool first_two_groups;    // among the very first two of the pixel
  bool last_of_size;        // the last group of this size
};

Film::Place Film::place(uint32_t sample) const {
  if (sampler_ == SamplerKind::independent) return {1, sample, 0, sample < 2, false};
  const SampleGroup g = sample_group(sample);
  return {g.size(), g.group, g.index, g.size_class == 0 && g.group < 2, g.group == 15};
}

Film::Film(int width, int height, SamplerKind sampler)
    : width_(width),
      height_(height),
      sampler_(sampler),
      pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {}

void Film::add_value(Channel& c, double value, const Place& place) {
  c.sum += value;
  c.group_sum += value;
  if (place.first_two_groups) c.early_squares += static_cast<float>(value * value);
  if (place.index_in_group + 1 < place.size) return;
  const double delta = c.group_sum - c.mean;
  c.mean += delta / (place.finished + 1);
  c.squares += static_cast<float>(delta * (c.group_sum - c.mean));
  c.group_sum = 0;
  if (place.first_two_groups && place.finished == 1)
    c.plain_variance = static_cast<float>(plain_variance(c.early_squares, c.sum, 2.0 * place.size));
  if (!place.last_of_size) return;
  const float variance = c.squares / static_cast<float>(place.finished);
  c.finished_variance += variance * static_cast<float>(place.finished + 1);
  c.rate = variance / static_cast<float>(place.size);
  c.mean = 0;
  c.squares = 0;
}

void Film::add(int x, int y, const Rgb& radiance, double alpha, const Auxiliary* first_hit) {
  assert(radiance.is_finite());
  Pixel& p = pixels_[index(x, y)];
  const Place where = place(p.count);
  for (int c = 0; c < 3; ++c) add_value(p.channels[static_cast<std::size_t>(c)], radiance[c], where);
  p.alpha += alpha;
  ++p.count;
  if (first_hit == nullptr) return;
  ++p.hits;
  const auto& [albedo, normal, depth] = *first_hit;
  const std::array<double, 7> values{albedo.r, albedo.g, albedo.b, normal.x, normal.y, normal.z, depth};
  for (std::size_t i = 0; i < values.size(); ++i) p.auxiliary[i] += static_cast<float>(values[i]);
}

double Film::variance_of_mean(const Channel& c, uint32_t count) const {
  if (count == 0) return 0;
  const double n = count;
  if (count == 1) return c.sum * c.sum;
  const Place next = place(count);
  const double outside = next.index_in_group;  // samples in the unfinished group
  double of_sum = c.finished_variance;
  if (next.finished >= 2) {
    const double of_group = c.squares / (next.finished - 1.0);
    of_sum += of_group * next.finished + c.plain_variance * outside;
  } else if (next.first_two_groups) {
    of_sum = n * plain_variance(c.early_squares, c.sum, n);
  } else {
    of_sum += static_cast<double>(c.rate) * next.finished * next.size + c.plain_variance * outside;
  }
  return of_sum / (n * n);
}

uint32_t Film::count(int x, int y) const {
  return pixels_[index(x, y)].count;
}

uint64_t Film::total_count() const {
  uint64_t total = 0;
  for (const Pixel& p : pixels_) total += p.count;
  return total;
}

Image Film::develop() const {
  Image image(width_, height_,
              {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B", "samples.Y", "albedo.R",
               "albedo.G", "albedo.B", "normal.X", "normal.Y", "normal.Z", "depth.Z"});
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const Pixel& p = pixels_[index(x, y)];
      if (p.count == 0) continue;
      for (int c = 0; c < 3; ++c) {
        const Channel& channel = p.channels[static_cast<std::size_t>(c)];
        image.at(c, x, y) = static_cast<float>(channel.sum / p.count);
        image.at(4 + c, x, y) = static_cast<float>(variance_of_mean(channel, p.count));
      }
      image.at(3, x, y) = static_cast<float>(p.alpha / p.count);
      image.at(7, x, y) = static_cast<float>(p.count);
      if (p.hits == 0) continue;
      for (int i = 0; i < 7; ++i)
        image.at(8 + i, x, y) = p.auxiliary[static_cast<std::size_t>(i)] / static_cast<float>(p.hits);
    }
  return image;
}

}  // namespace alabaster

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/progress.h"
#include "image/exr_file.h"
#include "scene/discrete_distribution.h"
#include "scene/lights.h"

namespace alabaster {

namespace {

/// Drawn texel by texel with the solid angle taken exactly; the weight of a texel is its tent-filtered value,
/// positive wherever the bilinear lookup inside it can be.
class LatlongEnvironment final : public Environment {
 public:
  LatlongEnvironment(int width, int height, std::vector<Rgb> texels, double rotation)
      : width_(width), height_(height), texels_(std::move(texels)), rotation_(rotation) {
    std::vector<double> row_weights;
    for (int y = 0; y < height_; ++y) {
      std::vector<double> weights;
      for (int x = 0; x < width_; ++x) {
        weights.push_back(tent(x, y));
        mean_ += texel(x, y) * (row_solid_angle(y) / (4 * pi));
      }
      columns_.emplace_back(weights);
      row_weights.push_back(columns_.back().total() * row_solid_angle(y));
    }
    rows_ = DiscreteDistribution(row_weights);
  }

  Rgb radiance(const Vec3& direction) const override {
    const Vec2 st = image_position(direction) - Vec2(0.5);
    const double fx = std::floor(st.x), fy = std::floor(st.y);
    const double ax = st.x - fx, ay = st.y - fy;
    const int x = static_cast<int>(fx), y = static_cast<int>(fy);
    return (1 - ay) * ((1 - ax) * texel(x, y) + ax * texel(x + 1, y)) +
           ay * ((1 - ax) * texel(x, y + 1) + ax * texel(x + 1, y + 1));
  }

  std::optional<LightSample> sample(Vec2 u) const override {
    if (!(rows_.total() > 0)) return std::nullopt;
    const auto row = rows_.sample(u.y);
    const auto column = columns_[row.index].sample(u.x);
    const int y = static_cast<int>(row.index);
    const double top = row_cosine(y), bottom = row_cosine(y + 1);
    const double cosine = top + row.remapped * (bottom - top);
    const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    const double phi =
        2 * pi * ((static_cast<double>(column.index) + column.remapped) / width_ - 0.5) - rotation_;
    const Vec3 direction{sine * std::sin(phi), cosine, -sine * std::cos(phi)};
    return LightSample{direction, std::numeric_limits<double>::infinity(), radiance(direction),
                       texel_pdf(column.index, row.index), false};
  }

  double pdf(const Vec3& direction) const override {
    if (!(rows_.total() > 0)) return 0;
    const Vec2 st = image_position(direction);
    const auto x = static_cast<std::size_t>(std::clamp(static_cast<int>(st.x), 0, width_ - 1));
    const auto y = static_cast<std::size_t>(std::clamp(static_cast<int>(st.y), 0, height_ - 1));
    return texel_pdf(x, y);
  }

  Rgb mean_radiance() const override { return mean_; }

 private:
  /// In texels; (0, 0) is the corner at the top left.
  Vec2 image_position(const Vec3& direction) const {
    double u = 0.5 + (std::atan2(direction.x, -direction.z) + rotation_) / (2 * pi);
    u -= std::floor(u);
    return {u * width_, std::acos(std::clamp(direction.y, -1.0, 1.0)) * inv_pi * height_};
  }

  const Rgb& texel(int x, int y) const {
    // Columns wrap; rows end at the poles.
    const int column = ((x % width_) + width_) % width_, row = std::clamp(y, 0, height_ - 1);
    return texels_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(column)];
  }

  double tent(int x, int y) const {
    double sum = 0;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        sum += (dx == 0 ? 2 : 1) * (dy == 0 ? 2 : 1) * texel(x + dx, y + dy).mean();
    return sum / 16;
  }

  double row_cosine(int y) const { return std::cos(pi * y / height_); }
  /// Of one texel of the row.
  double row_solid_angle(int y) const { return (row_cosine(y) - row_cosine(y + 1)) * 2 * pi / width_; }

  double texel_pdf(std::size_t x, std::size_t y) const {
    if (columns_[y].total() <= 0) return 0;
    return rows_.probability(y) * columns_[y].probability(x) / row_solid_angle(static_cast<int>(y));
  }

  int width_, height_;
  std::vector<Rgb> texels_;
  double rotation_;
  std::vector<DiscreteDistribution> columns_;
  DiscreteDistribution rows_;
  Rgb mean_;
};

}  // namespace

std::unique_ptr<Environment> make_latlong_environment(int width, int height, std::vector<Rgb> texels,
                                                      double rotation) {
  return std::make_unique<LatlongEnvironment>(width, height, std::move(texels), rotation);
}

std::unique_ptr<Environment> load_latlong_environment(const std::filesystem::path& file, double rotation,
                                                      const Rgb& strength) {
  const Image image = read_exr(file).image;
  const int r = image.find("R"), g = image.find("G"), b = image.find("B");
  if (r < 0 || g < 0 || b < 0)
    throw InputError(file.string(), "has no channels R, G and B; an environment needs them");
  std::vector<Rgb> texels;
  std::size_t mended = 0;
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      Rgb value = Rgb(image.at(r, x, y), image.at(g, x, y), image.at(b, x, y)) * strength;
      if (!value.is_finite() || value.min() < 0) {
        for (int c = 0; c < 3; ++c) value[c] = std::isfinite(value[c]) ? std::max(0.0, value[c]) : 0;
        ++mended;
      }
      texels.push_back(value);
    }
  }
  if (mended > 0)
    warn(fmt::format("{}: texels that are negative or not finite count as 0 ({} of them)", file.string(),
                     mended));
  return make_latlong_environment(image.width(), image.height(), std::move(texels), rotation);
}

}  // namespace alabaster

#include "integrators/planar_lattice.h"

#include <cstring>
#include <numeric>

#include "optics/photon_walk.h"

namespace alabaster {

namespace {

// Eight photons in one register (GCC and Clang vector extension).
using Float8 = float __attribute__((vector_size(32)));
constexpr int block = 8;

Float8 load(const float* from) {
  Float8 v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
void store(float* to, Float8 v) {
  std::memcpy(to, &v, sizeof v);
}
float sum_of(Float8 v) {
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

int round_up(int n) {
  return (n + block - 1) / block * block;
}

// Scores are summed in float for so many walks, then in double.
constexpr uint64_t walks_per_flush = 16;
constexpr int turns = 4;
// Of the lattice, about: fewer make a walk dearer than what it serves, more only make pixels err alike.
constexpr int points_across = 20;
// Chances of being seen below this are taken by chance.
constexpr double least_score = 0.03;

Vec2 turned(Vec2 v, int turn) {
  switch (turn) {
    case 0:
      return v;
    case 1:
      return {-v.y, v.x};
    case 2:
      return -v;
    default:
      return {v.y, -v.x};
  }
}

/// One axis of the lattice, in the direction in which texels and pixels are counted.
struct LatticeAxis {
  int nodes;               // of the texture's grid in a tile: texels, or whole parts of them
  int nodes_per_texel;     //
  int step;                // of the lattice, in nodes
  int count;               // of lattice points that cover the light, wherever the first lies within one step
  double first_node;       // of the light's near edge
  double first_pixel;      //
  double pixels_per_step;  //
  double nodes_per_optical;  // signed
  double pixels_per_optical;

  /// `size` in metres: of a tile, of a pixel, of the light; `tile_position` of the light's near edge in
  /// tiles.
  static LatticeAxis make(double tile_size, int texels, double pixel_size, double light_size,
                          double tile_position, double pixel_position, double signed_mean_free_path) {
    constexpr int most_nodes = 4096;  // that texels may be divided into
    LatticeAxis axis;
    const double texels_per_pixel = pixel_size / (tile_size / texels);
    axis.nodes_per_texel = std::clamp(static_cast<int>(std::ceil(std::min(1 / texels_per_pixel, 1e6) - 1e-9)),
                                      1, std::max(1, most_nodes / texels));
    axis.nodes = texels * axis.nodes_per_texel;
    const double nodes_per_pixel = std::min(texels_per_pixel, 1e6) * axis.nodes_per_texel;
    const double across = light_size / pixel_size;
    const int pixels = std::max(1, static_cast<int>(std::lround(std::min(across, 1e6) / points_across)));
    axis.step = pixels * std::max(1, static_cast<int>(std::lround(nodes_per_pixel)));
    const double node_size = tile_size / axis.nodes, step_size = axis.step * node_size;
    axis.count = std::max(1, static_cast<int>(std::ceil(light_size / step_size - 1e-9)));
    axis.first_node = tile_position * axis.nodes - 0.5 * axis.nodes_per_texel;
    axis.first_pixel = pixel_position;
    axis.pixels_per_step = step_size / pixel_size;
    axis.nodes_per_optical = signed_mean_free_path / node_size;
    axis.pixels_per_optical = signed_mean_free_path / pixel_size;
    return axis;
  }
  double step_size() const { return pixels_per_step / std::abs(pixels_per_optical); }  // optical

  /// The node that a lattice shifted by `offset` steps reads after a displacement, its first point's: one of
  /// the two neighbours by chance, so that the mean is linear interpolation.
  int node(double offset, double displacement, Rng& rng) const {
    const double place = first_node + step * offset + displacement * nodes_per_optical;
    const double around = place - nodes * std::floor(place / nodes), below = std::floor(around);
    const int chosen = static_cast<int>(below) + (rng.uniform() < around - below ? 1 : 0);
    return chosen < nodes ? chosen : chosen - nodes;
  }
  /// Image coordinate of the first point.
  double pixel(double offset, double displacement) const {
    return first_pixel + pixels_per_step * offset + displacement * pixels_per_optical;
  }
};

/// One channel of the albedo at the nodes, laid out so that steps of the lattice along a row are neighbours
/// in memory.
class LatticeTexture {
 public:
  LatticeTexture(const TexelArray& texels, int channel, const LatticeAxis& u, const LatticeAxis& v) {
    // Steps of `step` fall into as many cycles as step and nodes have common divisors.
    const int cycles = std::gcd(u.nodes, u.step), length = u.nodes / cycles, run = length + round_up(u.count);
    stride_ = static_cast<std::size_t>(cycles) * static_cast<std::size_t>(run);
    column_.resize(static_cast<std::size_t>(u.nodes));
    std::vector<int> node_of(stride_);
    for (int cycle = 0; cycle < cycles; ++cycle)
      for (int k = 0; k < run; ++k) {
        const int node = static_cast<int>((cycle + static_cast<int64_t>(k) * u.step) % u.nodes),
                  place = cycle * run + k;
        node_of[static_cast<std::size_t>(place)] = node;
        if (k < length) column_[static_cast<std::size_t>(node)] = place;
      }
    albedo_.resize(stride_ * static_cast<std::size_t>(v.nodes));
    for (int y = 0; y < v.nodes; ++y)
      for (std::size_t i = 0; i < stride_; ++i)
        albedo_[static_cast<std::size_t>(y) * stride_ + i] =
            at_node(texels, channel, node_of[i], u.nodes_per_texel, y, v.nodes_per_texel);
  }

  /// The albedo at a node and, a step of the lattice apart each, beyond.
  const float* from(int x, int y) const {
    return &albedo_[static_cast<std::size_t>(y) * stride_ +
                    static_cast<std::size_t>(column_[static_cast<std::size_t>(x)])];
  }

 private:
  static float at_node(const TexelArray& texels, int channel, int x, int per_x, int y, int per_y) {
    const int i = x / per_x, j = y / per_y;
    const int next_i = (i + 1) % texels.width, next_j = (j + 1) % texels.height;
    const float u = static_cast<float>(x % per_x) / static_cast<float>(per_x),
                v = static_cast<float>(y % per_y) / static_cast<float>(per_y);
    const auto along = [&](int row) {
      return (1 - u) * texels.at(i, row)[channel] + u * texels.at(next_i, row)[channel];
    };
    return (1 - v) * along(j) + v * along(next_j);
  }

  std::size_t stride_ = 0;
  std::vector<int> column_;
  std::vector<float> albedo_;
};

/// What a walk writes to.
struct Workspace {
  std::vector<float> weights;   // turn x channel x row x column of the lattice
  std::vector<int> begin, end;  // of the light in every row, in columns, whole blocks
  std::vector<float> scores;    // channel x row x column of the image, by cycles, with margins
  std::vector<int> pixel;       // of a column
};

class LatticeLane final : public PlanarLane {
 public:
  LatticeLane(const PlanarScene& scene, int first, int channels, int outputs)
      : scene_(scene),
        first_(first),
        channels_(channels),
        outputs_(outputs),
        mean_free_path_(scene.medium.mean_free_path[first]),
        columns_(axis(scene, mean_free_path_, 0)),
        rows_(axis(scene, mean_free_path_, 1)),
        target_weight_(scene, mean_free_path_, true),
        seen_(seen_inside(scene)),
        stride_(round_up(columns_.count)),
        aligned_(std::abs(columns_.pixels_per_step - std::round(columns_.pixels_per_step)) < 1e-9),
        cycles_(aligned_ ? std::max(1, static_cast<int>(std::lround(columns_.pixels_per_step))) : 1),
        seen_columns_((scene.view.width + cycles_ - 1) / cycles_),
        cycle_stride_(round_up(seen_columns_) + 2 * block) {
    for (int c = 0; c < channels; ++c) textures_.emplace_back(*scene.albedo, first + c, columns_, rows_);
  }

  uint64_t walks_at_once() const override { return walks_per_flush; }
  double paths_per_walk() const override {
    const double cell = columns_.step_size() * rows_.step_size() * mean_free_path_ * mean_free_path_;
    return turns * scene_.light.area() / cell;
  }

  void run(PlanarBatch& batch, uint64_t walks) const override {
    Workspace space;
    space.weights.resize(plane() * static_cast<std::size_t>(turns * channels_));
    space.begin.resize(static_cast<std::size_t>(rows_.count));
    space.end.resize(static_cast<std::size_t>(rows_.count));
    space.pixel.resize(static_cast<std::size_t>(stride_));
    space.scores.resize(score_plane() * static_cast<std::size_t>(channels_));
    for (uint64_t done = 0; done < walks; done += walks_per_flush) {
      for (uint64_t i = 0; i < walks_per_flush; ++i) walk(batch, space);
      flush(space, batch);
    }
  }

 private:
  static LatticeAxis axis(const PlanarScene& scene, double mean_free_path, int index) {
    const double radius = scene.light.radius;
    const Vec2 corner = scene.light.centre + Vec2(-radius, radius);  // the light's top left
    const Vec2 size = scene.view.size / Vec2(scene.view.width, scene.view.height);
    return LatticeAxis::make(scene.tile[index], index == 0 ? scene.albedo->width : scene.albedo->height,
                             size[index], 2 * radius, scene.uv(corner)[index],
                             scene.view.pixel(corner)[index], index == 0 ? mean_free_path : -mean_free_path);
  }
  std::size_t plane() const {
    return static_cast<std::size_t>(stride_) * static_cast<std::size_t>(rows_.count);
  }
  std::size_t score_plane() const {
    return static_cast<std::size_t>(cycle_stride_ * cycles_) * static_cast<std::size_t>(scene_.view.height);
  }
  std::size_t score_index(int x, int y) const {
    return static_cast<std::size_t>((y * cycles_ + x % cycles_) * cycle_stride_ + x / cycles_ + block);
  }
  float* weights(Workspace& space, int turn, int channel) const {
    return &space.weights[plane() * static_cast<std::size_t>(turn * channels_ + channel)];
  }

  void walk(PlanarBatch& batch, Workspace& space) const {
    Rng& rng = batch.rng;
    const double eta = scene_.medium.eta, g = scene_.medium.g;
    const Vec2 offset(rng.uniform(), rng.uniform());
    const int photons = turns * start(offset, space);
    if (photons == 0) return;
    Vec3 position(0), direction = sample_diffuse_entry(eta, rng);
    double scale = 1;  // that the stored weights still lack
    for (;;) {
      double flight = sample_free_flight(rng);
      if (direction.z < 0 && flight * -direction.z > position.z) {
        const double to_boundary = position.z / -direction.z;
        position += to_boundary * direction;
        position.z = 0;
        const double out = 1 - fresnel_dielectric(-direction.z, 1 / eta);
        if (scene_.view.radiosity && out > 0)
          for (int turn = 0; turn < turns; ++turn)
            score(turn, scale * out, offset, turned(Vec2(position), turn), space);
        if (rng.uniform() < out) return;
        direction.z = -direction.z;
        flight -= to_boundary;
      }
      position += flight * direction;
      batch.collisions += static_cast<uint64_t>(photons);
      const double weight = scale * attenuate(offset, Vec2(position), rng, space) / photons;
      if (!scene_.view.radiosity) score_collision(position, direction, scale, offset, rng, space);
      const double target = target_weight_.around_centre(Vec2(position));
      if (weight < 0.4 * target) {
        if (rng.uniform() * target >= weight) return;
        scale *= target / weight;
      }
      direction = scatter(direction, g, rng);
    }
  }

  /// Weight 1 to every point of the shifted lattice inside the light, 0 to the others; how many are inside.
  int start(Vec2 offset, Workspace& space) const {
    const double radius = scene_.light.radius / mean_free_path_;
    float* first = space.weights.data();
    std::fill_n(first, plane(), 0.0f);
    int inside = 0;
    for (int r = 0; r < rows_.count; ++r) {
      const double y = (r + offset.y) * rows_.step_size() - radius;
      double half = std::abs(y) <= radius ? radius : -1;
      if (scene_.light.shape == PlanarLight::Shape::disk && half > 0)
        half = std::sqrt(radius * radius - y * y);
      const auto column = [&](double x) {
        return std::clamp(static_cast<int>(std::ceil((x + radius) / columns_.step_size() - offset.x)), 0,
                          columns_.count);
      };
      const int begin = half > 0 ? column(-half) : 0, end = half > 0 ? std::max(begin, column(half)) : 0;
      inside += end - begin;
      space.begin[static_cast<std::size_t>(r)] = begin / block * block;
      space.end[static_cast<std::size_t>(r)] = begin < end ? round_up(end) : 0;
      float* row = first + static_cast<std::ptrdiff_t>(r) * stride_;
      std::fill(row + begin, row + end, 1.0f);
    }
    for (int i = 1; i < turns * channels_; ++i)
      std::copy_n(first, plane(), first + plane() * static_cast<std::size_t>(i));
    return inside;
  }

  /// Every photon meets the albedo at its place; the largest channel's sum of weights.
  double attenuate(Vec2 offset, Vec2 displacement, Rng& rng, Workspace& space) const {
    const int row_step = rows_.step % rows_.nodes;
    double sums[3] = {0, 0, 0};
    for (int turn = 0; turn < turns; ++turn) {
      const Vec2 d = turned(displacement, turn);
      const int x = columns_.node(offset.x, d.x, rng), first_y = rows_.node(offset.y, d.y, rng);
      for (int c = 0; c < channels_; ++c) {
        const LatticeTexture& texture = textures_[static_cast<std::size_t>(c)];
        float* row = weights(space, turn, c);
        Float8 sum{};
        int y = first_y;
        for (int r = 0; r < rows_.count; ++r, row += stride_) {
          const float* albedo = texture.from(x, y);
          const int end = space.end[static_cast<std::size_t>(r)];
          for (int i = space.begin[static_cast<std::size_t>(r)]; i < end; i += block) {
            const Float8 w = load(row + i) * load(albedo + i);
            store(row + i, w);
            sum += w;
          }
          y += row_step;
          if (y >= rows_.nodes) y -= rows_.nodes;
        }
        sums[c] += static_cast<double>(sum_of(sum));
      }
    }
    return std::max({sums[0], sums[1], sums[2]});
  }

  /// Every photon scores its chance of leaving towards the camera without another collision, into the pixel
  /// that sees it.
  void score_collision(const Vec3& position, const Vec3& direction, double scale, Vec2 offset, Rng& rng,
                       Workspace& space) const {
    const double distance = position.z / -seen_.z, unhindered = std::exp(-distance);
    for (int turn = 0; turn < turns; ++turn) {
      const Vec3 incident(turned(Vec2(direction), turn), direction.z);
      double value = henyey_greenstein(glm::dot(incident, seen_), scene_.medium.g) * unhindered;
      if (value < least_score) {
        if (rng.uniform() * least_score >= value) continue;
        value = least_score;
      }
      score(turn, scale * value, offset, turned(Vec2(position), turn) + distance * Vec2(seen_), space);
    }
  }

  /// Adds value x weight to the pixels that lie at a displacement from the photons' starts.
  void score(int turn, double value, Vec2 offset, Vec2 displacement, Workspace& space) const {
    const double x = columns_.pixel(offset.x, displacement.x), y = rows_.pixel(offset.y, displacement.y);
    if (!(std::abs(x) < 1e8 && std::abs(y) < 1e8)) return;
    const int first_x = static_cast<int>(std::floor(x));
    const int cycle = (first_x % cycles_ + cycles_) % cycles_, shift = (first_x - cycle) / cycles_;
    if (!aligned_)
      for (int i = 0; i < columns_.count; ++i)
        space.pixel[static_cast<std::size_t>(i)] =
            static_cast<int>(std::floor(x + i * columns_.pixels_per_step));
    for (int r = 0; r < rows_.count; ++r) {
      const auto row = static_cast<int>(std::floor(y + r * rows_.pixels_per_step));
      if (row < 0 || row >= scene_.view.height) continue;
      const int begin = space.begin[static_cast<std::size_t>(r)],
                end = space.end[static_cast<std::size_t>(r)];
      for (int c = 0; c < channels_; ++c) {
        const float* from = weights(space, turn, c) + static_cast<std::ptrdiff_t>(r) * stride_;
        float* to = &space.scores[score_plane() * static_cast<std::size_t>(c) + score_index(cycle, row)];
        if (aligned_) {
          add_blocks(from, begin, end, to, shift, static_cast<float>(value));
        } else {
          for (int i = begin; i < std::min(end, columns_.count); ++i)
            if (const int p = space.pixel[static_cast<std::size_t>(i)]; p >= 0 && p < scene_.view.width)
              to[p] += static_cast<float>(value) * from[i];
        }
      }
    }
  }

  /// Columns begin .. end - 1 to those of one cycle of the image, shift + begin ..., whole blocks that
  /// overlap it: `to` has a margin of a block on either side.
  void add_blocks(const float* from, int begin, int end, float* to, int shift, float value) const {
    while (begin < end && begin + shift <= -block) begin += block;
    while (begin < end && end - block + shift >= seen_columns_) end -= block;
    for (int i = begin; i < end; i += block)
      store(to + shift + i, load(to + shift + i) + value * load(from + i));
  }

  void flush(Workspace& space, PlanarBatch& batch) const {
    for (int c = 0; c < channels_; ++c)
      for (int y = 0; y < scene_.view.height; ++y)
        for (int x = 0; x < scene_.view.width; ++x) {
          const float score = space.scores[score_plane() * static_cast<std::size_t>(c) + score_index(x, y)];
          const std::size_t pixel =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(scene_.view.width) +
              static_cast<std::size_t>(x);
          for (int k = 0; k < outputs_; ++k)
            batch.sums[3 * pixel + static_cast<std::size_t>(first_ + c + k)] += static_cast<double>(score);
        }
    std::fill(space.scores.begin(), space.scores.end(), 0.0f);
  }

  const PlanarScene& scene_;
  int first_, channels_, outputs_;
  double mean_free_path_;  // m
  LatticeAxis columns_, rows_;
  TargetWeight target_weight_;
  Vec3 seen_;   // inside: the direction that refracts towards the camera
  int stride_;  // of a row of weights
  // The image as scores are added to it: where a step of the lattice is a whole number of pixels, pixels so
  // far apart are neighbours.
  bool aligned_;
  int cycles_, seen_columns_, cycle_stride_;
  std::vector<LatticeTexture> textures_;
};

}  // namespace

std::unique_ptr<PlanarLane> make_lattice_lane(const PlanarScene& scene, int first, int channels,
                                              int outputs) {
  return std::make_unique<LatticeLane>(scene, first, channels, outputs);
}

}  // namespace alabaster

#include "integrators/albedo_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/rng.h"

namespace alabaster {

namespace {

// Cells near the surface have this side, in lengths; deeper ones this share of their depth.
constexpr double finest_side = 0.5;
constexpr double side_by_depth = 0.25;
constexpr unsigned most_cells_logarithm = 4;  // base 2, along a side of a block
constexpr uintptr_t side_bits = 15;
constexpr uint32_t chunk_size = 1024, most_chunks = 1 << 16;
constexpr std::size_t cells_per_chunk = 4096;
constexpr uint32_t most_blocks_per_side = 160;
// The relative variance that a collision may add to a walk's weight.
constexpr double tolerated_variance = 0.015;
constexpr double least_exactness = 1.0 / 16;
// A constant guess that adds less than this share of it needs no map.
constexpr double worth_a_map = 0.03;
// A cell that would send most walks to the exact query may as well send all.
constexpr double hopeless_exactness = 0.7;

// Fractions in a number of bits.
uint32_t rounded(double value, int bits) {
  return static_cast<uint32_t>(std::lround(std::clamp(value, 0.0, 1.0) * ((1 << bits) - 1)));
}
double fraction(uint32_t value, int bits) {
  const uint32_t mask = (1u << bits) - 1;
  return (value & mask) * (1.0 / mask);
}

// Unit vectors in 24 bits: octahedron, unfolded (Cigolle et al. 2014).
uint32_t packed(const Vec3& n) {
  const double sum = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  Vec2 p(n.x / sum, n.y / sum);
  if (n.z < 0)
    p = Vec2((1 - std::abs(p.y)) * std::copysign(1.0, p.x), (1 - std::abs(p.x)) * std::copysign(1.0, p.y));
  return rounded(0.5 * p.x + 0.5, 12) << 12 | rounded(0.5 * p.y + 0.5, 12);
}
Vec3 unpacked(uint32_t bits) {
  const double x = 2 * fraction(bits >> 12, 12) - 1, y = 2 * fraction(bits, 12) - 1;
  Vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
  if (n.z < 0)
    n = Vec3((1 - std::abs(y)) * std::copysign(1.0, x), (1 - std::abs(x)) * std::copysign(1.0, y), n.z);
  return glm::normalize(n);
}

double unit_number(uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1p-53;
}

double exactness(double variance) {
  const double share = std::max(least_exactness, variance / (variance + tolerated_variance));
  return share > hopeless_exactness ? 1 : share;
}

// Relative to the channel it matters most for, so that black channels do not count.
double relative_square(const Rgb& difference, const Rgb& mean) {
  double largest = 0;
  for (int c = 0; c < 3; ++c)
    largest = std::max(largest, difference[c] * difference[c] / std::max(mean[c] * mean[c], 1e-4));
  return largest;
}

Rgb clamped(const Rgb& albedo) {
  return {std::clamp(albedo.r, 0.0, 1.0), std::clamp(albedo.g, 0.0, 1.0), std::clamp(albedo.b, 0.0, 1.0)};
}

}  // namespace

/// 16 bytes, since walks live on how many of them a processor's cache holds.
struct alignas(16) AlbedoCells::Cell {
  /// What follows is written by whoever takes the state from empty to busy. From `first_map` on: the number
  /// of an affine map, which is the better guess.
  std::atomic<uint32_t> state{empty};
  float distance = 0;   // m, of the centre
  uint32_t mean = 0;    // albedo, ten bits a channel
  uint32_t packed = 0;  // exactness, eight bits above the normal's 24

  enum : uint32_t { empty, busy, constant, first_map };
  Rgb albedo() const { return {fraction(mean >> 20, 10), fraction(mean >> 10, 10), fraction(mean, 10)}; }
  double exactness() const { return fraction(packed >> 24, 8); }
};

/// From a cell to barycentric coordinates in the plane of a triangle.
struct AlbedoCells::Map {
  uint32_t triangle = 0;
  std::array<float, 2> at_centre{};
  std::array<std::array<float, 3>, 2> gradient{};  // 1/m
};

struct AlbedoCells::Sample {
  Vec3 offset{0};  // from the cell's centre
  Vec3 closest{0};
  uint32_t triangle = no_index;
  double distance = 0;
  Rgb albedo;
};

struct AlbedoCells::Place {
  Vec3 centre{0};
  double size;
  uint64_t seed;
};

AlbedoCells::AlbedoCells(const RayScene& rays, const TriangleMesh& mesh, uint32_t object,
                         const AlbedoField* albedo, double length)
    : rays_(rays), mesh_(mesh), object_(object), albedo_(albedo), length_(length), maps_(most_chunks) {
  const BoundingBox box = bounding_box(mesh);
  const Vec3 extent = box.high - box.low;
  const double longest = std::max({extent.x, extent.y, extent.z, length});
  block_size_ = std::max(length, longest * 1.001 / most_blocks_per_side);
  low_ = box.low - Vec3(0.0005 * longest);
  std::size_t total = 1;
  for (int k = 0; k < 3; ++k) {
    const auto axis = static_cast<std::size_t>(k);
    count_[axis] = static_cast<uint32_t>((extent[k] + 0.001 * longest) / block_size_) + 1;
    total *= count_[axis];
  }
  blocks_ = std::vector<std::atomic<uintptr_t>>(total);
}

AlbedoCells::~AlbedoCells() {
  for (const std::atomic<Map*>& chunk : maps_) delete[] chunk.load();
}

AlbedoCells::View AlbedoCells::at(const Vec3& p) const {
  const double per_block = 1 / block_size_;
  const Vec3 in_blocks = (p - low_) * per_block, x = glm::max(in_blocks, Vec3(0));
  const Index3 place{std::min(static_cast<uint32_t>(x.x), count_[0] - 1),
                     std::min(static_cast<uint32_t>(x.y), count_[1] - 1),
                     std::min(static_cast<uint32_t>(x.z), count_[2] - 1)};
  const Vec3 corner(place[0], place[1], place[2]);
  const std::size_t index = (std::size_t{place[2]} * count_[1] + place[1]) * count_[0] + place[0];
  uintptr_t block = blocks_[index].load(std::memory_order_acquire);
  if (block == 0) block = make_block(index, low_ + block_size_ * (corner + Vec3(0.5)));
  const int side = 1 << (block & side_bits);
  const Vec3 within = glm::min((x - corner) * static_cast<double>(side), Vec3(side * (1 - 0x1p-40)));
  const int i = static_cast<int>(within.x), j = static_cast<int>(within.y), k = static_cast<int>(within.z);
  const int number = (k * side + j) * side + i;
  Cell& cell = reinterpret_cast<Cell*>(block & ~side_bits)[number];
  const double size = block_size_ / side;
  const Vec3 centre = low_ + block_size_ * corner + size * (Vec3(i, j, k) + Vec3(0.5));
  uint32_t state = cell.state.load(std::memory_order_acquire);
  if (state < Cell::constant) {
    fill(cell, {centre, size, hash_combine(index, static_cast<uint64_t>(number))});
    state = cell.state.load(std::memory_order_acquire);
  }
  const Vec3 offset = p - centre;
  const double aside = glm::length(offset), distance = static_cast<double>(cell.distance);
  View view{cell.albedo(),
            cell.exactness(),
            unpacked(cell.packed),
            distance,
            distance * (1 - 0x1p-22) - aside,
            distance * (1 + 0x1p-22) + aside};
  if (state != Cell::constant) {
    const Map& map = this->map(state - Cell::first_map);
    view.triangle = map.triangle;
    if (view.exactness < 1) view.albedo = mapped(map, offset);
  }
  // Behind an open sheet walks leave the grid, and what the cells at its rim know does not hold.
  const bool outside = std::min({in_blocks.x, in_blocks.y, in_blocks.z}) < 0 || in_blocks.x > count_[0] ||
                       in_blocks.y > count_[1] || in_blocks.z > count_[2];
  if (outside) view.exactness = 1;
  return view;
}

const AlbedoCells::Map& AlbedoCells::map(uint32_t number) const {
  return maps_[number / chunk_size].load(std::memory_order_acquire)[number % chunk_size];
}

uint32_t AlbedoCells::keep(const Map& map) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const uint32_t number = map_count_++;
  std::atomic<Map*>& chunk = maps_[number / chunk_size];
  if (chunk.load() == nullptr) {
    chunk.store(new Map[chunk_size], std::memory_order_release);
    bytes_ += chunk_size * sizeof(Map);
  }
  chunk.load()[number % chunk_size] = map;
  return number;
}

Rgb AlbedoCells::mapped(const Map& map, const Vec3& offset) const {
  SurfacePoint point;
  point.triangle = map.triangle;
  for (int k = 0; k < 2; ++k) {
    const auto& gradient = map.gradient[static_cast<std::size_t>(k)];
    point.barycentric[k] = map.at_centre[static_cast<std::size_t>(k)] + gradient[0] * offset.x +
                           gradient[1] * offset.y + gradient[2] * offset.z;
  }
  point.uv = mesh_.uv(map.triangle, point.barycentric);
  return clamped(albedo_->at(point));
}

uintptr_t AlbedoCells::make_block(std::size_t index, const Vec3& centre) const {
  const auto closest = rays_.closest_point(object_, centre);
  queries_.fetch_add(1, std::memory_order_relaxed);
  const double distance = closest ? closest->distance : 0;
  const double depth = std::max(0.0, distance - std::sqrt(0.75) * block_size_);
  const double wanted = std::max(finest_side * length_, side_by_depth * depth);
  unsigned logarithm = 0;
  while (logarithm < most_cells_logarithm && block_size_ / (1 << logarithm) > 1.01 * wanted) ++logarithm;
  const std::lock_guard<std::mutex> lock(mutex_);
  uintptr_t block = blocks_[index].load();
  if (block == 0) {  // else another thread was faster, and made the same
    block = reinterpret_cast<uintptr_t>(new_cells(std::size_t{1} << (3 * logarithm))) | logarithm;
    blocks_[index].store(block, std::memory_order_release);
  }
  return block;
}

// From chunks, so that cells made one after the other lie side by side.
AlbedoCells::Cell* AlbedoCells::new_cells(std::size_t count) const {
  if (count > cells_left_) {
    cells_left_ = std::max(cells_per_chunk, count);
    cell_chunks_.push_back(std::make_unique<Cell[]>(cells_left_));
    bytes_ += cells_left_ * sizeof(Cell);
  }
  Cell* const last = cell_chunks_.back().get();
  cells_left_ -= count;
  return last + cells_left_;
}

AlbedoCells::Sample AlbedoCells::sample(const Vec3& p, double radius, uint32_t guess) const {
  Sample result;
  const auto closest = rays_.closest_point(object_, p, radius, guess);
  queries_.fetch_add(1, std::memory_order_relaxed);
  if (!closest) return result;
  SurfacePoint point;
  point.triangle = result.triangle = closest->triangle;
  point.barycentric = closest->barycentric;
  point.uv = mesh_.uv(closest->triangle, closest->barycentric);
  result.closest = closest->position;
  result.distance = closest->distance;
  if (albedo_ != nullptr) result.albedo = albedo_->at(point);
  return result;
}

void AlbedoCells::fill(Cell& cell, const Place& place) const {
  uint32_t expected = Cell::empty;
  if (!cell.state.compare_exchange_strong(expected, Cell::busy, std::memory_order_acquire)) {
    while (cell.state.load(std::memory_order_acquire) == Cell::busy) {  // microseconds
    }
    return;
  }
  const Sample middle = sample(place.centre, std::numeric_limits<double>::infinity(), no_index);
  cell.distance = static_cast<float>(middle.distance);
  // Every second octant and the centre first: where they agree, that is enough.
  std::vector<Sample> samples{middle};
  if (albedo_ != nullptr)
    for (const int octant : {0, 3, 5, 6}) samples.push_back(sample_octant(place, octant, middle));
  double variance = set_mean(cell, samples);
  uint32_t state = Cell::constant;
  if (variance > worth_a_map * tolerated_variance && middle.triangle != no_index) {
    for (const int octant : {1, 2, 4, 7}) samples.push_back(sample_octant(place, octant, middle));
    variance = set_mean(cell, samples);
    const Map map = fit(middle, samples);
    double residual = 0;
    // The map has four unknowns in each coordinate, which the samples fit too well.
    for (const Sample& s : samples)
      residual += relative_square(s.albedo - mapped(map, s.offset), cell.albedo()) /
                  static_cast<double>(samples.size() - 4);
    const bool better = residual < 0.5 * variance;
    if (better) variance = residual;
    // Where all queries are exact the map at least knows a triangle to begin with.
    if (better || exactness(variance) >= 1) state = Cell::first_map + keep(map);
  }
  const Vec3 normal = middle.triangle != no_index ? mesh_.geometric_normal(middle.triangle) : Vec3(0, 0, 1);
  cell.packed = rounded(exactness(variance), 8) << 24 | packed(normal);
  cell.state.store(state, std::memory_order_release);
}

AlbedoCells::Sample AlbedoCells::sample_octant(const Place& place, int octant, const Sample& middle) const {
  Vec3 offset;
  for (int axis = 0; axis < 3; ++axis) {
    const double u = unit_number(hash_combine(place.seed, static_cast<uint64_t>(3 * octant + axis)));
    offset[axis] = place.size * (0.5 * ((octant >> axis & 1) + u) - 0.5);
  }
  const Vec3 p = place.centre + offset;
  Sample result = sample(p, glm::length(p - middle.closest) * (1 + 1e-6), middle.triangle);
  result.offset = offset;
  return result;
}

// Returns the samples' variance relative to their mean.
double AlbedoCells::set_mean(Cell& cell, const std::vector<Sample>& samples) {
  const auto count = static_cast<double>(samples.size());
  Rgb mean;
  for (const Sample& s : samples) mean += s.albedo / count;
  cell.mean = rounded(mean.r, 10) << 20 | rounded(mean.g, 10) << 10 | rounded(mean.b, 10);
  double variance = 0;
  for (const Sample& s : samples)
    variance += relative_square(s.albedo - mean, mean) / std::max(1.0, count - 1);
  return variance;
}

// Least squares of where the samples' closest points lie in the plane of the centre's triangle.
AlbedoCells::Map AlbedoCells::fit(const Sample& centre, const std::vector<Sample>& samples) const {
  const Index3& corner = mesh_.corners[centre.triangle];
  const Vec3 origin = mesh_.positions[corner[0]];
  const Vec3 u = mesh_.positions[corner[1]] - origin, v = mesh_.positions[corner[2]] - origin;
  const Vec3 normal = glm::cross(u, v);
  const double squared = length_squared(normal);
  const Vec3 along_u = glm::cross(v, normal) / squared, along_v = glm::cross(normal, u) / squared;
  const auto coordinates = [&](const Vec3& p) {
    return Vec2(glm::dot(along_u, p - origin), glm::dot(along_v, p - origin));
  };
  const auto count = static_cast<double>(samples.size());
  Vec3 mean_offset(0);
  Vec2 mean_value(0);
  for (const Sample& s : samples)
    mean_offset += s.offset / count, mean_value += coordinates(s.closest) / count;
  Mat3 spread(0.0);
  Vec3 product[2] = {Vec3(0), Vec3(0)};
  for (const Sample& s : samples) {
    const Vec3 d = s.offset - mean_offset;
    spread += glm::outerProduct(d, d);
    const Vec2 value = coordinates(s.closest) - mean_value;
    product[0] += value.x * d, product[1] += value.y * d;
  }
  const Mat3 inverse = glm::inverse(spread);
  Map map;
  map.triangle = centre.triangle;
  for (int k = 0; k < 2; ++k) {
    const Vec3 gradient = inverse * product[k];
    const auto row = static_cast<std::size_t>(k);
    map.at_centre[row] = static_cast<float>(mean_value[k] - glm::dot(gradient, mean_offset));
    for (int axis = 0; axis < 3; ++axis)
      map.gradient[row][static_cast<std::size_t>(axis)] = static_cast<float>(gradient[axis]);
  }
  return map;
}

}  // namespace alabaster

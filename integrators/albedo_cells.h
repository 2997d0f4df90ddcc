#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "core/rgb.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"
#include "texture/albedo_field.h"

namespace alabaster {

/// What is remembered of the closest surface points around a place in the medium: cells of a sparse grid,
/// fine near the surface and coarser with depth, made when a walk first comes by. A cell knows how far the
/// surface is from its centre and a guess of the albedo, whichever fits its samples better: their mean, or
/// the texture read through an affine map from the cell to the tangent plane of its centre's closest point.
///
/// The guess is no more than a control variate: whoever uses it adds, with the probability `exactness`, the
/// difference from the exact albedo divided by that probability. The expectation is then the exact albedo
/// whatever the cell says, across the medial axis as well, and the cell decides about noise and time alone.
///
/// A cell's contents depend on its place only, never on the walks or on the number of threads. Thread-safe.
class AlbedoCells {
 public:
  /// `length`, m: the scale at which cells are made, a mean free path. Without an albedo the cells know the
  /// surface alone. Everything passed by reference outlives this.
  AlbedoCells(const RayScene& rays, const TriangleMesh& mesh, uint32_t object, const AlbedoField* albedo,
              double length);
  ~AlbedoCells();
  AlbedoCells(const AlbedoCells&) = delete;
  AlbedoCells& operator=(const AlbedoCells&) = delete;

  struct View {
    Rgb albedo;            // the guess
    double exactness = 1;  // probability with which the exact albedo has to be asked for, (0, 1]
    Vec3 normal{0};        // of the surface closest to the cell's centre: unit, outwards, at one point
    double depth = 0;      // m: how far that is
    double clearance = 0;  // m: no surface is closer to the point; may be negative
    double reach = 0;      // m: some surface is at most this close to the point
    uint32_t triangle = no_index;  // one that may be close, for the exact query
  };
  View at(const Vec3& p) const;

  /// Point queries spent on cells, and bytes held, so far.
  int64_t queries() const { return queries_.load(std::memory_order_relaxed); }
  std::size_t bytes() const { return bytes_.load(std::memory_order_relaxed); }

 private:
  struct Cell;
  struct Map;
  struct Sample;
  struct Place;
  Cell* new_cells(std::size_t count) const;
  uintptr_t make_block(std::size_t index, const Vec3& centre) const;
  void fill(Cell& cell, const Place& place) const;
  Sample sample(const Vec3& p, double radius, uint32_t guess) const;
  Sample sample_octant(const Place& place, int octant, const Sample& middle) const;
  static double set_mean(Cell& cell, const std::vector<Sample>& samples);
  Map fit(const Sample& centre, const std::vector<Sample>& samples) const;
  Rgb mapped(const Map& map, const Vec3& offset) const;
  const Map& map(uint32_t number) const;
  uint32_t keep(const Map& map) const;

  const RayScene& rays_;
  const TriangleMesh& mesh_;
  uint32_t object_;
  const AlbedoField* albedo_;
  double length_;
  Vec3 low_{0};            // m: corner of the grid
  double block_size_ = 1;  // m
  Index3 count_{1, 1, 1};
  /// Address of a block's cells, the logarithm of their number along an axis in its lowest bits; 0: not made.
  mutable std::vector<std::atomic<uintptr_t>> blocks_;
  mutable std::vector<std::atomic<Map*>> maps_;  // in chunks, which never move
  mutable uint32_t map_count_ = 0;
  mutable std::vector<std::unique_ptr<Cell[]>> cell_chunks_;
  mutable std::size_t cells_left_ = 0;  // in the last chunk
  mutable std::mutex mutex_;            // of what grows
  mutable std::atomic<int64_t> queries_{0};
  mutable std::atomic<std::size_t> bytes_{0};
};

}  // namespace alabaster

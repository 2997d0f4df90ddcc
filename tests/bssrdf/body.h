#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "bssrdf/area_sampler.h"
#include "bssrdf/placements.h"
#include "bssrdf/probe_sampler.h"
#include "core/frame.h"
#include "core/rng.h"
#include "geometry/mesh.h"
#include "geometry/ray_scene.h"
#include "geometry/uv_atlas.h"

/// A mesh with everything that models and entry sampling need. Lengths in metres.
struct Body {
  explicit Body(alabaster::TriangleMesh given)
      : mesh(std::move(given)), atlas(mesh), placement(parts()), projected(parts()) {
    rays.add(mesh);
    rays.commit();
  }
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;

  alabaster::PlacementBody parts() const { return {&mesh, &atlas, &rays, 0}; }
  /// For BssrdfMedium::shape, with the baseline's families.
  const alabaster::ShapeBasis* shape() {
    if (curvature.empty()) curvature = alabaster::CurvatureField(mesh, rays, 0);
    basis = {&alabaster::baseline_shapes(), &curvature};
    return &basis;
  }
  alabaster::ProbeTarget target() const { return {&rays, &mesh, 0, {}}; }

  alabaster::TriangleMesh mesh;
  alabaster::UvAtlas atlas;
  alabaster::RayScene rays;
  alabaster::ChordPlacement placement;
  alabaster::ProjectedChordPlacement projected;  // always by queries
  alabaster::CurvatureField curvature;
  alabaster::ShapeBasis basis;
};

/// Points uniform over the mesh.
inline std::vector<alabaster::SurfacePoint> points_on(const alabaster::TriangleMesh& mesh, int count,
                                                      uint64_t seed) {
  const alabaster::AreaSampler area(mesh, [](uint32_t) { return true; });
  alabaster::Rng rng(seed);
  std::vector<alabaster::SurfacePoint> points;
  for (int k = 0; k < count; ++k) {
    const auto [triangle, barycentric] = area.sample({rng.uniform(), rng.uniform()});
    points.push_back(mesh.surface_point(triangle, barycentric));
  }
  return points;
}

inline alabaster::EntryRandom entry_random(alabaster::Rng& rng) {
  return {{rng.uniform(), rng.uniform()}, {rng.uniform(), rng.uniform()}, rng.uniform()};
}

inline constexpr const char* all_models[] = {"homogeneous",   "factorized",          "aggregate",
                                             "composite",     "composite:symmetric", "composite:order1",
                                             "composite:view"};

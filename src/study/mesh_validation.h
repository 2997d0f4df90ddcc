#pragma once

#include <string>
#include <vector>

#include "study/mesh_method.h"
#include "study/mesh_scene.h"
#include "study/method_result.h"
#include "study/reference_store.h"

namespace alabaster {

/// What meshes are measured with.
struct MeshBudget {
  int resolution = 96;            // pixels of the longer side
  double reference_noise = 0.05;  // of the references, RMSE / RMS
  uint32_t max_spp = 2048;        // of the references
  uint32_t spp = 256;             // of the methods; twice as many without texture
};

/// A method's error on a mesh, and where it comes from.
struct MeshMethodResult : MethodResult {
  TimedImage flat_render;  // on one albedo per object
  /// The error that is left with one albedo per object: that of the shape.
  Metrics shape;
  /// The error of the image multiplied, pixel by pixel, by reference / method on one albedo: what the texture
  /// adds. Over the pixels where both of these are known to 10 %. Walks know the shape: all their error is
  /// this.
  Metrics aggregation;
  double aggregation_pixels = 0;  // share of the lit pixels it could use
  double sampling_noise = 0;      // of the method's image alone
};

/// One mesh with everything measured on it.
struct MeshSceneResult {
  std::string name, title;
  std::string skipped;  // why nothing was measured; empty otherwise
  TimedImage reference, flat_reference;
  std::vector<MeshMethodResult> methods;
};

/// Renders references (from the store where it has them) and methods, in that order. Nothing is measured, and
/// `skipped` says why, where the reference cannot be rendered. When a stop was asked for, methods are
/// missing.
MeshSceneResult measure_mesh(const std::string& scene, const std::vector<MeshMethod>& methods,
                             const MeshBudget& budget, ReferenceStore& store, uint64_t seed);

/// a x correction / divisor with its variance by propagation, as an image of a's kind, and the pixels where
/// both factors are known to 10 %.
struct CorrectedImage {
  Image image;
  std::vector<bool> known;
};
CorrectedImage corrected(const Image& a, const Image& correction, const Image& divisor);

}  // namespace alabaster

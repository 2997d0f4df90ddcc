#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "integrators/volume_walk.h"
#include "study/mesh_method.h"
#include "study/mesh_scene.h"
#include "study/validation.h"

namespace alabaster {

// S_V(x_i, x_e) over a mesh for one exit point x_e: the models against a tally of random walks that start at
// x_e. Under broad light a kernel's error averages out; this shows it where it is made.

/// How much the entry's albedo differs from the exit's (mean over the channels).
enum class Contrast { low, middle, high };  // below 0.1, below 0.3, above
Contrast contrast_of(const Rgb& entry, const Rgb& exit);
const char* name_of(Contrast contrast);

/// The distances that are told apart, in mean free paths: two to the octave.
struct ResponseBins {
  static constexpr int count = 24;
  static constexpr double first = 0.05;  // below it lies bin 0 alone
  static double low(int bin);
  static double high(int bin);
  static int of(double distance);
};

/// Sums over the surface by distance and contrast, mean over the channels: the share of the light that left
/// x_e that came in there, or that leaves there if it came in at x_e (the true S_V is reciprocal).
struct ResponseSums {
  std::array<std::array<double, 3>, ResponseBins::count> value{};     // [distance][contrast]
  std::array<std::array<double, 3>, ResponseBins::count> variance{};  // of the value; 0 where not random
  std::vector<double> by_triangle;                                    // 1/m^2, mean over the triangle
  double total() const;
};

ResponseBudget response_budget(Quality quality);

/// A point of an object of a scene that has a medium.
struct ExitPoint {
  std::string name;  // "light" or "dark"
  uint32_t object = 0;
  SurfacePoint surface;
  Rgb albedo;
};

/// The points nearest to the image's centre among those of the highest and of the lowest albedo that the
/// camera sees.
std::vector<ExitPoint> choose_exits(const MeshScene& scene);

/// Walks from the exit, their directions drawn in proportion to T(cos) cos, tallied where they leave. Their
/// density per area is S_V(x_i, x_e): on a half-space the basis R. Independent of the number of threads.
ResponseSums tally_response(const Scene& scene, const ExitPoint& exit, WalkAlbedo albedo, uint64_t walks,
                            uint64_t seed);

/// A model's S_V integrated over the mesh: one random point in each of many small parts of it.
ResponseSums integrate_response(const Scene& scene, const ExitPoint& exit, const MeshMethod& method,
                                uint64_t seed);

/// One exit of one scene with everything measured.
struct ResponseResult {
  std::string scene;
  ExitPoint exit;
  ResponseSums reference;
  std::vector<std::pair<std::string, ResponseSums>> methods;
  Image triangles;  // of what the camera sees: "object" and "triangle", -1 where nothing
};

/// What is measured when no scenes are named.
const std::vector<std::string>& response_scenes();

/// Measures the methods on the scenes and writes response.csv,
/// response.json (a row per scene, exit, method, distance and contrast), and response.html with false colours
/// on the surface and charts. Throws InputError.
std::vector<ResponseResult> validate_response(const ValidationOptions& options);

}  // namespace alabaster

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/sampler.h"
#include "integrators/integrator.h"
#include "scene/film.h"

namespace alabaster {

/// A part of an image in pixels, from the top left: x0 <= x < x1, y0 <= y < y1.
struct PixelRectangle {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool operator==(const PixelRectangle&) const = default;
};

struct RenderOptions {
  uint32_t spp = 64;  // samples per pixel
  SamplerKind sampler = SamplerKind::sobol;
  uint64_t seed = 0;
  /// The part that is rendered; the whole image when absent. Its pixels are the whole image's.
  std::optional<PixelRectangle> crop;
  /// Seconds of wall time after which no further sample is begun; 0: no limit.
  double time_limit = 0;
  std::string label = "rendering";  // of the progress line
};

struct RenderResult {
  Film film;
  uint64_t samples = 0;           // of all pixels
  uint64_t rejected = 0;          // not finite, counted as black: a bug
  uint32_t fewest = 0, most = 0;  // samples of a pixel
  double seconds = 0, cpu_seconds = 0;
  bool complete = false;   // every pixel has all its samples
  bool cancelled = false;  // a stop was asked for
};

/// Renders in passes over the whole image that double the samples of every pixel: 1, 2, 4, ... spp. Stops at
/// the end, when the time is over or when a stop is asked for (core/cancellation.h), and keeps every finished
/// sample; then pixels may differ in their sample counts. Every sample depends on (pixel, index, seed) only.
RenderResult render(const Integrator& integrator, const RenderOptions& options);

}  // namespace alabaster

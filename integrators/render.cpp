#include "integrators/render.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>

#include "core/cancellation.h"
#include "core/parallel.h"
#include "core/progress.h"

namespace alabaster {

namespace {

constexpr int tile_size = 16;

// One render: what its passes share.
class Job {
 public:
  Job(const Integrator& integrator, const RenderOptions& options, const PixelRectangle& window, Film& film)
      : integrator_(integrator),
        options_(options),
        window_(window),
        film_(film),
        deadline_(options.time_limit > 0 ? wall_seconds() + options.time_limit
                                         : std::numeric_limits<double>::infinity()),
        total_(static_cast<uint64_t>(window.width()) * static_cast<uint64_t>(window.height()) * options.spp),
        start_(wall_seconds()),
        progress_(options.label) {}

  // Brings every pixel to `target` samples unless stopped.
  void pass(uint32_t target) {
    const int columns = (window_.width() + tile_size - 1) / tile_size;
    const int rows = (window_.height() + tile_size - 1) / tile_size;
    parallel_for(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 1,
                 [&](std::size_t begin, std::size_t end) {
                   for (std::size_t t = begin; t < end; ++t) {
                     tile(static_cast<int>(t) % columns, static_cast<int>(t) / columns, target);
                     show_progress(target);
                   }
                 });
  }

  bool stopped() const { return stop_.load(std::memory_order_relaxed); }
  uint64_t rejected() const { return rejected_; }

 private:
  void tile(int column, int row, uint32_t target) {
    const int x1 = std::min(window_.width(), (column + 1) * tile_size);
    const int y1 = std::min(window_.height(), (row + 1) * tile_size);
    Sampler sampler(options_.sampler, options_.seed);
    uint64_t done = 0;
    for (int y = row * tile_size; y < y1; ++y)
      for (int x = column * tile_size; x < x1; ++x) done += pixel(x, y, target, sampler);
    done_ += done;
  }

  uint64_t pixel(int x, int y, uint32_t target, Sampler& sampler) {
    const uint32_t first = film_.count(x, y);
    for (uint32_t k = first; k < target; ++k) {
      if ((k % 16 == 0 || k == first) && must_stop()) return k - first;
      sampler.start(window_.x0 + x, window_.y0 + y, k);
      add(x, y, integrator_.sample(window_.x0 + x, window_.y0 + y, sampler));
    }
    return target - first;
  }

  void add(int x, int y, const PixelSample& sample) {
    Rgb radiance = sample.radiance;
    if (!radiance.is_finite()) {
      ++rejected_;
      radiance = Rgb();
    }
    const Film::Auxiliary first_hit{sample.albedo, sample.normal, sample.depth};
    film_.add(x, y, radiance, sample.alpha, sample.hit ? &first_hit : nullptr);
  }

  bool must_stop() {
    if (stopped()) return true;
    if (!cancellation_requested() && wall_seconds() < deadline_) return false;
    stop_ = true;
    return true;
  }

  void show_progress(uint32_t target) {
    const std::unique_lock<std::mutex> lock(progress_mutex_, std::try_to_lock);
    if (!lock) return;
    double fraction = static_cast<double>(done_) / static_cast<double>(total_);
    if (options_.time_limit > 0)
      fraction = std::max(fraction, std::min(1.0, (wall_seconds() - start_) / options_.time_limit));
    progress_.update(fraction, fmt::format("up to {} spp", target));
  }

  const Integrator& integrator_;
  const RenderOptions& options_;
  PixelRectangle window_;
  Film& film_;
  double deadline_;
  uint64_t total_;
  double start_;
  Progress progress_;
  std::mutex progress_mutex_;
  std::atomic<uint64_t> done_{0}, rejected_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace

RenderResult render(const Integrator& integrator, const RenderOptions& options) {
  const PixelRectangle window =
      options.crop.value_or(PixelRectangle{0, 0, integrator.width(), integrator.height()});
  RenderResult result{Film(window.width(), window.height(), options.sampler)};
  const double wall = wall_seconds(), cpu = cpu_seconds();
  {
    Job job(integrator, options, window, result.film);
    for (uint32_t target = 1; !job.stopped(); target = std::min(options.spp, 2 * target)) {
      job.pass(std::min(target, options.spp));
      if (target >= options.spp) break;
    }
    result.rejected = job.rejected();
    result.complete = !job.stopped();
  }
  result.seconds = wall_seconds() - wall;
  result.cpu_seconds = cpu_seconds() - cpu;
  result.cancelled = cancellation_requested();
  result.fewest = std::numeric_limits<uint32_t>::max();
  for (int y = 0; y < window.height(); ++y)
    for (int x = 0; x < window.width(); ++x) {
      const uint32_t count = result.film.count(x, y);
      result.samples += count;
      result.fewest = std::min(result.fewest, count);
      result.most = std::max(result.most, count);
    }
  return result;
}

}  // namespace alabaster

#include "integrators/planar_volume.h"

#include <cassert>
#include <cmath>

#include "core/cancellation.h"
#include "core/error.h"
#include "core/parallel.h"
#include "integrators/planar_lane.h"
#include "integrators/planar_lattice.h"
#include "integrators/planar_walk_texture.h"
#include "optics/photon_walk.h"

namespace alabaster {

namespace {

// Independent parts of a result, from which its variance is estimated; also the unit of parallel work.
constexpr std::size_t batch_count = 32;

template <int C>
class WalkLane final : public PlanarLane {
 public:
  /// Serves channels first .. first + C - 1 of the texture and writes them to `outputs` channels each.
  WalkLane(const PlanarScene& scene, PlanarEstimator estimator, int first, int outputs)
      : scene_(scene),
        from_light_(estimator == PlanarEstimator::from_light),
        analog_(estimator == PlanarEstimator::analog),
        first_(first),
        outputs_(outputs),
        mean_free_path_(scene.medium.mean_free_path[first]),
        eta_(scene.medium.eta),
        critical_cosine_(std::sqrt(1 - 1 / (eta_ * eta_))),
        g_(scene.medium.g),
        texture_(scene, first, mean_free_path_),
        target_weight_(scene, mean_free_path_, from_light_),
        seen_(seen_inside(scene)) {}

  void run(PlanarBatch& batch, uint64_t walks) const override {
    if (from_light_) {
      photons(batch, walks);
    } else {
      camera_paths(batch, walks);
    }
  }
  double paths_per_walk() const override {
    return from_light_ ? 1 : static_cast<double>(scene_.view.width) * scene_.view.height;
  }

 private:
  void photons(PlanarBatch& batch, uint64_t count) const {
    const auto at_collision = [&](const PlanarPath& p) {
      if (!scene_.view.radiosity) score_collision(p, batch);
    };
    const auto at_boundary = [&](const PlanarPath& p, double out) {
      if (scene_.view.radiosity) score(p, out, Vec2(p.position), batch);
    };
    for (uint64_t i = 0; i < count; ++i) {
      PlanarPath path;
      const Vec2 entry = scene_.light.sample({batch.rng.uniform(), batch.rng.uniform()}) / mean_free_path_;
      path.position = Vec3(entry, 0);
      path.direction = sample_diffuse_entry(eta_, batch.rng);
      path.weight.fill(1);
      follow(path, batch, at_collision, at_boundary);
      while (!batch.split.empty()) {
        PlanarPath copy = batch.split.back();
        batch.split.pop_back();
        follow(copy, batch, at_collision, at_boundary);
      }
    }
  }

  void camera_paths(PlanarBatch& batch, uint64_t per_pixel) const {
    const PlanarView& view = scene_.view;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x)
        for (uint64_t i = 0; i < per_pixel; ++i) camera_path(x, y, batch);
  }

  double transmittance_inside(double cosine) const {
    return cosine <= critical_cosine_ ? 0 : 1 - fresnel_dielectric(cosine, 1 / eta_);
  }

  void camera_path(int x, int y, PlanarBatch& batch) const {
    PlanarPath path;
    const Vec2 start = scene_.view.point({x + batch.rng.uniform(), y + batch.rng.uniform()});
    path.position = Vec3(start / mean_free_path_, 0);
    double transmitted;
    if (scene_.view.radiosity) {
      path.direction = sample_diffuse_entry(eta_, batch.rng);
      transmitted = diffuse_transmittance(eta_);
    } else {
      path.direction = Vec3(-seen_.x, -seen_.y, -seen_.z);
      transmitted = 1 - fresnel_dielectric(scene_.view.towards.z, eta_);
    }
    path.weight.fill(transmitted);
    if (analog_ && !survives(path, transmitted, batch.rng)) return;
    const auto on_pixel = [&](const PlanarPath& p, double out) {
      if (!scene_.light.contains(mean_free_path_ * Vec2(p.position))) return;
      add(p, out, x, y, batch);
    };
    follow(
        path, batch, [](const PlanarPath&) {}, on_pixel);
  }

  /// The walk from a direction inside to its end. `at_collision` sees the path after absorption, before its
  /// new direction; `at_boundary` sees it before it leaves or turns back, with the part that would leave.
  template <class AtCollision, class AtBoundary>
  void follow(PlanarPath& path, PlanarBatch& batch, AtCollision at_collision, AtBoundary at_boundary) const {
    Rng& rng = batch.rng;
    for (;;) {
      double flight = sample_free_flight(rng);
      if (path.direction.z < 0 && flight * -path.direction.z > path.position.z) {
        const double to_boundary = path.position.z / -path.direction.z;
        path.position += to_boundary * path.direction;
        path.position.z = 0;
        const double out = transmittance_inside(-path.direction.z);
        const bool leaves = out > 0 && rng.uniform() < out;
        if (!analog_ && out > 0) at_boundary(path, out);
        if (analog_ && leaves) at_boundary(path, 1);
        if (leaves) return;
        path.direction.z = -path.direction.z;
        flight -= to_boundary;
      }
      path.position += flight * path.direction;
      ++batch.collisions;
      const auto albedo = texture_.at(path.position.x, path.position.y);
      double largest = 0;
      for (std::size_t c = 0; c < C; ++c) largest = std::max(largest, path.weight[c] *= albedo[c]);
      if (analog_) {
        if (!survives(path, largest, rng)) return;
      } else {
        at_collision(path);
        if (!roulette_or_split(path, largest, batch)) return;
      }
      path.direction = scatter(path.direction, g_, rng);
    }
  }

  /// Goes on with the probability of its weight, then with weight 1.
  static bool survives(PlanarPath& path, double weight, Rng& rng) {
    path.weight.fill(1);
    return rng.uniform() < weight;
  }

  /// Keeps weights near the target of the place: light photons live on by chance, heavy ones are split.
  /// False: it died.
  bool roulette_or_split(PlanarPath& path, double largest, PlanarBatch& batch) const {
    const double target = target_weight_.at(Vec2(path.position));
    if (largest < 0.4 * target) {
      if (batch.rng.uniform() * target >= largest) return false;
      for (double& w : path.weight) w *= target / largest;
    } else if (largest > 5 * target) {
      const int copies = std::min(static_cast<int>(largest / (2 * target)), 8);
      for (double& w : path.weight) w /= copies;
      for (int i = 1; i < copies; ++i) {
        batch.split.push_back({path.position, scatter(path.direction, g_, batch.rng), path.weight});
      }
    }
    return true;
  }

  /// The exact probability of leaving towards the camera without another collision, into the pixel that sees
  /// it.
  void score_collision(const PlanarPath& path, PlanarBatch& batch) const {
    const double distance = path.position.z / -seen_.z;
    const double value = henyey_greenstein(glm::dot(path.direction, seen_), g_) * std::exp(-distance);
    score(path, value, Vec2(path.position) + distance * Vec2(seen_), batch);
  }

  void score(const PlanarPath& path, double value, Vec2 optical_point, PlanarBatch& batch) const {
    const PlanarView& view = scene_.view;
    const Vec2 pixel = view.pixel(mean_free_path_ * optical_point);
    if (pixel.x >= 0 && pixel.x < view.width && pixel.y >= 0 && pixel.y < view.height)
      add(path, value, static_cast<int>(pixel.x), static_cast<int>(pixel.y), batch);
  }

  void add(const PlanarPath& path, double value, int x, int y, PlanarBatch& batch) const {
    const std::size_t pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(scene_.view.width) +
                              static_cast<std::size_t>(x);
    for (int c = 0; c < C * outputs_; ++c)
      batch.sums[3 * pixel + static_cast<std::size_t>(first_ + c)] +=
          value * path.weight[static_cast<std::size_t>(c / outputs_)];
  }

  const PlanarScene& scene_;
  bool from_light_, analog_;
  int first_, outputs_;
  double mean_free_path_;  // m
  double eta_, critical_cosine_;
  double g_;
  WalkTexture<C> texture_;
  TargetWeight target_weight_;
  Vec3 seen_;  // inside: the direction that refracts towards the camera
};

bool traces_from_light(PlanarEstimator estimator) {
  return estimator == PlanarEstimator::from_light || estimator == PlanarEstimator::lattice;
}

bool is_grey(const TexelArray& texels) {
  for (const Vec4f& t : texels.texels)
    if (t.x != t.y || t.y != t.z) return false;
  return true;
}

std::vector<std::unique_ptr<PlanarLane>> make_lanes(const PlanarScene& scene, PlanarEstimator estimator) {
  std::vector<std::unique_ptr<PlanarLane>> lanes;
  const bool one_length = scene.medium.mean_free_path.is_grey();
  if (estimator == PlanarEstimator::lattice) {
    const bool grey = one_length && is_grey(*scene.albedo);
    const int channels = one_length && !grey ? 3 : 1, outputs = grey ? 3 : 1;
    for (int c = 0; c < 3; c += channels * outputs)
      lanes.push_back(make_lattice_lane(scene, c, channels, outputs));
  } else if (one_length && is_grey(*scene.albedo)) {
    lanes.push_back(std::make_unique<WalkLane<1>>(scene, estimator, 0, 3));
  } else if (one_length && estimator != PlanarEstimator::analog) {
    lanes.push_back(std::make_unique<WalkLane<3>>(scene, estimator, 0, 1));
  } else {
    for (int c = 0; c < 3; ++c) lanes.push_back(std::make_unique<WalkLane<1>>(scene, estimator, c, 1));
  }
  return lanes;
}

}  // namespace

struct PlanarVolume::State {
  PlanarScene scene;
  PlanarVolumeOptions options;
  std::vector<std::unique_ptr<PlanarLane>> lanes;
  std::vector<PlanarBatch> batches;
  double cpu_seconds = 0;

  std::size_t pixels() const {
    return static_cast<std::size_t>(scene.view.width) * static_cast<std::size_t>(scene.view.height);
  }

  /// What the mean of a path's scores is multiplied by.
  Rgb scale() const {
    const Medium& medium = scene.medium;
    const PlanarView& view = scene.view;
    if (!traces_from_light(options.estimator)) return scene.light.radiance * static_cast<double>(pixels());
    // Photons carry what crosses the boundary, pi c x area x radiance. A collision sends weight x
    // phase function x attenuation per steradian; over the pixel's area seen from inside that is a radiance,
    // which the boundary changes by T / eta^2.
    const double ratio = diffuse_transmittance(medium.eta) * scene.light.area() / view.pixel_area();
    if (view.radiosity) return scene.light.radiance * ratio;
    const double transmitted = 1 - fresnel_dielectric(view.towards.z, medium.eta);
    const double sine_squared = (1 - view.towards.z * view.towards.z) / (medium.eta * medium.eta);
    return scene.light.radiance *
           (pi * ratio * transmitted / (medium.eta * medium.eta * std::sqrt(1 - sine_squared)));
  }

  // Lanes trace equally many walks.
  double paths(const PlanarBatch& batch) const {
    return static_cast<double>(batch.walks) * lanes.front()->paths_per_walk();
  }

  Rgb batch_mean(const PlanarBatch& batch, std::size_t pixel) const {
    const double n = batch.walks > 0 ? paths(batch) : 1;
    return Rgb(batch.sums[3 * pixel], batch.sums[3 * pixel + 1], batch.sums[3 * pixel + 2]) / n * scale();
  }

  struct Estimate {
    Rgb mean, variance_of_mean;
  };
  Estimate estimate(std::size_t pixel) const {
    Rgb sum, squares;
    for (const PlanarBatch& batch : batches) sum += batch_mean(batch, pixel);
    const Rgb mean = sum / static_cast<double>(batch_count);
    for (const PlanarBatch& batch : batches) {
      const Rgb d = batch_mean(batch, pixel) - mean;
      squares += d * d;
    }
    return {mean, squares / static_cast<double>(batch_count * (batch_count - 1))};
  }
};

PlanarVolume::PlanarVolume(const PlanarScene& scene, const PlanarVolumeOptions& options)
    : state_(std::make_unique<State>()) {
  check(scene);
  if (scene.light.shape == PlanarLight::Shape::plane && traces_from_light(options.estimator))
    throw InputError("scene '" + scene.name +
                     "': light on the whole plane cannot be traced from the light; "
                     "trace it from the camera");
  state_->scene = scene;
  state_->options = options;
  state_->lanes = make_lanes(state_->scene, options.estimator);
  for (std::size_t i = 0; i < batch_count; ++i) {
    state_->batches.emplace_back(options.seed, i);
    state_->batches.back().sums.resize(3 * state_->pixels());
  }
}

PlanarVolume::~PlanarVolume() = default;

void PlanarVolume::run(uint64_t paths) {
  State& state = *state_;
  const double start = alabaster::cpu_seconds();
  const PlanarLane& first = *state.lanes.front();
  const uint64_t at_once = first.walks_at_once();
  const double runs =
      static_cast<double>(paths) / (batch_count * first.paths_per_walk() * static_cast<double>(at_once));
  const uint64_t walks = at_once * static_cast<uint64_t>(std::ceil(runs));
  parallel_for(batch_count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      PlanarBatch& batch = state.batches[i];
      for (const auto& lane : state.lanes) lane->run(batch, walks);
      batch.walks += walks;
    }
  });
  state.cpu_seconds += alabaster::cpu_seconds() - start;
}

Image PlanarVolume::develop() const {
  const PlanarView& view = state_->scene.view;
  Image image(view.width, view.height,
              {"R", "G", "B", "A", "variance.R", "variance.G", "variance.B", "samples.Y"});
  const float per_pixel =
      static_cast<float>(static_cast<double>(paths()) / static_cast<double>(state_->pixels()));
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) {
      const auto estimate = state_->estimate(
          static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width) + static_cast<std::size_t>(x));
      image.set_rgb(0, x, y, estimate.mean);
      image.at(3, x, y) = 1;
      image.set_rgb(4, x, y, estimate.variance_of_mean);
      image.at(7, x, y) = per_pixel;
    }
  return image;
}

double PlanarVolume::noise() const {
  Rgb variance, square;
  for (std::size_t pixel = 0; pixel < state_->pixels(); ++pixel) {
    const auto estimate = state_->estimate(pixel);
    variance += estimate.variance_of_mean;
    square += estimate.mean * estimate.mean;
  }
  return square.is_black() ? 0 : std::sqrt(variance.mean() / square.mean());
}

uint64_t PlanarVolume::paths() const {
  double sum = 0;
  for (const PlanarBatch& batch : state_->batches) sum += state_->paths(batch);
  return static_cast<uint64_t>(std::llround(sum));
}

uint64_t PlanarVolume::collisions() const {
  uint64_t sum = 0;
  for (const PlanarBatch& batch : state_->batches) sum += batch.collisions;
  return sum;
}

double PlanarVolume::cpu_seconds() const {
  return state_->cpu_seconds;
}

PlanarEstimator cheapest_estimator(const PlanarScene& scene) {
  if (scene.light.shape == PlanarLight::Shape::plane) return PlanarEstimator::from_camera;
  const bool small = scene.light.area() < 32 * scene.view.pixel_area();
  return small ? PlanarEstimator::from_light : PlanarEstimator::lattice;
}

void run_to_noise(PlanarVolume& volume, double noise, uint64_t max_paths) {
  uint64_t step = std::max<uint64_t>(volume.paths(), 200000);
  while (volume.paths() < max_paths && !cancellation_requested()) {
    volume.run(std::min(step, max_paths - volume.paths()));
    const double now = volume.noise();
    if (now > 0 && now <= noise) return;
    // Noise falls as 1 / sqrt(paths); a little less than what is missing, then look again.
    const double wanted = now > 0 ? std::pow(now / noise, 2) - 1 : 3;
    const double factor = std::clamp(1.02 * wanted, 0.05, 4.0);
    step = static_cast<uint64_t>(factor * static_cast<double>(volume.paths())) + 1;
  }
}

}  // namespace alabaster

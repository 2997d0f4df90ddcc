#include "study/response.h"

#include <algorithm>
#include <cmath>

#include "core/cancellation.h"
#include "core/error.h"
#include "core/frame.h"
#include "core/parallel.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "integrators/bssrdf_transport.h"
#include "optics/fresnel.h"
#include "study/response_output.h"

namespace alabaster {

Contrast contrast_of(const Rgb& entry, const Rgb& exit) {
  const double difference = std::abs(entry.mean() - exit.mean());
  return difference < 0.1 ? Contrast::low : difference < 0.3 ? Contrast::middle : Contrast::high;
}

const char* name_of(Contrast contrast) {
  constexpr const char* names[] = {"low", "middle", "high"};
  return names[static_cast<int>(contrast)];
}

double ResponseBins::low(int bin) {
  return bin == 0 ? 0 : first * std::exp2(0.5 * (bin - 1));
}
double ResponseBins::high(int bin) {
  return first * std::exp2(0.5 * bin);
}
int ResponseBins::of(double distance) {
  if (distance < first) return 0;
  return std::min(count - 1, 1 + static_cast<int>(2 * std::log2(distance / first)));
}

double ResponseSums::total() const {
  double sum = 0;
  for (const auto& bin : value) sum += bin[0] + bin[1] + bin[2];
  return sum;
}

const std::vector<std::string>& response_scenes() {
  static const std::vector<std::string> names{"sphere_3", "sphere_10", "slab_2", "blob"};
  return names;
}

ResponseBudget response_budget(Quality quality) {
  return quality == Quality::quick ? ResponseBudget{} : ResponseBudget{30'000'000, 256};
}

namespace {

constexpr std::size_t batches = 32;

const Medium& medium_of(const Scene& scene, const ExitPoint& exit) {
  return *scene.materials[scene.objects[exit.object].mesh.materials[exit.surface.triangle]].medium;
}

/// One flag per material: whether it bounds the exit's medium.
std::vector<uint8_t> boundary_of(const Scene& scene, const ExitPoint& exit) {
  std::vector<uint8_t> boundary;
  for (const Material& material : scene.materials)
    boundary.push_back(material.medium == medium_of(scene, exit) ? 1 : 0);
  return boundary;
}

/// Puts values that belong to an entry point into their bins.
class Binning {
 public:
  Binning(const Scene& scene, const ExitPoint& exit)
      : exit_(exit),
        albedo_(*scene.objects[exit.object].albedo),
        mean_free_path_(medium_of(scene, exit).mean_free_path.mean()) {}

  double& slot(ResponseSums& sums, const SurfacePoint& entry) const {
    const double distance = glm::distance(entry.position, exit_.surface.position) / mean_free_path_;
    const Contrast contrast = contrast_of(albedo_.at(entry), exit_.albedo);
    return sums
        .value[static_cast<std::size_t>(ResponseBins::of(distance))][static_cast<std::size_t>(contrast)];
  }
  double mean_free_path() const { return mean_free_path_; }

 private:
  const ExitPoint& exit_;
  const AlbedoField& albedo_;
  double mean_free_path_;  // m, of the channels' mean
};

/// A direction just inside the surface and its weight, as light leaves by T(cos) cos / (pi c).
std::pair<Vec3, double> start_direction(const Vec3& normal, double eta, double c, Rng& rng) {
  const double r2 = rng.uniform(), phi = 2 * pi * rng.uniform(), cosine = std::sqrt(1 - r2);
  const Vec3 viewer =
      Frame(normal).to_world({std::sqrt(r2) * std::cos(phi), std::sqrt(r2) * std::sin(phi), cosine});
  const Vec3 along = (cosine * normal - viewer) / eta;
  const Vec3 inwards = along - std::sqrt(std::max(0.0, 1 - glm::dot(along, along))) * normal;
  return {glm::normalize(inwards), (1 - fresnel_dielectric(cosine, eta)) / c};
}

/// Visits parts of the mesh so small that S_V is nearly even over each, with a random point of each.
class SurfaceParts {
 public:
  SurfaceParts(const TriangleMesh& mesh, const Vec3& exit, double mean_free_path, Rng& rng)
      : mesh_(mesh), exit_(exit), mean_free_path_(mean_free_path), rng_(rng) {}

  /// visit(point, area)
  template <class Visit>
  void over(uint32_t triangle, Visit&& visit) {
    split(triangle, {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, mesh_.area(triangle), 0, visit);
  }

 private:
  using Corners = std::array<Vec2, 3>;  // barycentric

  double longest_allowed(double distance) const {
    const double far = std::max(0.25 * mean_free_path_, 0.03 * distance);
    return std::max(0.004 * mean_free_path_, std::min(0.1 * distance, far));
  }

  template <class Visit>
  void split(uint32_t triangle, const Corners& corners, double area, int depth, Visit&& visit) {
    std::array<Vec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = mesh_.position(triangle, corners[i]);
    const double edge =
        std::max({glm::distance(p[0], p[1]), glm::distance(p[1], p[2]), glm::distance(p[2], p[0])});
    const double distance = glm::distance((p[0] + p[1] + p[2]) / 3.0, exit_);
    if (depth < 16 && edge > longest_allowed(distance)) {
      const Vec2 a = 0.5 * (corners[0] + corners[1]), b = 0.5 * (corners[1] + corners[2]),
                 c = 0.5 * (corners[2] + corners[0]);
      for (const Corners& part : {Corners{corners[0], a, c}, Corners{a, corners[1], b},
                                  Corners{c, b, corners[2]}, Corners{a, b, c}})
        split(triangle, part, area / 4, depth + 1, visit);
      return;
    }
    const double r = std::sqrt(rng_.uniform()), v = rng_.uniform();
    const Vec2 place = (1 - r) * corners[0] + r * (1 - v) * corners[1] + r * v * corners[2];
    visit(mesh_.surface_point(triangle, place), area);
  }

  const TriangleMesh& mesh_;
  Vec3 exit_;
  double mean_free_path_;
  Rng& rng_;
};

}  // namespace

std::vector<ExitPoint> choose_exits(const MeshScene& scene) {
  constexpr int side = 48;
  struct Candidate {
    ExitPoint exit;
    double off_centre;
  };
  std::vector<Candidate> seen;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Ray ray = scene.scene.cameras.front().ray(Vec2(x, y) + 0.5, side, side);
      const auto hit = scene.scene.rays.nearest(ray);
      if (!hit || !scene.scene.material(*hit).medium) continue;
      const SceneObject& object = scene.scene.objects[hit->object];
      ExitPoint exit{"", hit->object, object.mesh.surface_point(hit->triangle, hit->barycentric), {}};
      exit.surface.object = hit->object;
      if (glm::dot(exit.surface.geometric_normal, -ray.direction) < 0.4) continue;  // towards the silhouette
      exit.albedo = object.albedo->at(exit.surface);
      seen.push_back({exit, std::hypot(x - 0.5 * side, y - 0.5 * side)});
    }
  if (seen.empty()) return {};
  double low = 1, high = 0;
  for (const Candidate& c : seen) {
    low = std::min(low, c.exit.albedo.mean());
    high = std::max(high, c.exit.albedo.mean());
  }
  std::vector<ExitPoint> exits;
  for (const bool light : {true, false}) {
    const Candidate* best = nullptr;
    for (const Candidate& c : seen) {
      const double away = light ? high - c.exit.albedo.mean() : c.exit.albedo.mean() - low;
      if (away <= 0.1 * (high - low) && (best == nullptr || c.off_centre < best->off_centre)) best = &c;
    }
    exits.push_back(best->exit);
    exits.back().name = light ? "light" : "dark";
    if (high - low < 0.02) break;  // one albedo
  }
  return exits;
}

ResponseSums tally_response(const Scene& scene, const ExitPoint& exit, WalkAlbedo albedo, uint64_t walks,
                            uint64_t seed) {
  const SceneObject& object = scene.objects[exit.object];
  const Medium& medium = medium_of(scene, exit);
  VolumeWalkOptions options;
  options.albedo = albedo;
  const VolumeWalk walk(scene.rays, object.mesh, exit.object, boundary_of(scene, exit), medium,
                        *object.albedo, options);
  const Binning binning(scene, exit);
  const double c = diffuse_transmittance(medium.eta);
  const uint64_t per_batch = (walks + batches - 1) / batches;

  std::vector<ResponseSums> parts(batches);
  parallel_for(batches, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      Rng rng(seed, b);
      parts[b].by_triangle.assign(object.mesh.triangle_count(), 0);
      for (uint64_t i = 0; i < per_batch && !cancellation_requested(); ++i) {
        const auto [direction, weight] = start_direction(exit.surface.geometric_normal, medium.eta, c, rng);
        const auto end_of_walk = walk.walk(exit.surface, direction, rng);
        if (!end_of_walk || end_of_walk->order == 0) continue;
        const double value = weight * end_of_walk->weight.mean() / static_cast<double>(per_batch);
        binning.slot(parts[b], end_of_walk->point) += value;
        parts[b].by_triangle[end_of_walk->point.triangle] += value;
      }
    }
  });

  ResponseSums sums;
  sums.by_triangle.assign(object.mesh.triangle_count(), 0);
  for (std::size_t d = 0; d < ResponseBins::count; ++d)
    for (std::size_t k = 0; k < 3; ++k) {
      RunningMoments moments;
      for (const ResponseSums& part : parts) moments.add(part.value[d][k]);
      sums.value[d][k] = moments.mean();
      sums.variance[d][k] = moments.variance_of_mean();
    }
  for (uint32_t t = 0; t < sums.by_triangle.size(); ++t) {
    for (const ResponseSums& part : parts) sums.by_triangle[t] += part.by_triangle[t];
    sums.by_triangle[t] /= static_cast<double>(batches) * object.mesh.area(t);
  }
  return sums;
}

ResponseSums integrate_response(const Scene& scene, const ExitPoint& exit, const MeshMethod& method,
                                uint64_t seed) {
  const SceneObject& object = scene.objects[exit.object];
  const BssrdfTransport transport(scene, exit.object, medium_of(scene, exit), boundary_of(scene, exit),
                                  method.model, method.basis_value());
  const Bssrdf& model = transport.model();
  const BssrdfPoint at_exit = model.medium().point(exit.surface);
  const Binning binning(scene, exit);
  const std::vector<uint8_t> boundary = boundary_of(scene, exit);
  ResponseSums sums;
  sums.by_triangle.assign(object.mesh.triangle_count(), 0);
  Rng rng(seed);
  SurfaceParts parts(object.mesh, exit.surface.position, binning.mean_free_path(), rng);
  for (uint32_t t = 0; t < object.mesh.triangle_count() && !cancellation_requested(); ++t) {
    if (boundary[object.mesh.materials[t]] == 0) continue;
    parts.over(t, [&](SurfacePoint entry, double area) {
      entry.object = exit.object;
      const double value = model.evaluate(model.medium().point(entry), at_exit).mean() * area;
      binning.slot(sums, entry) += value;
      sums.by_triangle[t] += value;
    });
    sums.by_triangle[t] /= object.mesh.area(t);
  }
  return sums;
}

namespace {

Image visible_triangles(const MeshScene& scene) {
  Image image(scene.width, scene.height, {"object", "triangle"});
  for (int y = 0; y < scene.height; ++y)
    for (int x = 0; x < scene.width; ++x) {
      const auto hit = scene.scene.rays.nearest(
          scene.scene.cameras.front().ray(Vec2(x, y) + 0.5, scene.width, scene.height));
      image.at(0, x, y) = hit ? static_cast<float>(hit->object) : -1;
      image.at(1, x, y) = hit ? static_cast<float>(hit->triangle) : -1;
    }
  return image;
}

ResponseResult measure(const MeshScene& scene, const ExitPoint& exit, const std::vector<MeshMethod>& methods,
                       const ResponseBudget& budget, uint64_t seed) {
  ResponseResult result{scene.name, exit, {}, {}, visible_triangles(scene)};
  result.reference = tally_response(scene.scene, exit, WalkAlbedo::closest_point, budget.walks, seed);
  for (const MeshMethod& method : methods)
    result.methods.emplace_back(
        method.name, method.transport == Transport::bssrdf
                         ? integrate_response(scene.scene, exit, method, seed + 1)
                         : tally_response(scene.scene, exit, WalkAlbedo::exit, budget.walks, seed + 2));
  return result;
}

}  // namespace

std::vector<ResponseResult> validate_response(const ValidationOptions& options) {
  const ResponseBudget budget = options.response_budget.value_or(response_budget(options.quality));
  for (const std::string& name : options.scenes)
    if (!is_mesh_scene_name(name))
      throw InputError("scene '" + name +
                       "': the response is measured on meshes; flat scenes have their kernels in "
                       "validate's report");
  std::vector<MeshMethod> methods;
  for (const std::string& name : options.models) methods.push_back(parse_mesh_method(name));
  if (methods.empty()) methods = standard_mesh_methods();
  std::vector<ResponseResult> results;
  for (const std::string& name : expand_mesh_scenes(options.scenes)) {
    if (cancellation_requested()) break;
    const MeshScene scene = load_mesh_scene(name, budget.resolution);
    const std::string obstacle = obstacle_to_reference(scene);
    if (!obstacle.empty()) {
      warn(obstacle + " (left out)");
      continue;
    }
    for (const ExitPoint& exit : choose_exits(scene)) {
      ResponseResult measured = measure(scene, exit, methods, budget, options.seed);
      if (cancellation_requested()) break;
      say(scene.name + ", " + exit.name + " exit: measured");
      results.push_back(std::move(measured));
    }
  }
  write_response(results, options);
  return results;
}

}  // namespace alabaster

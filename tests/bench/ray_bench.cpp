// Rays per second through RayScene against a bare Embree loop that shoots the same rays, in one run:
//   build/release/tests/test_bench "[rays]"
// One thread. Each figure is the best of several short rounds, ours and the bare loop's taking turns, so that
// other work on the machine disturbs both alike.

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "core/rng.h"
#include "geometry/ray_scene.h"
#include "geometry/shapes.h"

using namespace alabaster;

namespace {

class BareScene {
 public:
  BareScene(const TriangleMesh& mesh, RTCSceneFlags flags) : device_(rtcNewDevice("threads=1")) {
    for (const Vec3& p : mesh.positions)
      for (int k = 0; k < 3; ++k) vertices_.push_back(static_cast<float>(p[k]));
    vertices_.push_back(0);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices_.data(), 0,
                               12, mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.corners.data(), 0,
                               12, mesh.corners.size());
    rtcCommitGeometry(geometry);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, flags);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~BareScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  BareScene(const BareScene&) = delete;
  BareScene& operator=(const BareScene&) = delete;
  operator RTCScene() const { return scene_; }

 private:
  std::vector<float> vertices_;
  RTCDevice device_;
  RTCScene scene_;
};

RTCRay bare_ray(const Ray& ray) {
  RTCRay r{};
  const Vec3f o(ray.origin), d(ray.direction);
  r.org_x = o.x, r.org_y = o.y, r.org_z = o.z, r.dir_x = d.x, r.dir_y = d.y, r.dir_z = d.z;
  r.tnear = static_cast<float>(ray.t_min), r.tfar = static_cast<float>(ray.t_max), r.mask = ~0u;
  return r;
}

struct Counted {
  RTCIntersectContext context;
  std::size_t hits = 0;
};

void count_and_reject(const RTCFilterFunctionNArguments* args) {
  ++reinterpret_cast<Counted*>(args->context)->hits;
  args->valid[0] = 0;
}

std::size_t bare_all_hits(RTCScene scene, const std::vector<RTCRay>& rays) {
  Counted counted;
  rtcInitIntersectContext(&counted.context);
  counted.context.filter = count_and_reject;
  for (RTCRay r : rays) rtcOccluded1(scene, &counted.context, &r);
  return counted.hits;
}

std::size_t bare_nearest(RTCScene scene, const std::vector<RTCRay>& rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  std::size_t hits = 0;
  for (const RTCRay& ray : rays) {
    RTCRayHit r;
    r.ray = ray;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &r);
    hits += r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  return hits;
}

std::size_t bare_occluded(RTCScene scene, const std::vector<RTCRay>& rays) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  std::size_t hits = 0;
  for (RTCRay r : rays) {
    rtcOccluded1(scene, &context, &r);
    hits += r.tfar < 0;
  }
  return hits;
}

Vec3 uniform_direction(Rng& rng) {
  const double z = 2 * rng.uniform() - 1, phi = 2 * pi * rng.uniform(), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

SurfacePoint random_point(const TriangleMesh& mesh, Rng& rng) {
  const auto t = static_cast<uint32_t>(rng.uniform() * static_cast<double>(mesh.triangle_count()));
  const double r = std::sqrt(rng.uniform());
  return mesh.surface_point(t, {r * rng.uniform(), 1 - r});
}

/// Seconds of CPU time of one call.
double seconds_of(const std::function<std::size_t()>& shoot, std::size_t& result) {
  const double start = cpu_seconds();
  result = shoot();
  return cpu_seconds() - start;
}

void compare(const std::string& name, std::size_t rays, const std::function<std::size_t()>& ours,
             const std::vector<std::pair<std::string, std::function<std::size_t()>>>& bare) {
  std::vector<double> best(1 + bare.size(), 1e300);
  std::vector<std::size_t> hits(1 + bare.size());
  for (int round = 0; round < 40; ++round) {
    best[0] = std::min(best[0], seconds_of(ours, hits[0]));
    for (std::size_t i = 0; i < bare.size(); ++i)
      best[i + 1] = std::min(best[i + 1], seconds_of(bare[i].second, hits[i + 1]));
  }
  const auto millions = [&](double seconds) { return 1e-6 * static_cast<double>(rays) / seconds; };
  fmt::print("{:<24} ours {:6.2f} M rays/s ({} hits)", name, millions(best[0]), hits[0]);
  for (std::size_t i = 0; i < bare.size(); ++i) {
    fmt::print("; {} {:.2f}, ratio {:.2f}", bare[i].first, millions(best[i + 1]), best[i + 1] / best[0]);
    // The same work was done: hits differ at most by rays through edges and at a shadow ray's origin.
    const auto difference = std::max(hits[i + 1], hits[0]) - std::min(hits[i + 1], hits[0]);
    CHECK(difference < rays / 500);
  }
  fmt::print("\n");
}

}  // namespace

TEST_CASE("rays per second against bare Embree", "[.][bench][rays]") {
  const TriangleMesh mesh = make_blob(1, 0.1, 420);
  fmt::print("{} triangles\n", mesh.triangle_count());
  RayScene scene;
  scene.add(mesh);
  scene.commit();
  const BareScene fast(mesh, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  const BareScene plain(mesh, RTC_SCENE_FLAG_NONE);
  const BareScene robust(
      mesh, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));

  constexpr std::size_t count = 20000;
  Rng rng(1);
  std::vector<Ray> probes, shadows, camera;
  for (std::size_t i = 0; i < count; ++i) {
    const SurfacePoint p = random_point(mesh, rng);
    // A probe: a chord of 5 % of the radius through a point near the surface.
    Ray probe;
    probe.direction = 0.05 * uniform_direction(rng);
    probe.origin = p.position - probe.direction * rng.uniform();
    probe.t_max = 1;
    probes.push_back(probe);
    // A shadow ray to a far light, on the lit side.
    Ray shadow;
    shadow.origin = p.position;
    shadow.direction = uniform_direction(rng);
    if (glm::dot(shadow.direction, p.geometric_normal) < 0) shadow.direction = -shadow.direction;
    shadow.ignore_object = 0, shadow.ignore_triangle = p.triangle;
    shadow.t_min = 1e-5, shadow.t_max = 100;
    shadows.push_back(shadow);
    Ray eye;
    eye.origin = {0, 0, 4};
    eye.direction = glm::normalize(Vec3(1.2 * rng.uniform() - 0.6, 1.2 * rng.uniform() - 0.6, -2));
    camera.push_back(eye);
  }
  const auto bare_rays = [](const std::vector<Ray>& rays) {
    std::vector<RTCRay> out;
    for (const Ray& ray : rays) out.push_back(bare_ray(ray));
    return out;
  };
  const std::vector<RTCRay> bare_probes = bare_rays(probes), bare_shadows = bare_rays(shadows),
                            bare_camera = bare_rays(camera);
  std::vector<Hit> hits;
  compare("short all-hit probes", count,
          [&] {
            std::size_t sum = 0;
            for (const Ray& ray : probes) scene.all_hits(0, ray, hits), sum += hits.size();
            return sum;
          },
          {{"bare", [&] { return bare_all_hits(fast, bare_probes); }},
           {"bare robust", [&] { return bare_all_hits(robust, bare_probes); }}});
  compare("camera rays", count,
          [&] {
            std::size_t sum = 0;
            for (const Ray& ray : camera) sum += scene.nearest(ray).has_value();
            return sum;
          },
          {{"bare", [&] { return bare_nearest(plain, bare_camera); }},
           {"bare robust", [&] { return bare_nearest(robust, bare_camera); }}});
  compare("shadow rays", count,
          [&] {
            std::size_t sum = 0;
            for (const Ray& ray : shadows) sum += scene.occluded(ray);
            return sum;
          },
          {{"bare", [&] { return bare_occluded(plain, bare_shadows); }},
           {"bare robust", [&] { return bare_occluded(robust, bare_shadows); }}});
}

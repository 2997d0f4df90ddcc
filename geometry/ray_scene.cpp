#include "geometry/ray_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/triangle.h"

namespace alabaster {

namespace {

/// One device for the process; Embree counts its references.
RTCDevice shared_device() {
  struct Device {
#ifdef ALABASTER_EMBREE_ONE_THREAD
    RTCDevice handle = rtcNewDevice("threads=1,set_affinity=0");
#else
    RTCDevice handle = rtcNewDevice(nullptr);
#endif
    Device() {
      if (!handle) throw std::runtime_error("Embree: no device (is this an x86-64 CPU with SSE2?)");
    }
    ~Device() {
      rtcReleaseDevice(handle);
    }
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
  };
  static const Device device;
  return device.handle;
}

/// What a filter function needs to know of the query it is called in.
struct QueryContext {
  RTCIntersectContext embree;  // first: Embree hands back its address
  double random = 0;
  uint32_t ignore_object = no_index, ignore_triangle = no_index;
  std::vector<Hit>* hits = nullptr;
  bool touches_edge = false;

  QueryContext(const Ray& ray, double random_number) : random(random_number) {
    rtcInitIntersectContext(&embree);
    ignore_object = ray.ignore_object, ignore_triangle = ray.ignore_triangle;
  }
  bool ignores(RTCHitN* hit) const {
    return RTCHitN_primID(hit, 1, 0) == ignore_triangle && RTCHitN_geomID(hit, 1, 0) == ignore_object;
  }
};

const QueryContext& query_of(const RTCFilterFunctionNArguments* args) {
  return *reinterpret_cast<const QueryContext*>(args->context);
}

/// A ray that came this close to an edge (as a barycentric weight) may have hit the neighbour as well:
/// Embree's robust test counts the border in on both sides, with a tolerance of one float rounding.
constexpr float edge_tolerance = 1e-6f;

// Filter functions: N is 1, since all queries here are of single rays.

void reject_ignored(const RTCFilterFunctionNArguments* args) {
  assert(args->N == 1);
  if (query_of(args).ignores(args->hit)) args->valid[0] = 0;
}

void collect(const RTCFilterFunctionNArguments* args) {
  assert(args->N == 1);
  auto& query = *reinterpret_cast<QueryContext*>(args->context);
  args->valid[0] = 0;  // rejected, so that the traversal goes on
  if (query.ignores(args->hit)) return;
  const float u = RTCHitN_u(args->hit, 1, 0), v = RTCHitN_v(args->hit, 1, 0);
  query.touches_edge |= std::min({u, v, 1 - u - v}) <= edge_tolerance;
  query.hits->push_back({RTCRayN_tfar(args->ray, 1, 0), Vec2(u, v), RTCHitN_geomID(args->hit, 1, 0),
                         RTCHitN_primID(args->hit, 1, 0)});
}

void apply_hit_filter(const RTCFilterFunctionNArguments* args) {
  assert(args->N == 1);
  const auto& filter = *static_cast<const HitFilter*>(args->geometryUserPtr);
  const Vec2 barycentric(RTCHitN_u(args->hit, 1, 0), RTCHitN_v(args->hit, 1, 0));
  if (!filter(RTCHitN_primID(args->hit, 1, 0), barycentric, query_of(args).random)) args->valid[0] = 0;
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

class SceneHandle {
 public:
  SceneHandle() = default;
  explicit SceneHandle(RTCScene scene) : scene_(scene) {}
  SceneHandle(const SceneHandle& other) : scene_(other.scene_) {
    if (scene_) rtcRetainScene(scene_);
  }
  SceneHandle(SceneHandle&& other) noexcept : scene_(std::exchange(other.scene_, nullptr)) {}
  SceneHandle& operator=(SceneHandle other) noexcept {
    std::swap(scene_, other.scene_);
    return *this;
  }
  ~SceneHandle() {
    if (scene_) rtcReleaseScene(scene_);
  }
  operator RTCScene() const { return scene_; }

 private:
  RTCScene scene_ = nullptr;
};

/// A disk around a triangle, in Embree's space: a quick bound on how close the triangle can be.
struct TriangleDisk {
  Vec3f centre;
  float radius;
  Vec3f normal;

  TriangleDisk(const Vec3f& a, const Vec3f& b, const Vec3f& c) : centre((a + b + c) / 3.0f) {
    radius = std::sqrt(std::max({glm::dot(a - centre, a - centre), glm::dot(b - centre, b - centre),
                                 glm::dot(c - centre, c - centre)}));
    const Vec3f area = glm::cross(b - a, c - a);
    const float length = glm::length(area);
    // A needle's normal says nothing: without one the disk counts as a ball.
    normal = length > 1e-3f * radius * radius ? area / length : Vec3f(0);
  }
  /// Of the distance from p to the triangle, but for rounding.
  float lower_bound_squared(const Vec3f& p) const {
    const Vec3f v = p - centre;
    const float height = glm::dot(normal, v);
    const float aside = std::sqrt(std::max(0.0f, glm::dot(v, v) - height * height)) - radius;
    return height * height + (aside > 0 ? aside * aside : 0);
  }
};

/// What stays of a mesh: the arrays, not the object, so that whoever holds the mesh may move it.
struct ObjectData {
  const Vec3* positions = nullptr;
  const Index3* corners = nullptr;
  std::size_t position_count = 0, triangle_count = 0;
  std::vector<float> buffer;          // positions as Embree sees them
  std::unique_ptr<HitFilter> filter;  // its address is known to Embree
  SceneHandle scene;                  // this object alone
  mutable std::once_flag disks_made;  // by the first query for a closest point
  mutable std::vector<TriangleDisk> disks;

  void make_disks() const {
    const auto corner = [&](uint32_t i) {
      return Vec3f(buffer[3 * std::size_t{i}], buffer[3 * std::size_t{i} + 1],
                   buffer[3 * std::size_t{i} + 2]);
    };
    disks.reserve(triangle_count);
    for (std::size_t t = 0; t < triangle_count; ++t)
      disks.emplace_back(corner(corners[t][0]), corner(corners[t][1]), corner(corners[t][2]));
  }
  Triangle triangle(uint32_t t) const {
    return {positions[corners[t][0]], positions[corners[t][1]], positions[corners[t][2]]};
  }
};

}  // namespace

struct RayScene::Impl {
  // Embree computes in float. It sees space moved and scaled so that the scene is about the unit cube around
  // the origin: precision then depends neither on where the scene lies nor on its unit. The scale is a power
  // of two, exact; t is the same in both spaces.
  Vec3 centre{0};
  double scale = 1;
  std::deque<ObjectData> objects;
  SceneHandle scene;  // all objects; the one object's scene itself where there is but one

  Vec3 to_embree(const Vec3& p) const { return (p - centre) * scale; }
  RTCRay embree_ray(const Ray& ray) const;
  void choose_space();
  RTCGeometry make_geometry(ObjectData& object) const;
  void drop_repeated_hits(const Ray& ray, std::vector<Hit>& hits) const;
};

namespace {

SceneHandle new_scene() {
  const RTCScene scene = rtcNewScene(shared_device());
  // Robust: no ray slips through between two triangles, and no box is missed by rounding.
  rtcSetSceneFlags(
      scene, static_cast<RTCSceneFlags>(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
  return SceneHandle(scene);
}

}  // namespace

void RayScene::Impl::choose_space() {
  BoundingBox box;
  for (const ObjectData& object : objects)
    for (std::size_t i = 0; i < object.position_count; ++i)
      if (is_finite(object.positions[i])) box.extend(object.positions[i]);
  if (box.empty()) return;
  centre = box.low + 0.5 * (box.high - box.low);
  const Vec3 size = box.high - box.low;
  const double extent = std::max({size.x, size.y, size.z});
  if (extent > 0 && std::isfinite(extent)) scale = std::exp2(-std::ceil(std::log2(extent)));
}

RTCGeometry RayScene::Impl::make_geometry(ObjectData& object) const {
  object.buffer.resize(3 * object.position_count + 1);  // Embree reads 16 bytes at the last position
  for (std::size_t i = 0; i < object.position_count; ++i) {
    const Vec3f p(to_embree(object.positions[i]));
    for (int k = 0; k < 3; ++k) object.buffer[3 * i + static_cast<std::size_t>(k)] = p[k];
  }
  const RTCGeometry geometry = rtcNewGeometry(shared_device(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, object.buffer.data(), 0,
                             3 * sizeof(float), object.position_count);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, object.corners, 0,
                             sizeof(Index3), object.triangle_count);
  if (object.filter) {
    rtcSetGeometryUserData(geometry, object.filter.get());
    rtcSetGeometryIntersectFilterFunction(geometry, apply_hit_filter);
    rtcSetGeometryOccludedFilterFunction(geometry, apply_hit_filter);
  }
  rtcCommitGeometry(geometry);
  return geometry;
}

RTCRay RayScene::Impl::embree_ray(const Ray& ray) const {
  const Vec3 o = to_embree(ray.origin), d = ray.direction * scale;
  RTCRay r;
  r.org_x = static_cast<float>(o.x), r.org_y = static_cast<float>(o.y), r.org_z = static_cast<float>(o.z);
  r.dir_x = static_cast<float>(d.x), r.dir_y = static_cast<float>(d.y), r.dir_z = static_cast<float>(d.z);
  r.tnear = static_cast<float>(ray.t_min), r.tfar = static_cast<float>(ray.t_max);
  r.time = 0, r.mask = ~0u, r.id = 0, r.flags = 0;
  return r;
}

RayScene::RayScene() : impl_(std::make_unique<Impl>()) {}
RayScene::~RayScene() = default;
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

uint32_t RayScene::add(const TriangleMesh& mesh, HitFilter filter) {
  assert(!impl_->scene && "add after commit");
  ObjectData& object = impl_->objects.emplace_back();
  object.positions = mesh.positions.data(), object.position_count = mesh.positions.size();
  object.corners = mesh.corners.data(), object.triangle_count = mesh.corners.size();
  if (filter) object.filter = std::make_unique<HitFilter>(std::move(filter));
  return static_cast<uint32_t>(impl_->objects.size() - 1);
}

void RayScene::commit() {
  Impl& impl = *impl_;
  impl.choose_space();
  const bool single = impl.objects.size() == 1;
  SceneHandle all = new_scene();
  for (uint32_t id = 0; id < impl.objects.size(); ++id) {
    ObjectData& object = impl.objects[id];
    object.scene = single ? all : new_scene();
    if (object.triangle_count > 0) {
      const RTCGeometry geometry = impl.make_geometry(object);
      rtcAttachGeometryByID(all, geometry, id);
      if (!single) rtcAttachGeometryByID(object.scene, geometry, id);
      rtcReleaseGeometry(geometry);  // the scenes hold it
    }
    if (!single) rtcCommitScene(object.scene);
  }
  rtcCommitScene(all);
  if (rtcGetDeviceError(shared_device()) != RTC_ERROR_NONE)
    throw std::runtime_error("Embree could not build the scene; it needs about 200 bytes per triangle");
  impl.scene = std::move(all);
}

std::optional<Hit> RayScene::nearest(const Ray& ray, double random) const {
  QueryContext query(ray, random);
  if (ray.ignore_triangle != no_index) query.embree.filter = reject_ignored;
  RTCRayHit r;
  r.ray = impl_->embree_ray(ray);
  r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene, &query.embree, &r);
  if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return Hit{r.ray.tfar, Vec2(r.hit.u, r.hit.v), r.hit.geomID, r.hit.primID};
}

bool RayScene::occluded(const Ray& ray, double random) const {
  QueryContext query(ray, random);
  if (ray.ignore_triangle != no_index) query.embree.filter = reject_ignored;
  RTCRay r = impl_->embree_ray(ray);
  rtcOccluded1(impl_->scene, &query.embree, &r);
  return r.tfar == -std::numeric_limits<float>::infinity();
}

void RayScene::all_hits(uint32_t object, const Ray& ray, std::vector<Hit>& hits, double random) const {
  hits.clear();
  QueryContext query(ray, random);
  query.embree.filter = collect;
  query.hits = &hits;
  RTCRay r = impl_->embree_ray(ray);
  // The any-hit traversal: it need not sort what it visits.
  rtcOccluded1(impl_->objects[object].scene, &query.embree, &r);
  if (query.touches_edge && hits.size() > 1) impl_->drop_repeated_hits(ray, hits);
}

/// Two triangles that share an edge, both hit on it and facing the same way, are one crossing. Facing
/// opposite ways (a ray that grazes a crease) they are two: in and out again.
void RayScene::Impl::drop_repeated_hits(const Ray& ray, std::vector<Hit>& hits) const {
  const ObjectData& object = objects[hits[0].object];
  const auto on_edge = [](const Hit& h) {
    return std::min({h.barycentric.x, h.barycentric.y, 1 - h.barycentric.x - h.barycentric.y}) <=
           double{edge_tolerance};
  };
  const auto share_corner = [&](const Hit& a, const Hit& b) {
    const Index3 &p = object.corners[a.triangle], &q = object.corners[b.triangle];
    return std::any_of(p.begin(), p.end(), [&](uint32_t i) { return std::count(q.begin(), q.end(), i) > 0; });
  };
  const auto same_crossing = [&](const Hit& a, const Hit& b) {
    if (!on_edge(a) || !on_edge(b) || !share_corner(a, b)) return false;
    const Triangle ta = object.triangle(a.triangle), tb = object.triangle(b.triangle);
    const double size = std::max(ta.longest_edge_squared(), tb.longest_edge_squared());
    const double tolerance = 10 * double{edge_tolerance};
    if (length_squared(ta.point(a.barycentric) - tb.point(b.barycentric)) > tolerance * tolerance * size)
      return false;
    return glm::dot(ta.area_vector(), ray.direction) * glm::dot(tb.area_vector(), ray.direction) > 0;
  };
  // In order of triangles, so that which of them stays does not depend on the hierarchy.
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.triangle < b.triangle; });
  auto kept = hits.begin();
  for (auto hit = hits.begin(); hit != hits.end(); ++hit)
    if (std::none_of(hits.begin(), kept, [&](const Hit& other) { return same_crossing(other, *hit); }))
      *kept++ = *hit;
  hits.erase(kept, hits.end());
}

namespace {

struct ClosestQuery {
  const ObjectData& object;
  Vec3 point;
  double scale;
  double best_squared;  // m^2
  std::optional<ClosestPoint> best;
};

/// By how much, in Embree's unit cube, a box of float positions may miss the true triangle: half a float
/// rounding of the position in each axis, and that of the query point.
constexpr double embree_rounding = 2e-7;

/// Whether the triangle is the best so far.
bool consider(ClosestQuery& query, uint32_t number) {
  const Triangle triangle = query.object.triangle(number);
  const Vec2 barycentric = triangle.closest(query.point);
  const Vec3 position = triangle.point(barycentric);
  const double squared = length_squared(position - query.point);
  const bool tie = query.best && squared == query.best_squared && number < query.best->triangle;
  if (!tie && !(squared < query.best_squared || (!query.best && squared <= query.best_squared))) return false;
  query.best_squared = squared;
  query.best = ClosestPoint{position, barycentric, number, 0};
  return true;
}

bool visit_triangle(RTCPointQueryFunctionArguments* args) {
  auto& query = *static_cast<ClosestQuery*>(args->userPtr);
  // Most triangles of a leaf are farther than the best so far; the margin covers the disk's rounding.
  const float limit = args->query->radius * (1 + 4e-6f) + 1e-6f;
  const Vec3f local(args->query->x, args->query->y, args->query->z);
  if (query.object.disks[args->primID].lower_bound_squared(local) > limit * limit) return false;
  if (!consider(query, args->primID)) return false;
  // A little more than the distance: ties must be visited, so that the answer is the lowest triangle's.
  const auto radius =
      static_cast<float>(std::sqrt(query.best_squared) * query.scale * (1 + 1e-6) + 2 * embree_rounding);
  if (!(radius < args->query->radius)) return false;
  args->query->radius = radius;
  return true;
}

}  // namespace

std::optional<ClosestPoint> RayScene::closest_point(uint32_t object, const Vec3& p, double radius,
                                                    uint32_t guess) const {
  if (!is_finite(p) || !(radius >= 0)) return std::nullopt;
  const ObjectData& data = impl_->objects[object];
  std::call_once(data.disks_made, [&] { data.make_disks(); });
  ClosestQuery closest{data, p, impl_->scale, radius * radius, {}};
  if (guess != no_index && consider(closest, guess)) radius = std::sqrt(closest.best_squared);
  const Vec3 local = impl_->to_embree(p);
  RTCPointQuery query;
  query.x = static_cast<float>(local.x), query.y = static_cast<float>(local.y);
  query.z = static_cast<float>(local.z);
  query.time = 0;
  const double far = std::max({std::abs(local.x), std::abs(local.y), std::abs(local.z)});
  query.radius = static_cast<float>(radius * impl_->scale * (1 + 1e-6) + 2 * embree_rounding * (1 + far));
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(data.scene, &query, &context, visit_triangle, &closest);
  if (closest.best) closest.best->distance = std::sqrt(closest.best_squared);
  return closest.best;
}

}  // namespace alabaster

#include "scene/light_sampler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/frame.h"
#include "scene/scene.h"

namespace alabaster {

namespace {

bool faces(const Vec3& normal, const Vec3& towards) {
  return normal == Vec3(0) || glm::dot(normal, towards) > 0;
}

// KHR_lights_punctual: linear in the cosine between the cones, squared.
double spot_attenuation(const SpotLight& spot, const Vec3& to_light) {
  const double cosine = -glm::dot(spot.direction, to_light);
  const double inner = std::cos(spot.inner_cone), outer = std::cos(spot.outer_cone);
  const double t = std::clamp((cosine - outer) / std::max(inner - outer, 1e-9), 0.0, 1.0);
  return t * t;
}

std::optional<LightSample> delta_sample(const Light& light, const Vec3& point) {
  LightSample sample;
  sample.delta = true;
  sample.pdf = 1;
  if (const auto* directional = std::get_if<DirectionalLight>(&light)) {
    sample.direction = -directional->direction;
    sample.distance = std::numeric_limits<double>::infinity();
    sample.radiance = directional->irradiance;
    return sample;
  }
  const auto* spot = std::get_if<SpotLight>(&light);
  const auto* bulb = std::get_if<PointLight>(&light);
  if (spot == nullptr && bulb == nullptr) return std::nullopt;
  const Vec3 offset = (spot != nullptr ? spot->position : bulb->position) - point;
  sample.distance = glm::length(offset);
  if (!(sample.distance > 0)) return std::nullopt;
  sample.direction = offset / sample.distance;
  const Rgb intensity =
      spot != nullptr ? spot->intensity * spot_attenuation(*spot, sample.direction) : bulb->intensity;
  sample.radiance = intensity / (sample.distance * sample.distance);
  if (sample.radiance.is_black()) return std::nullopt;
  return sample;
}

double delta_weight(const Light& light, const Vec3& point, const Vec3& normal) {
  const auto sample = delta_sample(light, point);
  return sample && faces(normal, sample->direction) ? sample->radiance.mean() : 0;
}

/// A cone counts as soon as a part of it is above the horizon.
double cone_weight(const Light& light, const Vec3& point, const Vec3& normal, double half_cosine) {
  const auto sample = delta_sample(light, point);
  const double half_sine = std::sqrt(std::max(0.0, 1 - half_cosine * half_cosine));
  const bool above = sample && (normal == Vec3(0) || glm::dot(normal, sample->direction) > -half_sine);
  return above ? sample->radiance.mean() : 0;
}

double disk_weight(const DiskLight& disk, const Vec3& point, const Vec3& normal) {
  const Vec3 offset = point - disk.position;
  const double height = glm::dot(offset, disk.direction);
  if (height <= 0) return 0;
  if (normal != Vec3(0) && -glm::dot(normal, offset) <= -disk.radius) return 0;
  const double squared = length_squared(offset);
  const double area = pi * disk.radius * disk.radius;
  // Irradiance of a facing receiver, about; the floor keeps grazing points possible.
  const double cosine = std::max(height / std::sqrt(squared), 0.05);
  return disk.radiance.mean() * cosine * area / (squared + disk.radius * disk.radius);
}

/// Per solid angle, of points drawn uniformly from the disk.
double density_on_disk(const DiskLight& disk, const Vec3& direction, double distance) {
  const double cosine = -glm::dot(direction, disk.direction);
  return cosine > 0 ? distance * distance / (cosine * pi * disk.radius * disk.radius) : 0;
}

/// Mean square over squared mean of the radiance, over the sphere: 1 for a constant environment, large where
/// little of the sphere holds the light.
double contrast(const Environment& environment) {
  constexpr int side = 32;
  double sum = 0;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j) {
      const auto sample = environment.sample({(i + 0.5) / side, (j + 0.5) / side});
      if (sample && sample->pdf > 0) sum += std::pow(sample->radiance.mean(), 2) / sample->pdf;
    }
  return sum / (side * side) / (4 * pi) / std::pow(environment.mean_radiance().mean(), 2);
}
constexpr double concentrated_contrast = 10;

// Emission averaged over corners, edge midpoints and centre, and a part of the untextured value so that no
// triangle that could emit is left out.
double emission_estimate(const Material& material, const TriangleMesh& mesh, uint32_t triangle) {
  if (!material.emissive) return material.emission.mean();
  constexpr std::array<Vec2, 7> points{Vec2(0, 0),
                                       Vec2(1, 0),
                                       Vec2(0, 1),
                                       Vec2(0.5, 0),
                                       Vec2(0.5, 0.5),
                                       Vec2(0, 0.5),
                                       Vec2(1.0 / 3.0, 1.0 / 3.0)};
  double sum = 0;
  for (const Vec2& p : points) sum += emission(material, mesh, triangle, p).mean();
  return sum / points.size() + 0.05 * material.emission.mean();
}

}  // namespace

LightSampler::LightSampler(const Scene& scene, double angular_size, Lights lights)
    : scene_(scene),
      cone_cosine_(std::cos(0.5 * angular_size)),
      cone_projected_solid_angle_(pi * std::pow(std::sin(0.5 * angular_size), 2)) {
  if (scene.environment && lights == Lights::all) {
    environment_power_ = pi * scene.environment->mean_radiance().mean();
    if (environment_power_ > 0) {
      entries_.push_back({Kind::environment});
      environment_concentrated_ = contrast(*scene.environment) > concentrated_contrast;
    }
  }
  std::vector<double> powers;
  BoundingBox bounds;
  triangle_slot_.resize(scene.objects.size());
  for (std::size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (std::holds_alternative<PatchLight>(light)) {
      patches_.push_back(i);
    } else if (std::holds_alternative<DiskLight>(light)) {
      disks_.push_back(i);
      entries_.push_back({Kind::disk, i});
    } else if (const auto* emitter = std::get_if<TriangleLight>(&light)) {
      const TriangleMesh& mesh = scene.objects[emitter->object].mesh;
      const Material& material = scene.materials[mesh.materials[emitter->triangle]];
      const double power = pi * (material.double_sided ? 2 : 1) * mesh.area(emitter->triangle) *
                           emission_estimate(material, mesh, emitter->triangle);
      if (!(power > 0)) continue;
      auto& slots = triangle_slot_[emitter->object];
      slots.resize(mesh.triangle_count(), no_index);
      slots[emitter->triangle] = static_cast<uint32_t>(triangles_.size());
      triangles_.push_back(*emitter);
      powers.push_back(power);
      for (const uint32_t corner : mesh.corners[emitter->triangle]) bounds.extend(mesh.positions[corner]);
    } else if (angular_size > 0) {
      cones_.push_back(i);
      entries_.push_back({Kind::cone, i});
    } else {
      entries_.push_back({Kind::delta, i});
    }
  }
  if (triangles_.empty()) return;
  triangle_choice_ = DiscreteDistribution(powers);
  triangle_power_ = triangle_choice_.total();
  triangle_centre_ = bounds.centre();
  triangle_radius_ = 0.5 * bounds.diagonal();
  entries_.push_back({Kind::triangles});
}

double LightSampler::weight(const Entry& entry, const Vec3& point, const Vec3& normal) const {
  switch (entry.kind) {
    case Kind::environment:
      return environment_power_;
    case Kind::delta:
      return delta_weight(scene_.lights[entry.light], point, normal);
    case Kind::cone:
      return cone_weight(scene_.lights[entry.light], point, normal, cone_cosine_);
    case Kind::disk:
      return disk_weight(std::get<DiskLight>(scene_.lights[entry.light]), point, normal);
    case Kind::triangles: {
      const double squared =
          std::max(length_squared(point - triangle_centre_), triangle_radius_ * triangle_radius_);
      return triangle_power_ / (4 * pi * squared);
    }
  }
  return 0;
}

double LightSampler::total_weight(const Vec3& point, const Vec3& normal) const {
  double total = 0;
  for (const Entry& entry : entries_) total += weight(entry, point, normal);
  return total;
}

double LightSampler::choice_probability(Kind kind, std::size_t light, const Vec3& point,
                                        const Vec3& normal) const {
  if (entries_.size() == 1) {
    const Entry& only = entries_.front();
    return only.kind == kind && only.light == light && weight(only, point, normal) > 0 ? 1 : 0;
  }
  double total = 0, chosen = 0;
  for (const Entry& entry : entries_) {
    const double w = weight(entry, point, normal);
    total += w;
    if (entry.kind == kind && entry.light == light) chosen = w;
  }
  return total > 0 ? chosen / total : 0;
}

std::optional<LightSample> LightSampler::sample(const Vec3& point, const Vec3& normal, double u_choice,
                                                Vec2 u) const {
  if (entries_.empty()) return std::nullopt;
  const Entry* chosen = &entries_.front();
  double probability = 1;
  if (entries_.size() > 1) {
    const double total = total_weight(point, normal);
    if (!(total > 0)) return std::nullopt;
    double target = u_choice * total;
    chosen = nullptr;
    for (const Entry& entry : entries_) {
      const double w = weight(entry, point, normal);
      if (w <= 0) continue;
      chosen = &entry;
      probability = w / total;
      if (target < w) break;
      target -= w;
    }
  } else if (!(weight(*chosen, point, normal) > 0)) {
    return std::nullopt;
  }
  auto result = sample_entry(*chosen, point, u);
  if (!result) return std::nullopt;
  result->pdf *= probability;
  return result;
}

std::optional<LightSample> LightSampler::sample_entry(const Entry& entry, const Vec3& point, Vec2 u) const {
  switch (entry.kind) {
    case Kind::environment:
      return scene_.environment->sample(u);
    case Kind::delta:
      return delta_sample(scene_.lights[entry.light], point);
    case Kind::cone:
      return sample_cone(scene_.lights[entry.light], point, u);
    case Kind::disk:
      return sample_disk(std::get<DiskLight>(scene_.lights[entry.light]), point, u);
    case Kind::triangles:
      return sample_triangle(point, u);
  }
  return std::nullopt;
}

std::optional<LightSample> LightSampler::sample_cone(const Light& light, const Vec3& point, Vec2 u) const {
  auto sample = delta_sample(light, point);
  if (!sample) return std::nullopt;
  const double cosine = 1 - u.x * (1 - cone_cosine_), phi = 2 * pi * u.y;
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  sample->direction = Frame(sample->direction).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
  sample->radiance /= cone_projected_solid_angle_;
  sample->pdf = 1 / (2 * pi * (1 - cone_cosine_));
  sample->delta = false;
  return sample;
}

std::optional<DiskHit> LightSampler::cone(std::size_t i, const Ray& ray) const {
  const auto centre = delta_sample(scene_.lights[cones_[i]], ray.origin);
  if (!centre || centre->distance > ray.t_max || glm::dot(centre->direction, ray.direction) < cone_cosine_)
    return std::nullopt;
  return DiskHit{centre->distance, centre->radiance / cone_projected_solid_angle_, cones_[i]};
}

double LightSampler::pdf_cone(const Vec3& point, const Vec3& normal, const DiskHit& hit) const {
  return choice_probability(Kind::cone, hit.light, point, normal) / (2 * pi * (1 - cone_cosine_));
}

bool LightSampler::has_sizeless() const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [](const Entry& entry) { return entry.kind == Kind::delta; });
}

bool LightSampler::is_concentrated(const Entry& entry) const {
  return entry.kind == Kind::cone || entry.kind == Kind::disk ||
         (entry.kind == Kind::environment && environment_concentrated_);
}

bool LightSampler::has_concentrated() const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [this](const Entry& entry) { return is_concentrated(entry); });
}

std::optional<LightSample> LightSampler::sample_concentrated(const Vec3& point, const Vec3& normal,
                                                             double u_choice, Vec2 u) const {
  double total = 0;
  for (const Entry& entry : entries_)
    if (is_concentrated(entry)) total += weight(entry, point, normal);
  double target = u_choice * total;
  const Entry* chosen = nullptr;
  for (const Entry& entry : entries_) {
    const double w = is_concentrated(entry) ? weight(entry, point, normal) : 0;
    if (w <= 0) continue;
    chosen = &entry;
    if (target < w) break;
    target -= w;
  }
  if (chosen == nullptr) return std::nullopt;
  auto result = sample_entry(*chosen, point, u);
  if (result) result->pdf = pdf_concentrated(point, normal, result->direction);
  return result && result->pdf > 0 ? result : std::nullopt;
}

double LightSampler::pdf_concentrated(const Vec3& point, const Vec3& normal, const Vec3& direction) const {
  Ray ray;
  ray.origin = point;
  ray.direction = direction;
  double total = 0, sum = 0;
  std::size_t cone_number = 0;
  for (const Entry& entry : entries_) {
    if (!is_concentrated(entry)) continue;
    const double w = weight(entry, point, normal);
    total += w;
    if (entry.kind == Kind::environment) {
      sum += w * scene_.environment->pdf(direction);
    } else if (entry.kind == Kind::cone) {
      if (cone(cone_number++, ray)) sum += w / (2 * pi * (1 - cone_cosine_));
    } else if (const auto hit = disk_along(entry.light, ray)) {
      sum += w * density_on_disk(std::get<DiskLight>(scene_.lights[entry.light]), direction, hit->t);
    }
  }
  return total > 0 ? sum / total : 0;
}

Rgb LightSampler::radiance_along(const Vec3& point, const Vec3& direction) const {
  Ray ray;
  ray.origin = point;
  ray.direction = direction;
  Rgb sum = scene_.environment ? scene_.environment->radiance(direction) : Rgb();
  for (const std::size_t i : disks_)
    if (const auto hit = disk_along(i, ray)) sum += hit->radiance;
  for (std::size_t i = 0; i < cones_.size(); ++i)
    if (const auto hit = cone(i, ray)) sum += hit->radiance;
  return sum;
}

std::optional<LightSample> LightSampler::sample_disk(const DiskLight& disk, const Vec3& point, Vec2 u) const {
  const double r = disk.radius * std::sqrt(u.x), phi = 2 * pi * u.y;
  const Frame frame(disk.direction);
  const Vec3 on_disk = disk.position + frame.to_world({r * std::cos(phi), r * std::sin(phi), 0});
  const Vec3 offset = on_disk - point;
  const double squared = length_squared(offset);
  LightSample sample;
  sample.distance = std::sqrt(squared);
  if (!(sample.distance > 0)) return std::nullopt;
  sample.direction = offset / sample.distance;
  const double cosine = -glm::dot(sample.direction, disk.direction);
  if (cosine <= 0) return std::nullopt;
  sample.radiance = disk.radiance;
  sample.pdf = squared / (cosine * pi * disk.radius * disk.radius);
  return sample;
}

std::optional<LightSample> LightSampler::sample_triangle(const Vec3& point, Vec2 u) const {
  const auto choice = triangle_choice_.sample(u.x);
  const TriangleLight& light = triangles_[choice.index];
  const TriangleMesh& mesh = scene_.objects[light.object].mesh;
  const double root = std::sqrt(choice.remapped);
  const Vec2 barycentric{root * (1 - u.y), root * u.y};
  const Vec3 offset = mesh.position(light.triangle, barycentric) - point;
  const double squared = length_squared(offset);
  LightSample sample;
  sample.distance = std::sqrt(squared);
  if (!(sample.distance > 0)) return std::nullopt;
  sample.direction = offset / sample.distance;
  const Material& material = scene_.materials[mesh.materials[light.triangle]];
  const double cosine = -glm::dot(sample.direction, mesh.geometric_normal(light.triangle));
  if (cosine == 0 || (cosine < 0 && !material.double_sided)) return std::nullopt;
  sample.radiance = emission(material, mesh, light.triangle, barycentric) *
                    opacity(material, mesh, light.triangle, barycentric);
  sample.pdf =
      triangle_choice_.probability(choice.index) * squared / (std::abs(cosine) * mesh.area(light.triangle));
  return sample;
}

double LightSampler::pdf_environment(const Vec3& point, const Vec3& normal, const Vec3& direction) const {
  if (environment_power_ <= 0) return 0;
  return choice_probability(Kind::environment, 0, point, normal) * scene_.environment->pdf(direction);
}

double LightSampler::pdf_triangle(const Vec3& point, const Vec3& normal, const Vec3& direction,
                                  const Hit& hit) const {
  if (hit.object >= triangle_slot_.size() || triangle_slot_[hit.object].empty()) return 0;
  const uint32_t slot = triangle_slot_[hit.object][hit.triangle];
  if (slot == no_index) return 0;
  const TriangleMesh& mesh = scene_.objects[hit.object].mesh;
  const double cosine = -glm::dot(direction, mesh.geometric_normal(hit.triangle));
  if (cosine == 0 || (cosine < 0 && !scene_.material(hit).double_sided)) return 0;
  return choice_probability(Kind::triangles, 0, point, normal) * triangle_choice_.probability(slot) * hit.t *
         hit.t / (std::abs(cosine) * mesh.area(hit.triangle));
}

double LightSampler::pdf_disk(const Vec3& point, const Vec3& normal, const Vec3& direction,
                              const DiskHit& hit) const {
  return choice_probability(Kind::disk, hit.light, point, normal) *
         density_on_disk(std::get<DiskLight>(scene_.lights[hit.light]), direction, hit.t);
}

std::optional<DiskHit> LightSampler::disk_along(std::size_t i, const Ray& ray) const {
  const auto& disk = std::get<DiskLight>(scene_.lights[i]);
  const double approach = -glm::dot(ray.direction, disk.direction);
  if (approach <= 0) return std::nullopt;
  const double t = glm::dot(ray.origin - disk.position, disk.direction) / approach;
  if (t <= ray.t_min || t >= ray.t_max) return std::nullopt;
  if (length_squared(ray.origin + t * ray.direction - disk.position) > disk.radius * disk.radius)
    return std::nullopt;
  return DiskHit{t, disk.radiance, i};
}

std::optional<DiskHit> LightSampler::nearest_disk(const Ray& ray) const {
  std::optional<DiskHit> nearest;
  for (const std::size_t i : disks_) {
    const auto hit = disk_along(i, ray);
    if (hit && (!nearest || hit->t < nearest->t)) nearest = hit;
  }
  return nearest;
}

Rgb LightSampler::emitted(const Hit& hit, const Vec3& direction) const {
  const Material& material = scene_.material(hit);
  if (material.emission.is_black()) return Rgb(0);
  const TriangleMesh& mesh = scene_.objects[hit.object].mesh;
  if (!material.double_sided && glm::dot(direction, mesh.geometric_normal(hit.triangle)) >= 0) return Rgb(0);
  return emission(material, mesh, hit.triangle, hit.barycentric);
}

Rgb LightSampler::uniform_radiance(const Vec3& point) const {
  Rgb sum;
  for (const std::size_t i : patches_) {
    const auto& patch = std::get<PatchLight>(scene_.lights[i]);
    if (length_squared(point - patch.position) <= patch.radius * patch.radius) sum += patch.radiance;
  }
  return sum;
}

}  // namespace alabaster

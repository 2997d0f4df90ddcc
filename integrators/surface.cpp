#include "integrators/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "core/error.h"
#include "core/frame.h"
#include "integrators/bssrdf_transport.h"
#include "integrators/volume_checks.h"
#include "integrators/volume_transport.h"
#include "optics/fresnel.h"
#include "optics/photon_walk.h"

namespace alabaster {

namespace {

constexpr double default_angular_size = pi / 180;
// Chains of mirrors and internal reflections end here at the latest.
constexpr int max_specular_chain = 64;
// Directions of which one is followed where light's aim has a say. docs/probe_sampling.md has the figures.
constexpr int aimed_looks = 3;
// So many lamps may guide entries. From nearer than this part of the scene none is expected to shine
// brighter.
constexpr std::size_t most_expected_lamps = 8;
constexpr double least_lamp_size = 0.01;
// Radiance that may come from where the environment is dark, in units of its mean.
constexpr double unseen_share = 0.1;

/// The environment as a few directions, drawn by its own importance.
void add_environment(const Environment& environment, std::vector<ExpectedLight::Distant>& lights) {
  constexpr int side = 24;
  for (int k = 0; k < side * side; ++k)
    if (const auto light = environment.sample(Vec2(k / side + 0.5, k % side + 0.5) / double{side}))
      lights.push_back({light->direction, light->radiance.mean() / light->pdf / (side * side)});
}

/// A light that shines from one place; nothing for others.
std::optional<ExpectedLight::Lamp> expected_lamp(const Light& light, double least_size) {
  if (const auto* point = std::get_if<PointLight>(&light))
    return ExpectedLight::Lamp{point->position, point->intensity.mean(), Vec3(0), -1, 0, least_size};
  if (const auto* spot = std::get_if<SpotLight>(&light)) {
    const double none = std::cos(spot->outer_cone);
    return ExpectedLight::Lamp{spot->position,
                               spot->intensity.mean(),
                               glm::normalize(spot->direction),
                               none,
                               std::max(std::cos(spot->inner_cone), none + 1e-6),
                               least_size};
  }
  if (const auto* disk = std::get_if<DiskLight>(&light)) {
    const double area = pi * disk->radius * disk->radius;
    return ExpectedLight::Lamp{disk->position,
                               disk->radiance.mean() * area,
                               glm::normalize(disk->direction),
                               0,
                               1,
                               std::max(disk->radius, least_size)};
  }
  return std::nullopt;
}

/// What shines on a surface; nothing where that takes more than a few directions and places to tell.
std::optional<ExpectedLight> expected_light(const Scene& scene) {
  std::vector<ExpectedLight::Distant> lights;
  std::vector<ExpectedLight::Lamp> lamps;
  if (scene.environment) add_environment(*scene.environment, lights);
  for (const Light& light : scene.lights) {
    if (const auto* sun = std::get_if<DirectionalLight>(&light))
      lights.push_back({-glm::normalize(sun->direction), sun->irradiance.mean()});
    else if (const auto lamp = expected_lamp(light, least_lamp_size * scene.bounds.diagonal()))
      lamps.push_back(*lamp);
    else
      return std::nullopt;
  }
  if ((!scene.environment && scene.lights.empty()) || lamps.size() > most_expected_lamps) return std::nullopt;
  return ExpectedLight(lights, lamps);
}

double power_heuristic(double pdf, double other) {
  return pdf * pdf / (pdf * pdf + other * other);
}

/// Of lights without size: walks have to meet them.
double angular_size(const SurfaceOptions& options) {
  return options.angular_size.value_or(options.transport == Transport::bssrdf ? 0 : default_angular_size);
}

}  // namespace

struct SurfaceIntegrator::Interface {
  double eta = 1.5;
  double diffuse_transmittance = 1;  // c of docs/theory.md
  double transmission(double cosine) const {
    return 1 - fresnel_dielectric(std::clamp(cosine, 0.0, 1.0), eta);
  }
};

struct SurfaceIntegrator::Body {
  Medium medium;
  Rgb sigma_t;
  double sigma_min = 0;
  uint32_t object = 0;
  /// Share of sigma_t by the closest surface point; null: 1. BSSRDFs know nothing of it.
  const AlbedoField* density = nullptr;
  std::unique_ptr<SubsurfaceTransport> transport;
};

struct SurfaceIntegrator::Path {
  const Sampler& sampler;
  uint32_t vertices = 0;  // begun so far: tells their random numbers apart
};

struct SurfaceIntegrator::Arrival {
  /// Density per solid angle with which the direction was drawn; 0 where light sampling had no chance, so
  /// that lights the ray finds count in full.
  double pdf = 0;
  const LightSampler* rival = nullptr;  // the light sampler that had the chance
  Vec3 origin{0}, normal{0};            // as given to it
  int bounces = 0;                      // diffuse ones so far
  int chain = 0;                        // mirror and refraction events so far
  double throughput = 1;                // an estimate of the path's weight, for Russian roulette
  bool camera = false;

  Arrival specular(double factor) const {
    Arrival next = *this;
    next.pdf = 0;
    next.camera = false;
    ++next.chain;
    next.throughput *= factor;
    return next;
  }
  Arrival scattered(double direction_pdf, const LightSampler& lights, const SurfacePoint& from,
                    double factor) const {
    Arrival next = specular(factor);
    next.pdf = direction_pdf;
    next.rival = &lights;
    next.origin = from.position;
    next.normal = from.geometric_normal;
    return next;
  }
  double weight_against(double light_pdf) const { return pdf > 0 ? power_heuristic(pdf, light_pdf) : 1; }
};

struct SurfaceIntegrator::Look {
  Vec3 direction{0};
  double pdf = 0;     // per solid angle, of a single draw
  double factor = 0;  // times the radiance from there: an estimate of the integral of T(cos) L cos
};

SurfaceIntegrator::SurfaceIntegrator(const Scene& scene, const SurfaceOptions& options)
    : scene_(scene),
      options_(options),
      camera_(options.camera, options.width, options.height),
      lights_(scene, angular_size(options)),
      near_lights_(scene, angular_size(options), LightSampler::Lights::but_environment),
      guide_(scene, lights_) {
  const double reach = std::max(glm::length(scene.bounds.low), glm::length(scene.bounds.high));
  offset_ = 0x1p-20 * reach;  // a few units in the last place of Embree's floats
  for (const Material& material : scene.materials) {
    stochastic_opacity_ |= material.alpha_mode == AlphaMode::blend;
    const double eta = material.medium ? material.medium->eta : material.ior;
    interfaces_.push_back({eta, diffuse_transmittance(eta)});
  }
  if (options.transport != Transport::bssrdf) check_media_apart(scene);
  expected_light_ = expected_light(scene);
  if (scene.environment)
    if (const double mean = scene.environment->mean_radiance().mean(); mean > 0)
      unseen_radiance_ = unseen_share * mean;
  prepare_bodies();
}

SurfaceIntegrator::~SurfaceIntegrator() = default;

void SurfaceIntegrator::prepare_bodies() {
  body_of_.resize(scene_.objects.size());
  for (uint32_t o = 0; o < scene_.objects.size(); ++o) {
    const SceneObject& object = scene_.objects[o];
    body_of_[o].assign(scene_.materials.size(), nullptr);
    std::vector<uint8_t> used(scene_.materials.size(), 0);
    for (const uint16_t material : object.mesh.materials) used[material] = 1;
    for (std::size_t m = 0; m < used.size(); ++m) {
      if (!used[m] || !scene_.materials[m].medium || body_of_[o][m] != nullptr) continue;
      auto body = std::make_unique<Body>();
      body->medium = *scene_.materials[m].medium;
      body->sigma_t = body->medium.sigma_t();
      body->sigma_min = body->sigma_t.min();
      body->object = o;
      if (options_.transport != Transport::bssrdf) body->density = object.density.get();
      std::vector<uint8_t> boundary(used.size(), 0);
      for (std::size_t other = m; other < used.size(); ++other)
        if (used[other] && scene_.materials[other].medium == body->medium) {
          boundary[other] = 1;
          body_of_[o][other] = body.get();
        }
      body->transport = make_transport(o, body->medium, std::move(boundary));
      bodies_.push_back(std::move(body));
    }
  }
}

std::unique_ptr<SubsurfaceTransport> SurfaceIntegrator::make_transport(uint32_t object, const Medium& medium,
                                                                       std::vector<uint8_t> boundary) const {
  if (options_.transport == Transport::bssrdf) {
    // Images on the half-space basis are a baseline: the guide that they were made with stays.
    const bool guided = expected_light_ && (options_.basis == Basis::shape || scene_.lights.empty());
    return std::make_unique<BssrdfTransport>(scene_, object, medium, std::move(boundary), options_.model,
                                             options_.basis, options_.placement, options_.distance,
                                             guided ? &*expected_light_ : nullptr);
  }
  if (lights_.has_sizeless())
    throw InputError(scene_.name,
                     "light without size: no walk through a smooth boundary can meet it; give it one with "
                     "--angular-size, or use --integrator surface");
  VolumeWalkOptions walk = options_.walk;
  walk.albedo = options_.transport == Transport::walk ? WalkAlbedo::exit : WalkAlbedo::closest_point;
  return std::make_unique<VolumeTransport>(scene_, object, medium, std::move(boundary), walk,
                                           lights_.has_concentrated() ? &guide_ : nullptr);
}

std::vector<std::string> SurfaceIntegrator::report() const {
  std::vector<std::string> lines;
  for (const auto& body : bodies_)
    if (std::string line = body->transport->report(); !line.empty()) lines.push_back(std::move(line));
  return lines;
}

const SurfaceIntegrator::Body* SurfaceIntegrator::body(const Interaction& it) const {
  return body_of_[it.point.object][it.material_index];
}

PixelSample SurfaceIntegrator::sample(int x, int y, const Sampler& sampler) const {
  Path path{sampler};
  const Vec2 pixel = Vec2(x, y) + sampler.get_2d(Dimension::pixel);
  const Ray ray = camera_.ray(pixel);
  Arrival arrival;
  arrival.camera = true;
  PixelSample result;
  const uint32_t vertex = path.vertices++;
  const auto hit = scene_.rays.nearest(ray, opacity_number(path, vertex));
  const bool direct = shows(Layer::unscattered, arrival);
  if (direct) result.radiance = disks(ray, hit ? hit->t : ray.t_max, arrival);
  if (!hit) {
    if (direct) result.radiance += environment(ray, arrival);
    result.alpha = options_.environment_visible && scene_.environment ? 1
                   : result.radiance.is_black()                       ? 0
                                                                      : 1;
    return result;
  }
  const Interaction it = make_interaction(scene_, ray, *hit);
  if (direct) result.radiance += emission(ray, *hit, arrival);
  result.radiance += outgoing(it, arrival, path);
  result.alpha = 1;
  result.hit = true;
  result.albedo = it.base_colour;
  result.normal = it.point.shading_normal;
  result.depth = hit->t * glm::dot(ray.direction, options_.camera.direction);
  return result;
}

Rgb SurfaceIntegrator::incoming(const Ray& ray, const Arrival& arrival, Path& path) const {
  const uint32_t vertex = path.vertices++;
  const auto hit = scene_.rays.nearest(ray, opacity_number(path, vertex));
  Rgb sum;
  sum += disks(ray, hit ? hit->t : ray.t_max, arrival);
  if (!hit) return sum + environment(ray, arrival);
  sum += emission(ray, *hit, arrival);
  if (arrival.bounces > options_.depth || arrival.chain > max_specular_chain) return sum;
  const double survival = std::min(1.0, arrival.throughput);
  if (survival < 1 && path.sampler.get_1d(Dimension::roulette, vertex) >= survival) return sum;
  Arrival survivor = arrival;
  survivor.throughput = std::max(1.0, arrival.throughput);
  return sum + outgoing(make_interaction(scene_, ray, *hit), survivor, path) / survival;
}

bool SurfaceIntegrator::shows(Layer layer, const Arrival& arrival) const {
  const bool first = arrival.bounces == 0 && arrival.chain == 0;
  return !first || options_.layer == Layer::all || options_.layer == layer;
}

Rgb SurfaceIntegrator::environment(const Ray& ray, const Arrival& arrival) const {
  if (!scene_.environment || (arrival.camera && !options_.environment_visible)) return Rgb();
  const Rgb radiance = scene_.environment->radiance(ray.direction);
  if (arrival.pdf == 0) return radiance;
  return radiance * arrival.weight_against(
                        arrival.rival->pdf_environment(arrival.origin, arrival.normal, ray.direction));
}

Rgb SurfaceIntegrator::disks(const Ray& ray, double t_max, const Arrival& arrival) const {
  Ray until = ray;
  until.t_max = t_max;
  Rgb sum;
  if (const auto hit = lights_.nearest_disk(until)) {
    const double pdf =
        arrival.pdf == 0 ? 0 : arrival.rival->pdf_disk(arrival.origin, arrival.normal, ray.direction, *hit);
    sum += hit->radiance * arrival.weight_against(pdf);
  }
  // The camera does not see what stands for a light without size.
  for (std::size_t i = 0; i < lights_.cone_count() && !arrival.camera; ++i)
    if (const auto hit = lights_.cone(i, until)) {
      const double pdf = arrival.pdf == 0 ? 0 : arrival.rival->pdf_cone(arrival.origin, arrival.normal, *hit);
      sum += hit->radiance * arrival.weight_against(pdf);
    }
  return sum;
}

Rgb SurfaceIntegrator::emission(const Ray& ray, const Hit& hit, const Arrival& arrival) const {
  if (scene_.material(hit).emission.is_black()) return Rgb();
  const Rgb radiance = lights_.emitted(hit, ray.direction);
  if (arrival.pdf == 0 || radiance.is_black()) return radiance;
  return radiance * arrival.weight_against(
                        arrival.rival->pdf_triangle(arrival.origin, arrival.normal, ray.direction, hit));
}

Rgb SurfaceIntegrator::fresnel(const Interaction& it, double cosine) const {
  const double dielectric = 1 - interfaces_[it.material_index].transmission(cosine);
  if (it.metallic == 0) return Rgb(dielectric);
  // glTF 2.0, appendix B: Schlick's form, base colour at normal incidence.
  const double grazing = std::pow(1 - std::clamp(cosine, 0.0, 1.0), 5.0);
  const Rgb metal = it.base_colour + (Rgb(1) - it.base_colour) * grazing;
  return (1 - it.metallic) * Rgb(dielectric) + it.metallic * metal;
}

Rgb SurfaceIntegrator::outgoing(const Interaction& it, const Arrival& arrival, Path& path) const {
  if (!options_.specular) return from_body(it, arrival, path);
  const Rgb mirror = fresnel(it, it.cos_viewer);
  const double strength = mirror.max();
  // What the camera sees directly gets both parts; later one of them, so that paths do not multiply.
  if (arrival.bounces == 0 && arrival.chain == 0) {
    // The body comes first, whatever the mirror ray meets: its random numbers stay stratified over samples.
    const uint32_t vertex = path.vertices;
    const Rgb body = from_body(it, arrival, path);
    if (!shows(Layer::mirror, arrival)) return body;
    // A blurred and faint mirror image is not worth two rays every time.
    const double q = it.roughness.is_smooth() ? 1 : std::clamp(3 * strength, 0.15, 1.0);
    if (q < 1 && path.sampler.get_1d(Dimension::lobe, vertex) >= q) return body;
    Path apart{path.sampler, 0x8000u};
    return body + mirrored(it, arrival, apart) / q;
  }
  const double through = (1 - strength) * std::max(0.05, it.base_colour.max());
  const double p = strength / std::max(1e-9, strength + through);
  if (path.sampler.get_1d(Dimension::lobe, path.vertices) < p) return mirrored(it, arrival, path) / p;
  return from_body(it, arrival, path) / (1 - p);
}

// ---- The interface ----

Rgb SurfaceIntegrator::mirrored(const Interaction& it, const Arrival& arrival, Path& path) const {
  if (!it.roughness.is_smooth()) return mirrored_rough(it, arrival, path);
  const Rgb factor = fresnel(it, it.cos_viewer);
  if (factor.is_black()) return Rgb();
  const Vec3 direction = mirror_direction(it.towards_viewer, it.mirror_normal, it.point.geometric_normal);
  const Rgb arriving = incoming(leaving(it.point, direction), arrival.specular(factor.max()), path) +
                       lights_.uniform_radiance(it.point.position);
  return factor * arriving;
}

Rgb SurfaceIntegrator::mirrored_rough(const Interaction& it, const Arrival& arrival, Path& path) const {
  const uint32_t vertex = path.vertices++;
  const Frame frame(it.mirror_normal);
  const Vec3 wo = frame.to_local(it.towards_viewer);
  const Ggx& ggx = it.roughness;
  Rgb sum;

  const auto light = lights_.sample(it.point.position, it.point.geometric_normal,
                                    path.sampler.get_1d(Dimension::light_choice, vertex),
                                    path.sampler.get_2d(Dimension::light_point, vertex));
  if (light) {
    const Vec3 wi = frame.to_local(light->direction);
    if (wi.z > 0 && glm::dot(light->direction, it.point.geometric_normal) > 0 &&
        lit(it.point, *light, opacity_number(path, vertex))) {
      const Vec3 h = glm::normalize(wo + wi);
      const Rgb value =
          fresnel(it, glm::dot(wo, h)) * (ggx.distribution(h) * ggx.masking_shadowing(wo, wi) / (4 * wo.z));
      const double weight = light->delta ? 1 : power_heuristic(light->pdf, ggx.pdf_reflection(wo, wi));
      sum += value * light->radiance * (weight / light->pdf);
    }
  }

  const Vec3 h = ggx.sample_visible_normal(wo, path.sampler.get_2d(Dimension::reflection, vertex));
  const Vec3 wi = 2 * glm::dot(wo, h) * h - wo;
  const Vec3 direction = frame.to_world(wi);
  if (wi.z <= 0 || glm::dot(direction, it.point.geometric_normal) <= 0) return sum;
  const Rgb factor = fresnel(it, glm::dot(wo, h)) * (ggx.masking_shadowing(wo, wi) / ggx.masking(wo));
  const Arrival next = arrival.scattered(ggx.pdf_reflection(wo, wi), lights_, it.point, factor.max());
  return sum + factor * (incoming(leaving(it.point, direction), next, path) +
                         lights_.uniform_radiance(it.point.position));
}

// ---- The body ----

Rgb SurfaceIntegrator::from_body(const Interaction& it, const Arrival& arrival, Path& path) const {
  const Interface& interface = interfaces_[it.material_index];
  const double transmission = (1 - it.metallic) * interface.transmission(it.cos_viewer);
  if (transmission <= 0) return Rgb();
  const uint32_t vertex = path.vertices;
  const Body* below = body(it);
  if (below == nullptr && it.material->transmission > 0) {
    if (path.sampler.get_1d(Dimension::specular_path, vertex) < it.material->transmission)
      return options_.specular && shows(Layer::unscattered, arrival)
                 ? transmission * straight_through(it, arrival, path)
                 : Rgb();
  } else if (below != nullptr) {
    const bool scatter_below =
        it.subsurface >= 1 || path.sampler.get_1d(Dimension::specular_path, vertex) < it.subsurface;
    if (scatter_below) {
      Rgb sum;
      if (shows(Layer::scattered, arrival)) sum += subsurface(it, *below, arrival, path);
      if (options_.specular && shows(Layer::unscattered, arrival))
        sum += unscattered(it, *below, arrival, path);
      return transmission * sum;
    }
  }
  if (!shows(Layer::scattered, arrival)) return Rgb();
  const Rgb reflectance = it.base_colour;
  const double lobe = 1 / (pi * interface.diffuse_transmittance);
  return transmission * lobe * reflectance *
         entering(it.point, it.mirror_normal, interface, transmission * reflectance.max(), arrival, path);
}

Rgb SurfaceIntegrator::straight_through(const Interaction& it, const Arrival& arrival, Path& path) const {
  SurfacePoint behind = it.point;
  behind.geometric_normal = -behind.geometric_normal;
  const Ray ray = leaving(behind, -it.towards_viewer);
  return it.base_colour * incoming(ray, arrival.specular(it.base_colour.max()), path);
}

Rgb SurfaceIntegrator::subsurface(const Interaction& it, const Body& body, const Arrival& arrival,
                                  Path& path) const {
  const auto entry = body.transport->sample(it.point, it.towards_viewer, path.sampler, path.vertices++);
  if (!entry || entry->weight.is_black()) return Rgb();
  if (entry->direction) return entry->weight * entering_along(*entry, arrival, path);
  SurfacePoint point = entry->point;
  if (!it.front) {  // the back of an open sheet: light enters on the side it is seen from
    point.geometric_normal = -point.geometric_normal;
    point.shading_normal = -point.shading_normal;
  }
  const TriangleMesh& mesh = scene_.objects[it.point.object].mesh;
  const uint16_t material = mesh.materials[point.triangle];
  const Vec3 mirror_normal = mapped_normal(scene_.materials[material], mesh, point, it.front);
  return entry->weight * entering(point, mirror_normal, interfaces_[material], pi * entry->weight.max(),
                                  arrival, path, entry->aim.value_or(LightAim()));
}

// What a walk meets where it left: lights in full, since no light sampling can reach through the boundary.
Rgb SurfaceIntegrator::entering_along(const SubsurfaceEntry& entry, const Arrival& arrival,
                                      Path& path) const {
  // Weights of walks may be negative.
  Arrival next = arrival.specular(std::max(entry.weight.max(), -entry.weight.min()));
  ++next.bounces;
  next.chain = 0;
  return incoming(leaving(entry.point, *entry.direction), next, path) +
         lights_.uniform_radiance(entry.point.position);
}

// Environment and other surfaces are met by one ray, drawn for both; other lights are sampled by themselves.
Rgb SurfaceIntegrator::entering(const SurfacePoint& point, const Vec3& mirror_normal,
                                const Interface& interface, double weight, const Arrival& arrival, Path& path,
                                const LightAim& aim) const {
  const uint32_t vertex = path.vertices++;
  Rgb sum = pi * interface.diffuse_transmittance * lights_.uniform_radiance(point.position) * aim.mean();
  if (near_lights_.has_lights())
    sum += entering_from_light(point, mirror_normal, interface, vertex, path, aim);
  const bool aimed = scene_.environment && !aim.is_even();
  const Look seen = aimed ? look_aimed(point, mirror_normal, interface, aim, vertex, path)
                          : look(point, mirror_normal, interface,
                                 path.sampler.get_2d(Dimension::diffuse_direction, vertex));
  const Rgb value = aim.at(seen.direction);
  if (seen.factor <= 0 || value.is_black()) return sum;
  Arrival next =
      arrival.scattered(seen.pdf, near_lights_, point, weight * inv_pi * seen.factor * value.max());
  ++next.bounces;
  next.chain = 0;
  return sum + seen.factor * value * incoming(leaving(point, seen.direction), next, path);
}

SurfaceIntegrator::Look SurfaceIntegrator::look(const SurfacePoint& point, const Vec3& mirror_normal,
                                                const Interface& interface, Vec2 u) const {
  const Vec3& normal = point.shading_normal;
  HemisphereSample chosen;
  if (scene_.environment) {
    chosen = scene_.environment->sample_hemisphere(normal, u);
  } else {
    chosen.direction = cosine_direction(normal, u);
    chosen.pdf = glm::dot(normal, chosen.direction) * inv_pi;
  }
  const double cosine = glm::dot(normal, chosen.direction);
  if (!(chosen.pdf > 0) || cosine <= 0 || glm::dot(chosen.direction, point.geometric_normal) <= 0) return {};
  const double transmission = interface.transmission(glm::dot(mirror_normal, chosen.direction));
  return {chosen.direction, chosen.pdf, transmission * cosine / chosen.pdf};
}

// Resampling (Talbot et al. 2005): whatever is promised, it is unbiased, since nothing that may send light is
// promised none. The directions are strata of each other.
SurfaceIntegrator::Look SurfaceIntegrator::look_aimed(const SurfacePoint& point, const Vec3& mirror_normal,
                                                      const Interface& interface, const LightAim& aim,
                                                      uint32_t vertex, const Path& path) const {
  const Vec2 u = path.sampler.get_2d(Dimension::diffuse_direction, vertex);
  std::array<Look, aimed_looks> looks;
  std::array<double, aimed_looks> promises{};
  double sum = 0;
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const Vec2 turned = u + static_cast<double>(k) / aimed_looks;
    looks[k] = look(point, mirror_normal, interface, turned - glm::floor(turned));
    if (looks[k].factor <= 0) continue;
    const double radiance = scene_.environment->radiance(looks[k].direction).mean() + unseen_radiance_;
    promises[k] = looks[k].factor * aim.at(looks[k].direction).mean() * radiance;
    sum += promises[k];
  }
  if (!(sum > 0)) return {};
  double left = path.sampler.get_1d(Dimension::light_lobe, vertex) * sum;
  std::size_t k = 0;
  while (k + 1 < looks.size() && left >= promises[k]) left -= promises[k++];
  if (!(promises[k] > 0)) return {};
  looks[k].factor *= sum / (aimed_looks * promises[k]);
  return looks[k];
}

Rgb SurfaceIntegrator::entering_from_light(const SurfacePoint& point, const Vec3& mirror_normal,
                                           const Interface& interface, uint32_t vertex, const Path& path,
                                           const LightAim& aim) const {
  const auto light = near_lights_.sample(point.position, point.geometric_normal,
                                         path.sampler.get_1d(Dimension::light_choice, vertex),
                                         path.sampler.get_2d(Dimension::light_point, vertex));
  if (!light) return Rgb();
  const double cosine = glm::dot(point.shading_normal, light->direction);
  if (cosine <= 0 || glm::dot(point.geometric_normal, light->direction) <= 0) return Rgb();
  const double transmission = interface.transmission(glm::dot(mirror_normal, light->direction));
  if (transmission <= 0 || !lit(point, *light, opacity_number(path, vertex))) return Rgb();
  const double other = light->delta ? 0 : entering_pdf(point.shading_normal, light->direction);
  return aim.at(light->direction) * light->radiance *
         (transmission * cosine * power_heuristic(light->pdf, other) / light->pdf);
}

double SurfaceIntegrator::entering_pdf(const Vec3& normal, const Vec3& direction) const {
  if (scene_.environment) return scene_.environment->pdf_hemisphere(normal, direction);
  return std::max(0.0, glm::dot(normal, direction)) * inv_pi;
}

// Light that crosses the medium without scattering, as a path of refractions and internal reflections. A
// flight length is drawn for the clearest channel: a ray that finds no surface within it is done with, at the
// cost of a short ray, and the others need no weight in that channel.
Rgb SurfaceIntegrator::unscattered(const Interaction& it, const Body& body, const Arrival& arrival,
                                   Path& path) const {
  const Vec3 out = it.towards_viewer, n = it.point.shading_normal;
  const double eta = body.medium.eta;
  const Vec3 tangential = (glm::dot(out, n) * n - out) / eta;
  Vec3 direction = tangential - std::sqrt(std::max(0.0, 1 - length_squared(tangential))) * n;
  SurfacePoint from = it.point;
  Rgb throughput(1);
  for (int bounce = 0; bounce < max_specular_chain; ++bounce) {
    from.geometric_normal = -from.geometric_normal;
    if (glm::dot(direction, from.geometric_normal) <= 0) return Rgb();
    const uint32_t vertex = path.vertices++ | 0x10000u;
    const Vec2 u = path.sampler.get_2d(Dimension::specular_path, vertex);
    Ray ray = leaving(from, direction);
    if (body.density == nullptr) ray.t_max = -std::log1p(-u.x) / body.sigma_min;
    const auto hit = scene_.rays.nearest(ray, 0.5);
    if (!hit) return Rgb();
    if (body.density != nullptr)
      throughput *=
          unscattered_share(body, ray, hit->t, path.sampler.stream(Dimension::specular_path, vertex));
    for (int c = 0; c < 3 && body.density == nullptr; ++c)
      throughput[c] *= std::exp(-(body.sigma_t[c] - body.sigma_min) * hit->t);
    const Interaction inside = make_interaction(scene_, ray, *hit);
    const Arrival next = arrival.specular(throughput.max());
    if (inside.front || this->body(inside) != &body)  // something within the medium
      return throughput * (emission(ray, *hit, next) + outgoing(inside, next, path));
    const Vec3 normal = inside.point.shading_normal;
    const double cosine = glm::dot(inside.towards_viewer, normal);
    from = inside.point;
    if (u.y < fresnel_dielectric(std::min(1.0, cosine), 1 / eta)) {
      direction = mirror_direction(inside.towards_viewer, normal, inside.point.geometric_normal);
      from.geometric_normal = -from.geometric_normal;
      continue;
    }
    const Vec3 across = eta * (cosine * normal - inside.towards_viewer);
    const Vec3 refracted = across - std::sqrt(std::max(0.0, 1 - length_squared(across))) * normal;
    SurfacePoint outside = inside.point;
    outside.geometric_normal = -outside.geometric_normal;
    if (glm::dot(refracted, outside.geometric_normal) <= 0) return Rgb();
    return throughput *
           (incoming(leaving(outside, refracted), next, path) + lights_.uniform_radiance(outside.position));
  }
  return Rgb();
}

// Transmittance of a medium of varying density, estimated by ratio tracking: at each collision of the densest
// medium, the chance that it was none.
Rgb SurfaceIntegrator::unscattered_share(const Body& body, const Ray& ray, double distance, Rng rng) const {
  const TriangleMesh& mesh = scene_.objects[body.object].mesh;
  const double sigma_max = body.sigma_t.max();
  Rgb share(1);
  for (double t = sample_free_flight(rng) / sigma_max; t < distance;
       t += sample_free_flight(rng) / sigma_max) {
    const auto closest = scene_.rays.closest_point(body.object, ray.origin + t * ray.direction);
    if (!closest) return Rgb();
    const double density = body.density->at(mesh.surface_point(closest->triangle, closest->barycentric)).r;
    share *= Rgb(1) - body.sigma_t * (density / sigma_max);
  }
  return share;
}

// ---- Rays ----

double SurfaceIntegrator::opacity_number(const Path& path, uint32_t vertex) const {
  return stochastic_opacity_ ? path.sampler.get_1d(Dimension::opacity, vertex) : 0.5;
}

Ray SurfaceIntegrator::leaving(const SurfacePoint& point, const Vec3& direction) const {
  Ray ray;
  ray.origin = point.position + offset_ * point.geometric_normal;
  ray.direction = direction;
  ray.ignore_object = point.object;
  ray.ignore_triangle = point.triangle;
  return ray;
}

bool SurfaceIntegrator::lit(const SurfacePoint& point, const LightSample& light,
                            double opacity_number) const {
  Ray ray = leaving(point, light.direction);
  if (std::isfinite(light.distance)) {
    ray.direction = point.position + light.distance * light.direction - ray.origin;
    ray.t_max = 1 - 1e-4;  // short of the light itself, whose triangles must not shadow it
  }
  return !scene_.rays.occluded(ray, opacity_number);
}

}  // namespace alabaster

#include "study/mesh_method.h"

#include <algorithm>

#include "bssrdf/surface_distance.h"
#include "core/error.h"
#include "integrators/render.h"

namespace alabaster {

namespace {

const std::vector<std::string>& models() {
  static const std::vector<std::string> names{"homogeneous", "factorized", "aggregate", "composite"};
  return names;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::vector<std::string> split(const std::string& name) {
  std::vector<std::string> parts(1);
  for (const char c : name) {
    if (c == '+' || c == ':') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

MeshMethod bssrdf_method(const std::string& model, const std::string& basis, const std::string& variant,
                         const std::string& placement = "", const std::string& distance = "") {
  MeshMethod method;
  if (!placement.empty()) method.placement = placement;
  if (!distance.empty()) method.distance = distance;
  method.basis = basis;
  method.model = variant.empty() ? model : model + ":" + variant;
  method.name = model + "+" + basis + (variant.empty() ? "" : "+" + variant) +
                (placement.empty() ? "" : "+" + placement) + (distance.empty() ? "" : "+" + distance);
  return method;
}

}  // namespace

const std::vector<std::string>& mesh_bases() {
  static const std::vector<std::string> names{"half-space", "shape"};
  return names;
}

Basis MeshMethod::basis_value() const {
  return basis == "shape" ? Basis::shape : Basis::half_space;
}

SurfaceOptions MeshMethod::apply(SurfaceOptions options) const {
  options.transport = transport;
  if (transport == Transport::bssrdf) {
    options.model = model;
    options.basis = basis_value();
    options.placement = placement;
    options.distance = distance;
  }
  return options;
}

MeshMethod parse_mesh_method(const std::string& name) {
  if (name == "walk") return {name, Transport::walk, "", ""};
  if (name == "volume") return {name, Transport::volume, "", ""};
  std::vector<std::string> parts = split(name);
  if (!contains(models(), parts[0]))
    throw InputError("there is no method '" + name + "'; use " + joined(models()) +
                     ", each with a basis (composite+half-space), walk or volume");
  std::string basis = mesh_bases().front();
  std::size_t next = 1;
  if (parts.size() > 1 && name[parts[0].size()] == '+') {
    basis = parts[next++];
    if (!contains(mesh_bases(), basis))
      throw InputError("method '" + name + "': there is no basis '" + basis + "'; use " +
                       joined(mesh_bases()));
  }
  const bool composite = parts[0] == "composite", placed = composite || parts[0] == "aggregate";
  std::string variant, placement, distance;
  if (next < parts.size() && composite && contains({"symmetric", "order1", "view"}, parts[next]))
    variant = parts[next++];
  if (next < parts.size() && placed && contains(placement_names(), parts[next])) placement = parts[next++];
  if (next < parts.size() && contains(distance_names(), parts[next])) distance = parts[next++];
  if (next < parts.size())
    throw InputError("method '" + name +
                     "': there is no such variant; composite takes symmetric, order1 and view, " +
                     "composite and aggregate a placement: " + joined(placement_names()) +
                     "; every model a distance: " + joined(distance_names()));
  if (placement == default_placement) placement.clear();
  if (distance == default_distance) distance.clear();
  return bssrdf_method(parts[0], basis, variant, placement, distance);
}

std::vector<MeshMethod> standard_mesh_methods() {
  std::vector<MeshMethod> methods;
  for (const std::string& basis : mesh_bases())
    for (const std::string& model : models()) methods.push_back(bssrdf_method(model, basis, ""));
  for (const char* name : {"composite+shape+view", "walk"}) methods.push_back(parse_mesh_method(name));
  return methods;
}

TimedImage render_timed(const SurfaceIntegrator& integrator, const std::string& label, uint32_t spp,
                        uint64_t seed) {
  RenderOptions options;
  options.spp = spp;
  options.seed = seed;
  options.label = label;
  RenderResult result = render(integrator, options);
  return {result.film.develop(), result.seconds, result.cpu_seconds, result.samples};
}

TimedImage render_mesh(const MeshScene& scene, const MeshMethod& method, uint32_t spp, uint64_t seed) {
  const SurfaceIntegrator integrator(scene.scene, method.apply(scene.options()));
  return render_timed(integrator, scene.name + " " + method.name, spp, seed);
}

}  // namespace alabaster

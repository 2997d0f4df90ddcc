#include "cli/render_settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "bssrdf/placements.h"
#include "core/error.h"

namespace alabaster {

namespace {

constexpr uint32_t most_samples = 1u << 24;
constexpr int largest_side = 1 << 16;

// One option's text with the words to complain about it.
struct Value {
  const std::string& text;
  std::string prefix;
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{}: '{}' {}", prefix, text, what));
  }
};

template <typename Integer>
Integer integer(const Value& v, Integer low, Integer high) {
  Integer result{};
  const char* end = v.text.data() + v.text.size();
  const auto [stop, error] = std::from_chars(v.text.data(), end, result);
  if (error != std::errc() || stop != end || result < low || result > high)
    v.refuse(fmt::format("is not a whole number from {} to {}", low, high));
  return result;
}

double real(const Value& v, double low, double high, const std::string& range) {
  double result{};
  const char* end = v.text.data() + v.text.size();
  const auto [stop, error] = std::from_chars(v.text.data(), end, result);
  if (error != std::errc() || stop != end || !(result >= low && result <= high))
    v.refuse("is not a number " + range);
  return result;
}

bool boolean(const Value& v) {
  if (v.text != "true" && v.text != "false") v.refuse("is neither true nor false");
  return v.text == "true";
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

void set_size(RenderSettings& s, const Value& v) {
  const std::vector<std::string> parts = split(v.text, 'x');
  if (parts.size() != 2) v.refuse("is not a size; write WIDTHxHEIGHT in pixels, as in 512x512");
  s.width = integer<int>({parts[0], v.prefix}, 1, largest_side);
  s.height = integer<int>({parts[1], v.prefix}, 1, largest_side);
}

void set_crop(RenderSettings& s, const Value& v) {
  const std::vector<std::string> parts = split(v.text, ',');
  if (parts.size() != 4) v.refuse("is not a rectangle; write X0,Y0,X1,Y1 in pixels from the top left");
  const auto pixel = [&](std::size_t i) { return integer<int>({parts[i], v.prefix}, 0, largest_side); };
  s.crop = PixelRectangle{pixel(0), pixel(1), pixel(2), pixel(3)};
  if (s.crop->width() <= 0 || s.crop->height() <= 0) v.refuse("is empty; X1 must exceed X0 and Y1 exceed Y0");
}

void set_integrator(RenderSettings& s, const Value& v) {
  if (v.text == "planar") v.refuse("renders flat scenes only: see alabaster validate; here use surface");
  if (v.text != "surface" && v.text != "volume" && v.text != "walk")
    v.refuse("is not known; use surface, volume or walk");
  s.integrator = v.text;
}

void set_model(RenderSettings& s, const Value& v) {
  const std::string base = v.text.substr(0, v.text.find(':'));  // a variant's name is checked by make_bssrdf
  if (base != "homogeneous" && base != "factorized" && base != "aggregate" && base != "composite")
    v.refuse("is not known; use homogeneous, factorized, aggregate, composite or composite:view");
  s.model = v.text;
}

void set_basis(RenderSettings& s, const Value& v) {
  if (v.text != "half-space" && v.text != "shape") v.refuse("is not known; use half-space or shape");
  s.basis = v.text;
}

void set_closest_point(RenderSettings& s, const Value& v) {
  if (v.text != "cached" && v.text != "exact") v.refuse("is not known; use cached or exact");
  s.walk.closest_point = v.text == "exact" ? ClosestPointMode::exact : ClosestPointMode::cached;
}

void set_placement(RenderSettings& s, const Value& v) {
  const auto& names = placement_names();
  if (std::find(names.begin(), names.end(), v.text) == names.end())
    v.refuse("is not known; use chord, arc, projected-chord or straightest");
  s.placement = v.text;
}

void set_guide(RenderSettings& s, const Value& v) {
  if (v.text != "all" && v.text != "light" && v.text != "depth" && v.text != "none")
    v.refuse("is not known; use all, light, depth or none");
  s.walk.look_for_light = v.text == "all" || v.text == "light";
  s.walk.steered = v.text == "all" || v.text == "depth";
}

void set_open(RenderSettings& s, const Value& v) {
  if (v.text != "refuse" && v.text != "sheet") v.refuse("is not known; use refuse or sheet");
  s.walk.open_sheets = v.text == "sheet";
}

void set_layer(RenderSettings& s, const Value& v) {
  static const std::map<std::string, Layer> layers{{"all", Layer::all},
                                                   {"scattered", Layer::scattered},
                                                   {"unscattered", Layer::unscattered},
                                                   {"mirror", Layer::mirror}};
  const auto found = layers.find(v.text);
  if (found == layers.end()) v.refuse("is not known; use all, scattered, unscattered or mirror");
  s.layer = found->second;
}

void set_sampler(RenderSettings& s, const Value& v) {
  try {
    s.sampler = sampler_kind_from_name(v.text);
  } catch (const InputError&) {
    v.refuse("is not known; use sobol or independent");
  }
}

void set_mean_free_path(RenderSettings& s, const Value& v) {
  try {
    s.load.mean_free_path = parse_length(v.text);
  } catch (const InputError& error) {
    throw InputError(v.prefix + ": " + error.what());
  }
}

using Setter = std::function<void(RenderSettings&, const Value&)>;
struct Option {
  RenderOptionInfo info;
  Setter set;
};

// clang-format off
const std::vector<Option>& options() {
  using S = RenderSettings;
  static const std::vector<Option> all{
      {{"integrator", "NAME", "surface (the default), volume (the reference) or walk", true}, set_integrator},
      {{"model", "NAME", "homogeneous, factorized, aggregate, composite or composite:view (the default)", true}, set_model},
      {{"basis", "NAME", "shape (the default) or half-space", true}, set_basis},
      {{"closest_point", "NAME", "of volume: cached (the default; same expectation) or exact", true}, set_closest_point},
      {{"placement", "NAME", "of composite's kernel: chord (the default), arc, projected-chord or straightest", true}, set_placement},
      {{"guide", "NAME", "of volume and walk: all (the default), light, depth or none", true}, set_guide},
      {{"open", "NAME", "of volume and walk: refuse open meshes (the default) or take them as a sheet over a half-space", true}, set_open},
      {{"angular_size", "DEGREES", "of point, spot and directional lights; 0: none (surface 0, volume and walk 1)", true},
       [](S& s, const Value& v) { s.angular_size = real(v, 0, 90, "of degrees from 0 to 90"); }},
      {{"layer", "NAME", "all (the default), scattered, unscattered or mirror: they add up", true}, set_layer},
      {{"sampler", "NAME", "sobol (the default) or independent", true}, set_sampler},
      {{"size", "WxH", "pixels of the whole image (512x512)", true}, set_size},
      {{"crop", "X0,Y0,X1,Y1", "render this part only, pixels from the top left", true}, set_crop},
      {{"spp", "N", "samples per pixel (64)", true},
       [](S& s, const Value& v) { s.spp = integer<uint32_t>(v, 1, most_samples); }},
      {{"seed", "N", "another seed gives another noise (0)", true},
       [](S& s, const Value& v) { s.seed = integer<uint64_t>(v, 0, ~uint64_t{0}); }},
      {{"time", "SECONDS", "stop after so much wall time; without --spp, go on until then", true},
       [](S& s, const Value& v) { s.time = real(v, 1e-3, 1e9, "of seconds above 0"); }},
      {{"depth", "N", "diffuse bounces between surfaces; 0: direct light only (4)", true},
       [](S& s, const Value& v) { s.depth = integer<int>(v, 0, 1000); }},
      {{"camera", "NAME", "the camera of the scene to use", true},
       [](S& s, const Value& v) { s.camera = v.text; }},
      {{"hide_environment", "", "camera rays that meet nothing are transparent", true},
       [](S& s, const Value& v) { s.load.hide_environment = boolean(v); }},
      {{"exposure", "STOPS", "brightness of the PNG (0)", true},
       [](S& s, const Value& v) { s.exposure = real(v, -100, 100, "of stops from -100 to 100"); }},
      {{"turntable", "N", "N images on a circle about the scene: out.0001.exr ...", true},
       [](S& s, const Value& v) { s.turntable = integer<int>(v, 1, 9999); }},
      {{"png", "FILE", "write a picture for the eye as well", false},
       [](S& s, const Value& v) { s.png = v.text; }},
      {{"mean_free_path", "M|R,G,B|P%", "metres, per channel, or per cent of the box diagonal", false},
       set_mean_free_path},
      {{"g", "G", "mean cosine of scattering, all media", false},
       [](S& s, const Value& v) { s.load.g = real(v, -0.99, 0.99, "from -0.99 to 0.99"); }},
      {{"eta", "ETA", "index of refraction, all media", false},
       [](S& s, const Value& v) { s.load.eta = real(v, 1, 3, "from 1 to 3"); }},
      {{"subsurface", "NAME,...", "materials that get a medium, instead of the default rule", false},
       [](S& s, const Value& v) { s.load.subsurface = split(v.text, ','); }},
      {{"subsurface_map", "FILE", "image: 0 plain diffuse, 1 subsurface", false},
       [](S& s, const Value& v) { s.load.subsurface_map = v.text; }},
      {{"threads", "N", "threads; 0: one per core (0)", false},
       [](S& s, const Value& v) { s.threads = integer<int>(v, 0, 4096); }},
      {{"quiet", "", "warnings and errors only", false}, [](S& s, const Value& v) { s.quiet = boolean(v); }},
  };
  return all;
}
// clang-format on

const Option* find(const std::string& name) {
  for (const Option& option : options())
    if (option.info.name == name) return &option;
  return nullptr;
}

}  // namespace

const std::vector<RenderOptionInfo>& render_option_infos() {
  static const std::vector<RenderOptionInfo> infos = [] {
    std::vector<RenderOptionInfo> all;
    for (const Option& option : options()) all.push_back(option.info);
    return all;
  }();
  return infos;
}

uint32_t RenderSettings::samples_per_pixel() const {
  if (spp) return *spp;
  return time > 0 ? most_samples : 64;
}

std::string OptionSource::error_prefix(const std::string& name) const {
  if (!file.empty()) return file + ": " + (place.empty() ? "" : place + ": ") + name;
  std::string option = "--" + name;
  for (char& c : option)
    if (c == '_') c = '-';
  return option;
}

void apply_options(const OptionTexts& texts, const OptionSource& source, RenderSettings& settings) {
  for (const auto& [name, text] : texts) {
    const Option* option = find(name);
    if (option == nullptr) throw InputError(source.error_prefix(name), "there is no such option");
    option->set(settings, {text, source.error_prefix(name)});
  }
}

void apply_scene_defaults(const OptionTexts& texts, const std::string& file, RenderSettings& settings) {
  for (const auto& [name, text] : texts) {
    const Option* option = find(name);
    if (option != nullptr && !option->info.in_scene_file)
      throw InputError(file, "integrator: " + name,
                       "cannot be set here; give it on the command line or among the materials");
  }
  apply_options(texts, {file, "integrator"}, settings);
}

void check_settings(const RenderSettings& s) {
  if (s.crop && (s.crop->x1 > s.width || s.crop->y1 > s.height))
    throw InputError(fmt::format("crop: {},{},{},{} leaves the image of {}x{} pixels", s.crop->x0, s.crop->y0,
                                 s.crop->x1, s.crop->y1, s.width, s.height));
}

}  // namespace alabaster

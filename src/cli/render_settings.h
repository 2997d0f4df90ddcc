#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "integrators/render.h"
#include "integrators/surface.h"
#include "scene/scene_file.h"

namespace alabaster {

/// Options by name (long option with underscores for dashes) and text, from the command line, a job of a
/// batch or the "integrator" object of a scene file. Flags have the text "true" or "false".
using OptionTexts = std::map<std::string, std::string>;

/// One option of `render`, for help texts and to know which keys a file may hold.
struct RenderOptionInfo {
  std::string name;   // with underscores
  std::string value;  // what stands for the value in help; empty: a flag
  std::string help;
  bool in_scene_file;  // a scene file may set it as a default
};
const std::vector<RenderOptionInfo>& render_option_infos();

/// Everything `render` can be told, checked.
struct RenderSettings {
  std::string integrator = "surface", model = "composite:view", basis = "shape", placement = "chord";
  SamplerKind sampler = SamplerKind::sobol;
  int width = 512, height = 512;
  std::optional<PixelRectangle> crop;
  std::optional<uint32_t> spp;  // see samples_per_pixel()
  uint64_t seed = 0;
  double time = 0;  // s; 0: no limit
  int depth = 4;
  int threads = 0;    // 0: all cores
  int turntable = 0;  // images; 0: a single one from the camera
  std::string camera;
  std::string png;
  double exposure = 0;  // stops
  bool quiet = false;
  VolumeWalkOptions walk;
  Layer layer = Layer::all;
  std::optional<double> angular_size;  // degrees
  LoadOptions load;

  /// What was asked for, or 64, or without end when there is only a time limit.
  uint32_t samples_per_pixel() const;
};

/// Names options in messages: "--spp" on the command line, "FILE: PLACE: spp" elsewhere.
struct OptionSource {
  std::string file, place;  // empty on the command line
  std::string error_prefix(const std::string& name) const;
};

/// Sets what `texts` names. Throws InputError for unknown names and values out of range.
void apply_options(const OptionTexts& texts, const OptionSource& source, RenderSettings& settings);
/// The same for a scene file's defaults: options that concern loading or outputs are refused.
void apply_scene_defaults(const OptionTexts& texts, const std::string& file, RenderSettings& settings);
/// What only the whole can tell: the crop lies in the image. Throws InputError.
void check_settings(const RenderSettings& settings);

}  // namespace alabaster

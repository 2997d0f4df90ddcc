#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "cli/commands.h"
#include "core/error.h"
#include "core/progress.h"
#include "image/exr_file.h"
#include "image/false_colour.h"
#include "image/image_decode.h"
#include "image/metrics.h"
#include "image/png_file.h"
#include "image/srgb.h"

namespace alabaster {

namespace {

using nlohmann::json;

struct CompareArguments {
  std::string a, b, diff, mask, scale;
  bool as_json = false;
};

/// A picture of any format as linear channels; EXR keeps all it has.
Image read_linear(const std::string& path) {
  if (path.size() > 4 && path.substr(path.size() - 4) == ".exr") return read_exr(path).image;
  const DecodedImage decoded = read_image(path);
  Image image(decoded.width, decoded.height, {"R", "G", "B", "A"});
  const auto store = [&](const auto& rgba, auto&& linear) {
    for (int y = 0, i = 0; y < image.height(); ++y)
      for (int x = 0; x < image.width(); ++x)
        for (int c = 0; c < 4; ++c, ++i) image.at(c, x, y) = linear(rgba[static_cast<std::size_t>(i)], c);
  };
  const auto decode = [](double code, int channel) {
    return static_cast<float>(channel < 3 ? srgb_to_linear(code) : code);
  };
  switch (decoded.rgba.index()) {
    case 0:
      store(std::get<0>(decoded.rgba), [&](uint8_t v, int c) { return decode(v / 255.0, c); });
      break;
    case 1:
      store(std::get<1>(decoded.rgba), [&](uint16_t v, int c) { return decode(v / 65535.0, c); });
      break;
    default:
      store(std::get<2>(decoded.rgba), [](float v, int) { return v; });
  }
  return image;
}

/// A pixel belongs to the mask where the mean of its colour exceeds one half.
std::vector<bool> read_mask(const std::string& path, const Image& a) {
  const Image mask = read_linear(path);
  if (mask.width() != a.width() || mask.height() != a.height())
    throw InputError(path, fmt::format("the mask has {} x {} pixels, the pictures {} x {}", mask.width(),
                                       mask.height(), a.width(), a.height()));
  const auto colour = find_colour(mask);
  if (!colour) throw InputError(path, "has no channels R, G and B (or Y) to use as a mask");
  std::vector<bool> inside;
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) inside.push_back(colour->get(mask, x, y).mean() > 0.5);
  return inside;
}

/// What both pictures cover: alpha above one half.
std::vector<bool> covered_by_both(const Image& a, const std::string& name_a, const Image& b,
                                  const std::string& name_b) {
  const auto alpha_of = [](const Image& image, const std::string& name) {
    const auto colour = find_colour(image);
    if (!colour || colour->alpha < 0)
      throw InputError(name, "has no alpha channel; --mask alpha needs one in both pictures");
    return colour->alpha;
  };
  const int alpha_a = alpha_of(a, name_a), alpha_b = alpha_of(b, name_b);
  std::vector<bool> inside;
  if (a.width() != b.width() || a.height() != b.height()) return inside;  // refused by the comparison
  for (int y = 0; y < a.height(); ++y)
    for (int x = 0; x < a.width(); ++x)
      inside.push_back(a.at(alpha_a, x, y) > 0.5f && b.at(alpha_b, x, y) > 0.5f);
  return inside;
}

json to_json(const Metrics& m) {
  const auto optional = [](const std::optional<double>& v) { return v ? json(*v) : json(nullptr); };
  return {{"rmse_over_rms", m.rmse_over_rms},
          {"rmse_over_mean", m.rmse_over_mean},
          {"bias", optional(m.bias)},
          {"noise", optional(m.noise)},
          {"mean_bias", m.mean_bias},
          {"mean_abs_log_ratio", m.mean_abs_log_ratio},
          {"kept", m.kept},
          {"bias_interval", optional(m.bias_interval)},
          {"mean_bias_interval", optional(m.mean_bias_interval)},
          {"log_interval", optional(m.log_interval)},
          {"rel_mse", m.rel_mse},
          {"mean_a", m.mean_a},
          {"mean_b", m.mean_b},
          {"pixels", m.pixels},
          {"finite", m.finite},
          {"scale", m.scale}};
}

void print(const Metrics& m) {
  const auto line = [](const char* name, const std::string& value, const char* meaning) {
    fmt::print("{:<20}{:>12}   {}\n", name, value, meaning);
  };
  const auto number = [](const std::optional<double>& v) {
    return v ? fmt::format("{:.5g}", *v) : "unknown";
  };
  line("rmse_over_rms", number(m.rmse_over_rms), "error over the reference's root mean square");
  const auto interval = [](const std::optional<double>& v, const char* meaning) {
    return v ? fmt::format("+- {:.2g} ({})", *v, meaning) : std::string(meaning);
  };
  line("rmse_over_mean", number(m.rmse_over_mean), "error over the reference's mean");
  line("bias", number(m.bias), interval(m.bias_interval, "the same without noise").c_str());
  line("noise", number(m.noise), "noise of both pictures");
  line("mean_bias", number(m.mean_bias), interval(m.mean_bias_interval, "mean(A) / mean(B) - 1").c_str());
  line("mean_abs_log_ratio", number(m.mean_abs_log_ratio),
       interval(m.log_interval, "mean |ln(A / B)|").c_str());
  line("kept", number(m.kept), "share of values it could use; below 0.95 it means nothing");
  line("rel_mse", number(m.rel_mse), "relative mean squared error");
  line("mean_a", number(m.mean_a), "");
  line("mean_b", number(m.mean_b), "");
  line("pixels", std::to_string(m.pixels), m.finite ? "" : "others hold NaN or infinity");
  if (m.scale != 1) line("scale", number(m.scale), "A was multiplied with it");
}

void check_diff_name(const std::string& path) {
  if (!path.empty() && std::filesystem::path(path).extension() != ".png")
    throw InputError(path, "the name of --diff must end in .png");
}

void write_difference(const std::string& path, Image a, const Image& b, double scale) {
  const auto colour_a = find_colour(a), colour_b = find_colour(b);
  for (const int channel : std::set<int>(colour_a->rgb.begin(), colour_a->rgb.end()))
    for (int y = 0; y < a.height(); ++y)
      for (int x = 0; x < a.width(); ++x) a.at(channel, x, y) *= static_cast<float>(scale);
  const auto values = signed_difference(a, *colour_a, b, *colour_b);
  const ColourScale colours = fitted_scale(values, true);
  write_png(path, with_legend(false_colour(values, a.width(), a.height(), colours), colours));
}

void run(const CompareArguments& arguments) {
  check_diff_name(arguments.diff);
  const Image a = read_linear(arguments.a), b = read_linear(arguments.b);
  CompareOptions options;
  options.fit_scale = arguments.scale == "fit";
  if (arguments.mask == "alpha")
    options.mask = covered_by_both(a, arguments.a, b, arguments.b);
  else if (!arguments.mask.empty())
    options.mask = read_mask(arguments.mask, a);
  const Metrics metrics = compare_images(a, b, options, arguments.a, arguments.b);
  for (const auto& [name, image] : {std::pair(&arguments.a, &a), {&arguments.b, &b}})
    if (!has_variance(*image)) say(*name + ": has no variance channels: bias and noise are unknown");
  if (!metrics.finite)
    warn(fmt::format("{} or {} holds NaN or infinity; those pixels were left out", arguments.a, arguments.b));
  if (!arguments.diff.empty()) write_difference(arguments.diff, a, b, metrics.scale);
  if (arguments.as_json)
    std::puts(to_json(metrics).dump(2).c_str());
  else
    print(metrics);
}

}  // namespace

void add_compare_command(CLI::App& app) {
  auto arguments = std::make_shared<CompareArguments>();
  CLI::App* command = app.add_subcommand("compare", "How far picture A is from the reference B");
  command->add_option("A", arguments->a, "Picture (EXR of any renderer, or PNG, JPEG, WebP, HDR)")
      ->required();
  command->add_option("B", arguments->b, "Reference")->required();
  command->add_flag("--json", arguments->as_json, "Print JSON");
  command->add_option("--diff", arguments->diff, "Write the signed difference A - B as a false-colour PNG");
  command->add_option(
      "--mask", arguments->mask,
      "Compare only where this picture is brighter than one half; alpha: where both pictures are covered");
  command
      ->add_option("--scale", arguments->scale, "fit: multiply A by the factor that brings it closest to B")
      ->check(CLI::IsMember({"fit", "none"}));
  command->callback([arguments] { run(*arguments); });
}

}  // namespace alabaster

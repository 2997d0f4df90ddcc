#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "cli/render_settings.h"

namespace alabaster {

/// One scene to one image (or a turntable of them).
struct RenderJob {
  std::filesystem::path input, output;
  OptionTexts texts;    // override the scene file's defaults
  OptionSource source;  // where they stand
};

/// Keeps loaded scenes for jobs that share them.
class SceneCache {
 public:
  /// The scene of `input` loaded with those options, from an earlier call if there was one.
  std::shared_ptr<const LoadedScene> get(const std::filesystem::path& input, const LoadOptions& options);
  /// Lets go of one; a job that still renders it keeps it.
  void release(const std::string& key) { scenes_.erase(key); }
  /// What tells scenes apart: the file and the options of loading that change it.
  static std::string key(const std::filesystem::path& input, const LoadOptions& options);

 private:
  std::map<std::string, std::shared_ptr<const LoadedScene>> scenes_;
};

/// What a job would write into its image: tells whether an image is the one wanted.
std::string job_fingerprint(const RenderJob& job);
/// Whether `output` is there, whole, and was rendered with the same options.
bool is_finished(const RenderJob& job);

/// Checks everything that can be checked before the work, renders, and writes the EXR (and PNG) with its
/// provenance. Returns false when a stop was asked for; then the image holds the samples that were finished.
/// Throws InputError.
bool run_render_job(const RenderJob& job, SceneCache& scenes);

}  // namespace alabaster

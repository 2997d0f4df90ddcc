#include "study/validation_report.h"

#include <fmt/format.h>

#include "study/mesh_report.h"
#include "study/planar_report.h"

namespace alabaster {

HtmlReport validation_page(const ValidationResult& result, const ValidationOptions& options) {
  HtmlReport report("Alabaster: validation",
                    fmt::format("Quality {}, seed {}, {:.0f} s ({:.0f} CPU s).{}",
                                options.quality == Quality::quick ? "quick" : "full", options.seed,
                                result.seconds, result.cpu_seconds,
                                result.cancelled ? " Stopped before the end: some scenes are missing." : ""));
  add_mesh_sections(report, result);
  add_planar_sections(report, result);
  return report;
}

}  // namespace alabaster

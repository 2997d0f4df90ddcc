#pragma once

#include <filesystem>

#include "optics/path_tally.h"
#include "optics/table_data.h"

namespace alabaster {

/// Measures a table, and ways to fit exponentials, against a simulation that the table was not made from.
/// Leaves in `folder`: fits.csv (one row per albedo and method), summary.csv (one row per method), lobe.csv,
/// and the charts profiles.svg, fits.svg, fit_by_distance.svg and lobe.svg (gnuplot).
///
/// Distances are 0.01 to 10 diffusion lengths, four bins to the octave, bins known to 2 % only.
void write_optics_report(const PathTally& simulation, const TableData& table,
                         const std::filesystem::path& folder);

}  // namespace alabaster

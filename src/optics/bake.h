#pragma once

#include <cstdint>
#include <functional>

#include "optics/half_space_walk.h"
#include "optics/table_data.h"

namespace alabaster {

struct BakeOptions {
  WalkMedium medium;
  uint64_t photons = 8'000'000;
  uint64_t seed = 1;
  TableView view = TableView::all;
};

/// Photons of the named qualities of `alabaster bake`.
inline constexpr uint64_t quick_photons = 8'000'000, full_photons = 120'000'000;

/// Simulates and tabulates. `progress` gets the fraction done.
TableData bake_table(const BakeOptions& options, const std::function<void(double)>& progress = {});

/// The table of a finished simulation.
TableData tabulate(const PathTally& tally, const BakeOptions& options);

}  // namespace alabaster

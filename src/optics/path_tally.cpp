#include "optics/path_tally.h"

#include <array>
#include <cassert>

#include "optics/fresnel.h"

namespace alabaster {

namespace {

// How many photons begin each stage and how many of them are inside at its end, before any is stopped.
struct StageCounts {
  std::array<double, WalkStages::count> began{}, survived{};

  explicit StageCounts(const PathTally& tally) {
    uint64_t inside = tally.photons();
    assert(inside > 0);
    for (std::size_t stage = 0; stage < WalkStages::count; ++stage) {
      began[stage] = static_cast<double>(inside);
      inside -= tally.exits_of_stage(static_cast<int>(stage));
      survived[stage] = static_cast<double>(inside);
      inside -= tally.stopped(static_cast<int>(stage));
    }
  }
};

// The mean of a score that a photon gets when it leaves (0 when it never does). Within a stage the photons
// are independent: the score of one that goes on is the mean over the stages after, whose own variance adds.
class StagedMean {
 public:
  void add(int stage, double score, uint64_t count) {
    const auto n = static_cast<double>(count);
    sum_[static_cast<std::size_t>(stage)] += score * n;
    square_[static_cast<std::size_t>(stage)] += score * score * n;
  }
  Estimate estimate(const StageCounts& counts) const {
    double mean = 0, variance = 0;
    for (std::size_t stage = WalkStages::count; stage-- > 0;) {
      const double n = counts.began[stage];
      if (n == 0) continue;
      const double going_on = counts.survived[stage] / n;
      const double square = square_[stage] / n + going_on * mean * mean;
      const double later = going_on * going_on * variance;
      mean = sum_[stage] / n + going_on * mean;
      variance = std::max(0.0, square - mean * mean) / n + later;
    }
    return {mean, std::sqrt(variance)};
  }

 private:
  std::array<double, WalkStages::count> sum_{}, square_{};
};

// Reads counts(group, bin) at one albedo, for each bin.
template <typename Counts>
std::vector<Estimate> weigh(const PathTally& tally, double albedo, int bins, const Counts& counts) {
  std::vector<StagedMean> means(static_cast<std::size_t>(bins));
  for (int group = 1; group < OrderGroups::count; ++group) {
    const double score = OrderGroups::mean_power(group, albedo);
    if (score <= 0) continue;
    const int stage = tally.stage_of_group(group);
    for (int bin = 0; bin < bins; ++bin)
      means[static_cast<std::size_t>(bin)].add(stage, score, counts(group, bin));
  }
  const StageCounts stages(tally);
  std::vector<Estimate> result;
  for (const StagedMean& mean : means) result.push_back(mean.estimate(stages));
  return result;
}

}  // namespace

PathTally::PathTally(bool normal_view, bool far_side)
    : exits_(static_cast<std::size_t>(OrderGroups::count) * RadialBins::count),
      far_exits_(far_side ? exits_.size() : 0),
      directions_(static_cast<std::size_t>(OrderGroups::count) * cosine_bins),
      normal_views_(normal_view ? exits_.size() : 0) {}

void PathTally::merge(const PathTally& other) {
  for (std::size_t i = 0; i < exits_.size(); ++i) exits_[i] += other.exits_[i];
  for (std::size_t i = 0; i < far_exits_.size(); ++i) far_exits_[i] += other.far_exits_[i];
  for (std::size_t i = 0; i < directions_.size(); ++i) directions_[i] += other.directions_[i];
  for (std::size_t i = 0; i < normal_views_.size(); ++i) normal_views_[i] += other.normal_views_[i];
  for (std::size_t i = 0; i < stopped_.size(); ++i) stopped_[i] += other.stopped_[i];
  collisions_ += other.collisions_;
}

int PathTally::stage_of_group(int group) const {
  const int64_t order = OrderGroups::first(group);
  int stage = stopped(0) > 0 ? 0 : 1;
  while (order > WalkStages::limit(stage)) ++stage;
  return stage;
}

uint64_t PathTally::exits_of_stage(int stage) const {
  uint64_t sum = 0;
  for (int group = 0; group < OrderGroups::count; ++group)
    if (stage_of_group(group) == stage)
      for (int bin = 0; bin < cosine_bins; ++bin) sum += exits_by_cosine(group, bin);
  return sum;
}

uint64_t PathTally::photons() const {
  uint64_t sum = 0;
  for (const uint64_t count : directions_) sum += count;
  for (const uint64_t count : stopped_) sum += count;
  return sum;
}

Estimate PathTally::reflectance_over_albedo(double albedo) const {
  return weigh(*this, albedo, 1, [this](int group, int) {
    uint64_t count = 0;
    for (int bin = 0; bin < cosine_bins; ++bin) count += exits_by_cosine(group, bin);
    return count;
  })[0];
}

double PathTally::truncated() const {
  const StageCounts counts(*this);
  double inside = 1;
  for (std::size_t stage = 0; stage < WalkStages::count; ++stage)
    if (counts.began[stage] > 0) inside *= counts.survived[stage] / counts.began[stage];
  return inside;
}

std::vector<Estimate> radial_energy_over_albedo(const PathTally& tally, double albedo) {
  return weigh(tally, albedo, RadialBins::count, [&](int group, int bin) { return tally.exits(group, bin); });
}

std::vector<Estimate> far_radial_energy_over_albedo(const PathTally& tally, double albedo) {
  return weigh(tally, albedo, RadialBins::count,
               [&](int group, int bin) { return tally.far_exits(group, bin); });
}

std::vector<Estimate> normal_view_energy_over_albedo(const PathTally& tally, double albedo, double score) {
  std::vector<Estimate> energy = weigh(tally, albedo, RadialBins::count,
                                       [&](int group, int bin) { return tally.normal_views(group, bin); });
  for (Estimate& e : energy) e.value *= score, e.standard_error *= score;
  return energy;
}

std::vector<Estimate> exit_lobe_ratio(const PathTally& tally, double albedo, double eta) {
  const double total = tally.reflectance_over_albedo(albedo).value;
  const double c = diffuse_transmittance(eta);
  std::vector<Estimate> result = weigh(tally, albedo, PathTally::cosine_bins,
                                       [&](int group, int bin) { return tally.exits_by_cosine(group, bin); });
  for (int bin = 0; bin < PathTally::cosine_bins; ++bin) {
    // The assumed lobe's share of the bin, by Simpson's rule in 64 parts.
    double expected = 0;
    const int parts = 64;
    for (int i = 0; i <= parts; ++i) {
      const double cosine = (bin + static_cast<double>(i) / parts) / PathTally::cosine_bins;
      const double simpson = i == 0 || i == parts ? 1 : i % 2 == 1 ? 4 : 2;
      expected += simpson * (1 - fresnel_dielectric(cosine, eta)) * 2 * cosine / c;
    }
    expected *= total / (3 * parts * PathTally::cosine_bins);
    Estimate& estimate = result[static_cast<std::size_t>(bin)];
    estimate.value /= expected;
    estimate.standard_error /= expected;
  }
  return result;
}

}  // namespace alabaster

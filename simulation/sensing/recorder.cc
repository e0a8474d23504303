#include "simulation/sensing/recorder.h"

#include <cmath>
#include <limits>

#include "core/util/time.h"
#include "simulation/world/random.h"

namespace plumbline {
namespace {

constexpr double kEdge = 0.1;  // m; neighbouring ranges that differ by more lie at an edge
// They keep these random numbers apart from those of the noise.
constexpr uint64_t kMixKey = 0x6d6978;
constexpr uint64_t kOutlierKey = 0x6f7574;

// The beam's spot falls on both sides of an edge, and its range anywhere in between.
void MixPixels(double probability, uint64_t seed, PerfectScanLine* line) {
  if (probability == 0.0) return;
  Random random({seed,
                 static_cast<uint64_t>(line->scan_line.scanner_index),
                 static_cast<uint64_t>(line->line_index),
                 kMixKey});
  for (size_t i = 0; i + 1 < line->beams.size(); ++i) {
    const bool is_mixed = random.Uniform() < probability;
    const double share = random.Uniform();
    std::optional<RayHit>& beam = line->beams[i];
    const std::optional<RayHit>& next = line->beams[i + 1];
    if (!is_mixed || !beam || !next || std::abs(next->range - beam->range) < kEdge) continue;
    beam->range += share * (next->range - beam->range);
  }
}

}  // namespace

Recorder::Recorder(const Experiment& experiment, uint64_t seed)
    : rig_(experiment.rig),
      noise_(experiment.noise),
      faults_(experiment.faults),
      start_ns_(experiment.path.start_ns),
      seed_(seed),
      last_ranges_(experiment.rig.scanners.size()) {
  faults_.scanners.resize(rig_.scanners.size());
}

const Episode* Recorder::EpisodeAt(const ScannerFaults& faults, int64_t stamp_ns) const {
  const double time_s = SecondsBetween(start_ns_, stamp_ns);
  for (const Episode& episode : faults.episodes) {
    if (time_s >= episode.from_s && time_s < episode.to_s) return &episode;
  }
  return nullptr;
}

void Recorder::Scatter(const PerfectScanLine& perfect, double share, ScanLine* line) const {
  if (share == 0.0) return;
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(line->scanner_index)];
  Random random({seed_,
                 static_cast<uint64_t>(line->scanner_index),
                 static_cast<uint64_t>(perfect.line_index),
                 kOutlierKey});
  for (float& range : line->ranges) {
    const bool is_outlier = random.Uniform() < share;
    const double any =
        scanner.min_range_m + random.Uniform() * (scanner.max_range_m - scanner.min_range_m);
    if (is_outlier) range = static_cast<float>(any);
  }
}

std::optional<ScanLine> Recorder::Record(const PerfectScanLine& perfect) {
  const auto index = static_cast<size_t>(perfect.scan_line.scanner_index);
  const ScannerFaults& faults = faults_.scanners[index];
  const Episode* episode = EpisodeAt(faults, perfect.scan_line.stamp_ns);
  if (episode && episode->kind == Episode::Kind::kGone) return std::nullopt;
  PerfectScanLine seen = perfect;
  MixPixels(faults_.mixed_pixels, seed_, &seen);
  for (std::optional<RayHit>& beam : seen.beams) {
    if (beam) beam->range = faults.range_scale * beam->range + faults.range_bias_m;
  }
  ScanLine line = AddNoise(seen, rig_.scanners[index], noise_, seed_);
  const bool is_random = episode && episode->kind == Episode::Kind::kRandom;
  Scatter(perfect, is_random ? 1.0 : faults_.outliers, &line);
  if (faults.unit_m != 1.0) {
    for (float& range : line.ranges) range = static_cast<float>(range / faults.unit_m);
  }
  if (episode && episode->kind == Episode::Kind::kInfinite) {
    line.ranges.assign(line.ranges.size(), std::numeric_limits<float>::infinity());
  }
  if (episode && episode->kind == Episode::Kind::kFrozen && !last_ranges_[index].empty()) {
    line.ranges = last_ranges_[index];
  } else {
    last_ranges_[index] = line.ranges;
  }
  return line;
}

}  // namespace plumbline

#include "core/judging/scanner_agreement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>
#include <map>
#include <utility>

#include "core/judging/sightings.h"
#include "core/judging/verdict_levels.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Deviation of real walls from planes, and of two scanners that see different parts.
constexpr double kFlatness = 0.004;  // m
// Share of its points on planes, relative to the other scanners, below which a scanner shows
// something else than the building.
constexpr double kMinUsedRatio = 0.3;
// Difference between two scanners' views of a plane, in multiples of the noise, beyond which a
// pose or clock of the rig file is wrong.
constexpr double kMaxDifferenceRatio = 4.0;
// Most of a scanner's points on planes that no other scanner sees, where the others see their
// planes together: it builds a map of its own.
constexpr double kMaxAloneShare = 0.6;

// Weighted mean of the segments of one scanner on one plane in one second.
struct Mean {
  double sum_weights = 0.0;
  double sum = 0.0;

  void Add(double value, double weight) {
    sum_weights += weight;
    sum += weight * value;
  }
  double value() const { return sum / sum_weights; }
};

using MeansOfScanners = std::vector<Mean>;

// The differences between scanners in one second.
void AddDifferences(const std::map<int, MeansOfScanners>& means,
                    std::vector<ScannerAgreement>* agreements) {
  for (const auto& [landmark_id, of_scanners] : means) {
    for (size_t i = 0; i < of_scanners.size(); ++i) {
      if (of_scanners[i].sum_weights == 0.0) continue;
      Mean others;
      for (size_t j = 0; j < of_scanners.size(); ++j) {
        if (j != i && of_scanners[j].sum_weights > 0.0) {
          others.Add(of_scanners[j].value(), of_scanners[j].sum_weights);
        }
      }
      if (others.sum_weights == 0.0) continue;
      const double difference = of_scanners[i].value() - others.value();
      const double variance = 1.0 / of_scanners[i].sum_weights + 1.0 / others.sum_weights +
                              2.0 * kFlatness * kFlatness;
      ScannerAgreement& agreement = (*agreements)[i];
      ++agreement.num_differences;
      agreement.difference_m += difference * difference;
      agreement.difference_ratio += difference * difference / variance;
    }
  }
}

// Points on planes, by scanner.
using Counts = std::vector<int64_t>;

// How well any scanner but one can see a surface, from whatever direction the rig faces it:
// the sine of the angle between the surface and the best scan plane, the rig upright. 0 of a
// floor, where all others are level.
double VisibilityToOthers(const Rig& rig,
                          size_t scanner,
                          const Eigen::Vector3d& normal_world) {
  double best = 0.0;
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    if (i == scanner) continue;
    if (rig.scanners[i].mount) return 1.0;  // it comes to see any surface
    const Eigen::Vector3d axis =
        rig.scanners[i].body_from_scanner.rotation * Eigen::Vector3d::UnitZ();
    const double cosine = normal_world.z() * axis.z();
    best = std::max(best, std::sqrt(std::max(0.0, 1.0 - cosine * cosine)));
  }
  return best;
}

// points: by landmark. What the others can not see says nothing of whether they see the same.
void AddAloneShares(const Rig& rig,
                    const MapState& state,
                    const std::vector<Counts>& points,
                    std::vector<ScannerAgreement>* agreements) {
  std::vector<double> alone(agreements->size(), 0.0);
  std::vector<double> all(agreements->size(), 0.0);
  for (size_t landmark = 0; landmark < points.size(); ++landmark) {
    const Counts& of_scanners = points[landmark];
    int64_t sum = 0;
    for (const int64_t count : of_scanners) sum += count;
    for (size_t i = 0; i < of_scanners.size() && sum > 0; ++i) {
      const double weight = VisibilityToOthers(rig, i, state.landmarks[landmark].Normal()) *
                            static_cast<double>(of_scanners[i]);
      const auto others = static_cast<double>(sum - of_scanners[i]);
      all[i] += weight;
      // Planes of which the other scanners together have next to no points are seen by this
      // one alone.
      if (others < kExceptionShare * static_cast<double>(sum)) alone[i] += weight;
    }
  }
  for (size_t i = 0; i < agreements->size(); ++i) {
    if (all[i] > 0.0) (*agreements)[i].alone_share = alone[i] / all[i];
  }
}

std::string Percent(double share) {
  return std::to_string(static_cast<int>(std::lround(100.0 * share))) + " %";
}

// "from 3 to 8 s" for each run of marked seconds, at least min_length long; empty if none.
// first_second: of the first mark.
std::string RunsInWords(const std::vector<bool>& marked,
                        size_t min_length,
                        size_t first_second) {
  std::string words;
  for (size_t first = 0; first < marked.size(); ++first) {
    if (!marked[first]) continue;
    size_t last = first;
    while (last < marked.size() && marked[last]) ++last;
    if (last - first >= min_length) {
      words += (words.empty() ? "from " : ", from ") + std::to_string(first_second + first) +
               " to " + std::to_string(first_second + last) + " s";
    }
    first = last;
  }
  return words;
}

class FaultFinder {
 public:
  FaultFinder(const Rig& rig,
              const std::vector<ScannerAgreement>& agreements,
              const ScannerActivity& activity)
      : rig_(rig), agreements_(agreements), activity_(activity) {}

  std::vector<ScannerFault> Find() {
    for (size_t i = 0; i < agreements_.size(); ++i) {
      if (agreements_[i].num_points == 0) {
        Report(i, false, "returned no valid range in the whole recording");
        continue;
      }
      CheckActivity(i);
      if (agreements_.size() > 1) CheckAgreement(i);
    }
    return std::move(faults_);
  }

 private:
  void Report(size_t scanner, bool contradicts, const std::string& what) {
    faults_.push_back({static_cast<int>(scanner),
                       contradicts,
                       "scanner " + rig_.scanners[scanner].name + " " + what});
  }

  static ScannerActivity::Second CountsAt(const std::vector<ScannerActivity::Second>& seconds,
                                          size_t second) {
    return second < seconds.size() ? seconds[second] : ScannerActivity::Second();
  }

  void CheckActivity(size_t scanner) {
    if (scanner >= activity_.seconds().size()) return;
    const auto& seconds = activity_.seconds()[scanner];
    std::vector<int64_t> counts;
    const auto [first, last] = activity_.Span();
    for (size_t s = first; s < last; ++s) counts.push_back(CountsAt(seconds, s).num_points);
    const auto usual = static_cast<double>(Median(std::move(counts)));
    std::vector<bool> silent(first, false);
    std::vector<bool> frozen(first, false);
    for (size_t s = first; s < last; ++s) {
      const ScannerActivity::Second second = CountsAt(seconds, s);
      silent.push_back(static_cast<double>(second.num_points) < kHardlyAnyShare * usual);
      frozen.push_back(second.num_repeated > 1 && 2 * second.num_repeated > second.num_lines);
    }
    const auto first_second = static_cast<size_t>(activity_.first_second());
    const std::string when_silent = RunsInWords(silent, kMinSilent, first_second);
    if (!when_silent.empty())
      Report(scanner, false, "returned next to nothing " + when_silent);
    const std::string when_frozen = RunsInWords(frozen, 1, first_second);
    if (!when_frozen.empty()) {
      Report(scanner,
             true,
             "contradicts the others: it repeats the very same ranges " + when_frozen +
                 ", as a frozen driver does");
    }
  }

  void CheckAgreement(size_t scanner) {
    const ScannerAgreement& agreement = agreements_[scanner];
    double others_used = 0.0;
    double others_alone = 1.0;  // of those that see planes at all
    for (size_t i = 0; i < agreements_.size(); ++i) {
      if (i == scanner) continue;
      others_used = std::max(others_used, agreements_[i].used_share);
      if (agreements_[i].num_segments == 0) continue;
      others_alone = std::min(others_alone, agreements_[i].alone_share);
    }
    char text[200];
    if (agreement.used_share < kMinUsedRatio * others_used) {
      Report(scanner,
             true,
             "contradicts the others: only " + Percent(agreement.used_share) +
                 " of its points lie on planes, " + Percent(others_used) +
                 " of another's: it may be turned, mirrored or mistaken for another, or it "
                 "returns noise");
    } else if (agreement.num_differences >= kMinAveraged &&
               agreement.difference_ratio > kMaxDifferenceRatio &&
               agreement.difference_m > kSameSurface) {
      std::snprintf(text,
                    sizeof(text),
                    "contradicts the others: it sees the same planes %.0f mm away from where "
                    "they see them; check body_from_scanner and time_offset_s in the rig file",
                    1e3 * agreement.difference_m);
      Report(scanner, true, text);
    } else if (agreement.alone_share > kMaxAloneShare && others_alone < 0.5 * kMaxAloneShare) {
      Report(scanner,
             true,
             "contradicts the others: " + Percent(agreement.alone_share) +
                 " of its points lie on planes that no other scanner sees; check "
                 "body_from_scanner in the rig file");
    }
  }

  const Rig& rig_;
  const std::vector<ScannerAgreement>& agreements_;
  const ScannerActivity& activity_;
  std::vector<ScannerFault> faults_;
};

}  // namespace

void ScannerActivity::Add(int scanner_index,
                          double time_s,
                          int64_t num_points,
                          int64_t num_used,
                          uint64_t fingerprint) {
  const auto scanner = static_cast<size_t>(scanner_index);
  if (scanner >= seconds_.size()) {
    seconds_.resize(scanner + 1);
    last_fingerprints_.resize(scanner + 1, 0);
  }
  const auto second = static_cast<size_t>(std::max(0.0, time_s));
  if (second >= seconds_[scanner].size()) seconds_[scanner].resize(second + 1);
  Second& now = seconds_[scanner][second];
  ++now.num_lines;
  now.num_points += num_points;
  now.num_used += num_used;
  if (fingerprint != 0 && fingerprint == last_fingerprints_[scanner]) ++now.num_repeated;
  last_fingerprints_[scanner] = fingerprint;
}

std::pair<size_t, size_t> ScannerActivity::Span() const {
  size_t first = std::numeric_limits<size_t>::max();
  size_t last = 0;
  for (const std::vector<Second>& of_scanner : seconds_) {
    for (size_t second = 0; second < of_scanner.size(); ++second) {
      if (of_scanner[second].num_points == 0) continue;
      first = std::min(first, second);
      last = std::max(last, second + 1);
    }
  }
  return {std::min(first, last), last};
}

uint64_t FingerprintOf(const std::vector<float>& ranges) {
  constexpr int kMinDistinct = 10;  // valid ranges; a covered scanner repeats itself rightly
  uint64_t hash = 1469598103934665603ULL;  // Fowler, Noll and Vo's, of 64 bits
  int num_valid = 0;
  for (const float range : ranges) {
    uint32_t bits = 0;
    std::memcpy(&bits, &range, sizeof(bits));
    hash = (hash ^ bits) * 1099511628211ULL;
    if (std::isfinite(range) && range > 0.0F) ++num_valid;
  }
  return num_valid < kMinDistinct ? 0 : std::max<uint64_t>(1, hash);
}

std::vector<ScannerAgreement> CompareScanners(const Rig& rig,
                                              const MapState& state,
                                              const ScannerActivity& activity,
                                              int64_t start_ns) {
  const size_t num_scanners = rig.scanners.size();
  std::vector<ScannerAgreement> agreements(num_scanners);
  std::vector<Counts> points(state.landmarks.size(), Counts(num_scanners, 0));
  SharedPoses poses(rig, state.trajectory);
  for (const auto& [first, last] : ObservationsBySecond(start_ns, state)) {
    std::map<int, MeansOfScanners> means;
    for (size_t i = first; i < last; ++i) {
      const Observation& observation = state.observations[i];
      if (observation.landmark_id < 0) continue;
      const auto scanner = static_cast<size_t>(observation.scanner_index);
      const Landmark& landmark = state.landmarks[static_cast<size_t>(observation.landmark_id)];
      points[static_cast<size_t>(landmark.id)][scanner] += observation.num_points;
      const ScanPlacement placement =
          poses.Of(observation).motion.At(observation.middle_time_ns());
      const Eigen::Vector3d centroid = placement * observation.centroid().homogeneous();
      const Eigen::Vector3d normal = landmark.NormalNear(centroid);
      const double cut = (placement.leftCols<2>().transpose() * normal).norm();
      const double sigma = std::max(1e-4, cut * observation.sigma_offset_m);
      const double distance = landmark.SignedDistance(centroid);
      MeansOfScanners& of_scanners = means[landmark.id];
      of_scanners.resize(num_scanners);
      of_scanners[scanner].Add(distance, 1.0 / (sigma * sigma));
      agreements[scanner].deviation_ratio +=
          distance * distance / (sigma * sigma + kFlatness * kFlatness);
      ++agreements[scanner].num_segments;
    }
    AddDifferences(means, &agreements);
  }
  AddAloneShares(rig, state, points, &agreements);
  for (size_t i = 0; i < num_scanners; ++i) {
    ScannerAgreement& agreement = agreements[i];
    const double num_segments = std::max(1, agreement.num_segments);
    const double num_differences = std::max(1, agreement.num_differences);
    agreement.difference_m = std::sqrt(agreement.difference_m / num_differences);
    agreement.difference_ratio = std::sqrt(agreement.difference_ratio / num_differences);
    agreement.deviation_ratio = std::sqrt(agreement.deviation_ratio / num_segments);
    int64_t num_used = 0;
    if (i < activity.seconds().size()) {
      for (const auto& second : activity.seconds()[i]) {
        agreement.num_points += second.num_points;
        num_used += second.num_used;
      }
    }
    if (agreement.num_points > 0) {
      agreement.used_share =
          static_cast<double>(num_used) / static_cast<double>(agreement.num_points);
    }
  }
  return agreements;
}

std::vector<ScannerFault> FindScannerFaults(const Rig& rig,
                                            const std::vector<ScannerAgreement>& agreements,
                                            const ScannerActivity& activity) {
  return FaultFinder(rig, agreements, activity).Find();
}

}  // namespace plumbline

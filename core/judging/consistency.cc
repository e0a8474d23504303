#include "core/judging/consistency.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "core/judging/bent_surfaces.h"
#include "core/judging/degeneracy.h"
#include "core/judging/doubled_surfaces.h"
#include "core/judging/evidence.h"
#include "core/judging/imu_contradictions.h"
#include "core/judging/likely_cause.h"
#include "core/judging/open_joints.h"
#include "core/judging/passages.h"
#include "core/judging/pose_jumps.h"
#include "core/judging/revisits.h"
#include "core/judging/sightings.h"
#include "core/judging/verdict_levels.h"
#include "core/judging/wheel_slips.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// A second is in doubt if more of what it saw again than an exception contradicts other times;
// the map is contradictory from this share on.
constexpr double kContradictoryShare = 0.25;
constexpr double kMaxStddev = 0.05;  // m, of a position that is known

// Points of a second's segments with and without a plane.
SharesOverTime SegmentsWithoutPlane(const MapState& state, int64_t start_ns) {
  SharesOverTime shares;
  for (const auto& [first, last] : ObservationsBySecond(start_ns, state)) {
    Share& share = shares.emplace_back();
    for (size_t i = first; i < last; ++i) {
      const Observation& observation = state.observations[i];
      share.comparable += observation.num_points;
      if (observation.landmark_id < 0) share.contradicted += observation.num_points;
    }
  }
  return shares;
}

// Results of all tests, by second.
struct Evidence {
  ContradictedPassages passages;
  DoubledSurfaces doubled;
  std::vector<RevisitOffset> revisits;
  std::vector<SecondOfMotion> motion;
  std::vector<bool> jumps;
  std::vector<bool> unsupported_jumps;
  std::vector<bool> open_joints;
  std::vector<bool> glitches;
  BentSurfaces bent;
  SharesOverTime without_plane;
  std::vector<PositionStrength> strengths;
  std::vector<DegenerateInterval> open;
  std::vector<WheelSlip> slips;
  std::vector<ImuContradiction> against_imu;
  std::vector<double> position_stddevs_m;
  std::vector<ScannerAgreement> scanners;
  std::vector<ScannerFault> faults;
};

template <typename Element>
Element At(const std::vector<Element>& elements, size_t index) {
  return index < elements.size() ? elements[index] : Element();
}

void LogEvidence(const Rig& rig, const MapState& state, const Evidence& evidence) {
  if (!VLOG_IS_ON(1)) return;
  for (size_t s = 0; s < evidence.without_plane.size(); ++s) {
    const Share passages = At(evidence.passages.shares, s);
    const Share doubled = At(evidence.doubled.shares, s);
    const RevisitOffset revisit = At(evidence.revisits, s);
    const SecondOfMotion motion = At(evidence.motion, s);
    const PositionStrength strength = At(evidence.strengths, s);
    char text[300];
    std::snprintf(
        text,
        sizeof(text),
        "second %zu: passed %.3f of %.0f, doubled %.3f of %.0f, revisit %d segs "
        "%.3f m %.2f deg near %.2f moved %.2f, accelerations %.2f %.2f %.2f %.2f, no "
        "plane %.2f, "
        "weakest %.4f m",
        s,
        passages.value(),
        passages.comparable,
        doubled.value(),
        doubled.comparable,
        revisit.num_segments,
        revisit.translation_m,
        revisit.rotation_rad * 180.0 / M_PI,
        revisit.near_share,
        revisit.moved_share,
        motion.accelerations[SecondOfMotion::kHorizontal],
        motion.accelerations[SecondOfMotion::kVertical],
        motion.accelerations[SecondOfMotion::kYaw],
        motion.accelerations[SecondOfMotion::kTilt],
        At(evidence.without_plane, s).value(),
        strength.stddev_m);
    VLOG(1) << text;
  }
  for (size_t i = 0; i < evidence.scanners.size(); ++i) {
    const ScannerAgreement& a = evidence.scanners[i];
    VLOG(1) << "scanner " << rig.scanners[i].name << ": " << a.num_points << " points, used "
            << a.used_share << ", alone " << a.alone_share << ", difference " << a.difference_m
            << " m, ratio " << a.difference_ratio << " of " << a.num_differences
            << ", deviation ratio " << a.deviation_ratio;
  }
  for (const BentSurface& surface : evidence.bent.surfaces) {
    VLOG(1) << "plane " << surface.landmark_id << ": " << surface.num_off << " of "
            << surface.num_tiles << " places lie off, up to " << surface.largest_m << " m";
  }
  for (const DoubledSurface& pair : evidence.doubled.pairs) {
    VLOG(1) << "doubled: planes " << pair.landmark_a << " and " << pair.landmark_b << ", "
            << pair.separation_m << " m apart, over " << pair.area_m2 << " m2";
  }
  int num_planes = 0;
  double area = 0.0;
  for (const Landmark& landmark : state.landmarks) {
    if (landmark.num_segments == 0) continue;
    ++num_planes;
    area += landmark.extent.area_m2();
  }
  VLOG(1) << num_planes << " planes, " << area << " m2";
}

Evidence Collect(const Rig& rig,
                 const FinishedMap& map,
                 const ScannerActivity& activity,
                 int64_t start_ns) {
  const MapState& state = map.state;
  Evidence evidence;
  evidence.position_stddevs_m = map.position_stddevs_m;
  const Sightings sightings = CollectSightings(rig, state, start_ns);
  evidence.passages = FindContradictedPassages(state, sightings);
  evidence.doubled = FindDoubledSurfaces(state, sightings);
  evidence.revisits = CompareVisits(rig, state, sightings, start_ns);
  evidence.motion = MotionOverTime(state, start_ns);
  evidence.jumps = FindJumps(evidence.motion, evidence.passages.shares);
  evidence.unsupported_jumps = FindUnsupportedJumps(rig, state, evidence.motion, start_ns);
  // All points hold a rig that moves in the plane, or its wheels.
  if (!map.planar) evidence.open_joints = FindOpenJoints(rig, state, start_ns);
  evidence.glitches = FindGlitches(evidence.motion, SupportOverTime(state, start_ns));
  evidence.bent = FindBentSurfaces(rig, state, start_ns);
  evidence.without_plane = SegmentsWithoutPlane(state, start_ns);
  evidence.strengths = StrengthOverTime(rig, map.planar, state, start_ns);
  evidence.open = DegenerateIntervals(evidence.strengths);
  evidence.slips = FindWheelSlips(state, evidence.strengths, evidence.open, start_ns);
  evidence.against_imu =
      FindImuContradictions(state, static_cast<int>(evidence.strengths.size()), start_ns);
  evidence.scanners = CompareScanners(rig, state, activity, start_ns);
  evidence.faults = FindScannerFaults(rig, evidence.scanners, activity);
  return evidence;
}

std::string Percent(double share) {
  return std::to_string(static_cast<int>(std::lround(100.0 * share))) + " %";
}

class Judge {
 public:
  // span: the seconds since first_second that the map covers.
  Judge(const Rig& rig,
        const Evidence& evidence,
        const std::pair<size_t, size_t>& span,
        int first_second)
      : rig_(rig), evidence_(evidence), span_(span), first_second_(first_second) {}

  ConsistencyReport Report(double variance_factor) {
    JudgeShares(evidence_.passages.shares,
                evidence_.passages.without_worst,
                kMinComparable,
                kSlipped,
                "beams pass through what were surfaces at other times");
    JudgeShares(evidence_.doubled.shares,
                evidence_.doubled.shares,
                kMinComparable,
                kSlipped,
                "surfaces are doubled: seen here and, at other times, beside it");
    JudgeRevisits();
    AddIntervals(
        evidence_.jumps, kLost, "the pose jumps: the rig accelerates as it does nowhere else");
    AddIntervals(evidence_.unsupported_jumps,
                 kLost,
                 "the pose jumps where no wall, floor or ceiling shows it");
    AddIntervals(evidence_.open_joints,
                 kOpen,
                 "no wide surface shows the heading here, and hardly a wall is seen before "
                 "and after it");
    AddIntervals(evidence_.glitches,
                 kLost,
                 "for an instant segments lie off the planes, and the rig seems to jerk");
    AddIntervals(evidence_.bent.seconds,
                 kBent,
                 "floor or ceiling bends here: a gentle ramp may have been taken for level");
    JudgeStatedDeviations();
    JudgeWheels();
    JudgeImu(true, "the accelerometer reads", "m/s of velocity", 1.0);
    JudgeImu(false, "the gyroscope reads", "deg of turn", 180.0 / M_PI);
    JudgeScanners();
    Share all;
    for (const Share& share : evidence_.passages.shares) {
      all.contradicted += share.contradicted;
      all.comparable += share.comparable;
    }
    Consistency& consistency = report_.consistency;
    consistency.contradicted_share = all.value();
    consistency.degenerate_intervals = evidence_.open;
    std::sort(consistency.doubtful_intervals.begin(),
              consistency.doubtful_intervals.end(),
              [](const auto& a, const auto& b) { return a.start_s < b.start_s; });
    CountFromTheRecordingsStart(&consistency.doubtful_intervals);
    CountFromTheRecordingsStart(&consistency.degenerate_intervals);
    if (consistency.verdict != Verdict::kConsistent)
      report_.cause = LikeliestCause(candidates_);
    AddWarnings(variance_factor);
    return std::move(report_);
  }

 private:
  template <typename Interval>
  void CountFromTheRecordingsStart(std::vector<Interval>* intervals) const {
    for (Interval& interval : *intervals) {
      interval.start_s += first_second_;
      interval.end_s += first_second_;
    }
  }

  void Raise(Verdict verdict) {
    report_.consistency.verdict = std::max(report_.consistency.verdict, verdict);
  }

  // What doubtful seconds of one kind say of the cause, and what to do about it.
  struct Kind {
    CauseOrder order;
    const char* name;
    const char* next_step;
  };
  static constexpr Kind kSlipped = {
      CauseOrder::kMap,
      "the map has slipped",
      "map the recording up to there alone; if that is consistent, look at what happens then"};
  static constexpr Kind kLost = {CauseOrder::kMotion,
                                 "the rig was lost for a moment",
                                 "look at what the scanners saw there: too few surfaces, a "
                                 "jerk, or people close by; move "
                                 "slower there"};
  static constexpr Kind kBent = {
      CauseOrder::kMap,
      "a gentle ramp may have been taken for a level floor",
      "compare the heights at both ends of that floor with the building's"};
  static constexpr Kind kOpen = {CauseOrder::kMotion,
                                 "the scans left a direction open",
                                 "tilt a scanner, or go where an end of the space is in view"};

  static constexpr Kind kSlip = {CauseOrder::kMotion,
                                 "the wheels slipped where nothing else shows the way",
                                 kOpen.next_step};

  static constexpr Kind kAgainstImu = {
      CauseOrder::kMotion,
      "the map contradicts the IMU",
      "look at what the scanners saw there: a floor that rises looks level to a scanner that "
      "sees one line of it"};

  void AddIntervals(const std::vector<bool>& marked,
                    const Kind& kind,
                    const std::string& reason) {
    const std::vector<DoubtfulInterval> intervals = IntervalsOf(marked, kMaxGap, reason);
    if (intervals.empty()) return;
    char text[80];
    std::snprintf(text,
                  sizeof(text),
                  "from %.0f to %.0f s ",
                  intervals.front().start_s + first_second_,
                  intervals.front().end_s + first_second_);
    Doubt(kind.order, {kind.name, "", text + reason, kind.next_step}, intervals);
  }

  // What everything that makes a map doubtful does. intervals: one at least.
  void Doubt(CauseOrder order,
             const Cause& cause,
             const std::vector<DoubtfulInterval>& intervals) {
    Raise(Verdict::kDoubtful);
    candidates_.push_back({order, intervals.front().start_s + first_second_, cause});
    auto& all = report_.consistency.doubtful_intervals;
    all.insert(all.end(), intervals.begin(), intervals.end());
  }

  // A second is in doubt by one of the shares, or where the first makes the map contradictory.
  void JudgeShares(const SharesOverTime& shares,
                   const SharesOverTime& of_several,
                   double min_comparable,
                   const Kind& kind,
                   const std::string& reason) {
    std::vector<bool> marked;
    double largest = 0.0;
    for (size_t s = 0; s < shares.size(); ++s) {
      const Share smooth = Smoothed(shares, static_cast<int>(s));
      const Share several = Smoothed(of_several, static_cast<int>(s));
      const bool counts = smooth.comparable >= min_comparable;
      const bool is_marked =
          counts &&
          (smooth.value() > kContradictoryShare ||
           (several.comparable >= min_comparable && several.value() > kExceptionShare));
      marked.push_back(is_marked);
      if (is_marked) largest = std::max(largest, smooth.value());
    }
    AddIntervals(
        marked, kind, reason + " (up to " + Percent(largest) + " of the surface seen again)");
    if (largest > kContradictoryShare) Raise(Verdict::kContradictory);
  }

  void JudgeRevisits() {
    std::vector<bool> marked;
    double largest = 0.0;
    for (const RevisitOffset& offset : evidence_.revisits) {
      marked.push_back(offset.is_shift());
      if (offset.is_shift()) largest = std::max(largest, offset.translation_m);
    }
    char text[120];
    std::snprintf(text,
                  sizeof(text),
                  "surfaces lie up to %.0f cm off where an earlier visit saw them",
                  100.0 * largest);
    AddIntervals(marked, kSlipped, text);
  }

  // A stretch that the motion prior has bridged has honest standard deviations, but is no map
  // to rely on.
  void JudgeStatedDeviations() {
    std::vector<bool> marked;
    double largest = 0.0;
    for (const double stddev_m : evidence_.position_stddevs_m) {
      marked.push_back(stddev_m > kMaxStddev);
      largest = std::max(largest, stddev_m);
    }
    char text[160];
    std::snprintf(text,
                  sizeof(text),
                  "the position against the map's start is known to %.2g m only: where the "
                  "scans left a direction open, the motion alone tells how far the rig went",
                  largest);
    AddIntervals(marked, kOpen, text);
  }

  void JudgeWheels() {
    for (const WheelSlip& slip : evidence_.slips) {
      if (slip.sum_m < kMaxStddev) continue;
      char text[240];
      std::snprintf(text,
                    sizeof(text),
                    "from %.0f to %.0f s the wheels count %.2g m more or less than the rig "
                    "went, while the scans leave this direction open: where they slipped is "
                    "not known, and the position there to no better than that",
                    slip.start_s + first_second_,
                    slip.end_s + first_second_,
                    slip.sum_m);
      Doubt(kSlip.order,
            {kSlip.name, "", text, kSlip.next_step},
            {{slip.start_s, slip.end_s, text}});
    }
  }

  void JudgeImu(bool by_accelerometer, const char* reads, const char* of_what, double unit) {
    std::vector<bool> marked;
    ImuContradiction largest;
    for (const ImuContradiction& found : evidence_.against_imu) {
      // By as much a velocity errs after a second, and a turn a metre away.
      const double way_m = found.difference_world.norm();
      if (found.by_accelerometer != by_accelerometer || way_m < kMaxStddev) continue;
      marked.resize(static_cast<size_t>(found.second) + 1);
      marked.back() = true;
      if (way_m > largest.difference_world.norm()) largest = found;
    }
    char text[160];
    std::snprintf(
        text,
        sizeof(text),
        "%s up to %.2g %s within three seconds that the map does not have (%s, about "
        "%d s)",
        reads,
        unit * largest.difference_world.norm(),
        of_what,
        DirectionInWords(largest.difference_world.normalized()).c_str(),
        largest.second + first_second_);
    AddIntervals(marked, kAgainstImu, text);
  }

  void JudgeScanners() {
    for (const ScannerFault& fault : evidence_.faults) {
      report_.warnings.push_back(fault.sentence);
      if (!fault.contradicts) continue;
      const std::string& name = rig_.scanners[static_cast<size_t>(fault.scanner_index)].name;
      const auto [first, last] = span_;
      Doubt(CauseOrder::kScanner,
            {"scanner " + name + " is not as the rig file says",
             name,
             fault.sentence,
             "hold the recording against the rig file with plumbline_check, and measure again "
             "where " +
                 name + " sits"},
            {{static_cast<double>(first), static_cast<double>(last), fault.sentence}});
    }
  }

  void AddWarnings(double variance_factor) {
    char text[240];
    if (kDoubtfulVarianceFactor * variance_factor < 1.0) {
      std::snprintf(
          text,
          sizeof(text),
          "the scans deviate from the planes only %.2f times as far as the rig file's "
          "noise says: range_noise_m is too large, and so are the stated deviations",
          std::sqrt(variance_factor));
      report_.warnings.emplace_back(text);
    }
    for (const DegenerateInterval& interval : report_.consistency.degenerate_intervals) {
      std::snprintf(text,
                    sizeof(text),
                    "from %.0f to %.0f s the scans leave one direction of the position open "
                    "(%s): to %.2g m from a second's measurements",
                    interval.start_s,
                    interval.end_s,
                    interval.direction.c_str(),
                    interval.stddev_m);
      report_.warnings.emplace_back(text);
    }
    if (report_.consistency.verdict == Verdict::kContradictory) {
      report_.warnings.emplace_back(
          "the map contradicts the scans it was made from: do not trust it, nor the standard "
          "deviations that it states");
    }
  }

  const Rig& rig_;
  const Evidence& evidence_;
  std::pair<size_t, size_t> span_;
  int first_second_;
  std::vector<CauseCandidate> candidates_;
  ConsistencyReport report_;
};

}  // namespace

ConsistencyReport JudgeConsistency(const Rig& rig,
                                   const FinishedMap& map,
                                   const ScannerActivity& activity,
                                   int64_t start_ns) {
  const int64_t map_start_ns = start_ns + NanosecondsFromSeconds(map.first_second);
  const Evidence evidence = Collect(rig, map, activity, map_start_ns);
  LogEvidence(rig, map.state, evidence);
  return Judge(rig, evidence, activity.Span(), map.first_second).Report(map.variance_factor);
}

}  // namespace plumbline

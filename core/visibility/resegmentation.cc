#include "core/visibility/resegmentation.h"

#include <glog/logging.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "core/association/association.h"
#include "core/geometry/matrix_types.h"
#include "core/map/landmark_view.h"
#include "core/map/scan_line_batches.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/scan_reader.h"
#include "core/util/ordered_pipeline.h"
#include "core/visibility/beam_association.h"
#include "core/visibility/plane_trace.h"
#include "core/visibility/segment_cutter.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

// A surface shows single beams long before it shows segments: with loop closure off, a plane
// bounds segments for so many times the gap after which it is not taken up again.
constexpr int kGapFactor = 10;
// Of beams that no segment has, so many are placed together: a few milliseconds.
constexpr int kBeamsAtOnce = 32;
// Planes so far beside a scan line's beams have nothing to do with them: more than a cell of
// what was seen, and how near a plane has to come to what it bounds.
constexpr double kBesideBeams = 1.0;  // m
constexpr int kMaxInt = std::numeric_limits<int>::max();

using Range = SegmentCutter::Range;
using NewEnd = SegmentCutter::NewEnd;
using Ends = SegmentCutter::Ends;

// The gap of planes that bound segments.
LoopClosureOptions BoundingGap(const LoopClosureOptions& options) {
  LoopClosureOptions gap = options;
  gap.max_gap_scans = std::min(gap.max_gap_scans, kMaxInt / kGapFactor) * kGapFactor;
  return gap;
}

// Of the beams that have returned.
float FarthestRange(const ScanLine& scan_line, const Scanner& scanner) {
  constexpr size_t kLanes = 8;  // side by side
  const auto limit = static_cast<float>(scanner.max_range_m);
  std::array<float, kLanes> farthest = {};
  const std::vector<float>& ranges = scan_line.ranges;
  const auto take = [&](size_t lane, float range) {
    const float valid = range <= limit ? range : 0.0f;
    farthest[lane] = farthest[lane] < valid ? valid : farthest[lane];
  };
  size_t next = 0;
  for (; next + kLanes <= ranges.size(); next += kLanes) {
    for (size_t lane = 0; lane < kLanes; ++lane) take(lane, ranges[next + lane]);
  }
  for (; next < ranges.size(); ++next) take(0, ranges[next]);
  return *std::max_element(farthest.begin(), farthest.end());
}

// Around all beams of a scan line. The spans of a slow scanner's observations are shorter than
// the line (Observation::measurement); front: one of them.
ScanSlab SlabOf(const ScanLine& scan_line,
                const Rig& rig,
                const Observation& front,
                double farthest_m,
                SegmentCutter* cutter) {
  const std::array<int64_t, 3> times_ns = NodesOfSpan(
      BeamInstant(scan_line, 0, rig), BeamInstant(scan_line, scan_line.num_beams() - 1, rig));
  if (front.measurement.node_times_ns() == times_ns) {
    return {cutter->poses()->Of(front).motion, farthest_m, kBesideBeams};
  }
  const Scanner& scanner = rig.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const ObservationPoses poses(times_ns, scanner.body_from_scanner, cutter->sampler());
  return {poses.motion, farthest_m, kBesideBeams};
}

// Of those that for_each visits the planes that may bound the observations [first, last) of a
// scan line: what lies beside all of its beams can not. Their own planes stay, wherever these
// have been seen so far.
template <typename ForEach>
std::vector<LandmarkCandidate> CandidatesOfLine(const ScanSlab& slab,
                                                const std::deque<Observation>& observations,
                                                size_t first,
                                                size_t last,
                                                const ForEach& for_each) {
  const auto is_own = [&](const LandmarkCandidate& candidate) {
    for (size_t i = first; i < last; ++i) {
      if (observations[i].landmark_id == candidate.landmark->id) return true;
    }
    return false;
  };
  std::vector<LandmarkCandidate> candidates;
  for_each([&](const LandmarkCandidate& candidate) {
    if (slab.Touches(candidate) || is_own(candidate)) candidates.push_back(candidate);
  });
  return candidates;
}

// RecutSegments' work on single scan lines. Serves one thread.
class Recutter {
 public:
  // counts: whether openings are counted.
  Recutter(const Rig& rig,
           const MapperOptions& options,
           const std::vector<PlaneOpenings>& openings,
           bool counts,
           MapState* state)
      : rig_(rig),
        options_(options),
        counts_(counts),
        state_(state),
        openings_(openings),
        cutter_(rig, options, state->trajectory, &openings_, counts ? &counted_ : nullptr) {}
  Recutter(const Recutter&) = delete;
  Recutter& operator=(const Recutter&) = delete;

  // The observations [first, last) of a scan line; returns how many changed. Adds the short
  // runs found to these.
  int Recut(const ScanLine& scan_line,
            size_t first,
            size_t last,
            std::vector<Observation>* short_runs);
  OpeningMap TakeCounted() { return std::move(counted_); }

 private:
  // For the observations [first, last) of a scan line.
  void SetCandidates(const ScanLine& scan_line, size_t first, size_t last);
  bool RecutOne(const ScanLine& scan_line, const Ends& ends, Observation* observation);
  void AddRuns(const ScanLine& scan_line,
               const Observation& nearby,
               int first_beam,
               int last_beam,
               std::vector<Observation>* short_runs);
  void AddRun(const ScanLine& scan_line,
              const Observation& nearby,
              int landmark_id,
              const Ends& ends,
              std::vector<Observation>* short_runs);

  const Rig& rig_;
  const MapperOptions& options_;
  bool counts_;
  MapState* state_;
  const std::vector<PlaneOpenings>& openings_;
  OpeningMap counted_;
  SegmentCutter cutter_;
  std::vector<LandmarkCandidate> within_gap_;
  int candidates_scan_ = -1;
};

void Recutter::SetCandidates(const ScanLine& scan_line, size_t first, size_t last) {
  const Observation& front = state_->observations[first];
  if (front.scan_index != candidates_scan_) {
    const LoopClosureOptions gap = BoundingGap(options_.loop_closure);
    if (candidates_scan_ < 0 || !gap.enabled) {
      within_gap_ = CandidatesWithinGap(state_->landmarks, front.scan_index, gap);
    }
    candidates_scan_ = front.scan_index;
  }
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const double farthest_m = FarthestRange(scan_line, scanner);
  const Reach reach(cutter_.poses()->Of(front).world_from_scanner.translation,
                    farthest_m,
                    options_.association);
  const ScanSlab slab = SlabOf(scan_line, rig_, front, farthest_m, &cutter_);
  cutter_.SetCandidates(
      CandidatesOfLine(slab, state_->observations, first, last, [&](const auto& visit) {
        for (const LandmarkCandidate& candidate : within_gap_) {
          if (reach.Takes(candidate)) visit(candidate);
        }
      }));
}

// Of beams that no segment has, adds those that the planes explain one by one.
void Recutter::AddRuns(const ScanLine& scan_line,
                       const Observation& nearby,
                       int first_beam,
                       int last_beam,
                       std::vector<Observation>* short_runs) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  for (int first = first_beam; first <= last_beam; first += kBeamsAtOnce) {
    const int last = std::min(first + kBeamsAtOnce - 1, last_beam);
    const int64_t time_ns = BeamInstant(scan_line, (first + last) / 2, rig_);
    const ScanPlacement placement =
        PlacementOf(cutter_.sampler()->WorldFromBody(time_ns) * scanner.body_from_scanner);
    const FirstPlanes planes(scan_line, scanner, placement, cutter_.candidates(), openings_);
    for (const FirstPlanes::Run& run : planes.RunsWithin(first, last)) {
      const Landmark& landmark = *run.plane->landmark;
      if (!IsWithinGap(landmark, nearby.scan_index, options_.loop_closure)) continue;
      AddRun(scan_line,
             nearby,
             landmark.id,
             {{run.first_beam, run.trace, true}, {run.last_beam, run.trace, true}},
             short_runs);
    }
  }
}

// Beams between these ends, as far as they pass as a segment of their plane would.
void Recutter::AddRun(const ScanLine& scan_line,
                      const Observation& nearby,
                      int landmark_id,
                      const Ends& ends,
                      std::vector<Observation>* short_runs) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  Observation run;
  run.landmark_id = landmark_id;
  run.first_beam = ends.first.beam;
  run.last_beam = ends.last.beam;
  run.scan_index = nearby.scan_index;
  run.scan_line_index = nearby.scan_line_index;
  run.scanner_index = nearby.scanner_index;
  run.sigma_offset_m = static_cast<float>(scanner.range_noise_m /
                                          std::sqrt(run.last_beam - run.first_beam + 1));
  run.sigma_direction_rad = static_cast<float>(M_PI);  // not known without the plane
  SegmentMeasurement nodes;
  nodes.node_times_ns = NodesOfSpan(BeamInstant(scan_line, run.first_beam, rig_),
                                    BeamInstant(scan_line, run.last_beam, rig_));
  run.measurement = StoredMeasurement(nodes, {});
  run.points = nearby.points;  // so that Replace keeps them too
  Range beams;
  cutter_.LeaveOutHidden(scan_line, ends, &beams, &run);
  cutter_.Replace(scan_line, beams, Matrix6d::Zero(), &run);
  if (run.landmark_id >= 0) short_runs->push_back(std::move(run));
}

// Whether it changed.
bool Recutter::RecutOne(const ScanLine& scan_line,
                        const Ends& ends,
                        Observation* observation) {
  Range range;
  const bool is_another = cutter_.LeaveOutHidden(scan_line, ends, &range, observation);
  // While openings are still counted, a segment that keeps its beams keeps its line too.
  if (is_another || (!counts_ && observation->taken_to != observation->landmark_id)) {
    cutter_.Replace(scan_line, range, Matrix6d::Zero(), observation);
  }
  return is_another;
}

int Recutter::Recut(const ScanLine& scan_line,
                    size_t first,
                    size_t last,
                    std::vector<Observation>* short_runs) {
  const auto& observations = state_->observations;
  SetCandidates(scan_line, first, last);
  const std::vector<Ends> ends = cutter_.FindEnds(scan_line, observations, first, last);
  int num_changed = 0;
  int next = 0;  // beam that no segment has taken
  for (size_t i = 0; i < ends.size(); ++i) {
    Observation& observation = state_->observations[first + i];
    if (observation.landmark_id < 0) continue;
    if (RecutOne(scan_line, ends[i], &observation)) ++num_changed;
    if (observation.landmark_id < 0) continue;
    AddRuns(scan_line, observations[first], next, observation.first_beam - 1, short_runs);
    next = observation.last_beam + 1;
  }
  AddRuns(scan_line, observations[first], next, scan_line.num_beams() - 1, short_runs);
  return num_changed;
}

}  // namespace

int RecutSegments(const Rig& rig,
                  const MapperOptions& options,
                  RecordingReader* recording,
                  const std::vector<PlaneOpenings>& openings,
                  OpeningMap* counted,
                  MapState* state) {
  CHECK_EQ(openings.size(), state->landmarks.size());
  // None of the new runs is to be taken for an old one.
  const int revision = state->short_runs.empty() ? 1 : state->short_runs.front().revision + 1;
  state->short_runs.clear();
  struct Item {
    LineBlock block;
    std::vector<Observation> short_runs;
    int num_changed = 0;
  };
  tbb::enumerable_thread_specific<Recutter> recutters(
      [&] { return Recutter(rig, options, openings, counted != nullptr, state); });
  LineBlockReader reader(recording, *state);
  std::deque<Observation> short_runs;
  int num_changed = 0;
  ForEachInOrder<Item>([&](Item* item) { return reader.Next(&item->block); },
                       [&](Item* item) {
                         Recutter& recutter = recutters.local();
                         item->num_changed = 0;
                         for (const LineBlock::Line& line : item->block.lines) {
                           if (line.first_observation == line.last_observation) continue;
                           item->num_changed += recutter.Recut(line.scan_line,
                                                               line.first_observation,
                                                               line.last_observation,
                                                               &item->short_runs);
                         }
                       },
                       [&](Item* item) {
                         num_changed += item->num_changed;
                         for (Observation& run : item->short_runs) {
                           run.revision = revision;
                           short_runs.push_back(std::move(run));
                         }
                         item->short_runs.clear();
                       });
  state->short_runs = std::move(short_runs);
  if (counted != nullptr) {
    for (Recutter& recutter : recutters) counted->Add(recutter.TakeCounted());
  }
  return num_changed;
}

void RecutScan(const Rig& rig,
               const MapperOptions& options,
               const Scan& scan,
               size_t first_observation,
               const Matrix6d& pose_covariance,
               MapState* state) {
  std::deque<Observation>& observations = state->observations;
  if (first_observation >= observations.size()) return;
  const Observation& front = observations[first_observation];
  SegmentCutter cutter(rig, options, state->trajectory, nullptr, nullptr);
  const LoopClosureOptions gap = BoundingGap(options.loop_closure);
  const Reach reach = ReachOfScan(rig,
                                  observations,
                                  first_observation,
                                  cutter.poses()->Of(front).world_from_body.translation,
                                  pose_covariance,
                                  options.association);
  const std::vector<LandmarkCandidate> of_scan =
      CandidatesWithin(reach, LandmarksWithinGap{state->landmarks, front.scan_index, gap});
  size_t last = first_observation;
  for (size_t line = 0; line < scan.scan_lines.size(); ++line) {
    const ScanLine& scan_line = scan.scan_lines[line];
    const size_t first = last;
    while (last < observations.size() &&
           observations[last].scan_line_index == scan.scan_line_indices[line]) {
      ++last;
    }
    if (first == last) continue;
    const Scanner& scanner = rig.scanners[static_cast<size_t>(scan_line.scanner_index)];
    const ScanSlab slab = SlabOf(
        scan_line, rig, observations[first], FarthestRange(scan_line, scanner), &cutter);
    cutter.SetCandidates(
        CandidatesOfLine(slab, observations, first, last, [&](const auto& visit) {
          for (const LandmarkCandidate& candidate : of_scan) visit(candidate);
        }));
    const std::vector<Ends> ends = cutter.FindEnds(scan_line, observations, first, last);
    for (size_t i = first; i < last; ++i) {
      Observation& observation = observations[i];
      // Before the pose was known as well, its plane may have seemed nearer.
      if (cutter.Find(observation.landmark_id) == nullptr) continue;
      Range range;
      cutter.LeaveOutHidden(scan_line, ends[i - first], &range, &observation);
      cutter.Replace(scan_line, range, pose_covariance, &observation);
    }
  }
}

}  // namespace plumbline

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
#include "core/map/scan_line_batches.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/scan_reader.h"
#include "core/surface/landmark_view.h"
#include "core/util/ordered_pipeline.h"
#include "core/visibility/beam_association.h"
#include "core/visibility/beam_runs.h"
#include "core/visibility/beam_tests.h"
#include "core/visibility/plane_trace.h"
#include "core/visibility/scan_line_resegmenter.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

// With loop closure off, a plane bounds segments for this multiple of the gap after which it
// is not taken up again: a surface shows single beams long before it shows segments.
constexpr int kGapFactor = 10;

using BeamRange = ScanLineResegmenter::BeamRange;
using NewEnd = ScanLineResegmenter::NewEnd;
using Ends = ScanLineResegmenter::Ends;

// The gap of planes that bound segments.
LoopClosureOptions BoundingGap(const LoopClosureOptions& options) {
  LoopClosureOptions gap = options;
  gap.max_gap_scans =
      std::min(gap.max_gap_scans, std::numeric_limits<int>::max() / kGapFactor) * kGapFactor;
  return gap;
}

// The largest range of the beams that have returned.
float FarthestRange(const ScanLine& scan_line, const Scanner& scanner) {
  constexpr size_t kSimdWidth = 8;  // side by side
  const auto limit = static_cast<float>(scanner.max_range_m);
  std::array<float, kSimdWidth> farthest = {};
  const std::vector<float>& ranges = scan_line.ranges;
  const auto take = [&](size_t column, float range) {
    const float valid = range <= limit ? range : 0.0f;
    farthest[column] = farthest[column] < valid ? valid : farthest[column];
  };
  size_t next = 0;
  for (; next + kSimdWidth <= ranges.size(); next += kSimdWidth) {
    for (size_t column = 0; column < kSimdWidth; ++column) take(column, ranges[next + column]);
  }
  for (; next < ranges.size(); ++next) take(0, ranges[next]);
  return *std::max_element(farthest.begin(), farthest.end());
}

// The slab around all beams of a scan line. The spans of a slow scanner's observations are
// shorter than the line (Observation::measurement); front: one of the line's observations.
ScanSlab SlabOf(const ScanLine& scan_line,
                const Rig& rig,
                const Observation& front,
                double farthest_m,
                ScanLineResegmenter* resegmenter) {
  const std::array<int64_t, 3> times_ns = NodesOfSpan(
      BeamInstant(scan_line, 0, rig), BeamInstant(scan_line, scan_line.num_beams() - 1, rig));
  if (front.measurement.node_times_ns() == times_ns) {
    return {resegmenter->poses()->Of(front).motion, farthest_m, kConcernReach};
  }
  const Scanner& scanner = rig.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const ObservationPoses poses(times_ns, scanner, resegmenter->sampler());
  return {poses.motion, farthest_m, kConcernReach};
}

// Selects, from the planes that for_each visits, those that may bound the observations
// [first, last) of a scan line: planes beside all of its beams can not. The observations' own
// planes stay, wherever these have been seen so far.
template <typename ForEach>
std::vector<LandmarkView> ViewsOfLine(const ScanSlab& slab,
                                      const std::deque<Observation>& observations,
                                      size_t first,
                                      size_t last,
                                      const ForEach& for_each) {
  const auto is_own = [&](const LandmarkView& view) {
    for (size_t i = first; i < last; ++i) {
      if (observations[i].landmark_id == view.landmark->id) return true;
    }
    return false;
  };
  std::vector<LandmarkView> views;
  for_each([&](const LandmarkView& view) {
    if (slab.Touches(view) || is_own(view)) views.push_back(view);
  });
  return views;
}

// The ends of a run of single beams: other surfaces bound it.
Ends EndsOf(const BeamAssociation::PlaneBeams& run) {
  return {{run.first_beam, run.trace, true}, {run.last_beam, run.trace, true}};
}

// Does ResegmentRecording's work on single scan lines. Serves one thread.
class RecordingResegmenter {
 public:
  // counts: whether openings are counted.
  RecordingResegmenter(const Rig& rig,
                       const MapperOptions& options,
                       const PoseCovarianceAt& pose_covariance,
                       const std::vector<PlaneOpenings>& openings,
                       bool counts,
                       MapState* state)
      : rig_(rig),
        options_(options),
        pose_covariance_(pose_covariance),
        counts_(counts),
        is_planar_(IsPlanar(rig)),
        state_(state),
        openings_(openings),
        resegmenter_(
            rig, options, state->trajectory, &openings_, counts ? &counted_ : nullptr) {}
  RecordingResegmenter(const RecordingResegmenter&) = delete;
  RecordingResegmenter& operator=(const RecordingResegmenter&) = delete;

  // Resegments the observations [first, last) of a scan line and returns how many changed.
  // Appends the sub-minimum segments found.
  int Resegment(const ScanLine& scan_line,
                size_t first,
                size_t last,
                std::vector<Observation>* sub_minimum_segments);
  OccupancyGrids TakeCounted() { return std::move(counted_); }

 private:
  // Selects the planes for the observations [first, last) of a scan line.
  void SetViews(const ScanLine& scan_line, size_t first, size_t last);
  // Resegments a scan line by which surface each of its beams lies on.
  int ResegmentByBeams(const ScanLine& scan_line,
                       size_t first,
                       size_t last,
                       std::vector<Observation>* sub_minimum_segments);
  // The scan plane's placement at the instant of a beam.
  ScanPlacement PlacementAt(const ScanLine& scan_line, int beam);
  // Takes an observation to its plane between the ends, or to its arc on the range. Returns
  // whether it changed, which those on arcs do not count.
  bool ResegmentOne(const ScanLine& scan_line,
                    const Ends& ends,
                    const BeamRange& on_arc,
                    Observation* observation);
  // The beams of the observation `at` of [first, last), and those between it and the ones on
  // the same surface beside it.
  BeamRange BetweenOthers(size_t first, size_t last, size_t at) const;
  void AddSubMinimumSegments(const ScanLine& scan_line,
                             const Observation& nearby,
                             int first_beam,
                             int last_beam,
                             std::vector<Observation>* sub_minimum_segments);
  void AddSubMinimumSegment(const ScanLine& scan_line,
                            const Observation& nearby,
                            int landmark_id,
                            const Ends& ends,
                            std::vector<Observation>* sub_minimum_segments);
  // Whether the pose predicts the distance of these beams from their surface better than one
  // of them measures it.
  bool AreBeamsPredicted(const Observation& segment);

  const Rig& rig_;
  const MapperOptions& options_;
  const PoseCovarianceAt& pose_covariance_;
  Matrix6d covariance_of_line_ = Matrix6d::Zero();  // of the pose amid the scan line
  bool counts_;
  bool is_planar_;
  MapState* state_;
  const std::vector<PlaneOpenings>& openings_;
  OccupancyGrids counted_;
  ScanLineResegmenter resegmenter_;
  std::vector<LandmarkView> within_gap_;
  int views_scan_ = -1;
};

void RecordingResegmenter::SetViews(const ScanLine& scan_line, size_t first, size_t last) {
  const Observation& front = state_->observations[first];
  if (front.scan_index != views_scan_) {
    const LoopClosureOptions gap = BoundingGap(options_.loop_closure);
    if (views_scan_ < 0 || !gap.enabled) {
      within_gap_ = ViewsWithinGap(state_->landmarks, front.scan_index, gap);
    }
    views_scan_ = front.scan_index;
  }
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const double farthest_m = FarthestRange(scan_line, scanner);
  const Reach reach(resegmenter_.poses()->Of(front).world_from_scanner.translation,
                    farthest_m,
                    options_.association);
  const ScanSlab slab = SlabOf(scan_line, rig_, front, farthest_m, &resegmenter_);
  resegmenter_.SetViews(
      ViewsOfLine(slab, state_->observations, first, last, [&](const auto& visit) {
        for (const LandmarkView& view : within_gap_) {
          if (reach.Takes(view)) visit(view);
        }
      }));
}

ScanPlacement RecordingResegmenter::PlacementAt(const ScanLine& scan_line, int beam) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const int64_t time_ns = BeamInstant(scan_line, beam, rig_);
  return PlacementOf(resegmenter_.sampler()->WorldFromBody(time_ns, scanner.delay_s) *
                     scanner.BodyFromScanner(time_ns));
}

// Adds, from beams that no segment has, those that single planes explain.
void RecordingResegmenter::AddSubMinimumSegments(
    const ScanLine& scan_line,
    const Observation& nearby,
    int first_beam,
    int last_beam,
    std::vector<Observation>* sub_minimum_segments) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  for (int first = first_beam; first <= last_beam; first += kBeamsPerPlacement) {
    const int last = std::min(first + kBeamsPerPlacement - 1, last_beam);
    const ScanPlacement placement = PlacementAt(scan_line, (first + last) / 2);
    const BeamAssociation planes(
        scan_line, scanner, placement, resegmenter_.views(), openings_);
    for (const BeamAssociation::PlaneBeams& beams : planes.Associate(first, last)) {
      const Landmark& landmark = *beams.plane->landmark;
      if (!IsWithinGap(landmark, nearby.scan_index, options_.loop_closure)) continue;
      AddSubMinimumSegment(
          scan_line, nearby, landmark.id, EndsOf(beams), sub_minimum_segments);
    }
  }
}

// Adds the beams between these ends, as far as they would pass as a segment of their plane.
void RecordingResegmenter::AddSubMinimumSegment(
    const ScanLine& scan_line,
    const Observation& nearby,
    int landmark_id,
    const Ends& ends,
    std::vector<Observation>* sub_minimum_segments) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  Observation segment;
  segment.landmark_id = landmark_id;
  segment.first_beam = ends.first.beam;
  segment.last_beam = ends.last.beam;
  segment.scan_index = nearby.scan_index;
  segment.scan_line_index = nearby.scan_line_index;
  segment.scanner_index = nearby.scanner_index;
  segment.sigma_offset_m = static_cast<float>(
      scanner.RangeStddev(scan_line.ranges[static_cast<size_t>(segment.first_beam)]) /
      std::sqrt(segment.last_beam - segment.first_beam + 1));
  segment.sigma_direction_rad = static_cast<float>(M_PI);  // not known without the plane
  SegmentMeasurement nodes;
  nodes.node_times_ns = NodesOfSpan(BeamInstant(scan_line, segment.first_beam, rig_),
                                    BeamInstant(scan_line, segment.last_beam, rig_));
  segment.measurement = PackedSegment(nodes, {});
  segment.points = nearby.points;  // so that Replace keeps them too
  const Landmark& landmark = state_->landmarks[static_cast<size_t>(landmark_id)];
  if (!resegmenter_.TakeToArc(
          scan_line, landmark, {segment.first_beam, segment.last_beam}, &segment)) {
    BeamRange beams;
    resegmenter_.ExcludeOccluded(scan_line, ends, &beams, &segment);
    resegmenter_.Replace(scan_line, beams, Matrix6d::Zero(), &segment);
  }
  if (segment.landmark_id >= 0 && AreBeamsPredicted(segment)) {
    sub_minimum_segments->push_back(std::move(segment));
  }
}

bool RecordingResegmenter::AreBeamsPredicted(const Observation& segment) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(segment.scanner_index)];
  const double beam_stddev = scanner.RangeStddev(segment.centroid().norm());
  const ObservationPoses& poses = resegmenter_.poses()->Of(segment);
  const Eigen::Vector3d centroid_world =
      poses.motion.ToWorld(segment.centroid(), segment.middle_time_ns());
  const LandmarkView surface(state_->landmarks[static_cast<size_t>(segment.landmark_id)]);
  const Eigen::Vector3d normal = surface.UnitNormalNear(centroid_world);
  Eigen::Matrix<double, 6, 1> by_pose;
  by_pose << (centroid_world - poses.world_from_body.translation).cross(normal), normal;
  return by_pose.dot(covariance_of_line_ * by_pose) < beam_stddev * beam_stddev;
}

bool RecordingResegmenter::ResegmentOne(const ScanLine& scan_line,
                                        const Ends& ends,
                                        const BeamRange& on_arc,
                                        Observation* observation) {
  const Landmark& own = state_->landmarks[static_cast<size_t>(observation->landmark_id)];
  if (resegmenter_.TakeToArc(scan_line, own, on_arc, observation)) return false;
  BeamRange range;
  const bool is_another = resegmenter_.ExcludeOccluded(scan_line, ends, &range, observation);
  // While openings are still counted, a segment that keeps its beams keeps its line too.
  if (is_another || (!counts_ && observation->taken_to != observation->landmark_id)) {
    resegmenter_.Replace(scan_line, range, Matrix6d::Zero(), observation);
  }
  if (!counts_ && observation->landmark_id >= 0) EndAtPoints(scan_line, observation);
  return is_another;
}

BeamRange RecordingResegmenter::BetweenOthers(size_t first, size_t last, size_t at) const {
  const auto& observations = state_->observations;
  const auto is_on_same = [&](size_t other) {
    return observations[other].landmark_id == observations[at].landmark_id;
  };
  BeamRange range = {observations[at].first_beam, observations[at].last_beam};
  if (at > first && is_on_same(at - 1)) range.first = observations[at - 1].last_beam + 1;
  if (at + 1 < last && is_on_same(at + 1)) range.last = observations[at + 1].first_beam - 1;
  return range;
}

int RecordingResegmenter::ResegmentByBeams(const ScanLine& scan_line,
                                           size_t first,
                                           size_t last,
                                           std::vector<Observation>* sub_minimum_segments) {
  const Observation nearby = state_->observations[first];
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const BeamRuns found = FindBeamRuns(
      scan_line,
      scanner,
      [&](int beam) { return PlacementAt(scan_line, beam); },
      resegmenter_.views(),
      openings_);
  std::vector<bool> is_taken(found.runs.size(), false);
  int num_changed = 0;
  for (size_t i = first; i < last; ++i) {
    Observation& observation = state_->observations[i];
    if (observation.landmark_id < 0) continue;
    const size_t at = found.RunOf(observation, is_taken);
    if (at == found.runs.size()) {
      observation.landmark_id = -1;
      observation.num_points = 0;
      ++num_changed;
      continue;
    }
    is_taken[at] = true;
    observation.excluded_beams = found.between;
    const BeamAssociation::PlaneBeams& run = found.runs[at];
    const Ends ends = {{run.first_beam, run.trace, run.is_first_met},
                       {run.last_beam, run.trace, run.is_last_met}};
    const BeamRange beams = {run.first_beam, run.last_beam};
    if (ResegmentOne(scan_line, ends, beams, &observation)) ++num_changed;
  }
  for (size_t i = 0; i < found.runs.size(); ++i) {
    if (is_taken[i]) continue;
    const BeamAssociation::PlaneBeams& run = found.runs[i];
    const int id = run.plane->landmark->id;
    if (!IsWithinGap(*run.plane->landmark, nearby.scan_index, options_.loop_closure)) continue;
    AddSubMinimumSegment(scan_line, nearby, id, EndsOf(run), sub_minimum_segments);
  }
  return num_changed;
}

int RecordingResegmenter::Resegment(const ScanLine& scan_line,
                                    size_t first,
                                    size_t last,
                                    std::vector<Observation>* sub_minimum_segments) {
  const auto& observations = state_->observations;
  SetViews(scan_line, first, last);
  covariance_of_line_ = pose_covariance_(observations[first].middle_time_ns());
  // What ends are found by is about planes alone, and is exact for narrow faces; a level
  // scanner looks at furniture, whose faces take beams of each other by it. Before the
  // openings are known, and the arcs have settled, the segmentation knows the beams of an arc
  // better.
  if (!counts_ && (is_planar_ || resegmenter_.views().HasSoftEdges())) {
    return ResegmentByBeams(scan_line, first, last, sub_minimum_segments);
  }
  const std::vector<Ends> ends = resegmenter_.FindEnds(scan_line, observations, first, last);
  int num_changed = 0;
  int next = 0;  // beam that no segment has taken
  for (size_t i = 0; i < ends.size(); ++i) {
    Observation& observation = state_->observations[first + i];
    if (observation.landmark_id < 0) continue;
    const BeamRange between = BetweenOthers(first, last, first + i);
    if (ResegmentOne(scan_line, ends[i], between, &observation)) ++num_changed;
    if (observation.landmark_id < 0) continue;
    AddSubMinimumSegments(scan_line,
                          observations[first],
                          next,
                          observation.first_beam - 1,
                          sub_minimum_segments);
    next = observation.last_beam + 1;
  }
  AddSubMinimumSegments(
      scan_line, observations[first], next, scan_line.num_beams() - 1, sub_minimum_segments);
  return num_changed;
}

}  // namespace

int ResegmentRecording(const Rig& rig,
                       const MapperOptions& options,
                       RecordingReader* recording,
                       const PoseCovarianceAt& pose_covariance,
                       const std::vector<PlaneOpenings>& openings,
                       OccupancyGrids* counted,
                       MapState* state) {
  CHECK_EQ(openings.size(), state->landmarks.size());
  // None of the new sub-minimum segments is to be taken for an old one.
  const int revision = state->sub_minimum_segments.empty()
                           ? 1
                           : state->sub_minimum_segments.front().revision + 1;
  state->sub_minimum_segments.clear();
  struct Item {
    ScanLineBatch block;
    std::vector<Observation> sub_minimum_segments;
    int num_changed = 0;
  };
  tbb::enumerable_thread_specific<RecordingResegmenter> resegmenters([&] {
    return RecordingResegmenter(
        rig, options, pose_covariance, openings, counted != nullptr, state);
  });
  ScanLineBatchReader reader(recording, *state);
  std::deque<Observation> sub_minimum_segments;
  int num_changed = 0;
  RunOrderedPipeline<Item>([&](Item* item) { return reader.Next(&item->block); },
                           [&](Item* item) {
                             RecordingResegmenter& resegmenter = resegmenters.local();
                             item->num_changed = 0;
                             for (const ScanLineBatch::Line& line : item->block.lines) {
                               if (line.first_observation == line.last_observation) continue;
                               item->num_changed +=
                                   resegmenter.Resegment(line.scan_line,
                                                         line.first_observation,
                                                         line.last_observation,
                                                         &item->sub_minimum_segments);
                             }
                           },
                           [&](Item* item) {
                             num_changed += item->num_changed;
                             for (Observation& segment : item->sub_minimum_segments) {
                               segment.revision = revision;
                               sub_minimum_segments.push_back(std::move(segment));
                             }
                             item->sub_minimum_segments.clear();
                           });
  state->sub_minimum_segments = std::move(sub_minimum_segments);
  if (counted != nullptr) {
    for (RecordingResegmenter& resegmenter : resegmenters)
      counted->Add(resegmenter.TakeCounted());
  }
  return num_changed;
}

void ResegmentScan(const Rig& rig,
                   const MapperOptions& options,
                   const Scan& scan,
                   size_t first_observation,
                   const Matrix6d& pose_covariance,
                   MapState* state) {
  std::deque<Observation>& observations = state->observations;
  if (first_observation >= observations.size()) return;
  const Observation& front = observations[first_observation];
  ScanLineResegmenter resegmenter(rig, options, state->trajectory, nullptr, nullptr);
  const LoopClosureOptions gap = BoundingGap(options.loop_closure);
  const Reach reach = ReachOfScan(rig,
                                  observations,
                                  first_observation,
                                  resegmenter.poses()->Of(front).world_from_body.translation,
                                  pose_covariance,
                                  options.association);
  const std::vector<LandmarkView> of_scan =
      ViewsWithin(reach, LandmarksWithinGap{state->landmarks, front.scan_index, gap});
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
        scan_line, rig, observations[first], FarthestRange(scan_line, scanner), &resegmenter);
    resegmenter.SetViews(ViewsOfLine(slab, observations, first, last, [&](const auto& visit) {
      for (const LandmarkView& view : of_scan) visit(view);
    }));
    const std::vector<Ends> ends = resegmenter.FindEnds(scan_line, observations, first, last);
    for (size_t i = first; i < last; ++i) {
      Observation& observation = observations[i];
      // While the pose was less well known, the plane may have seemed nearer.
      if (resegmenter.Find(observation.landmark_id) == nullptr) continue;
      BeamRange range;
      resegmenter.ExcludeOccluded(scan_line, ends[i - first], &range, &observation);
      resegmenter.Replace(scan_line, range, pose_covariance, &observation);
    }
  }
}

}  // namespace plumbline

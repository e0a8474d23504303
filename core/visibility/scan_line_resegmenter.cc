#include "core/visibility/scan_line_resegmenter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/association/surface_levels.h"
#include "core/geometry/matrix_types.h"
#include "core/sensor/beam_instant.h"
#include "core/surface/landmark_view.h"
#include "core/util/quantiles.h"
#include "core/visibility/beam_tests.h"
#include "core/visibility/occlusion.h"

namespace plumbline {
// An end of a segment, the trace of its plane there, and where the trace meets other planes,
// from outside inwards.
struct ScanLineResegmenter::TracedEnd {
  const ScanLine& scan_line;
  const LandmarkView& own;
  const FreeEnd& end;
  ScanPlacement placement;  // at the end's instant
  Trace trace;
  std::vector<PlaneIntersection> intersections;
};

// The beams that other planes leave to a segment, counted outwards from its end.
struct ScanLineResegmenter::Bounds {
  int last = 0;  // the segment's last beam: negative where it is to become shorter
  int free = 0;  // the outermost beam that it may take
};

// The planes that meet a segment's plane where the segment ends now.
struct ScanLineResegmenter::IntersectionsAtEnd {
  bool any = false;
  bool goes_on = false;    // the segment's plane goes on beyond one of them
  bool at_corner = false;  // one of them is a wall
};

// A segment that reaches beyond an intersection ends there, unless it still follows its plane
// where the other would be more than far_m off.
ScanLineResegmenter::Bounds ScanLineResegmenter::FindBounds(const TracedEnd& traced,
                                                            double far_m) {
  Bounds bounds;
  std::vector<Trace> outside;
  for (const PlaneIntersection& intersection : traced.intersections) {
    if (intersection.last >= 0) {
      bounds.free = intersection.last;
      outside.push_back(intersection.other);
      continue;
    }
    const Eigen::Vector2d direction =
        traced.scan_line.BeamDirection(traced.end.beam + traced.end.step * bounds.last);
    const double own_range = traced.trace.RangeAlong(direction);
    double other_range = intersection.other.RangeAlong(direction);
    // Planes behind may be hidden by a plane that meets this one farther out.
    for (const Trace& nearer : outside) {
      const double range = nearer.RangeAlong(direction);
      if (range > own_range) other_range = std::min(other_range, range);
    }
    if (intersection.is_edge || std::abs(own_range - other_range) < far_m) {
      bounds.last = intersection.last;
    }
  }
  return bounds;
}

ScanLineResegmenter::IntersectionsAtEnd ScanLineResegmenter::IntersectionsAt(
    const TracedEnd& traced, int last_beam) {
  IntersectionsAtEnd at_end;
  for (const PlaneIntersection& intersection : traced.intersections) {
    const int beam = traced.end.beam + traced.end.step * intersection.last;
    if (std::abs(beam - last_beam) > 1) continue;
    at_end.any = true;
    at_end.goes_on = at_end.goes_on || intersection.goes_on;
    at_end.at_corner = at_end.at_corner || intersection.at_wall;
  }
  return at_end;
}

ScanLineResegmenter::ScanLineResegmenter(const Rig& rig,
                                         const MapperOptions& options,
                                         const Trajectory& trajectory,
                                         const std::vector<PlaneOpenings>* openings,
                                         OccupancyGrids* counted)
    : rig_(rig),
      options_(options),
      openings_(openings),
      counted_(counted),
      sampler_(trajectory),
      poses_(rig, trajectory) {}

const LandmarkView* ScanLineResegmenter::Find(int landmark_id) const {
  for (const LandmarkView& view : views_.planes()) {
    if (view.landmark->id == landmark_id) return &view;
  }
  return nullptr;
}

int ScanLineResegmenter::Extend(const ScanLine& scan_line,
                                const Trace& trace,
                                const FreeEnd& end,
                                int to) const {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  int last = end.beam;
  if (to == end.beam) return last;
  // Planes may meet beyond the scan line.
  to = std::clamp(to, 0, scan_line.num_beams() - 1);
  for (int beam = end.beam + end.step; end.step * (to - beam) >= 0; beam += end.step) {
    const double range = scan_line.ranges[static_cast<size_t>(beam)];
    if (!scanner.IsValidRange(range)) break;
    const double expected = trace.RangeAlong(scan_line.BeamDirection(beam));
    if (!(std::abs(range - expected) < kOutlierSigmas * scanner.RangeStddev(expected))) break;
    last = beam;
  }
  return last;
}

ScanLineResegmenter::TracedEnd ScanLineResegmenter::TraceEnd(const ScanLine& scan_line,
                                                             const Observation& observation,
                                                             const LandmarkView& own,
                                                             const FreeEnd& end) {
  const bool at_last = end.step > 0;
  const ScanPlacement placement =
      poses_.Of(observation)
          .motion.At(at_last ? observation.end_time_ns() : observation.start_time_ns());
  const Eigen::Vector2d p = at_last ? observation.end() : observation.start();
  const Trace trace(placement, own);
  return {scan_line,
          own,
          end,
          placement,
          trace,
          FindIntersections(
              {scan_line, placement, own, trace}, placement * p.homogeneous(), views_, end)};
}

ScanLineResegmenter::NewEnd ScanLineResegmenter::FindEnd(const ScanLine& scan_line,
                                                         const Observation& observation,
                                                         const FreeEnd& end) {
  const LandmarkView* own = Find(observation.landmark_id);
  if (own == nullptr) return {end.beam};
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
  const TracedEnd traced = TraceEnd(scan_line, observation, *own, end);
  const double range = (end.step > 0 ? observation.end() : observation.start()).norm();
  const Bounds bounds = FindBounds(traced, kFarSigmas * scanner.RangeStddev(range));
  NewEnd result{end.beam + end.step * bounds.last, traced.trace};
  if (bounds.last == 0) {
    result.beam = Extend(scan_line, traced.trace, end, end.beam + end.step * bounds.free);
  }
  const IntersectionsAtEnd at_end = IntersectionsAt(traced, result.beam);
  result.is_met = at_end.any;
  if (counted_ != nullptr) CountAtEnd(traced, result.beam, at_end);
  return result;
}

void ScanLineResegmenter::CountAtEnd(const TracedEnd& traced,
                                     int last_beam,
                                     const IntersectionsAtEnd& at_end) {
  const FreeEnd& end = traced.end;
  int on_plane = last_beam;
  while (on_plane != end.middle && IsOff(traced.scan_line, traced.trace, on_plane)) {
    on_plane -= end.step;
  }
  const Landmark& landmark = *traced.own.landmark;
  const auto scanner_index = static_cast<size_t>(traced.scan_line.scanner_index);
  const SegmentEnd counted_end{traced.scan_line,
                               rig_.scanners[scanner_index],
                               traced.placement,
                               traced.trace,
                               landmark,
                               on_plane,
                               end.step,
                               end.middle};
  // Walls hide the floor beyond them: for floors, beams beyond ends at walls show openings
  // too. So do beams beyond a wall's ends at the jambs of its doors.
  const bool shows_openings =
      !at_end.any || at_end.goes_on || TraitsOf(landmark).goes_on_behind_walls;
  if (shows_openings) CountPassages(counted_end, counted_);
  // At a ceiling, beams past a wall's free edge may be among a segment's last; at a corner it
  // is known where the wall ends.
  if (shows_openings || at_end.at_corner) CountHitsAtEnd(counted_end, counted_);
}

std::vector<ScanLineResegmenter::Ends> ScanLineResegmenter::FindEnds(
    const ScanLine& scan_line,
    const std::deque<Observation>& observations,
    size_t first,
    size_t last) {
  std::vector<Ends> ends;
  for (size_t i = first; i < last; ++i) {
    const Observation& observation = observations[i];
    Ends now{{observation.first_beam}, {observation.last_beam}};
    if (observation.landmark_id >= 0) {
      const int middle = (now.first.beam + now.last.beam) / 2;
      FreeEnd start{now.first.beam, -1, -1, middle, -1};
      FreeEnd end{now.last.beam, 1, scan_line.num_beams(), middle, -1};
      if (i > first) {
        start.limit = observations[i - 1].last_beam;
        start.neighbour_landmark = observations[i - 1].landmark_id;
      }
      if (i + 1 < last) {
        end.limit = observations[i + 1].first_beam;
        end.neighbour_landmark = observations[i + 1].landmark_id;
      }
      now = {FindEnd(scan_line, observation, start), FindEnd(scan_line, observation, end)};
      if (counted_ != nullptr) CountHits(scan_line, observation, now);
    }
    // Each end has its own pose: neighbours may differ by a beam on where they meet.
    if (!ends.empty()) {
      now.first.beam = std::max(now.first.beam, ends.back().last.beam + 1);
    }
    ends.push_back(now);
  }
  return ends;
}

void ScanLineResegmenter::CountHits(const ScanLine& scan_line,
                                    const Observation& observation,
                                    const Ends& ends) {
  const LandmarkView* own = Find(observation.landmark_id);
  if (own == nullptr) return;
  Occlusion{scan_line,
            rig_.scanners[static_cast<size_t>(observation.scanner_index)],
            poses_.Of(observation),
            *own,
            ends.first.beam,
            ends.last.beam}
      .CountHits(counted_);
}

bool ScanLineResegmenter::IsOff(const ScanLine& scan_line,
                                const Trace& trace,
                                int beam) const {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const double range = scan_line.ranges[static_cast<size_t>(beam)];
  const double expected = trace.RangeAlong(scan_line.BeamDirection(beam));
  return !(std::abs(range - expected) < kSignificantStddevs * scanner.RangeStddev(expected));
}

std::vector<int> ScanLineResegmenter::OccludedBeamsOf(const ScanLine& scan_line,
                                                      const Observation& observation,
                                                      const LandmarkView& own,
                                                      const BeamRange& range) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
  const Occlusion occlusion{
      scan_line, scanner, poses_.Of(observation), own, range.first, range.last};
  std::vector<int> beams = occlusion.BehindCorners(views_.planes());
  const std::vector<int> others =
      openings_ != nullptr
          ? occlusion.InOpenings((*openings_)[static_cast<size_t>(own.landmark->id)])
      : options_.rules.beams_behind_walls ? occlusion.BehindWalls(views_.planes())
                                          : std::vector<int>();
  beams.insert(beams.end(), others.begin(), others.end());
  return beams;
}

bool ScanLineResegmenter::ExcludeOccluded(const ScanLine& scan_line,
                                          const Ends& ends,
                                          BeamRange* range,
                                          Observation* observation) {
  *range = {ends.first.beam, ends.last.beam};
  const LandmarkView* own = Find(observation->landmark_id);
  if (own == nullptr) return false;
  std::vector<int> excluded = OccludedBeamsOf(scan_line, *observation, *own, *range);
  const auto& known = observation->excluded_beams;
  excluded.insert(excluded.end(), known.begin(), known.end());
  std::sort(excluded.begin(), excluded.end());
  excluded.erase(std::unique(excluded.begin(), excluded.end()), excluded.end());
  const auto is_excluded = [&](int beam) {
    return std::binary_search(excluded.begin(), excluded.end(), beam);
  };
  const auto trim = [&](const NewEnd& end, int step, int* beam) {
    const auto is_left = [&](int i) { return i >= range->first && i <= range->last; };
    while (is_left(*beam) && is_excluded(*beam)) *beam += step;
    if (end.is_met && *beam == end.beam) return;  // not free
    int inner = *beam;
    const auto goes = [&](int i) { return is_excluded(i) || IsOff(scan_line, *end.trace, i); };
    while (is_left(inner) && goes(inner)) inner += step;
    // min_points beams would be a segment: this one may lie on another plane as a whole.
    if (std::abs(inner - *beam) < options_.segmentation.min_points) *beam = inner;
  };
  trim(ends.first, 1, &range->first);
  trim(ends.last, -1, &range->last);
  excluded.erase(
      std::remove_if(excluded.begin(),
                     excluded.end(),
                     [&](int beam) { return beam < range->first || beam > range->last; }),
      excluded.end());
  const bool is_another = range->first != observation->first_beam ||
                          range->last != observation->last_beam ||
                          !(observation->excluded_beams == excluded);
  observation->excluded_beams = excluded;
  return is_another;
}

namespace {

// The beams of an observation in the range that count, as a segment; its last beam lies before
// its first where none is left.
Segment SegmentOf(const Observation& observation,
                  const ScanLineResegmenter::BeamRange& range) {
  const auto& excluded = observation.excluded_beams;
  const auto counts = [&](int beam) {
    return !std::binary_search(excluded.begin(), excluded.end(), beam);
  };
  Segment segment;
  segment.first_beam = range.first;
  segment.last_beam = range.last;
  while (segment.first_beam <= range.last && !counts(segment.first_beam)) ++segment.first_beam;
  if (segment.first_beam > range.last) return segment;
  while (segment.last_beam > segment.first_beam && !counts(segment.last_beam)) {
    --segment.last_beam;
  }
  for (const int beam : excluded) {
    if (beam > segment.first_beam && beam < segment.last_beam) {
      segment.excluded_beams.push_back(beam);
    }
  }
  segment.num_points = segment.last_beam - segment.first_beam + 1 -
                       static_cast<int>(segment.excluded_beams.size());
  segment.normal = {-observation.tangent().y(), observation.tangent().x()};
  segment.sigma_offset_m = observation.sigma_offset_m;
  segment.sigma_direction_rad = observation.sigma_direction_rad;
  return segment;
}

// Takes over what does not follow from the beams; the new one is on the surface's trace.
void TakeOver(const Observation& before, Observation* after) {
  after->scan_index = before.scan_index;
  after->scan_line_index = before.scan_line_index;
  after->landmark_id = before.landmark_id;
  after->taken_to = before.landmark_id;
  after->revision = before.revision + 1;
}

}  // namespace

void ScanLineResegmenter::Replace(const ScanLine& scan_line,
                                  const BeamRange& range,
                                  const Matrix6d& pose_covariance,
                                  Observation* observation) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const Segment segment = SegmentOf(*observation, range);
  if (segment.num_points == 0) {  // none is left
    observation->landmark_id = -1;
    observation->num_points = 0;
    return;
  }
  const LandmarkView* own = Find(observation->landmark_id);
  if (own == nullptr) {  // out of the scan line's reach, as where the estimate spins
    observation->landmark_id = -1;
    return;
  }
  const PlaneTrace trace = poses_.Of(*observation).motion.TraceOf(own->normal, own->distance);
  Observation resegmented =
      MakeObservationOn(trace, scan_line, scanner, segment, !observation->points.empty());
  TakeOver(*observation, &resegmented);
  // With other beams the observation may lie on its plane no more. (A single beam has no line
  // to test.)
  if (resegmented.num_points > 1 &&
      FindLandmark(
          resegmented, poses_.Of(resegmented), pose_covariance, {*own}, options_.association) <
          0) {
    resegmented.landmark_id = -1;
  }
  *observation = std::move(resegmented);
}

bool ScanLineResegmenter::TakeToArc(const ScanLine& scan_line,
                                    const Landmark& surface,
                                    const BeamRange& range,
                                    Observation* observation) {
  if (!surface.IsCurved()) return false;
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const ScanMotion& motion = poses_.Of(*observation).motion;
  std::vector<int> off_arc;
  for (int beam = range.first; beam <= range.last; ++beam) {
    const double measured = scan_line.ranges[static_cast<size_t>(beam)];
    const std::optional<double> met = RangeOnCylinder(
        surface, motion.At(BeamInstant(scan_line, beam, rig_)), scan_line.BeamDirection(beam));
    if (!met || !scanner.IsValidRange(measured) ||
        !(std::abs(measured - *met) < kOutlierSigmas * scanner.RangeStddev(*met))) {
      off_arc.push_back(beam);
    }
  }
  observation->excluded_beams = off_arc;
  const Segment segment = SegmentOf(*observation, range);
  if (segment.num_points < options_.segmentation.min_points) {
    observation->landmark_id = -1;
    return true;
  }
  Observation on_arc = MakeObservationOnArc(
      surface, motion, scan_line, scanner, segment, !observation->points.empty());
  TakeOver(*observation, &on_arc);
  *observation = std::move(on_arc);
  return true;
}

}  // namespace plumbline

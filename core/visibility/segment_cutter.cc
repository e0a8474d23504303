#include "core/visibility/segment_cutter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/geometry/matrix_types.h"
#include "core/map/landmark_view.h"
#include "core/visibility/occlusion.h"

namespace plumbline {
namespace {

// Beyond so many standard deviations of a range one beam tells two surfaces apart, whatever
// its noise.
constexpr double kFarSigmas = 9.0;
// A beam that a segment is given lies within so many of its plane.
constexpr double kOutlierSigmas = 5.0;
// The last one at a free end within so many: a beam past the edge may end on something close
// behind. Cut on both sides of the plane, the good ones' noise keeps its mean.
constexpr double kFreeEndSigmas = 3.0;

}  // namespace

SegmentCutter::SegmentCutter(const Rig& rig,
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

const LandmarkView* SegmentCutter::Find(int landmark_id) const {
  for (const LandmarkView& candidate : candidates_.planes()) {
    if (candidate.landmark->id == landmark_id) return &candidate;
  }
  return nullptr;
}

int SegmentCutter::Extend(const ScanLine& scan_line,
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
    if (!(std::abs(range - expected) < kOutlierSigmas * scanner.range_noise_m)) break;
    last = beam;
  }
  return last;
}

SegmentCutter::NewEnd SegmentCutter::FindEnd(const ScanLine& scan_line,
                                             const Observation& observation,
                                             const FreeEnd& end) {
  const LandmarkView* own = Find(observation.landmark_id);
  if (own == nullptr) return {end.beam};
  const bool at_last = end.step > 0;
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
  const ScanPlacement placement =
      poses_.Of(observation)
          .motion.At(at_last ? observation.end_time_ns() : observation.start_time_ns());
  const Eigen::Vector2d p = at_last ? observation.end() : observation.start();
  const Trace trace(placement, *own);
  const std::vector<PlaneIntersection> intersections = FindIntersections(
      {scan_line, placement, *own, trace}, placement * p.homogeneous(), candidates_, end);
  const double far_m = kFarSigmas * scanner.range_noise_m;
  int last = 0;  // counted outwards, as the meetings
  int free = 0;  // innermost intersection outside
  std::vector<Trace> outside;
  for (const PlaneIntersection& intersection : intersections) {
    if (intersection.last >= 0) {
      free = intersection.last;
      outside.push_back(intersection.other);
      continue;
    }
    const Eigen::Vector2d direction = scan_line.BeamDirection(end.beam + end.step * last);
    const double own_range = trace.RangeAlong(direction);
    double other_range = intersection.other.RangeAlong(direction);
    // What lies behind may be hidden by a plane that meets this one farther out.
    for (const Trace& nearer : outside) {
      const double range = nearer.RangeAlong(direction);
      if (range > own_range) other_range = std::min(other_range, range);
    }
    if (intersection.is_edge || std::abs(own_range - other_range) < far_m)
      last = intersection.last;
  }
  NewEnd result{end.beam + end.step * last, trace};
  if (last == 0) result.beam = Extend(scan_line, trace, end, end.beam + end.step * free);
  bool goes_on = false;    // the plane, beyond what it meets
  bool at_corner = false;  // of two walls
  for (const PlaneIntersection& intersection : intersections) {
    if (std::abs(end.beam + end.step * intersection.last - result.beam) > 1) continue;
    result.is_met = true;
    goes_on = goes_on || intersection.goes_on;
    at_corner = at_corner || intersection.plane->is_vertical;
  }
  if (counted_ == nullptr) return result;
  int on_plane = result.beam;
  while (on_plane != end.middle && IsOff(scan_line, trace, on_plane)) on_plane -= end.step;
  const SegmentEnd counted_end{
      scan_line, scanner, placement, trace, *own->landmark, on_plane, end.step, end.middle};
  // Walls hide the floor beyond them: for floors, what lies beyond ends at walls tells
  // something too. So it does beyond a wall's ends at the jambs of its doors.
  const bool tells_of_openings =
      !result.is_met || goes_on || own->landmark->model == PlaneModel::kHorizontal;
  if (tells_of_openings) CountPassages(counted_end, counted_);
  // At a ceiling, beams past a wall's free edge may be among a segment's last; at a corner it
  // is known where the wall ends.
  if (tells_of_openings || at_corner) CountHitsAtEnd(counted_end, counted_);
  return result;
}

std::vector<SegmentCutter::Ends> SegmentCutter::FindEnds(
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

void SegmentCutter::CountHits(const ScanLine& scan_line,
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

// Whether a beam is too far from the plane to be the last one at a free end.
bool SegmentCutter::IsOff(const ScanLine& scan_line, const Trace& trace, int beam) const {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const double range = scan_line.ranges[static_cast<size_t>(beam)];
  const double expected = trace.RangeAlong(scan_line.BeamDirection(beam));
  return !(std::abs(range - expected) < kFreeEndSigmas * scanner.range_noise_m);
}

std::vector<int> SegmentCutter::OccludedBeamsOf(const ScanLine& scan_line,
                                                const Observation& observation,
                                                const LandmarkView& own,
                                                const Range& range) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
  const Occlusion occlusion{
      scan_line, scanner, poses_.Of(observation), own, range.first, range.last};
  std::vector<int> beams = occlusion.BehindCorners(candidates_.planes());
  const std::vector<int> others =
      openings_ != nullptr
          ? occlusion.InOpenings((*openings_)[static_cast<size_t>(own.landmark->id)])
          : occlusion.BehindWalls(candidates_.planes());
  beams.insert(beams.end(), others.begin(), others.end());
  return beams;
}

bool SegmentCutter::ExcludeOccluded(const ScanLine& scan_line,
                                    const Ends& ends,
                                    Range* range,
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
    // So many would be a segment: this one may lie on another plane as a whole.
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

void SegmentCutter::Replace(const ScanLine& scan_line,
                            const Range& range,
                            const Matrix6d& pose_covariance,
                            Observation* observation) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const auto& excluded = observation->excluded_beams;
  const auto counts = [&](int beam) {
    return !std::binary_search(excluded.begin(), excluded.end(), beam);
  };
  Segment segment;
  segment.first_beam = range.first;
  segment.last_beam = range.last;
  while (segment.first_beam <= range.last && !counts(segment.first_beam)) ++segment.first_beam;
  while (segment.last_beam > segment.first_beam && !counts(segment.last_beam)) {
    --segment.last_beam;
  }
  if (segment.first_beam > range.last) {  // none is left
    observation->landmark_id = -1;
    observation->num_points = 0;
    return;
  }
  for (const int beam : excluded) {
    if (beam > segment.first_beam && beam < segment.last_beam) {
      segment.excluded_beams.push_back(beam);
    }
  }
  segment.num_points = segment.last_beam - segment.first_beam + 1 -
                       static_cast<int>(segment.excluded_beams.size());
  segment.normal = {-observation->tangent().y(), observation->tangent().x()};
  segment.sigma_offset_m = observation->sigma_offset_m;
  segment.sigma_direction_rad = observation->sigma_direction_rad;
  const LandmarkView* own = Find(observation->landmark_id);
  if (own == nullptr) {  // out of the scan line's reach, as where the estimate spins
    observation->landmark_id = -1;
    return;
  }
  const PlaneTrace trace = poses_.Of(*observation).motion.TraceOf(own->normal, own->distance);
  Observation resegmented =
      MakeObservationOn(trace, scan_line, scanner, segment, !observation->points.empty());
  resegmented.scan_index = observation->scan_index;
  resegmented.scan_line_index = observation->scan_line_index;
  resegmented.landmark_id = observation->landmark_id;
  resegmented.taken_to = observation->landmark_id;
  resegmented.revision = observation->revision + 1;
  // With other beams it may lie on its plane no more. (A single beam has no line to test.)
  if (resegmented.num_points > 1 &&
      FindLandmark(
          resegmented, poses_.Of(resegmented), pose_covariance, {*own}, options_.association) <
          0) {
    resegmented.landmark_id = -1;
  }
  *observation = std::move(resegmented);
}

}  // namespace plumbline

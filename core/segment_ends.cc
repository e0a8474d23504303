#include "core/segment_ends.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/association.h"
#include "core/hidden_beams.h"
#include "core/plane_meetings.h"
#include "core/scan_reader.h"
#include "core/scan_trace.h"

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
// A surface shows single beams long before it shows segments: with loop closure off, a plane
// bounds segments for so many times the gap after which it is not taken up again.
constexpr int kGapFactor = 10;
constexpr int kMaxInt = std::numeric_limits<int>::max();

class Recutter {
 public:
  Recutter(const Rig& rig,
           const MapperOptions& options,
           const OpeningMap& openings,
           OpeningMap* counted,
           MapState* state)
      : rig_(rig),
        options_(options),
        counted_(counted),
        state_(state),
        sampler_(state->trajectory),
        poses_(state->trajectory) {
    for (const Landmark& landmark : state->landmarks) {
      openings_.push_back(openings.OpeningsOf(landmark));
    }
  }

  // The observations [first, last) of a scan line; returns how many changed.
  int Recut(const ScanLine& scan_line, size_t first, size_t last);

 private:
  struct Range {
    int first;
    int last;
  };
  // Where a segment ends now.
  struct NewEnd {
    int beam;
    const LandmarkCandidate* beyond = nullptr;  // that may be given beams there
    std::optional<Trace> trace = std::nullopt;  // of its own plane, if it has one
    bool is_met = false;                        // by another plane
  };
  struct Ends {
    NewEnd first;
    NewEnd last;
  };
  // Beams between two segments.
  struct Gap {
    NewEnd before;  // of the segments on both sides
    NewEnd after;
    int landmark_before;  // their planes; -1: none
    int landmark_after;
  };

  void SetCandidates(const ScanLine& scan_line, const Observation& observation);
  const LandmarkCandidate* Find(int landmark_id) const;
  NewEnd FindEnd(const ScanLine& scan_line,
                 const Observation& observation,
                 const FreeEnd& end);
  const LandmarkCandidate* Beyond(const std::vector<PlaneMeeting>& meetings,
                                  int last,
                                  int scan_index) const;
  void FillGap(const ScanLine& scan_line, const Observation& nearby, const Gap& gap);
  int AddShortRun(const ScanLine& scan_line,
                  const Observation& nearby,
                  const LandmarkCandidate& plane,
                  const FreeEnd& end,
                  int own_landmark);
  int Extend(const ScanLine& scan_line, const Trace& trace, const FreeEnd& end, int to) const;
  bool IsOff(const ScanLine& scan_line, const Trace& trace, int beam) const;
  bool LeaveOutHidden(const ScanLine& scan_line,
                      const Ends& ends,
                      Range* range,
                      Observation* observation);
  void Replace(const ScanLine& scan_line, const Range& range, Observation* observation);

  const Rig& rig_;
  const MapperOptions& options_;
  std::vector<PlaneOpenings> openings_;  // by landmark id, as known before
  OpeningMap* counted_;                  // anew; null: not
  MapState* state_;
  PoseSampler sampler_;
  SharedPoses poses_;
  std::vector<LandmarkCandidate> within_gap_;
  std::vector<LandmarkCandidate> candidates_;  // those that come near the scan line
  int candidates_scan_ = -1;
};

// What lies beyond the farthest beam of the scan line can not bound its segments.
void Recutter::SetCandidates(const ScanLine& scan_line, const Observation& observation) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  double farthest = 0.0;
  for (const float range : scan_line.ranges) {
    if (scanner.IsValidRange(range)) farthest = std::max(farthest, static_cast<double>(range));
  }
  candidates_ = CandidatesWithinReach(
      within_gap_,
      (poses_.Of(observation).middle() * scanner.body_from_scanner).translation,
      farthest,
      options_.association);
}

const LandmarkCandidate* Recutter::Find(int landmark_id) const {
  for (const LandmarkCandidate& candidate : candidates_) {
    if (candidate.landmark->id == landmark_id) return &candidate;
  }
  return nullptr;
}

// The last beam, from the end's on, up to `to` for as long as the ranges lie on the trace.
int Recutter::Extend(const ScanLine& scan_line,
                     const Trace& trace,
                     const FreeEnd& end,
                     int to) const {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  int last = end.beam;
  if (to == end.beam) return last;
  BeamSweep sweep(scan_line, end.beam, end.step);
  for (int beam = end.beam + end.step; end.step * (to - beam) >= 0; beam += end.step) {
    sweep.Next();
    const double range = scan_line.ranges[static_cast<size_t>(beam)];
    if (!scanner.IsValidRange(range)) break;
    const double expected = trace.RangeAlong(sweep.direction());
    if (!(std::abs(range - expected) < kOutlierSigmas * scanner.range_noise_m)) break;
    last = beam;
  }
  return last;
}

// The plane beyond an end `last` beams from where the segment ended: one that may be given
// beams of this scan.
const LandmarkCandidate* Recutter::Beyond(const std::vector<PlaneMeeting>& meetings,
                                          int last,
                                          int scan_index) const {
  for (const PlaneMeeting& meeting : meetings) {
    if (std::abs(meeting.last - last) <= 1 &&
        IsWithinGap(*meeting.plane->landmark, scan_index, options_.loop_closure)) {
      return meeting.plane;
    }
  }
  return nullptr;
}

Recutter::NewEnd Recutter::FindEnd(const ScanLine& scan_line,
                                   const Observation& observation,
                                   const FreeEnd& end) {
  const LandmarkCandidate* own = Find(observation.landmark_id);
  if (own == nullptr) return {end.beam};
  const bool at_last = end.step > 0;
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
  const Rigid3d world_from_scanner =
      sampler_.WorldFromBody(at_last ? observation.end_time_ns : observation.start_time_ns) *
      scanner.body_from_scanner;
  const Eigen::Vector2d& p = at_last ? observation.end : observation.start;
  const Eigen::Vector3d p_world = world_from_scanner * Eigen::Vector3d(p.x(), p.y(), 0.0);
  const Trace trace(world_from_scanner, *own);
  const std::vector<PlaneMeeting> meetings =
      FindMeetings({scan_line, world_from_scanner, *own, trace}, p_world, candidates_, end);
  const double far_m = kFarSigmas * scanner.range_noise_m;
  int last = 0;  // counted outwards, as the meetings
  int free = 0;  // innermost meeting outside
  std::vector<Trace> outside;
  for (const PlaneMeeting& meeting : meetings) {
    if (meeting.last >= 0) {
      free = meeting.last;
      outside.push_back(meeting.other);
      continue;
    }
    const Eigen::Vector2d direction = scan_line.BeamDirection(end.beam + end.step * last);
    const double own_range = trace.RangeAlong(direction);
    double other_range = meeting.other.RangeAlong(direction);
    // What lies behind may be hidden by a plane that meets this one farther out.
    for (const Trace& nearer : outside) {
      const double range = nearer.RangeAlong(direction);
      if (range > own_range) other_range = std::min(other_range, range);
    }
    if (std::abs(own_range - other_range) < far_m) last = meeting.last;
  }
  NewEnd result{end.beam + end.step * last, nullptr, trace};
  if (last == 0) result.beam = Extend(scan_line, trace, end, end.beam + end.step * free);
  result.beyond =
      Beyond(meetings, end.step * (result.beam - end.beam), observation.scan_index);
  result.is_met =
      std::any_of(meetings.begin(), meetings.end(), [&](const PlaneMeeting& meeting) {
        return std::abs(end.beam + end.step * meeting.last - result.beam) <= 1;
      });
  // Walls hide the floor beyond them: for floors, ends at walls tell something too.
  const bool is_counted = !result.is_met || own->landmark->model == PlaneModel::kHorizontal;
  if (counted_ != nullptr && is_counted) {
    int on_plane = result.beam;
    while (on_plane != end.middle && IsOff(scan_line, trace, on_plane)) on_plane -= end.step;
    CountOpenings({scan_line,
                   scanner,
                   world_from_scanner,
                   trace,
                   *own->landmark,
                   on_plane,
                   end.step,
                   end.middle},
                  counted_);
  }
  return result;
}

// Whether a beam is too far from the plane to be the last one at a free end.
bool Recutter::IsOff(const ScanLine& scan_line, const Trace& trace, int beam) const {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const double range = scan_line.ranges[static_cast<size_t>(beam)];
  const double expected = trace.RangeAlong(scan_line.BeamDirection(beam));
  return !(std::abs(range - expected) < kFreeEndSigmas * scanner.range_noise_m);
}

// The range between the ends, shorter where the beams there can not lie on the segment's plane
// or are off it; other such beams are left out. Returns whether the segment is another one
// then.
bool Recutter::LeaveOutHidden(const ScanLine& scan_line,
                              const Ends& ends,
                              Range* range,
                              Observation* observation) {
  *range = {ends.first.beam, ends.last.beam};
  const LandmarkCandidate* own = Find(observation->landmark_id);
  if (own == nullptr) return false;
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation->scanner_index)];
  const HiddenBeams hidden{
      scan_line, scanner, poses_.Of(*observation), *own, range->first, range->last};
  std::vector<int> excluded = observation->excluded_beams;
  const PlaneOpenings& openings = openings_[static_cast<size_t>(own->landmark->id)];
  for (const auto& beams : {hidden.InOpenings(openings), hidden.BehindCorners(candidates_)}) {
    excluded.insert(excluded.end(), beams.begin(), beams.end());
  }
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
                          excluded != observation->excluded_beams;
  observation->excluded_beams = std::move(excluded);
  return is_another;
}

void Recutter::Replace(const ScanLine& scan_line,
                       const Range& range,
                       Observation* observation) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  std::vector<int> beams;  // that count
  for (int beam = range.first; beam <= range.last; ++beam) {
    const auto& excluded = observation->excluded_beams;
    if (!std::binary_search(excluded.begin(), excluded.end(), beam)) beams.push_back(beam);
  }
  if (beams.empty()) {
    observation->landmark_id = -1;
    observation->num_points = 0;
    return;
  }
  Segment segment;
  segment.first_beam = beams.front();
  segment.last_beam = beams.back();
  for (const int beam : observation->excluded_beams) {
    if (beam > beams.front() && beam < beams.back()) segment.excluded_beams.push_back(beam);
  }
  segment.num_points = static_cast<int>(beams.size());
  segment.normal = {-observation->tangent.y(), observation->tangent.x()};
  segment.sigma_offset_m = observation->sigma_offset_m;
  segment.sigma_direction_rad = observation->sigma_direction_rad;
  const LandmarkCandidate* own = Find(observation->landmark_id);
  CHECK(own != nullptr) << "a segment out of its own scan line's reach";
  const PlaneTrace trace(observation->measurement.node_times_ns,
                         poses_.Of(*observation).WorldFromScanner(scanner.body_from_scanner),
                         own->normal,
                         own->distance);
  Observation recut =
      MakeObservationOn(trace, scan_line, scanner, segment, !observation->points.empty());
  recut.scan_index = observation->scan_index;
  recut.scan_line_index = observation->scan_line_index;
  recut.landmark_id = observation->landmark_id;
  recut.taken_to = observation->landmark_id;
  recut.revision = observation->revision + 1;
  // With other beams it may lie on its plane no more. (A single beam has no line to test.)
  if (beams.size() > 1 && FindLandmark(recut,
                                       scanner.body_from_scanner,
                                       poses_.Of(recut),
                                       Matrix6d::Zero(),
                                       {*own},
                                       options_.association) < 0) {
    recut.landmark_id = -1;
  }
  *observation = std::move(recut);
}

// Beams of a plane beyond a segment's end, too few for a segment of their own; as far as they
// fit. Returns the last one taken. end: of the segment; own_landmark: its plane.
int Recutter::AddShortRun(const ScanLine& scan_line,
                          const Observation& nearby,
                          const LandmarkCandidate& plane,
                          const FreeEnd& end,
                          int own_landmark) {
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const int first = end.beam + end.step;
  const Rigid3d world_from_scanner =
      sampler_.WorldFromBody(BeamInstant(scan_line, first, rig_)) * scanner.body_from_scanner;
  if (plane.normal.dot(world_from_scanner.translation) <= plane.distance) return end.beam;
  const Trace trace(world_from_scanner, plane);
  const Eigen::Vector2d direction = scan_line.BeamDirection(first);
  const double range = trace.RangeAlong(direction);
  if (!scanner.IsValidRange(range)) return end.beam;
  const Eigen::Vector3d p_world =
      world_from_scanner * Eigen::Vector3d(range * direction.x(), range * direction.y(), 0.0);
  int to = end.limit - end.step;
  bool is_bounded = false;  // by another plane
  for (const PlaneMeeting& meeting : FindMeetings(
           {scan_line, world_from_scanner, plane, trace}, p_world, candidates_, end)) {
    if (meeting.plane->landmark->id == own_landmark || meeting.last < 1) continue;
    to = end.beam + end.step * meeting.last;
    is_bounded = true;
  }
  int last = Extend(scan_line, trace, end, to);
  while (last != end.beam && !IsOnPatch(scan_line, world_from_scanner, trace, plane, last)) {
    last -= end.step;
  }
  const int num_points = end.step * (last - end.beam);
  if (num_points < 1 || !IsOnPatch(scan_line, world_from_scanner, trace, plane, first)) {
    return end.beam;
  }
  Observation run;
  run.landmark_id = plane.landmark->id;
  run.first_beam = std::min(first, last);
  run.last_beam = std::max(first, last);
  run.scan_index = nearby.scan_index;
  run.scan_line_index = nearby.scan_line_index;
  run.scanner_index = nearby.scanner_index;
  run.sigma_offset_m = scanner.range_noise_m / std::sqrt(num_points);
  run.sigma_direction_rad = M_PI;  // not known without the plane
  run.measurement.node_times_ns = NodesOfSpan(BeamInstant(scan_line, run.first_beam, rig_),
                                              BeamInstant(scan_line, run.last_beam, rig_));
  if (!nearby.points.empty()) run.points.resize(1);  // so that Replace keeps them too
  const NewEnd near{first, nullptr, trace, true};
  const NewEnd far{last, nullptr, trace, is_bounded && last == to};
  const Ends ends = end.step > 0 ? Ends{near, far} : Ends{far, near};
  Range beams;
  LeaveOutHidden(scan_line, ends, &beams, &run);
  Replace(scan_line, beams, &run);
  if (run.landmark_id < 0) return end.beam;
  state_->short_runs.push_back(std::move(run));
  return last;
}

void Recutter::FillGap(const ScanLine& scan_line, const Observation& nearby, const Gap& gap) {
  int from = gap.before.beam;
  if (gap.before.beyond != nullptr && gap.before.beyond->landmark->id != gap.landmark_after) {
    FreeEnd end{from, 1, gap.after.beam, from, gap.landmark_after};
    if (from + 1 < gap.after.beam) {
      from = AddShortRun(scan_line, nearby, *gap.before.beyond, end, gap.landmark_before);
    }
  }
  if (gap.after.beyond != nullptr && gap.after.beyond->landmark->id != gap.landmark_before &&
      from + 1 < gap.after.beam) {
    FreeEnd end{gap.after.beam, -1, from, gap.after.beam, gap.landmark_before};
    AddShortRun(scan_line, nearby, *gap.after.beyond, end, gap.landmark_after);
  }
}

int Recutter::Recut(const ScanLine& scan_line, size_t first, size_t last) {
  const auto& observations = state_->observations;
  const int scan_index = observations[first].scan_index;
  if (scan_index != candidates_scan_) {
    LoopClosureOptions gap = options_.loop_closure;
    gap.max_gap_scans = std::min(gap.max_gap_scans, kMaxInt / kGapFactor) * kGapFactor;
    if (candidates_scan_ < 0 || !gap.enabled) {
      within_gap_ = CandidatesWithinGap(state_->landmarks, scan_index, gap);
    }
    candidates_scan_ = scan_index;
  }
  SetCandidates(scan_line, observations[first]);
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
    }
    // Each end has its own pose: neighbours may differ by a beam on where they meet.
    if (!ends.empty()) {
      now.first.beam = std::max(now.first.beam, ends.back().last.beam + 1);
    }
    ends.push_back(now);
  }
  for (size_t i = 0; i <= ends.size(); ++i) {
    Gap gap{{-1}, {scan_line.num_beams()}, -1, -1};
    if (i > 0) {
      gap.before = ends[i - 1].last;
      gap.landmark_before = observations[first + i - 1].landmark_id;
    }
    if (i < ends.size()) {
      gap.after = ends[i].first;
      gap.landmark_after = observations[first + i].landmark_id;
    }
    FillGap(scan_line, observations[first], gap);
  }
  int num_changed = 0;
  for (size_t i = first; i < last; ++i) {
    Observation& observation = state_->observations[i];
    if (observation.landmark_id < 0) continue;
    Range range;
    const bool is_another = LeaveOutHidden(scan_line, ends[i - first], &range, &observation);
    num_changed += is_another ? 1 : 0;
    // While openings are still counted, a segment that keeps its beams keeps its line too.
    const bool is_last_call = counted_ == nullptr;
    if (is_another || (is_last_call && observation.taken_to != observation.landmark_id)) {
      Replace(scan_line, range, &observation);
    }
  }
  return num_changed;
}

}  // namespace

int RecutSegments(const Rig& rig,
                  const MapperOptions& options,
                  RecordingReader* recording,
                  const OpeningMap& openings,
                  OpeningMap* counted,
                  MapState* state) {
  // None of the new runs is to be taken for an old one.
  const int revision = state->short_runs.empty() ? 1 : state->short_runs.front().revision + 1;
  state->short_runs.clear();
  Recutter recutter(rig, options, openings, counted, state);
  recording->Rewind();
  ScanLine scan_line;
  size_t next = 0;
  int num_changed = 0;
  for (int index = 0; recording->Next(&scan_line); ++index) {
    const size_t first = next;
    while (next < state->observations.size() &&
           state->observations[next].scan_line_index == index) {
      ++next;
    }
    if (next > first) num_changed += recutter.Recut(scan_line, first, next);
  }
  for (Observation& run : state->short_runs) run.revision = revision;
  return num_changed;
}

}  // namespace plumbline

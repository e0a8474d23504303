#include "core/association/undecided_planes.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "core/association/plane_kind.h"
#include "core/association/surface_levels.h"
#include "core/geometry/angles.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// The motion after which two scanners have swept enough of a plane.
constexpr double kSweepOfTwo = 0.1;  // m
// Time after which an undecided plane begins anew.
constexpr double kMaxUndecided = 20.0;  // s

// What has to be seen of a plane before it is trusted.
struct Needs {
  int num_lines;      // traces
  double motion_m;    // of the rig
  double min_side_m;  // of what was seen: smaller surfaces stay points
};
// Two lines lie on a plane by chance, but hardly on one that is upright, too.
template <typename Upright>
Needs NeedsOf(const Upright&) {
  return {0, 0.0, 0.0};
}
Needs NeedsOf(const HorizontalPlane&) { return {12, kSweepOfTwo, 0.0}; }
// A dozen traces on furniture or on the treads of a stair lie on a slope by chance now and
// then, and it draws the rig off as a true one holds it.
Needs NeedsOf(const GeneralPlane&) { return {30, kRevealingMotion, 0.4}; }

Eigen::Vector3d ToWorld(const Rigid3d& world_from_scanner, const Eigen::Vector2d& p) {
  return world_from_scanner * Eigen::Vector3d(p.x(), p.y(), 0.0);
}

}  // namespace

bool UndecidedPlanes::Takes(const Plane& plane,
                            const MeasuredLine& line,
                            const Trace& trace) const {
  for (auto last = plane.traces.rbegin(); last != plane.traces.rend(); ++last) {
    if (last->scan_line_index == trace.scan_line_index) return false;
    if (last->scan_index != trace.scan_index) break;
  }
  const auto is_near = [&](const Eigen::Vector3d& p) {
    const double gap = options_.association.max_gap_m;
    return (p.array() >= plane.low.array() - gap).all() &&
           (p.array() <= plane.high.array() + gap).all();
  };
  if (!is_near(trace.start_world) && !is_near(trace.end_world) &&
      !is_near(0.5 * (trace.start_world + trace.end_world))) {
    return false;
  }
  PlaneThroughLines with_line = plane.seen.lines;
  with_line.Add(line);
  const PlaneThroughLines::Fit fit = with_line.Solve();
  if (fit.chi2 - plane.seen.lines.Solve().chi2 >
      TwoDegreesQuantile(options_.association.significance)) {
    return false;
  }
  const auto height_of = [&](const Trace& other) {
    return fit.normal.dot(other.scanner_world - fit.centre_world);
  };
  // Traces that meet in a corner lie on a plane that one of them would only graze.
  const auto cuts = [&](const Trace& other) {
    return fit.normal.cross(other.scan_normal_world).squaredNorm() >
           kMinCuttingSineOfSlopes * kMinCuttingSineOfSlopes;
  };
  const Trace& first = plane.traces.front();
  return height_of(first) * height_of(trace) > 0.0 && cuts(first) && cuts(trace);
}

void UndecidedPlanes::Record(const Observation& observation,
                             const ObservationPoses& poses,
                             const MeasuredLine& line,
                             const Trace& trace,
                             Plane* plane) const {
  plane->seen.Count(observation, trace.observation_index, poses, line);
  plane->traces.push_back(trace);
  for (const Eigen::Vector3d& p : {trace.start_world, trace.end_world}) {
    plane->low = plane->low.cwiseMin(p);
    plane->high = plane->high.cwiseMax(p);
  }
}

void UndecidedPlanes::Offer(const Observation& observation,
                            int observation_index,
                            const ObservationPoses& poses,
                            const MeasuredLine& line) {
  Trace trace;
  trace.observation_index = observation_index;
  trace.scan_index = observation.scan_index;
  trace.scan_line_index = observation.scan_line_index;
  trace.start_world = ToWorld(poses.world_from_scanner, observation.start());
  trace.end_world = ToWorld(poses.world_from_scanner, observation.end());
  trace.scan_normal_world = poses.world_from_scanner.rotation * Eigen::Vector3d::UnitZ();
  trace.scanner_world = poses.world_from_scanner.translation;
  bool taken = false;
  for (Plane& plane : planes_) {
    if (!Takes(plane, line, trace)) continue;
    Record(observation, poses, line, trace, &plane);
    taken = true;
  }
  const double max_sigma = options_.planes.max_direction_sigma_deg * kRadiansPerDegree;
  if (taken || observation.num_points < options_.planes.min_points ||
      !(observation.sigma_direction_rad < max_sigma)) {
    return;
  }
  planes_.emplace_back();
  Record(observation, poses, line, trace, &planes_.back());
}

bool UndecidedPlanes::Decide(int min_scans, bool needs_age, Plane* plane) const {
  TentativePlane& seen = plane->seen;
  if (static_cast<int>(seen.scans.size()) < min_scans) return false;
  const bool by_two = seen.scanners.size() > 1;
  if (!by_two && seen.Motion() < kRevealingMotion) return false;
  const PlaneThroughLines::Fit fit = seen.lines.Solve();
  if (fit.chi2 > kMaxMeanChi2 * (2 * seen.lines.num_lines() - 3)) return false;
  std::optional<Landmark> landmark = DecideKind(fit, plane->traces.front().scanner_world);
  if (!landmark) return false;
  const Needs needs = VisitPlaneModel(
      landmark->model, landmark->chart, [](const auto& kind) { return NeedsOf(kind); });
  const bool is_start = min_scans <= 1;
  const int min_lines = is_start ? std::min(kMinWitnesses, needs.num_lines) : needs.num_lines;
  if (seen.lines.num_lines() < min_lines) return false;
  if (!is_start && seen.Motion() < needs.motion_m) return false;
  seen.landmark = std::move(*landmark);
  for (const Trace& trace : plane->traces) {
    seen.landmark.extent.AddSegment(trace.start_world, trace.end_world);
  }
  if (needs_age && !seen.HasAge(options_.planes)) return false;
  const Eigen::Vector2d sides =
      seen.landmark.extent.max_corner() - seen.landmark.extent.min_corner();
  return sides.minCoeff() >= needs.min_side_m;
}

std::vector<TentativePlane> UndecidedPlanes::TakeReady(int min_scans, bool needs_age) {
  std::vector<TentativePlane> ready;
  for (auto it = planes_.begin(); it != planes_.end();) {
    if (Decide(min_scans, needs_age, &*it)) {
      ready.push_back(std::move(it->seen));
      it = planes_.erase(it);
    } else {
      ++it;
    }
  }
  return ready;
}

bool UndecidedPlanes::AreOnNoWall(const std::vector<int>& observations, int min_scans) const {
  const std::set<int> asked(observations.begin(), observations.end());
  return std::any_of(planes_.begin(), planes_.end(), [&](const Plane& plane) {
    size_t num_shared = 0;
    std::set<int> other_scans;
    for (const Trace& trace : plane.traces) {
      if (asked.count(trace.observation_index) > 0) {
        ++num_shared;
      } else {
        other_scans.insert(trace.scan_index);
      }
    }
    if (2 * num_shared < asked.size()) return false;
    if (static_cast<int>(other_scans.size()) < min_scans) return false;
    const std::optional<Landmark> landmark = ShownByTwo(plane);
    return landmark && TraitsOf(*landmark).passes_for_wall;
  });
}

std::optional<Landmark> UndecidedPlanes::ShownByTwo(const Plane& plane) const {
  if (plane.seen.scanners.size() < 2) return std::nullopt;
  return DecideKind(plane.seen.lines.Solve(), plane.traces.front().scanner_world);
}

std::set<int> UndecidedPlanes::OnSlopes() const {
  std::set<int> observations;
  for (const Plane& plane : planes_) {
    const std::optional<Landmark> landmark = ShownByTwo(plane);
    if (!landmark || !TraitsOf(*landmark).has_soft_edges) continue;
    observations.insert(plane.seen.observations.begin(), plane.seen.observations.end());
  }
  return observations;
}

void UndecidedPlanes::DropStale(int64_t now_ns) {
  const auto is_stale = [&](const Plane& plane) {
    return SecondsBetween(plane.seen.last_time_ns, now_ns) >
               options_.planes.max_tentative_age_s ||
           SecondsBetween(plane.seen.first_time_ns, now_ns) > kMaxUndecided;
  };
  planes_.erase(std::remove_if(planes_.begin(), planes_.end(), is_stale), planes_.end());
}

}  // namespace plumbline

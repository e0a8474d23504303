#include "core/batch/drift_correction.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "core/batch/visited_walls.h"
#include "core/registration/revisits.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Share of closures that contradict the others beyond which no place counts as seen again.
constexpr double kMaxContradictedShare = 0.25;

// The way up to an instant; scan: an earlier scan, which moves on.
double WayAt(int64_t time_ns,
             const std::vector<PlacedScan>& scans,
             std::vector<PlacedScan>::const_iterator* scan) {
  while (std::next(*scan) != scans.end() && std::next(*scan)->time_ns <= time_ns) ++*scan;
  const auto next = std::next(*scan);
  if (next == scans.end() || time_ns <= (*scan)->time_ns) return (*scan)->way_m;
  return (*scan)->way_m + (next->way_m - (*scan)->way_m) *
                              SecondsBetween((*scan)->time_ns, time_ns) /
                              SecondsBetween((*scan)->time_ns, next->time_ns);
}

// Returns the pose after a visit's correction.
PlanarPose Corrected(const Visit& visit,
                     const PlanarPose& world_from_visit,
                     const Eigen::Vector2d& position) {
  const PlanarPose correction = world_from_visit * visit.world_from_visit.Inverse();
  return {std::remainder(correction.heading, 2.0 * M_PI), correction * position};
}

// Between two turns on the shorter way round.
PlanarPose Between(const PlanarPose& a, const PlanarPose& b, double share) {
  return {a.heading + share * std::remainder(b.heading - a.heading, 2.0 * M_PI),
          (1.0 - share) * a.position + share * b.position};
}

}  // namespace

void BendTrajectory(const std::vector<PlacedScan>& scans,
                    const std::vector<Visit>& visits,
                    const std::vector<PlanarPose>& corrected,
                    Trajectory* trajectory) {
  CHECK(!scans.empty() && !visits.empty() && visits.size() == corrected.size());
  auto scan = scans.begin();
  size_t next = 0;  // the first visit after the control point
  for (int i = 0; i < trajectory->num_control_points(); ++i) {
    // A control point acts most in the middle of the four intervals it reaches.
    const int64_t time_ns = trajectory->start_ns() + (i - 1) * trajectory->knot_interval_ns();
    const double way_m = WayAt(time_ns, scans, &scan);
    while (next < visits.size() && visits[next].way_m <= way_m) ++next;
    ControlPoint& point = trajectory->control_point(i);
    const Eigen::Vector2d position(point.position[0], point.position[1]);
    const auto by_visit = [&](size_t visit) {
      return Corrected(visits[visit], corrected[visit], position);
    };
    PlanarPose to;
    if (next == 0 || next == visits.size()) {
      to = by_visit(next == 0 ? 0 : next - 1);
    } else {
      const double from_m = visits[next - 1].way_m;
      to = Between(by_visit(next - 1),
                   by_visit(next),
                   (way_m - from_m) / (visits[next].way_m - from_m));
    }
    point.position[0] = to.position.x();
    point.position[1] = to.position.y();
    Eigen::Map<Eigen::Quaterniond> rotation(point.rotation.data());
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(to.heading, Eigen::Vector3d::UnitZ()));
    rotation = turn * rotation;
  }
}

std::optional<double> CorrectDrift(const Rig& rig,
                                   RecordingReader* recording,
                                   MapState* state) {
  const std::vector<PlacedScan> scans = PlaceScans(rig, state->trajectory, recording);
  const std::vector<Visit> visits = CutIntoVisits(scans, state->trajectory);
  const PlacedVisits placed = PlaceVisits(visits, state->odometry.get());
  if (placed.closures.empty() || Hold(placed.closures, visits)) return std::nullopt;
  const auto num_found = static_cast<double>(placed.closures.size()) + placed.num_contradicted;
  if (placed.num_contradicted > kMaxContradictedShare * num_found) {
    LOG(WARNING) << "loop closures contradict each other: " << placed.num_contradicted
                 << " of " << num_found << " pairs of visits; the drift stays";
    return std::nullopt;
  }
  double largest_m = 0.0;
  for (size_t i = 0; i < visits.size(); ++i) {
    const PlanarPose& corrected = placed.world_from_visit[i];
    largest_m =
        std::max(largest_m, (corrected.position - visits[i].world_from_visit.position).norm());
  }
  BendTrajectory(scans, visits, placed.world_from_visit, &state->trajectory);
  SplitWallsByVisits(state);
  PlaceWalls(rig, state);
  RebuildLandmarks(rig, state);
  const int num_merged = MergeVisitedWalls(state);
  PlaceWalls(rig, state);
  RebuildLandmarks(rig, state);
  LOG(INFO) << "loop closures: " << placed.closures.size()
            << " pairs of visits; the trajectory is corrected by up to " << largest_m
            << " m, and " << num_merged << " walls become one with others";
  return largest_m;
}

}  // namespace plumbline

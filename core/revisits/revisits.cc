#include "core/revisits/revisits.h"

#include <glog/logging.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>

#include "core/revisits/visit_grid.h"
#include "core/revisits/visit_matching.h"
#include "core/revisits/visit_surface.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Since when a place was left that counts as seen again.
constexpr double kMinAbsence = 20.0;  // s
constexpr double kMinWay = 12.0;      // m
// From the middle of one visit to that of another one, where they may show one place.
constexpr double kMaxDistance = 4.0;  // m
constexpr size_t kMaxTried = 3;       // earlier visits, the nearest ones
// How far the trajectory drifts from one visit to the next: a share of the way, and radians,
// of which a share of the turn.
constexpr double kPositionDrift = 0.02;
constexpr double kHeadingDrift = 0.01;
constexpr double kTurnDrift = 0.02;
// Errors of a match besides those of the surfaces: visits are not quite rigid.
constexpr double kMatchStddev = 0.03;          // m
constexpr double kMatchHeadingStddev = 0.004;  // rad
// Standard deviations of a match in a direction that it leaves open.
constexpr double kOpenStddev = 10.0;        // m
constexpr double kOpenHeadingStddev = 1.0;  // rad
constexpr double kMaxDeviation = 4.0;       // standard deviations, of a closure that holds

// The data by which a visit is matched.
struct Prepared {
  explicit Prepared(const Visit& visit) : grid(visit), surface(visit) {}
  VisitGrid grid;
  VisitSurface surface;
};

Eigen::Vector3d InverseSquares(double position, double heading) {
  return {1.0 / (position * position), 1.0 / (position * position), 1.0 / (heading * heading)};
}

PoseGraphEdge MotionEdge(const std::vector<Visit>& visits, size_t from) {
  PoseGraphEdge edge;
  edge.from = from;
  edge.to = from + 1;
  edge.from_from_to =
      visits[from].world_from_visit.Inverse() * visits[from + 1].world_from_visit;
  const double turn = std::remainder(edge.from_from_to.heading, 2.0 * M_PI);
  edge.from_from_to.heading = turn;
  const double way_m = visits[from + 1].way_m - visits[from].way_m;
  edge.information =
      InverseSquares(kPositionDrift * way_m, kHeadingDrift + kTurnDrift * std::abs(turn))
          .asDiagonal();
  return edge;
}

// poses: as they are, with whole turns.
PoseGraphEdge ClosureEdge(size_t earlier,
                          size_t later,
                          const VisitMatch& match,
                          const std::vector<PlanarPose>& poses) {
  PoseGraphEdge edge;
  edge.from = earlier;
  edge.to = later;
  edge.from_from_to = match.earlier_from_later;
  const double turn = poses[later].heading - poses[earlier].heading;
  edge.from_from_to.heading =
      turn + std::remainder(match.earlier_from_later.heading - turn, 2.0 * M_PI);
  Eigen::Matrix3d covariance =
      (match.information +
       Eigen::Matrix3d(InverseSquares(kOpenStddev, kOpenHeadingStddev).asDiagonal()))
          .inverse();
  covariance.diagonal() +=
      InverseSquares(1.0 / kMatchStddev, 1.0 / kMatchHeadingStddev);  // their squares
  edge.information = covariance.inverse();
  edge.may_be_wrong = true;
  return edge;
}

// Earlier visits that may show the place of a later one, nearest first.
std::vector<size_t> CandidatesFor(const std::vector<Visit>& visits,
                                  const std::vector<PlanarPose>& poses,
                                  size_t later) {
  std::vector<std::pair<double, size_t>> candidates;
  for (size_t i = 0; i < later; ++i) {
    if (SecondsBetween(visits[i].time_ns, visits[later].time_ns) < kMinAbsence) continue;
    if (visits[later].way_m - visits[i].way_m < kMinWay) continue;
    const double distance_m = (poses[i].position - poses[later].position).norm();
    if (distance_m < kMaxDistance) candidates.emplace_back(distance_m, i);
  }
  std::sort(candidates.begin(), candidates.end());
  if (candidates.size() > kMaxTried) candidates.resize(kMaxTried);
  std::vector<size_t> nearest;
  for (const auto& [distance_m, i] : candidates) nearest.push_back(i);
  return nearest;
}

}  // namespace

PlacedVisits PlaceVisits(const std::vector<Visit>& visits) {
  PlacedVisits placed;
  if (visits.empty()) return placed;
  std::vector<std::unique_ptr<Prepared>> prepared(visits.size());
  tbb::parallel_for(size_t{0}, visits.size(), [&](size_t i) {
    prepared[i] = std::make_unique<Prepared>(visits[i]);
  });
  std::vector<PlanarPose>& poses = placed.world_from_visit;
  poses.push_back(visits[0].world_from_visit);
  std::vector<PoseGraphEdge> edges;
  for (size_t later = 1; later < visits.size(); ++later) {
    edges.push_back(MotionEdge(visits, later - 1));
    poses.push_back(poses.back() * edges.back().from_from_to);
    const std::vector<size_t> candidates = CandidatesFor(visits, poses, later);
    std::vector<std::optional<VisitMatch>> matches(candidates.size());
    tbb::parallel_for(size_t{0}, candidates.size(), [&](size_t c) {
      const Prepared& earlier = *prepared[candidates[c]];
      matches[c] = MatchVisits(earlier.grid,
                               earlier.surface,
                               visits[later],
                               poses[candidates[c]].Inverse() * poses[later],
                               MatchWindow());
    });
    bool is_new = false;
    for (size_t c = 0; c < candidates.size(); ++c) {
      if (!matches[c]) continue;
      edges.push_back(ClosureEdge(candidates[c], later, *matches[c], poses));
      VLOG(1) << "at " << visits[later].way_m << " m the rig is where it was at "
              << visits[candidates[c]].way_m
              << " m: " << std::sqrt(SquaredDeviation(edges.back(), poses))
              << " standard deviations from where it was believed to be";
      is_new = true;
    }
    if (is_new) SolvePoseGraph(edges, &poses);
  }
  for (const PoseGraphEdge& edge : edges) {
    if (!edge.may_be_wrong) continue;
    if (SquaredDeviation(edge, poses) < kMaxDeviation * kMaxDeviation) {
      placed.closures.push_back(edge);
    } else {
      ++placed.num_contradicted;
    }
  }
  return placed;
}

bool Hold(const std::vector<PoseGraphEdge>& closures, const std::vector<Visit>& visits) {
  std::vector<PlanarPose> poses;
  for (const Visit& visit : visits) poses.push_back(visit.world_from_visit);
  return std::all_of(closures.begin(), closures.end(), [&](const PoseGraphEdge& closure) {
    return SquaredDeviation(closure, poses) < kMaxDeviation * kMaxDeviation;
  });
}

}  // namespace plumbline

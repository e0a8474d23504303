#include "core/registration/revisits.h"

#include <glog/logging.h>
#include <tbb/parallel_for.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "core/geometry/unknown_pose.h"
#include "core/registration/place_groups.h"
#include "core/registration/visit_grid.h"
#include "core/registration/visit_matching.h"
#include "core/registration/visit_surface.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// Way since a place was left from which it counts as seen again.
constexpr double kMinWay = 12.0;  // m
// From the middle of one visit to that of another one, where they may show one place.
constexpr double kMaxDistance = 4.0;  // m
constexpr size_t kMaxTried = 3;       // earlier visits, the nearest ones
// How far the trajectory drifts from one visit to the next: a share of the way and of the
// turn, and radians besides.
constexpr double kDrift = 0.02;
constexpr double kHeadingDrift = 0.01;
// Errors of a match besides those of the surfaces: visits are not quite rigid.
constexpr double kMatchStddev = 0.03;          // m
constexpr double kMatchHeadingStddev = 0.004;  // rad
constexpr double kMaxDeviation = 4.0;          // standard deviations, of a closure that holds

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
      InverseSquares(kDrift * way_m, kHeadingDrift + kDrift * std::abs(turn)).asDiagonal();
  return edge;
}

// Takes the motions that wheels deny for slips, most often of the scans, which know no limit
// to it: such a motion becomes the wheels', known to no more than the two differ. Denied is
// what is far off by the drift and by how far the wheels are off usually (the median): some
// drift by degrees a metre, always to one side.
void TakeSlips(const std::vector<Visit>& visits,
               const Odometry& wheels,
               std::vector<PoseGraphEdge>* motion) {
  struct Denial {
    PoseGraphEdge* edge = nullptr;
    PlanarMotion stated;
    double all_turns = 0.0;  // on the spot a rig turns by far more than it has in the end
  };
  std::vector<Denial> compared;
  std::vector<double> off_m;
  std::vector<double> off_rad;
  for (PoseGraphEdge& edge : *motion) {
    const int64_t begin_ns = visits[edge.from].time_ns;
    const int64_t end_ns = visits[edge.to].time_ns;
    const std::optional<PlanarMotion> stated = wheels.Between(begin_ns, end_ns);
    if (!stated) continue;
    Denial& denial = compared.emplace_back();
    denial.edge = &edge;
    denial.stated = *stated;
    const int64_t step_ns = NanosecondsFromSeconds(0.2);
    for (int64_t t = begin_ns; t + step_ns < end_ns; t += step_ns) {
      denial.all_turns += std::abs(wheels.Between(t, t + step_ns)->turn);
    }
    off_m.push_back((edge.from_from_to.position - stated->translation).norm());
    off_rad.push_back(
        std::abs(std::remainder(edge.from_from_to.heading - stated->turn, 2.0 * M_PI)));
  }
  if (compared.empty()) return;
  const double usual_m = Median(off_m);
  const double usual_rad = Median(off_rad);
  for (size_t i = 0; i < compared.size(); ++i) {
    PoseGraphEdge& edge = *compared[i].edge;
    const double position_drift = std::sqrt(1.0 / edge.information(0, 0));
    const double heading_drift = std::max(kHeadingDrift + kDrift * compared[i].all_turns,
                                          std::sqrt(1.0 / edge.information(2, 2)));
    if (std::hypot(off_m[i] / std::hypot(position_drift, usual_m),
                   off_rad[i] / std::hypot(heading_drift, usual_rad)) <= kMaxDeviation) {
      continue;
    }
    VLOG(1) << "from " << visits[edge.from].way_m << " m on the wheels deny " << off_m[i]
            << " m and " << off_rad[i] * 180.0 / M_PI << " deg of the motion";
    edge.from_from_to = {std::remainder(compared[i].stated.turn, 2.0 * M_PI),
                         compared[i].stated.translation};
    edge.information = InverseSquares(std::hypot(position_drift, off_m[i]),
                                      std::hypot(heading_drift, off_rad[i]))
                           .asDiagonal();
  }
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
       Eigen::Matrix3d(InverseSquares(kUnknownPosition, kUnknownTurn).asDiagonal()))
          .inverse();
  covariance.diagonal() +=
      InverseSquares(1.0 / kMatchStddev, 1.0 / kMatchHeadingStddev);  // their squares
  edge.information = covariance.inverse();
  edge.may_be_wrong = true;
  return edge;
}

// Whether the place of an earlier visit has been left since.
bool IsAgain(const Visit& earlier, const Visit& later) {
  return SecondsBetween(earlier.time_ns, later.time_ns) >= kMinAbsence &&
         later.way_m - earlier.way_m >= kMinWay;
}

// Earlier visits that may show the place of a later one, nearest first.
std::vector<size_t> CandidatesFor(const std::vector<Visit>& visits,
                                  const std::vector<PlanarPose>& poses,
                                  size_t later) {
  std::vector<std::pair<double, size_t>> candidates;
  for (size_t i = 0; i < later; ++i) {
    if (!IsAgain(visits[i], visits[later])) continue;
    const double distance_m = (poses[i].position - poses[later].position).norm();
    if (distance_m < kMaxDistance) candidates.emplace_back(distance_m, i);
  }
  std::sort(candidates.begin(), candidates.end());
  if (candidates.size() > kMaxTried) candidates.resize(kMaxTried);
  std::vector<size_t> nearest;
  for (const auto& [distance_m, i] : candidates) nearest.push_back(i);
  return nearest;
}

// Whether poses lie where an edge has them, as far as it can tell.
bool Holds(const PoseGraphEdge& edge, const std::vector<PlanarPose>& poses) {
  return SquaredDeviation(edge, poses) < kMaxDeviation * kMaxDeviation;
}

using Views = std::vector<std::unique_ptr<Prepared>>;

// A pose graph of visits, and where it has them.
struct VisitGraph {
  std::vector<PoseGraphEdge> edges;
  std::vector<PlanarPose> poses;
};

// Adds what a visit shows of earlier ones that lie near where it is believed to be. The graph
// is solved where that moves its poses: each solution takes as long as the way so far.
void CloseNear(const std::vector<Visit>& visits,
               const Views& views,
               size_t later,
               VisitGraph* graph) {
  const std::vector<size_t> candidates = CandidatesFor(visits, graph->poses, later);
  std::vector<std::optional<VisitMatch>> matches(candidates.size());
  tbb::parallel_for(size_t{0}, candidates.size(), [&](size_t c) {
    const Prepared& earlier = *views[candidates[c]];
    matches[c] = MatchVisits(earlier.grid,
                             earlier.surface,
                             visits[later],
                             graph->poses[candidates[c]].Inverse() * graph->poses[later],
                             MatchWindow());
  });
  bool holds = true;
  for (size_t c = 0; c < candidates.size(); ++c) {
    if (!matches[c]) continue;
    graph->edges.push_back(ClosureEdge(candidates[c], later, *matches[c], graph->poses));
    VLOG(1) << "at " << visits[later].way_m << " m the rig is where it was at "
            << visits[candidates[c]].way_m
            << " m: " << std::sqrt(SquaredDeviation(graph->edges.back(), graph->poses))
            << " standard deviations from where it was believed to be";
    holds = holds && Holds(graph->edges.back(), graph->poses);
  }
  if (!holds) SolvePoseGraph(graph->edges, &graph->poses);
}

// Looks once more for the places of visits that none were found for: while the drift up to
// them was not known, they were believed too far away.
void CloseLeft(const std::vector<Visit>& visits, const Views& views, VisitGraph* graph) {
  std::vector<bool> is_closed(visits.size(), false);
  bool any = false;
  for (const PoseGraphEdge& edge : graph->edges) {
    if (edge.may_be_wrong) any = is_closed[edge.to] = true;
  }
  if (!any) return;  // the poses are what they were
  for (size_t later = 1; later < visits.size(); ++later) {
    if (!is_closed[later]) CloseNear(visits, views, later, graph);
  }
  SolvePoseGraph(graph->edges, &graph->poses);
}

// How far from the middle of a visit what it shows lies, whichever way it looks: shares of its
// points, by the square root, in rings of half a metre, each with its neighbours since middles
// of visits of one place lie up to a stride apart.
std::vector<double> RingsOf(const Visit& visit) {
  std::vector<double> rings(40, 0.0);
  for (const Eigen::Vector2d& point : visit.points) {
    const auto ring = static_cast<int>(2.0 * point.norm());
    for (int i = std::max(0, ring - 1); i <= ring + 1; ++i) {
      if (i < static_cast<int>(rings.size())) rings[static_cast<size_t>(i)] += 1.0;
    }
  }
  double sum = 0.0;
  for (const double count : rings) sum += count;
  for (double& count : rings) count = std::sqrt(count / std::max(1.0, sum));
  return rings;
}

// Pairs of visits that are believed to be of different places and look alike by their rings:
// of every other visit the likeliest earlier ones.
std::vector<std::pair<size_t, size_t>> AlikePairs(const std::vector<Visit>& visits,
                                                  const std::vector<PlanarPose>& poses) {
  std::vector<std::vector<double>> rings(visits.size());
  tbb::parallel_for(
      size_t{0}, visits.size(), [&](size_t i) { rings[i] = RingsOf(visits[i]); });
  std::vector<std::pair<size_t, size_t>> pairs;
  for (size_t later = 0; later < visits.size(); later += 2) {
    std::vector<std::pair<double, size_t>> alike;
    for (size_t earlier = 0; earlier < later; ++earlier) {
      if (!IsAgain(visits[earlier], visits[later]) ||
          (poses[earlier].position - poses[later].position).norm() < kMaxDistance) {
        continue;
      }
      const double likeness = std::inner_product(
          rings[later].begin(), rings[later].end(), rings[earlier].begin(), 0.0);
      alike.emplace_back(-likeness, earlier);
    }
    std::sort(alike.begin(), alike.end());
    if (alike.size() > 2 * kMaxTried) alike.resize(2 * kMaxTried);
    for (const auto& [likeness, earlier] : alike) pairs.emplace_back(earlier, later);
  }
  return pairs;
}

// Where visits lie in others that are believed to be elsewhere.
std::vector<PoseGraphEdge> MatchAnywhere(const std::vector<Visit>& visits,
                                         const Views& views,
                                         const std::vector<PlanarPose>& poses) {
  const std::vector<std::pair<size_t, size_t>> pairs = AlikePairs(visits, poses);
  std::vector<std::optional<VisitMatch>> matches(pairs.size());
  tbb::parallel_for(size_t{0}, pairs.size(), [&](size_t i) {
    const auto& [earlier, later] = pairs[i];
    MatchWindow window =
        WindowByDirections(views[earlier]->surface, views[later]->surface, 0.5 * kMaxDistance);
    window.min_score *= 2.0;  // anywhere, more is alike by chance
    matches[i] = MatchVisits(
        views[earlier]->grid, views[earlier]->surface, visits[later], PlanarPose(), window);
  });
  std::vector<PoseGraphEdge> closures;
  for (size_t i = 0; i < pairs.size(); ++i) {
    if (!matches[i]) continue;
    closures.push_back(ClosureEdge(pairs[i].first, pairs[i].second, *matches[i], poses));
    const Eigen::Matrix3d covariance = closures.back().information.inverse();
    // A corridor that is open along itself agrees with any.
    const double spread = std::sqrt(covariance.topLeftCorner<2, 2>().trace());
    if (spread > VisitGrid::kCell * VisitGrid::kCoarse) closures.pop_back();
  }
  return closures;
}

// Finds groups of places elsewhere that agree with each other and contradict the graph. Where
// what was found near where it was believed to be agrees, there is nothing to look for.
std::vector<PlaceGroup> GroupsElsewhere(const std::vector<Visit>& visits,
                                        const Views& views,
                                        const std::vector<PoseGraphEdge>& motion,
                                        const VisitGraph& graph) {
  std::vector<PoseGraphEdge> near;
  size_t num_near = 0;
  size_t num_contradicted = 0;
  for (const PoseGraphEdge& edge : graph.edges) {
    if (!edge.may_be_wrong) continue;
    ++num_near;
    num_contradicted += Holds(edge, graph.poses) ? 0 : 1;
    const bool is_first = near.empty() || near.back().to != edge.to;
    if (is_first && edge.to % 2 == 0) near.push_back(edge);
  }
  if (4 * num_contradicted <= num_near) return {};
  // One near closure of each visit may contradict what is found elsewhere.
  std::vector<PoseGraphEdge> closures = MatchAnywhere(visits, views, graph.poses);
  closures.insert(closures.end(), near.begin(), near.end());
  std::vector<PlaceGroup> groups = ConsistentGroups(closures, motion, visits, kMinWay);
  const auto is_known = [&](const PlaceGroup& group) {
    return std::all_of(group.begin(), group.end(), [&](const PoseGraphEdge& closure) {
      return Holds(closure, graph.poses);
    });
  };
  groups.erase(std::remove_if(groups.begin(), groups.end(), is_known), groups.end());
  VLOG(1) << num_contradicted << " of " << num_near << " closures are contradicted; "
          << groups.size() << " groups of places elsewhere agree";
  return groups;
}

// Returns the graph of the motion and of groups of places. These are far beyond what a loss
// takes for an error, so they are believed first.
VisitGraph GraphOf(const std::vector<PlaceGroup>& groups,
                   const std::vector<Visit>& visits,
                   const Views& views,
                   const std::vector<PoseGraphEdge>& motion) {
  VisitGraph graph = {motion, {}};
  for (const PlaceGroup& group : groups) {
    for (PoseGraphEdge closure : group) {
      closure.may_be_wrong = false;
      graph.edges.push_back(closure);
    }
    VLOG(1) << group.size() << " visits from " << visits[group.front().to].way_m
            << " m on are where others were from " << visits[group.front().from].way_m
            << " m on";
  }
  graph.poses.push_back(visits[0].world_from_visit);
  for (const PoseGraphEdge& edge : motion) {
    graph.poses.push_back(graph.poses.back() * edge.from_from_to);
  }
  SolvePoseGraph(graph.edges, &graph.poses);
  for (size_t i = motion.size(); i < graph.edges.size(); ++i) {
    graph.edges[i].may_be_wrong = true;
  }
  for (size_t later = 1; later < visits.size(); ++later) {
    CloseNear(visits, views, later, &graph);
  }
  SolvePoseGraph(graph.edges, &graph.poses);
  return graph;
}

}  // namespace

PlacedVisits PlaceVisits(const std::vector<Visit>& visits, const Odometry* wheels) {
  PlacedVisits placed;
  if (visits.empty()) return placed;
  Views views(visits.size());
  tbb::parallel_for(size_t{0}, visits.size(), [&](size_t i) {
    views[i] = std::make_unique<Prepared>(visits[i]);
  });
  VisitGraph graph;
  std::vector<PoseGraphEdge> motion;
  for (size_t from = 0; from + 1 < visits.size(); ++from) {
    motion.push_back(MotionEdge(visits, from));
  }
  if (wheels != nullptr) TakeSlips(visits, *wheels, &motion);
  graph.poses.push_back(visits[0].world_from_visit);
  for (size_t later = 1; later < visits.size(); ++later) {
    graph.edges.push_back(motion[later - 1]);
    graph.poses.push_back(graph.poses.back() * motion[later - 1].from_from_to);
    CloseNear(visits, views, later, &graph);
  }
  SolvePoseGraph(graph.edges, &graph.poses);
  const std::vector<PlaceGroup> groups = GroupsElsewhere(visits, views, motion, graph);
  if (!groups.empty()) graph = GraphOf(groups, visits, views, motion);
  CloseLeft(visits, views, &graph);
  placed.world_from_visit = graph.poses;
  const std::vector<PlanarPose>& poses = graph.poses;
  const std::vector<PoseGraphEdge>& edges = graph.edges;
  for (const PoseGraphEdge& edge : edges) {
    if (!edge.may_be_wrong) continue;
    if (Holds(edge, poses)) {
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
    return Holds(closure, poses);
  });
}

}  // namespace plumbline

#include "core/registration/part_matching.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/geometry/robust_fit.h"

namespace plumbline {
namespace {

constexpr int kHeadings = 180;        // bins of two degrees
constexpr double kMinCosine = 0.985;  // between normals of one wall: ten degrees
constexpr size_t kMaxYaws = 16;
constexpr size_t kMaxShifts = 12;  // for each yaw

using Cell = std::pair<int, int>;

Cell CellOf(const Eigen::Vector2d& p, double size) {
  return {static_cast<int>(std::floor(p.x() / size)),
          static_cast<int>(std::floor(p.y() / size))};
}

// The spot of the same wall that is nearest along it; null where there is none.
const WallSpot* FindOn(const SpotGrid& grid,
                       const WallSpot& spot,
                       double max_along,
                       double max_across) {
  const WallSpot* best = nullptr;
  double best_distance = max_along;
  grid.ForEachNear(spot.position, [&](const WallSpot& other) {
    const Eigen::Vector2d offset = spot.position - other.position;
    if (other.normal.dot(spot.normal) < kMinCosine ||
        std::abs(other.normal.dot(offset)) > max_across || offset.norm() >= best_distance) {
      return;
    }
    best = &other;
    best_distance = offset.norm();
  });
  return best;
}

// Calls visit(spot) for the walls that a way leads through: it begins and ends well off them,
// on different sides. Beams along a wall come near it all the way.
template <typename Visit>
void ForWallsOn(const SpotGrid& grid,
                const FreeBeam& way,
                double spacing_m,
                const Visit& visit) {
  const double distance = 0.6 * spacing_m;
  const Eigen::Vector2d along = way.to - way.from;
  const double length_m = along.norm();
  for (double at = 0.0; at < length_m; at += 0.5 * spacing_m) {
    const Eigen::Vector2d p = way.from + along * (at / length_m);
    grid.ForEachNear(p, [&](const WallSpot& wall) {
      if ((wall.position - p).squaredNorm() > distance * distance) return;
      const double from = wall.normal.dot(way.from - wall.position);
      const double to = wall.normal.dot(way.to - wall.position);
      if (from * to < 0.0 && std::min(std::abs(from), std::abs(to)) > distance) visit(wall);
    });
  }
}

WallSpot Moved(const PlanarPose& pose, const WallSpot& spot) {
  const Eigen::Matrix2d rotation = pose.Rotation();
  return {rotation * spot.position + pose.position, rotation * spot.normal};
}

std::vector<double> HeadingHistogram(const std::vector<WallSpot>& spots) {
  std::vector<double> histogram(kHeadings, 0.0);
  for (const WallSpot& spot : spots) {
    const double heading =
        std::atan2(spot.normal.y(), spot.normal.x()) / (2.0 * M_PI) * kHeadings;
    const int bin = static_cast<int>(std::floor(heading));
    const double share = heading - bin;
    histogram[static_cast<size_t>((bin + kHeadings) % kHeadings)] += 1.0 - share;
    histogram[static_cast<size_t>((bin + 1 + kHeadings) % kHeadings)] += share;
  }
  return histogram;
}

// The turns of b under which its walls have the directions of a's, the best first.
std::vector<double> CandidateYaws(const PartView& a, const PartView& b) {
  const std::vector<double> of_a = HeadingHistogram(a.spots);
  const std::vector<double> of_b = HeadingHistogram(b.spots);
  std::vector<double> scores(kHeadings, 0.0);
  for (int turn = 0; turn < kHeadings; ++turn) {
    for (int bin = 0; bin < kHeadings; ++bin) {
      const double turned = of_a[static_cast<size_t>((bin + turn) % kHeadings)];
      scores[static_cast<size_t>(turn)] += std::sqrt(of_b[static_cast<size_t>(bin)] * turned);
    }
  }
  std::vector<std::pair<double, int>> peaks;
  for (int turn = 0; turn < kHeadings; ++turn) {
    const double score = scores[static_cast<size_t>(turn)];
    const double before = scores[static_cast<size_t>((turn + kHeadings - 1) % kHeadings)];
    const double after = scores[static_cast<size_t>((turn + 1) % kHeadings)];
    if (score > 0.0 && score >= before && score > after) peaks.emplace_back(-score, turn);
  }
  std::sort(peaks.begin(), peaks.end());
  if (peaks.size() > kMaxYaws) peaks.resize(kMaxYaws);
  std::vector<double> yaws;
  for (const auto& [score, turn] : peaks) yaws.push_back(turn * 2.0 * M_PI / kHeadings);
  return yaws;
}

// The shifts that bring most spots of b, turned, onto spots of a.
std::vector<PlanarPose> CandidateShifts(const PartView& a,
                                        const PartView& b,
                                        double yaw,
                                        double cell_m) {
  std::map<Cell, int> votes;
  for (const WallSpot& spot : b.spots) {
    const WallSpot turned = Moved({yaw, Eigen::Vector2d::Zero()}, spot);
    for (const WallSpot& other : a.spots) {
      if (other.normal.dot(turned.normal) < kMinCosine) continue;
      ++votes[CellOf(other.position - turned.position, cell_m)];
    }
  }
  std::vector<std::pair<int, Cell>> order;
  for (const auto& [cell, count] : votes) {
    bool is_peak = true;
    for (int i = -1; i <= 1; ++i) {
      for (int j = -1; j <= 1; ++j) {
        const auto other = votes.find({cell.first + i, cell.second + j});
        is_peak = is_peak && (other == votes.end() || other->second <= count);
      }
    }
    if (is_peak) order.emplace_back(-count, cell);
  }
  std::sort(order.begin(), order.end());
  if (order.size() > kMaxShifts) order.resize(kMaxShifts);
  std::vector<PlanarPose> poses;
  for (const auto& [count, cell] : order) {
    poses.push_back({yaw, cell_m * Eigen::Vector2d(cell.first + 0.5, cell.second + 0.5)});
  }
  return poses;
}

// Gauss-Newton on the spots' distances from the walls of the other part.
void Refine(const SpotGrid& grid,
            const PartView& b,
            double spacing_m,
            double last_m,
            PlanarPose* pose) {
  constexpr int kSteps = 8;
  for (int step = 0; step < kSteps; ++step) {
    const double max_across = step < kSteps / 2 ? 1.5 * spacing_m : last_m;
    RobustFit<3> fit;
    fit.AddPrior(1e-6 * Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
    for (const WallSpot& spot : b.spots) {
      const WallSpot moved = Moved(*pose, spot);
      const WallSpot* other = FindOn(grid, moved, 2.0 * spacing_m, max_across);
      if (other == nullptr) continue;
      const Eigen::Vector2d arm = moved.position - pose->position;
      fit.Add({other->normal.dot(Eigen::Vector2d(-arm.y(), arm.x())),
               other->normal.x(),
               other->normal.y()},
              other->normal.dot(moved.position - other->position),
              1.0);
    }
    const Eigen::Vector3d change = fit.Step();
    pose->heading += change(0);
    pose->position += change.tail<2>();
  }
}

// Counts the beams of one part, moved, that pass through walls of the other: (through, all).
std::pair<int, int> CountRefuted(const SpotGrid& grid,
                                 const std::vector<FreeBeam>& beams,
                                 const PlanarPose& pose,
                                 double spacing_m) {
  constexpr size_t kStride = 5;  // a fifth of the beams tells as well
  int refuted = 0;
  int all = 0;
  const Eigen::Matrix2d rotation = pose.Rotation();
  for (size_t i = 0; i < beams.size(); i += kStride) {
    const FreeBeam moved = {rotation * beams[i].from + pose.position,
                            rotation * beams[i].to + pose.position};
    bool through = false;
    ForWallsOn(grid, moved, spacing_m, [&through](const WallSpot&) { through = true; });
    if (through) ++refuted;
    ++all;
  }
  return {refuted, all};
}

// The spots that hardly one of the beams passes through. A segment may lead on across a door.
std::vector<WallSpot> SolidSpots(const std::vector<WallSpot>& spots,
                                 const std::vector<FreeBeam>& beams,
                                 double spacing_m) {
  constexpr int kFew = 2;  // one beam may be wrong
  const SpotGrid grid(spots, 2.0 * spacing_m);
  std::map<const WallSpot*, int> num_through;
  for (const FreeBeam& beam : beams) {
    std::set<const WallSpot*> through;
    ForWallsOn(grid, beam, spacing_m, [&](const WallSpot& wall) { through.insert(&wall); });
    for (const WallSpot* wall : through) ++num_through[wall];
  }
  std::vector<WallSpot> solid;
  for (const WallSpot& spot : grid.spots()) {
    const auto found = num_through.find(&spot);
    if (found == num_through.end() || found->second < kFew) solid.push_back(spot);
  }
  return solid;
}

// The share of a part's beams that pass through its own walls, after every other beam has
// taken away those that are none: what is to be expected of beams that belong to the place.
double OwnRefutedShare(const PartView& view, double spacing_m) {
  std::vector<FreeBeam> halves[2];
  for (size_t i = 0; i < view.beams.size(); ++i) halves[i % 2].push_back(view.beams[i]);
  const std::vector<WallSpot> solid = SolidSpots(view.spots, halves[0], spacing_m);
  const auto [refuted, all] =
      CountRefuted(SpotGrid(solid, 2.0 * spacing_m), halves[1], PlanarPose(), spacing_m);
  return static_cast<double>(refuted) / std::max(1, all);
}

struct Overlap {
  double length_m = 0.0;
  double weaker_length_m = 0.0;  // that holds the direction that is held least
  int num_surfaces = 0;
};

Overlap OverlapAt(const SpotGrid& grid,
                  const PartView& b,
                  const PlanarPose& pose,
                  const PartMatchingOptions& options) {
  Eigen::Matrix2d normals = Eigen::Matrix2d::Zero();
  std::map<Cell, int> surfaces;  // by heading and distance from the origin
  int count = 0;
  for (const WallSpot& spot : b.spots) {
    const WallSpot moved = Moved(pose, spot);
    if (FindOn(grid, moved, 2.0 * options.spacing_m, options.max_distance_m) == nullptr)
      continue;
    ++count;
    normals += spot.normal * spot.normal.transpose();
    const double heading = std::atan2(spot.normal.y(), spot.normal.x());
    ++surfaces[{static_cast<int>(std::lround(heading / (M_PI / 12.0) + 24.0)) % 24,
                static_cast<int>(std::lround(spot.normal.dot(spot.position) / 0.5))}];
  }
  const double weaker =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(normals).eigenvalues()(0);
  Overlap overlap{count * options.spacing_m, weaker * options.spacing_m, 0};
  for (const auto& [key, num_spots] : surfaces) {
    if (num_spots * options.spacing_m >= 0.6) ++overlap.num_surfaces;
  }
  return overlap;
}

bool AreOne(const PlanarPose& a, const PlanarPose& b, const Eigen::Vector2d& centre) {
  return std::cos(a.heading - b.heading) > 0.99 && (a * centre - b * centre).norm() < 0.4;
}

}  // namespace

PartMatch MatchParts(const PartView& view_a,
                     const PartView& view_b,
                     const PartMatchingOptions& options,
                     const std::function<bool(const PlanarPose&)>& is_possible) {
  const PartView a = {SolidSpots(view_a.spots, view_a.beams, options.spacing_m), view_a.beams};
  const PartView b = {SolidSpots(view_b.spots, view_b.beams, options.spacing_m), view_b.beams};
  // Among furniture, part of which is seen from here and part from there, beams pass through
  // walls of their own part as well, and through twice as many of one seen from other places.
  const double own_a = OwnRefutedShare(view_a, options.spacing_m);
  const double own_b = OwnRefutedShare(view_b, options.spacing_m);
  const double max_refuted_share = options.max_refuted_share + 2.0 * std::max(own_a, own_b);
  VLOG(1) << "of their own beams " << own_a << " and " << own_b << " pass through walls";
  if (a.spots.empty() || b.spots.empty()) return {std::nullopt, "a part shows no wall"};
  const SpotGrid of_a(a.spots, 2.0 * options.spacing_m);
  const SpotGrid of_b(b.spots, 2.0 * options.spacing_m);
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  for (const WallSpot& spot : b.spots) {
    centre += spot.position / static_cast<double>(b.spots.size());
  }
  std::vector<std::pair<PartPose, Overlap>> candidates;
  for (const double yaw : CandidateYaws(a, b)) {
    for (PlanarPose pose : CandidateShifts(a, b, yaw, 1.5 * options.spacing_m)) {
      Refine(of_a, b, options.spacing_m, options.max_distance_m, &pose);
      if (is_possible && !is_possible(pose)) continue;
      const Overlap overlap = OverlapAt(of_a, b, pose, options);
      candidates.push_back({{pose, overlap.length_m, 0.0}, overlap});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& x, const auto& y) {
    return x.first.length_m > y.first.length_m;
  });
  if (candidates.empty())
    return {std::nullopt, "no walls match where the rig can have come to"};
  std::vector<std::pair<PartPose, Overlap>> kept;  // at most two poses that nothing refutes
  for (auto& [pose, overlap] : candidates) {
    if (!kept.empty() && AreOne(kept.front().first.a_from_b, pose.a_from_b, centre)) continue;
    const auto through_a = CountRefuted(of_a, b.beams, pose.a_from_b, options.spacing_m);
    const auto through_b =
        CountRefuted(of_b, a.beams, pose.a_from_b.Inverse(), options.spacing_m);
    pose.refuted_share = static_cast<double>(through_a.first + through_b.first) /
                         std::max(1, through_a.second + through_b.second);
    VLOG(1) << "candidate: yaw " << pose.a_from_b.heading * 180.0 / M_PI << " deg, "
            << pose.a_from_b.position.transpose() << " m, matches " << overlap.length_m
            << " m (" << overlap.weaker_length_m << " m the other way) of "
            << overlap.num_surfaces << " surfaces, " << through_a.first << " of "
            << through_a.second << " and " << through_b.first << " of " << through_b.second
            << " beams refute it";
    if (pose.refuted_share > max_refuted_share) continue;
    kept.emplace_back(pose, overlap);
    if (kept.size() == 2) break;
  }
  if (kept.empty()) return {std::nullopt, "wherever walls match, beams pass through others"};
  const auto& [best, overlap] = kept.front();
  if (overlap.length_m < options.min_length_m) {
    return {std::nullopt, "too little of the walls is in both parts"};
  }
  if (overlap.weaker_length_m < 0.25 * options.min_length_m) {
    return {std::nullopt, "the walls in both parts leave a direction open"};
  }
  if (kept.size() == 2 && kept[1].first.length_m > options.max_second_share * best.length_m) {
    return {std::nullopt,
            "another pose matches nearly as well: there are rooms that look alike"};
  }
  if (overlap.num_surfaces < options.min_surfaces) {
    return {std::nullopt,
            "the walls in both parts are too few to be those of one place alone"};
  }
  return {best, ""};
}

}  // namespace plumbline

#include "core/visibility/free_space.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/association/association.h"
#include "core/association/plane_merging.h"
#include "core/geometry/plan_grid.h"
#include "core/sensor/rig.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/visibility/beam_tests.h"

namespace plumbline {
namespace {

// A beam passes a plane if it begins and ends this far from it, in standard deviations of a
// range.
constexpr double kMarginSigmas = 6.0;
// The middle of a wall is this share of its width: its rim may border an opening.
constexpr double kMiddleShare = 0.6;
// A landmark is passed through if this share of its cells is.
constexpr double kPassedShare = 0.5;
// Beams that cross a cell for each segment on it. Well above one: railings and rows of chairs
// are surfaces too, though many beams find their gaps.
constexpr int kPassagesPerSegment = 10;
// One of three beams of a segment is followed, in the next scan another: it stands for the
// first, the one in the middle and the last.
constexpr int kBeamsPerSegment = 3;

// The end of the beam that is followed.
Eigen::Vector2d PointFollowed(const Observation& observation) {
  switch (observation.scan_index % kBeamsPerSegment) {
    case 0:
      return observation.centroid();
    case 1:
      return observation.start();
    default:
      return observation.end();
  }
}

// The occupied cell of a patch that the point lies on, in the middle of the patch's width;
// nothing elsewhere.
std::optional<CellGrid::Cell> MiddleCell(const PatchExtent& extent,
                                         const Eigen::Vector3d& p_world) {
  const Eigen::Vector2d p = extent.Project(p_world);
  const double low = extent.min_corner().x();
  const double high = extent.max_corner().x();
  if (std::abs(p.x() - 0.5 * (low + high)) > 0.5 * kMiddleShare * (high - low)) {
    return std::nullopt;
  }
  const CellGrid::Cell cell = PatchExtent::CellAt(p);
  return extent.cells().Count(cell) > 0 ? std::optional<CellGrid::Cell>(cell) : std::nullopt;
}

// Where a beam whose ends lie on two sides of a surface, at signed distances start and end,
// crosses it: the share of the beam up to there. Along the beam, the distance is
// start + slope s + bow s^2.
double CrossingShare(double start, double end, double bow) {
  const double slope = end - start - bow;
  const double root = std::sqrt(slope * slope - 4.0 * bow * start);
  return 2.0 * start / (std::copysign(root, start) - slope);
}

// Counts the beam where it crosses a landmark's patch, well away from the surface at both of
// its ends.
void CountPassage(const LandmarkView& surface,
                  const Eigen::Vector3d& start_world,
                  const Eigen::Vector3d& end_world,
                  double margin_m,
                  CellGrid* passages) {
  const double start = surface.SignedDistance(start_world);
  const double end = surface.SignedDistance(end_world);
  if (std::abs(start) < margin_m || std::abs(end) < margin_m || start * end > 0.0) return;
  const Eigen::Vector3d along = end_world - start_world;
  const double bow = 0.5 * surface.curvature * along.head<2>().squaredNorm();
  const Eigen::Vector3d at = start_world + CrossingShare(start, end, bow) * along;
  const auto cell = MiddleCell(surface.landmark->extent, at);
  if (cell) passages->Add(*cell, kBeamsPerSegment);
}

// A box on the floor plan around the points of a surface for which MiddleCell() may find a
// cell.
Eigen::AlignedBox2d PlanBox(const LandmarkView& plane) {
  const PatchExtent& extent = plane.landmark->extent;
  Eigen::AlignedBox2d box;
  if (extent.empty()) return box;
  if (plane.is_curved) {
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(plane.radius_m + kConcernReach);
    return {plane.centre_world.head<2>() - reach, plane.centre_world.head<2>() + reach};
  }
  // Only the middle of the width counts.
  const double width = extent.max_corner().x() - extent.min_corner().x();
  const Eigen::Vector2d rim(-0.5 * (1.0 - kMiddleShare) * width, kConcernReach);
  const Eigen::AlignedBox2d patch(extent.min_corner() - rim, extent.max_corner() + rim);
  // Along their own normal the patch's axes may have been left behind by the plane.
  const Eigen::Vector3d across = extent.axes().u.cross(extent.axes().v);
  const double slope = plane.normal.dot(across);
  if (std::abs(slope) < 0.5) {
    constexpr double kAnywhere = 1e6;  // m
    box.extend(Eigen::Vector2d(-kAnywhere, -kAnywhere));
    box.extend(Eigen::Vector2d(kAnywhere, kAnywhere));
    return box;
  }
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft,
                            Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopLeft,
                            Eigen::AlignedBox2d::TopRight}) {
    const Eigen::Vector3d on_axes = extent.ToWorld(patch.corner(corner));
    const double away = (plane.distance - plane.normal.dot(on_axes)) / slope;
    box.extend(Eigen::Vector2d((on_axes + away * across).head<2>()));
  }
  return box;
}

}  // namespace

std::vector<bool> FindPassedThrough(const Rig& rig, const MapState& state) {
  const double margin_m = kMarginSigmas * MaxRangeNoise(rig);
  std::vector<CellGrid> passages(state.landmarks.size());
  LoopClosureOptions no_gap;
  no_gap.enabled = true;
  const std::vector<LandmarkView> planes = ViewsWithinGap(state.landmarks, 0, no_gap);
  std::vector<Eigen::AlignedBox2d> boxes;
  for (const LandmarkView& plane : planes) boxes.push_back(PlanBox(plane));
  PlanGrid grid(boxes);
  SharedPoses poses(rig, state.trajectory);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0) continue;
    const ScanPlacement placement =
        poses.Of(observation).motion.At(observation.middle_time_ns());
    const Eigen::Vector3d start_world = placement.col(2);
    const Eigen::Vector3d end_world = placement * PointFollowed(observation).homogeneous();
    grid.ForEachNear(start_world.head<2>(), end_world.head<2>(), [&](int index) {
      const LandmarkView& plane = planes[static_cast<size_t>(index)];
      if (plane.landmark->id == observation.landmark_id) return;
      CountPassage(plane,
                   start_world,
                   end_world,
                   margin_m,
                   &passages[static_cast<size_t>(plane.landmark->id)]);
    });
  }
  std::vector<bool> passed_through;
  for (const Landmark& landmark : state.landmarks) {
    const CellGrid& seen_on = landmark.extent.cells();
    int num_passed = 0;
    passages[static_cast<size_t>(landmark.id)].Any([&](const CellGrid::Cell& cell, int count) {
      if (count > kPassagesPerSegment * seen_on.Count(cell)) ++num_passed;
      return false;
    });
    passed_through.push_back(num_passed >
                             kPassedShare * kMiddleShare * seen_on.num_occupied());
  }
  return passed_through;
}

}  // namespace plumbline

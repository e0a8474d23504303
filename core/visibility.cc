#include "core/visibility.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/association.h"
#include "core/duplicates.h"

namespace plumbline {
namespace {

constexpr double kMarginSigmas = 6.0;  // of range noise, on both sides of the plane
constexpr double kMiddleShare = 0.6;   // of a wall's width: its rim may border an opening
constexpr double kPassedShare = 0.5;   // of a landmark's cells
// Beams that cross a cell for each segment on it. Well above one: railings and rows of chairs
// are surfaces too, though many beams find their gaps.
constexpr int kPassagesPerSegment = 10;

// Where a beam crosses a landmark's patch, well away from the plane at both of its ends.
std::optional<PatchExtent::Cell> CrossedCell(const LandmarkCandidate& plane,
                                             const Eigen::Vector3d& start_world,
                                             const Eigen::Vector3d& end_world,
                                             double margin_m) {
  const double start = plane.normal.dot(start_world) - plane.distance;
  const double end = plane.normal.dot(end_world) - plane.distance;
  if (std::abs(start) < margin_m || std::abs(end) < margin_m || start * end > 0.0) {
    return std::nullopt;
  }
  const Eigen::Vector3d at = start_world + start / (start - end) * (end_world - start_world);
  return plane.landmark->extent.MiddleCell(at, kMiddleShare);
}

}  // namespace

std::vector<bool> FindPassedThrough(const Rig& rig, const MapState& state) {
  const double margin_m = kMarginSigmas * MaxRangeNoise(rig);
  std::vector<CellGrid> passages(state.landmarks.size());
  LoopClosureOptions no_gap;
  no_gap.enabled = true;
  const std::vector<LandmarkCandidate> planes =
      CandidatesWithinGap(state.landmarks, 0, no_gap);
  for (const Observation& observation : state.observations) {
    if (observation.landmark_id < 0) continue;
    const Rigid3d world_from_scanner =
        state.trajectory.WorldFromBody(observation.middle_time_ns()) *
        rig.scanners[static_cast<size_t>(observation.scanner_index)].body_from_scanner;
    for (const Eigen::Vector2d& p :
         {observation.start, observation.centroid, observation.end}) {
      const Eigen::Vector3d end_world =
          world_from_scanner * Eigen::Vector3d(p.x(), p.y(), 0.0);
      for (const LandmarkCandidate& plane : planes) {
        if (plane.landmark->id == observation.landmark_id) continue;
        const auto cell =
            CrossedCell(plane, world_from_scanner.translation, end_world, margin_m);
        if (cell) passages[static_cast<size_t>(plane.landmark->id)].Add(*cell, 1);
      }
    }
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

#include "core/opening_map.h"

#include <cmath>

namespace plumbline {
namespace {

constexpr double kNarrow = 0.02;  // m
constexpr double kWide = 0.25;
// What is farther than this from a plane's bounding rectangle says nothing of it.
constexpr double kMargin = 1.0;
constexpr int kMinCount = 2;
constexpr double kMinShare = 0.1;
constexpr double kMinShareLevel = 0.5;

CellGrid::Cell CellOf(const Landmark& landmark,
                      const Eigen::Vector3d& p_world,
                      bool narrow_along_u) {
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector3d from_anchor = p_world - extent.anchor();
  const double u = extent.u_axis().dot(from_anchor);
  const double v = extent.v_axis().dot(from_anchor);
  return {static_cast<int>(std::floor(u / (narrow_along_u ? kNarrow : kWide))),
          static_cast<int>(std::floor(v / (narrow_along_u ? kWide : kNarrow)))};
}

// Without height there are no level edges: cells that are wide along u would only blur.
bool HasCells(const Landmark& landmark, bool narrow_along_u) {
  return narrow_along_u || OpeningMap::HasHeight(landmark);
}

}  // namespace

void OpeningMap::Count(const Landmark& landmark,
                       const Eigen::Vector3d& p_world,
                       CellGrid Counts::*grid) {
  if (!landmark.extent.IsWithin(p_world, kMargin)) return;
  CountsOfPlane& counts = counts_[landmark.id];
  for (const bool narrow_along_u : {true, false}) {
    if (!HasCells(landmark, narrow_along_u)) continue;
    (counts[narrow_along_u ? 0 : 1].*grid).Add(CellOf(landmark, p_world, narrow_along_u), 1);
  }
}

void OpeningMap::CountHit(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  Count(landmark, p_world, &Counts::hits);
}
void OpeningMap::CountPassage(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  Count(landmark, p_world, &Counts::passages);
}
void OpeningMap::CountBlock(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  Count(landmark, p_world, &Counts::blocks);
}

bool OpeningMap::HasHeight(const Landmark& landmark) {
  return landmark.extent.max_corner().y() - landmark.extent.min_corner().y() > kWide;
}

bool OpeningMap::HasOpenings(const Landmark& landmark) const {
  const auto at = counts_.find(landmark.id);
  if (at == counts_.end()) return false;
  const Counts& counts = at->second.front();
  return counts.passages.num_occupied() > 0 || counts.blocks.num_occupied() > 0;
}

bool OpeningMap::Counts::IsOpening(const CellGrid::Cell& cell,
                                   bool narrow_along_u,
                                   double min_share) const {
  const int blocked = blocks.Count(cell);
  if (blocked >= kMinCount && blocked > hits.Count(cell)) return true;
  for (int aside = -1; aside <= 1; ++aside) {
    CellGrid::Cell near = cell;
    (narrow_along_u ? near.first : near.second) += aside;
    const int passed = passages.Count(near);
    if (passed >= kMinCount && passed > min_share * (passed + hits.Count(near))) return true;
  }
  return false;
}

bool OpeningMap::IsOpening(const Landmark& landmark, const Eigen::Vector3d& p_world) const {
  const auto at = counts_.find(landmark.id);
  if (at == counts_.end()) return false;
  const double min_share = HasHeight(landmark) ? kMinShare : kMinShareLevel;
  for (const bool narrow_along_u : {true, false}) {
    if (!HasCells(landmark, narrow_along_u)) continue;
    const Counts& counts = at->second[narrow_along_u ? 0 : 1];
    if (counts.IsOpening(
            CellOf(landmark, p_world, narrow_along_u), narrow_along_u, min_share)) {
      return true;
    }
  }
  return false;
}

}  // namespace plumbline

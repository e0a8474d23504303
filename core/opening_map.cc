#include "core/opening_map.h"

#include <cmath>

namespace plumbline {
namespace {

constexpr double kCellSize = 0.05;  // m

CellGrid::Cell CellOf(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector3d from_anchor = p_world - extent.anchor();
  return {static_cast<int>(std::floor(extent.u_axis().dot(from_anchor) / kCellSize)),
          static_cast<int>(std::floor(extent.v_axis().dot(from_anchor) / kCellSize))};
}

}  // namespace

void OpeningMap::CountHit(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  counts_[landmark.id].hits.Add(CellOf(landmark, p_world), 1);
}

void OpeningMap::CountPassage(const Landmark& landmark, const Eigen::Vector3d& p_world) {
  counts_[landmark.id].passages.Add(CellOf(landmark, p_world), 1);
}

bool OpeningMap::IsOpening(const Landmark& landmark, const Eigen::Vector3d& p_world) const {
  const auto at = counts_.find(landmark.id);
  if (at == counts_.end()) return false;
  const CellGrid::Cell cell = CellOf(landmark, p_world);
  return at->second.passages.Count(cell) > at->second.hits.Count(cell);
}

}  // namespace plumbline

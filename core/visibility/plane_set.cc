#include "core/visibility/plane_set.h"

#include <limits>
#include <utility>

#include "core/map/landmark_view.h"

namespace plumbline {

PlaneSet::PlaneSet(std::vector<LandmarkView> planes) : planes_(std::move(planes)) {
  const Eigen::Array4d none = Eigen::Array4d::Zero();
  const Eigen::Array4d far = Eigen::Array4d::Constant(std::numeric_limits<double>::infinity());
  blocks_.assign((planes_.size() + kBlock - 1) / kBlock, {none, none, none, far});
  for (size_t i = 0; i < planes_.size(); ++i) {
    PlaneQuad& block = blocks_[i / kBlock];
    const auto at = static_cast<Eigen::Index>(i % kBlock);
    block.x[at] = planes_[i].normal.x();
    block.y[at] = planes_[i].normal.y();
    block.z[at] = planes_[i].normal.z();
    block.distance[at] = planes_[i].distance;
  }
}

PlaneRanges::PlaneRanges(const PlaneSet& planes, const ScanPlacement& placement)
    : planes_(planes.planes()) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  blocks_.reserve(planes.blocks_.size());
  for (const PlaneSet::PlaneQuad& block : planes.blocks_) {
    const auto along = [&](int axis) -> Eigen::Array4d {
      return block.x * placement(0, axis) + block.y * placement(1, axis) +
             block.z * placement(2, axis);
    };
    const Eigen::Array4d height = along(2) - block.distance;
    blocks_.push_back({-along(0), -along(1), (height > 0.0).select(height, kNever)});
  }
}

}  // namespace plumbline

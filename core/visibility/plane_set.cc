#include "core/visibility/plane_set.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/surface/landmark_view.h"

namespace plumbline {

PlaneSet::PlaneSet(std::vector<LandmarkView> surfaces) : planes_(std::move(surfaces)) {
  has_soft_edges_ = std::any_of(planes_.begin(), planes_.end(), [](const LandmarkView& s) {
    return s.traits.has_soft_edges;
  });
  const auto cylinders =
      std::stable_partition(planes_.begin(), planes_.end(), [](const LandmarkView& surface) {
        return !surface.is_curved;
      });
  cylinders_.assign(cylinders, planes_.end());
  planes_.erase(cylinders, planes_.end());
  const Eigen::Array4d none = Eigen::Array4d::Zero();
  const Eigen::Array4d far = Eigen::Array4d::Constant(std::numeric_limits<double>::infinity());
  quads_.assign((planes_.size() + kQuadSize - 1) / kQuadSize, {none, none, none, far});
  for (size_t i = 0; i < planes_.size(); ++i) {
    NormalQuad& quad = quads_[i / kQuadSize];
    const auto at = static_cast<Eigen::Index>(i % kQuadSize);
    quad.x[at] = planes_[i].normal.x();
    quad.y[at] = planes_[i].normal.y();
    quad.z[at] = planes_[i].normal.z();
    quad.distance[at] = planes_[i].distance;
  }
}

PlaneRanges::PlaneRanges(const PlaneSet& planes, const ScanPlacement& placement)
    : planes_(planes.planes()), cylinders_(planes.cylinders()), placement_(placement) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  quads_.reserve(planes.quads_.size());
  for (const PlaneSet::NormalQuad& quad : planes.quads_) {
    const auto along = [&](int axis) -> Eigen::Array4d {
      return quad.x * placement(0, axis) + quad.y * placement(1, axis) +
             quad.z * placement(2, axis);
    };
    const Eigen::Array4d height = along(2) - quad.distance;
    quads_.push_back({-along(0), -along(1), (height > 0.0).select(height, kNever)});
  }
}

}  // namespace plumbline

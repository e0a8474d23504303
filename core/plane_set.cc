#include "core/plane_set.h"

#include <limits>
#include <utility>

namespace plumbline {

PlaneSet::PlaneSet(std::vector<LandmarkCandidate> planes) : planes_(std::move(planes)) {
  const Eigen::Array4d none = Eigen::Array4d::Zero();
  const Eigen::Array4d far = Eigen::Array4d::Constant(std::numeric_limits<double>::infinity());
  blocks_.assign((planes_.size() + kBlock - 1) / kBlock, {none, none, none, far});
  for (size_t i = 0; i < planes_.size(); ++i) {
    Block& block = blocks_[i / kBlock];
    const auto at = static_cast<Eigen::Index>(i % kBlock);
    block.x[at] = planes_[i].normal.x();
    block.y[at] = planes_[i].normal.y();
    block.z[at] = planes_[i].normal.z();
    block.distance[at] = planes_[i].distance;
  }
}

}  // namespace plumbline

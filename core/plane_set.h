#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/landmark.h"

namespace plumbline {

// Planes that many points ask which of them they lie near. The distances are kept side by
// side: a few numbers of each plane answer for most, several planes at a time.
class PlaneSet {
 public:
  PlaneSet() = default;
  explicit PlaneSet(std::vector<LandmarkCandidate> planes);

  const std::vector<LandmarkCandidate>& planes() const { return planes_; }

  // Calls visit(plane) for the planes whose signed distance from the point is at most
  // distance_m in size, in order.
  template <typename Visit>
  void ForEachWithin(const Eigen::Vector3d& p_world, double distance_m, Visit visit) const {
    size_t first = 0;
    for (const Block& block : blocks_) {
      // As LandmarkCandidate::SignedDistance sums it.
      const Eigen::Array4d away =
          (block.x * p_world.x() + (block.y * p_world.y() + block.z * p_world.z()) -
           block.distance)
              .abs();
      if (away.minCoeff() <= distance_m) {
        for (int i = 0; i < kBlock; ++i) {
          if (away[i] <= distance_m) visit(planes_[first + static_cast<size_t>(i)]);
        }
      }
      first += kBlock;
    }
  }

 private:
  static constexpr int kBlock = 4;
  // Normals and distances; what is beyond the last plane is infinitely far away.
  struct Block {
    Eigen::Array4d x, y, z, distance;
  };

  std::vector<LandmarkCandidate> planes_;
  std::vector<Block> blocks_;
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/map/landmark.h"
#include "core/map/landmark_view.h"

namespace plumbline {

// Planes that many points ask which of them they lie near. The distances are kept side by
// side: a few numbers of each plane answer for most, several planes at a time.
class PlaneSet {
 public:
  PlaneSet() = default;
  explicit PlaneSet(std::vector<LandmarkView> planes);

  const std::vector<LandmarkView>& planes() const { return planes_; }

  // Calls visit(plane) for the planes whose signed distance from the point is at most
  // distance_m in size, in order.
  template <typename Visit>
  void ForEachWithin(const Eigen::Vector3d& p_world, double distance_m, Visit visit) const {
    size_t first = 0;
    for (const PlaneQuad& block : blocks_) {
      // As LandmarkView::SignedDistance sums it.
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
  friend class PlaneRanges;

  static constexpr int kBlock = 4;
  // Normals and distances; what is beyond the last plane is infinitely far away.
  struct PlaneQuad {
    Eigen::Array4d x, y, z, distance;
  };

  std::vector<LandmarkView> planes_;
  std::vector<PlaneQuad> blocks_;
};

// At which ranges the beams of a scan plane meet the planes of a set: those that have the
// scanner in front of them. Likewise several planes at a time. Valid while the set is.
class PlaneRanges {
 public:
  PlaneRanges(const PlaneSet& planes, const ScanPlacement& placement);

  // Calls visit(plane, range) for the planes that the beam along a unit vector (scanner frame)
  // meets at a range between these (m), in order.
  template <typename Visit>
  void ForEachBetween(const Eigen::Vector2d& direction,
                      double min_range,
                      double max_range,
                      Visit visit) const {
    size_t first = 0;
    for (const PlaneQuad& block : blocks_) {
      // The range is height / slope.
      const Eigen::Array4d slope = block.x * direction.x() + block.y * direction.y();
      const Eigen::Array4d within =
          (block.height - min_range * slope).min(max_range * slope - block.height);
      if (within.maxCoeff() > 0.0) {
        for (int i = 0; i < PlaneSet::kBlock; ++i) {
          if (!(within[i] > 0.0 && slope[i] > 0.0)) continue;
          visit(planes_[first + static_cast<size_t>(i)], block.height[i] / slope[i]);
        }
      }
      first += PlaneSet::kBlock;
    }
  }

 private:
  // The normals' parts in the scan plane, turned round; the scanner's height above the planes:
  // infinite where it is behind.
  struct PlaneQuad {
    Eigen::Array4d x, y, height;
  };

  const std::vector<LandmarkView>& planes_;
  std::vector<PlaneQuad> blocks_;
};

}  // namespace plumbline

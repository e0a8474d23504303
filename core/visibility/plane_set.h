#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/geometry/scan_plane_motion.h"
#include "core/map/observation.h"
#include "core/surface/landmark.h"
#include "core/surface/landmark_view.h"

namespace plumbline {

// A set of planes in which those near a point are found quickly. Normals and distances are
// kept side by side, so that several planes are tested at a time. Cylinders among the surfaces
// are kept apart.
class PlaneSet {
 public:
  PlaneSet() = default;
  explicit PlaneSet(std::vector<LandmarkView> surfaces);

  const std::vector<LandmarkView>& planes() const { return planes_; }
  const std::vector<LandmarkView>& cylinders() const { return cylinders_; }
  // Whether one of the surfaces has soft edges: the line where another one meets it does not
  // tell which beams lie on which.
  bool HasSoftEdges() const { return has_soft_edges_; }

  // Calls visit(plane) for the planes whose signed distance from the point is at most
  // distance_m in size, in order.
  template <typename Visit>
  void ForEachWithin(const Eigen::Vector3d& p_world, double distance_m, Visit visit) const {
    size_t first = 0;
    for (const NormalQuad& quad : quads_) {
      // As LandmarkView::SignedDistance sums it.
      const Eigen::Array4d away =
          (quad.x * p_world.x() + (quad.y * p_world.y() + quad.z * p_world.z()) -
           quad.distance)
              .abs();
      if (away.minCoeff() <= distance_m) {
        for (int i = 0; i < kQuadSize; ++i) {
          if (away[i] <= distance_m) visit(planes_[first + static_cast<size_t>(i)]);
        }
      }
      first += kQuadSize;
    }
  }

 private:
  friend class PlaneRanges;

  static constexpr int kQuadSize = 4;
  // Normals and distances of four planes; those beyond the last plane are infinitely far away.
  struct NormalQuad {
    Eigen::Array4d x, y, z, distance;
  };

  std::vector<LandmarkView> planes_;
  std::vector<LandmarkView> cylinders_;
  bool has_soft_edges_ = false;
  std::vector<NormalQuad> quads_;
};

// The ranges at which the beams of a scan plane meet the surfaces of a set that have the
// scanner in front of them, several planes at a time. Valid as long as the set is.
class PlaneRanges {
 public:
  PlaneRanges(const PlaneSet& planes, const ScanPlacement& placement);

  // Calls visit(surface, range) for the surfaces that the beam along a unit vector (scanner
  // frame) meets at a range between these (m): planes in order, then cylinders.
  template <typename Visit>
  void ForEachBetween(const Eigen::Vector2d& direction,
                      double min_range,
                      double max_range,
                      Visit visit) const {
    size_t first = 0;
    for (const SlopeQuad& quad : quads_) {
      // The range is height / slope.
      const Eigen::Array4d slope = quad.x * direction.x() + quad.y * direction.y();
      const Eigen::Array4d within =
          (quad.height - min_range * slope).min(max_range * slope - quad.height);
      if (within.maxCoeff() > 0.0) {
        for (int i = 0; i < PlaneSet::kQuadSize; ++i) {
          if (!(within[i] > 0.0 && slope[i] > 0.0)) continue;
          visit(planes_[first + static_cast<size_t>(i)], quad.height[i] / slope[i]);
        }
      }
      first += PlaneSet::kQuadSize;
    }
    for (const LandmarkView& cylinder : cylinders_) {
      const std::optional<double> range =
          RangeOnCylinder(*cylinder.landmark, placement_, direction);
      if (range && *range > min_range && *range < max_range) visit(cylinder, *range);
    }
  }

 private:
  // The normals' parts in the scan plane, turned round, and the scanner's height above the
  // planes, infinite where it is behind; of four planes.
  struct SlopeQuad {
    Eigen::Array4d x, y, height;
  };

  const std::vector<LandmarkView>& planes_;
  const std::vector<LandmarkView>& cylinders_;
  ScanPlacement placement_;
  std::vector<SlopeQuad> quads_;
};

}  // namespace plumbline

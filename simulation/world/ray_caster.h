#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "simulation/world/building.h"

namespace plumbline {

// A ray ends at a hit.
struct RayHit {
  double range = 0.0;  // m
  int face_id = 0;
};

// RayCaster finds the faces of a building that rays meet and points are near to, with CGAL's
// tree of bounding boxes.
class RayCaster {
 public:
  explicit RayCaster(const Building& building);
  ~RayCaster();

  // Finds the first face along the ray, seen from either side. direction_world has unit
  // length.
  std::optional<RayHit> Cast(const Eigen::Vector3d& origin_world,
                             const Eigen::Vector3d& direction_world) const;

  // Returns the distance in metres from the point to the nearest face.
  double Clearance(const Eigen::Vector3d& p_world) const;

  // True when the point lies in free space: straight below it is a face that faces up.
  bool IsInFreeSpace(const Eigen::Vector3d& p_world) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

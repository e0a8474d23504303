#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "simulation/world/building.h"

namespace plumbline {

inline constexpr int kNoFace = -1;

// A ray ends at a hit.
struct RayHit {
  double range = 0.0;        // m
  int face_id = 0;           // kNoFace: something that moves
  bool from_behind = false;  // the ray goes along the face's normal
  bool is_glass = false;
};

// RayCaster finds the faces of a building that rays meet and points are near to, with CGAL's
// tree of bounding boxes.
class RayCaster {
 public:
  explicit RayCaster(const Building& building);
  ~RayCaster();

  // Finds the first face along the ray, seen from either side, with through_glass the first
  // that is not of glass. direction_world has unit length.
  std::optional<RayHit> Cast(const Eigen::Vector3d& origin_world,
                             const Eigen::Vector3d& direction_world,
                             bool through_glass = false) const;

  // Returns the distance in metres from the point to the nearest face.
  double Clearance(const Eigen::Vector3d& p_world) const;

  // True when the point lies in free space: straight below it is a face that faces up.
  bool IsInFreeSpace(const Eigen::Vector3d& p_world) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace plumbline

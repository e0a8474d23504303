#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/world/path.h"

namespace plumbline {

// A person is an upright cylinder that walks to and fro along way points, follows the rig or
// walks round it. It steps aside for the rig.
struct Person {
  std::vector<Eigen::Vector3d> way_points;  // on the floor, building frame, m; else:
  double follows_m = 0.0;                   // behind the rig, along its path
  double circles_m = 0.0;                   // from the rig's body, all round
  double speed_m_s = 1.0;
  double radius_m = 0.2;
  double height_m = 1.75;
};

// A door is an upright rectangle that swings about its hinge, from shut to open and back. It
// stands open while the rig is near.
struct Door {
  Eigen::Vector3d hinge = Eigen::Vector3d::Zero();  // on the floor, m
  double width_m = 0.9;
  double height_m = 2.0;
  double shut_rad = 0.0;  // direction from the hinge, from the x axis
  double open_rad = 0.0;
  double period_s = 10.0;
};

// The moving things of a building while the rig walks through.
struct MovingOptions {
  std::vector<Person> people;
  std::vector<Door> doors;
  double body_height_m = 1.5;  // of the rig above the walking surface
};

// MovingThings finds what a beam meets of people and doors. Their phases are random.
class MovingThings {
 public:
  MovingThings(const MovingOptions& options, uint64_t seed);

  // Returns the distance in metres to the first one along the ray at an instant on the path.
  // Who stands round the ray's origin does not count. direction_world has unit length.
  std::optional<double> Cast(const Eigen::Vector3d& origin_world,
                             const Eigen::Vector3d& direction_world,
                             const Path& path,
                             int64_t time_ns) const;

  // Returns where the feet of a person are.
  Eigen::Vector3d PlaceOf(size_t person, const Path& path, int64_t time_ns) const;
  // Direction of a door's leaf from its hinge, rad.
  double AngleOf(size_t door, const Path& path, int64_t time_ns) const;

 private:
  MovingOptions options_;
  std::vector<double> person_phases_;  // 0 to 1
  std::vector<double> door_phases_;
};

}  // namespace plumbline

#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "core/geometry/rigid3.h"
#include "factors/spline/spline.h"

namespace plumbline {

// ControlPoint is one control point of the pose spline. Solvers hold pointers into it.
struct ControlPoint {
  std::array<double, 4> rotation = {0.0, 0.0, 0.0, 1.0};  // world_from_body, x y z w
  std::array<double, 3> position = {0.0, 0.0, 0.0};       // m, world
};

// Trajectory is the rig's pose as a function of time: a uniform cubic B-spline, position in
// R^3, rotation as a cumulative spline on SO(3). Interval i spans
//   [start + i * knot_interval, start + (i + 1) * knot_interval)
// and depends on control points i .. i+3 only. Control points keep their addresses as it
// grows.
class Trajectory {
 public:
  struct Location {
    int first = 0;   // first of the four control points
    double u = 0.0;  // in [0, 1)
  };

  // Starts at rest: every control point has the given pose.
  Trajectory(int64_t start_ns, int64_t knot_interval_ns, const Rigid3d& world_from_body);

  int64_t start_ns() const { return start_ns_; }
  int64_t end_ns() const;  // exclusive
  int64_t knot_interval_ns() const { return knot_interval_ns_; }
  double knot_interval_s() const { return static_cast<double>(knot_interval_ns_) * 1e-9; }
  int num_control_points() const { return static_cast<int>(control_points_.size()); }
  ControlPoint& control_point(int index) {
    return control_points_[static_cast<size_t>(index)];
  }
  const ControlPoint& control_point(int index) const {
    return control_points_[static_cast<size_t>(index)];
  }

  // Throws Error when the instant lies outside [start, end).
  Location Locate(int64_t time_ns) const;
  Rigid3d WorldFromBody(int64_t time_ns) const;
  // Derivative of the pose by the four control points it depends on.
  SplinePoseJacobian PoseJacobian(const Location& at) const;
  // Angular velocity in rad/s and linear velocity in m/s, both in the world frame.
  void Velocity(int64_t time_ns,
                Eigen::Vector3d* angular_world,
                Eigen::Vector3d* linear_world) const;

  // Appends control points at constant velocity until the instant is covered.
  void ExtendTo(int64_t time_ns);
  // Removes the control points that no pose up to this instant, inclusive, depends on.
  void ShrinkTo(int64_t time_ns);

  // Takes the trajectory to another world frame.
  void Move(const Rigid3d& to_from);
  // Goes on with a later trajectory of the same world frame and knots: between the two the
  // control points lie evenly from the last one of this to the first one of the other. Where
  // both have some, the later one's stay.
  void Append(const Trajectory& later);

  // Calls visit(member) for each: to keep them in a file and take them back.
  template <typename Visit>
  void VisitMembers(Visit& visit) {
    visit(start_ns_);
    visit(knot_interval_ns_);
    visit(control_points_);
  }

 private:
  int64_t start_ns_;
  int64_t knot_interval_ns_;
  std::deque<ControlPoint> control_points_;
};

// PoseSampler computes poses at instants near each other: it keeps the terms of the last knot
// interval. The trajectory must not change meanwhile.
class PoseSampler {
 public:
  explicit PoseSampler(const Trajectory& trajectory) : trajectory_(trajectory) {}

  // Returns the pose at an instant, or a delay (s) later, by the spline's interval at the
  // instant. Throws Error outside the trajectory.
  Rigid3d WorldFromBody(int64_t time_ns, double delay_s = 0.0);

 private:
  const Trajectory& trajectory_;
  int first_ = -1;
  std::array<RotationStep, 3> steps_;
};

}  // namespace plumbline

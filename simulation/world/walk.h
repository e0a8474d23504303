#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace plumbline {

// WalkOptions describe how a person carries the rig along points on the walking surface.
struct WalkOptions {
  std::string location;                 // "file:line", for messages
  std::vector<Eigen::Vector3d> points;  // building frame, m
  double smooth_m = 0.4;                // how far corners are rounded
  double speed_m_s = 1.0;
  double max_turn_rate_rad_s = 1.0;  // turning faster, the walk slows down
  struct Stop {
    double at_m = 0.0;  // since the first point, along the points
    double duration_s = 0.0;
  };
  std::vector<Stop> stops;  // in their order
};

// State of the walker at an instant.
struct WalkState {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  // on the walking surface, m
  double heading_rad = 0.0;                         // without jumps between -pi and pi
  double travelled_m = 0.0;                         // along the points
};

// A walk leads along points in space, over stairs too, heading where it goes. It begins and
// ends standing, accelerates like a person and slows down for corners; where the points turn
// back by more than 100 degrees it stands and turns on the spot.
//
// The points are joined by a curve that is smoothed by a raised cosine over the length; speed
// and turns are planned along it, and the outcome is smoothed once more over the time, so that
// place and heading have continuous second derivatives.
class Walk {
 public:
  // Throws Error when the points are too few or coincide.
  explicit Walk(const WalkOptions& options);

  double duration_s() const { return duration_s_; }
  double length_m() const { return length_m_; }
  WalkState At(double time_s) const;  // clamped to the walk's begin and end

 private:
  using Sample = Eigen::Matrix<double, 5, 1>;  // x, y, z, heading, travelled

  void SampleOver(const std::vector<double>& times, const std::vector<Sample>& samples);

  double length_m_ = 0.0;
  double duration_s_ = 0.0;
  std::vector<Sample> control_;  // of a uniform cubic B-spline
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>

namespace plumbline {

// ScannerMotion is the predicted motion of a scanner while it takes a scan line, in its own
// plane and frame.
struct ScannerMotion {
  Eigen::Vector2d velocity_m_s = Eigen::Vector2d::Zero();
  double yaw_rate_rad_s = 0.0;
};

}  // namespace plumbline

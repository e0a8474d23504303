#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>

#include "core/rigid3.h"

namespace plumbline {

// Where the points of a moving scan plane lie: by the quadratic through their places for the
// poses at three equidistant instants. Exact but for the motion's third derivative, the same
// as in the residuals (factors/segment_factor.h).
class ScanMotion {
 public:
  ScanMotion(const std::array<int64_t, 3>& times_ns,
             const std::array<Rigid3d, 3>& world_from_scanner)
      : middle_ns_(times_ns[1]),
        half_span_ns_(std::max(1.0, static_cast<double>(times_ns[2] - times_ns[1]))) {
    std::array<Eigen::Matrix3d, 3> nodes;
    for (size_t k = 0; k < 3; ++k) {
      nodes[k] = world_from_scanner[k].rotation.toRotationMatrix();
      nodes[k].col(2) = world_from_scanner[k].translation;
    }
    constant_ = nodes[1];
    linear_ = 0.5 * (nodes[2] - nodes[0]);
    quadratic_ = 0.5 * (nodes[0] + nodes[2]) - nodes[1];
  }

  // A point of the scan plane (m) measured at an instant near the three.
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& p_scanner, int64_t time_ns) const {
    const Eigen::Vector3d p(p_scanner.x(), p_scanner.y(), 1.0);
    const double tau = static_cast<double>(time_ns - middle_ns_) / half_span_ns_;
    return constant_ * p + tau * (linear_ * p + tau * (quadratic_ * p));
  }

 private:
  int64_t middle_ns_;
  double half_span_ns_;
  // To be multiplied by (x, y, 1); by the power of time, in half spans from the middle.
  Eigen::Matrix3d constant_;
  Eigen::Matrix3d linear_;
  Eigen::Matrix3d quadratic_;
};

}  // namespace plumbline

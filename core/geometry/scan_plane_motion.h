#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>

#include "core/geometry/rigid3.h"

namespace plumbline {

// A placement says where the scan plane lies in the world at an instant:
//   p_world = placement * (x, y, 1)
using ScanPlacement = Eigen::Matrix3d;

inline ScanPlacement PlacementOf(const Rigid3d& world_from_scanner) {
  ScanPlacement placement = world_from_scanner.rotation.toRotationMatrix();
  placement.col(2) = world_from_scanner.translation;
  return placement;
}

// PlaneTrace is the line in which a plane cuts the moving scan plane, normal(t) . p =
// distance(t) in the scanner frame, by the quadratic through three instants. The normal's
// length is the sine of the angle between plane and scan plane.
class PlaneTrace {
 public:
  // nodes: ( normal, distance ) at the three instants.
  PlaneTrace(int64_t middle_ns,
             double half_span_ns,
             const std::array<Eigen::Vector3d, 3>& nodes)
      : middle_ns_(middle_ns),
        half_span_ns_(half_span_ns),
        constant_(nodes[1]),
        linear_(0.5 * (nodes[2] - nodes[0])),
        quadratic_(0.5 * (nodes[0] + nodes[2]) - nodes[1]) {}

  // Returns ( normal, distance ) at an instant.
  Eigen::Vector3d At(int64_t time_ns) const {
    return AtShare(static_cast<double>(time_ns - middle_ns_) / half_span_ns_);
  }
  // tau: time in half spans from the middle instant, -1 at the first, 1 at the last.
  Eigen::Vector3d AtShare(double tau) const {
    return constant_ + tau * (linear_ + tau * quadratic_);
  }
  // Coefficients of one component by rising powers of tau.
  std::array<double, 3> Polynomial(int row) const {
    return {constant_[row], linear_[row], quadratic_[row]};
  }
  int64_t middle_ns() const { return middle_ns_; }
  double half_span_ns() const { return half_span_ns_; }
  // Returns the trace with normals of unit length at the three instants; between them the
  // length differs from one by less than the motion's third derivative makes.
  PlaneTrace WithUnitNormal() const {
    std::array<Eigen::Vector3d, 3> nodes;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = AtShare(k - 1.0);
      nodes[static_cast<size_t>(k)] = at / at.head<2>().norm();
    }
    return {middle_ns_, half_span_ns_, nodes};
  }

 private:
  int64_t middle_ns_;
  double half_span_ns_;
  Eigen::Vector3d constant_;
  Eigen::Vector3d linear_;
  Eigen::Vector3d quadratic_;
};

// ScanMotion says where the points of a moving scan plane lie in the world, by the quadratic
// through their places for the poses at three equidistant instants. It is exact but for the
// motion's third derivative, and the residuals use the same (factors/cost/segment_factor.h).
class ScanMotion {
 public:
  // range_scale: true range by measured one.
  ScanMotion(const std::array<int64_t, 3>& times_ns,
             const std::array<Rigid3d, 3>& world_from_scanner,
             double range_scale = 1.0)
      : middle_ns_(times_ns[1]),
        half_span_ns_(std::max(1.0, static_cast<double>(times_ns[2] - times_ns[1]))) {
    for (size_t k = 0; k < 3; ++k) {
      nodes_[k] = PlacementOf(world_from_scanner[k]);
      nodes_[k].leftCols<2>() *= range_scale;
    }
    linear_ = 0.5 * (nodes_[2] - nodes_[0]);
    quadratic_ = 0.5 * (nodes_[0] + nodes_[2]) - nodes_[1];
  }

  // Returns the placement at an instant near the three.
  ScanPlacement At(int64_t time_ns) const {
    const double tau = ShareOf(time_ns);
    return nodes_[1] + tau * (linear_ + tau * quadratic_);
  }
  // Moves a point of the scan plane (m), measured at the instant, to the world.
  Eigen::Vector3d ToWorld(const Eigen::Vector2d& p_scanner, int64_t time_ns) const {
    const Eigen::Vector3d p(p_scanner.x(), p_scanner.y(), 1.0);
    const double tau = ShareOf(time_ns);
    return nodes_[1] * p + tau * (linear_ * p + tau * (quadratic_ * p));
  }
  // Placements at the three instants.
  const std::array<ScanPlacement, 3>& nodes() const { return nodes_; }
  // Returns the trace of the plane normal_world . p = distance.
  PlaneTrace TraceOf(const Eigen::Vector3d& normal_world, double distance) const {
    std::array<Eigen::Vector3d, 3> traces;
    for (size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3d g = nodes_[k].transpose() * normal_world;
      traces[k] << g.head<2>(), distance - g.z();
    }
    return {middle_ns_, half_span_ns_, traces};
  }

 private:
  double ShareOf(int64_t time_ns) const {
    return static_cast<double>(time_ns - middle_ns_) / half_span_ns_;
  }

  int64_t middle_ns_;
  double half_span_ns_;
  std::array<ScanPlacement, 3> nodes_;
  // Coefficients of the first and the second power of time, in half spans from the middle.
  Eigen::Matrix3d linear_;
  Eigen::Matrix3d quadratic_;
};

}  // namespace plumbline

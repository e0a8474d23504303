#pragma once

#include <Eigen/Core>
#include <memory>

namespace ceres {
class Manifold;
}

namespace plumbline {

// Manifolds of the parameter blocks. Quaternions are stored (x, y, z, w).

// Rotation, 4 -> 3:  q [+] delta = Exp(delta) q,  q [-] q0 = Log(q q0^-1). Delta in rad, in
// the frame that q maps to (the world for control points).
std::unique_ptr<ceres::Manifold> CreateRotationManifold();

// Rotation about the world's z axis only, 4 -> 1:  q [+] delta = Exp(delta e_z) q. For rigs
// that move in the plane: roll and pitch keep the values they start with.
std::unique_ptr<ceres::Manifold> CreateYawManifold();

// Vertical plane (a, d), 2 -> 2, that bends along with the plane's turning about a vertical
// line through centre (x, y of the world):
//   a [+] delta = a + delta_0
//   d [+] delta = d + delta_1 + (n(a + delta_0) - n(a) - n'(a) delta_0) . centre
// To first order this is the plain sum. A plane seen far from the origin turns about where it
// was seen; in the plain sum that is a curved valley, in which Gauss-Newton steps creep.
std::unique_ptr<ceres::Manifold> CreateVerticalPlaneManifold(const Eigen::Vector2d& centre);

// d q / d delta of q [+] delta at delta = 0, 4 x 3.
Eigen::Matrix<double, 4, 3> RotationPlusJacobian(const double* q);

// d delta / d q of (q [-] q0) at q = q0, 3 x 4. RotationMinusJacobian * RotationPlusJacobian =
// I.
Eigen::Matrix<double, 3, 4> RotationMinusJacobian(const double* q);

// Angle in (-pi, pi] of the part of q q0^-1 that turns about the world's z axis.
double YawDifference(const double* q, const double* q0);

}  // namespace plumbline

#pragma once

#include <Eigen/Core>

#include "core/segmentation/beam_model.h"

namespace plumbline {

// A segment in the making.
struct LinePiece {
  int first = 0;
  int last = 0;                   // inclusive
  bool starts_at_change = false;  // a test has proved that the line before ends there
  Eigen::Vector2d q = Eigen::Vector2d::Zero();
  LineEquations information{};  // of the last fit or, while growing, of the points taken up
  int num_points = 0;           // of the last fit or taken up
  double chi2 = 0.0;            // after the last fit
};

// (q_a - q_b)^T (P_a + P_b)^-1 (q_a - q_b), chi square with two degrees of freedom if both are
// one line.
inline double Difference(const LinePiece& a, const LinePiece& b) {
  const LineEquations& m = a.information;
  const LineEquations& n = b.information;
  const double scale_m = 1.0 / m.Determinant();
  const double scale_n = 1.0 / n.Determinant();
  const double xx = scale_m * m.yy + scale_n * n.yy;
  const double xy = -scale_m * m.xy - scale_n * n.xy;
  const double yy = scale_m * m.xx + scale_n * n.xx;
  const Eigen::Vector2d d = a.q - b.q;
  return (yy * d.x() * d.x() - 2.0 * xy * d.x() * d.y() + xx * d.y() * d.y()) /
         (xx * yy - xy * xy);
}

}  // namespace plumbline

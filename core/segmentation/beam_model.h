#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "core/segmentation/segmentation.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"
#include "core/sensor/scanner_motion.h"

namespace plumbline {

// A line's parameters as a fraction, q = (x, y) / scale, scale > 0: solving for it takes no
// division.
struct ScaledLine {
  double x = 0.0;
  double y = 0.0;
  double scale = 1.0;

  Eigen::Vector2d q() const { return {x / scale, y / scale}; }
};

// Least squares for the two parameters of a line: sums over observations row . q = value.
// Start them with {}: arrays of them that are filled one by one are not to be zeroed first.
struct LineEquations {
  double xx, xy, yy;  // sum weight row row^T
  double x, y;        // sum weight row value
  double square;      // sum weight value^2

  void Add(const Eigen::Vector2d& row, double value, double weight) {
    const double wx = weight * row.x();
    const double wy = weight * row.y();
    xx += wx * row.x();
    xy += wx * row.y();
    yy += wy * row.y();
    x += wx * value;
    y += wy * value;
    square += weight * value * value;
  }

  LineEquations operator-(const LineEquations& other) const {
    return {xx - other.xx,
            xy - other.xy,
            yy - other.yy,
            x - other.x,
            y - other.y,
            square - other.square};
  }

  double Determinant() const { return xx * yy - xy * xy; }
  bool IsSolvable() const { return Determinant() > 1e-12 * xx * yy; }

  Eigen::Vector2d Solve() const {
    const double scale = 1.0 / Determinant();
    return {scale * (yy * x - xy * y), scale * (xx * y - xy * x)};
  }
  ScaledLine SolveScaled() const { return {yy * x - xy * y, xx * y - xy * x, Determinant()}; }

  // Variance of row . q.
  double VarianceOf(const Eigen::Vector2d& row) const {
    return (yy * row.x() * row.x() - 2.0 * xy * row.x() * row.y() + xx * row.y() * row.y()) /
           Determinant();
  }

  // Reduction of the sum of squares by the solution, times the determinant.
  double ScaledGain() const { return yy * x * x - 2.0 * xy * x * y + xx * y * y; }

  // Least sum of squares; 0 where the observations do not determine q.
  double Chi2() const { return IsSolvable() ? square - ScaledGain() / Determinant() : 0.0; }
};

// The beams of one scan line with the motion taken out, and their measurement model.
//
// Beam i starts at o and points along the unit vector u, both in the scanner frame at the
// middle time. A line is kept as q = n / d with q . p = 1 for its points and n pointing away
// from the scanner, so that it predicts the range (1 - q . o) / (q . u), whose derivative by q
// is -(o + range u) / (q . u). Its variance is sigma_range^2, which may grow with the fourth
// power of the range (by gamma^2), plus that of the beam's direction times the squared
// derivative of the range by the angle.
//
// All tests and sums are written without the divisions. With the measured range rho and
//   s = q . u,  N = 1 - q . o,  p = s o + N u,  e = rho s - N,  f = s e,
//   V = sigma_range^2 s^4 + gamma^2 N^4 + (sigma_angle N (q x u))^2
// the residual is f / s^2, its variance V / s^4 and minus its derivative by q is p / s^2, so
// that the beam adds p p^T / V and -p f / V to the normal equations and f^2 / V to chi square.
class BeamModel {
 public:
  struct Beam {
    Eigen::Vector2d origin;
    Eigen::Vector2d direction;
    double range;  // NaN: no return
  };
  struct Prediction {
    double range;
    double variance;
  };
  // A beam's intersection with a scaled line q = (x, y) / scale: each number is multiplied by
  // scale to the power at which it contains q (N and e: the first).
  struct LineIntersection {
    double slope;      // s
    double numerator;  // N
    double excess;     // e
    Eigen::Vector2d point;
    double variance;  // V
  };

  // Beams whose squared whitened residual exceeds `outlier_threshold` are not on a line.
  BeamModel(const ScanLine& scan_line,
            const Scanner& scanner,
            const ScannerMotion& motion,
            double outlier_threshold);

  int num_beams() const { return num_beams_; }
  Beam beam(int i) const {
    return {{origin_x_[i], origin_y_[i]}, {direction_x_[i], direction_y_[i]}, range_[i]};
  }
  bool HasReturn(int i) const { return !std::isnan(range_[i]); }
  // Variance of the noise of a range.
  double RangeVariance(double range) const {
    const double range2 = range * range;
    return range_variance_ + noise_growth_ * (range2 * range2);
  }
  double outlier_threshold() const { return outlier_threshold_; }

  // Predict returns false when the beam does not meet the line, or only far outside the
  // scanner's range.
  bool Predict(int i, const Eigen::Vector2d& q, Prediction* prediction) const {
    const double slope = q.x() * direction_x_[i] + q.y() * direction_y_[i];
    const double numerator = 1.0 - (q.x() * origin_x_[i] + q.y() * origin_y_[i]);
    if (!(numerator > 0.0 && slope * 2.0 * max_range_ > numerator)) return false;
    const double inverse = 1.0 / slope;
    const double range = numerator * inverse;
    const double cross = q.y() * direction_x_[i] - q.x() * direction_y_[i];
    const double by_angle = angle_noise_ * range * cross * inverse;
    prediction->range = range;
    prediction->variance = RangeVariance(range) + by_angle * by_angle;
    return true;
  }

  // Intersect returns false where Predict does. Without a return the excess is NaN.
  bool Intersect(int i, const ScaledLine& line, LineIntersection* meeting) const {
    const double slope = line.x * direction_x_[i] + line.y * direction_y_[i];
    const double numerator = line.scale - (line.x * origin_x_[i] + line.y * origin_y_[i]);
    if (!(numerator > 0.0 && slope * 2.0 * max_range_ > numerator)) return false;
    const double cross = line.y * direction_x_[i] - line.x * direction_y_[i];
    const double by_angle = angle_noise_ * numerator * cross;
    const double slope2 = slope * slope;
    const double numerator2 = numerator * numerator;
    meeting->slope = slope;
    meeting->numerator = numerator;
    meeting->excess = range_[i] * slope - numerator;
    meeting->point = {slope * origin_x_[i] + numerator * direction_x_[i],
                      slope * origin_y_[i] + numerator * direction_y_[i]};
    meeting->variance = range_variance_ * (slope2 * slope2) +
                        noise_growth_ * (numerator2 * numerator2) + by_angle * by_angle;
    return true;
  }

  bool IsOnLine(const LineIntersection& at) const {
    const double f = at.slope * at.excess;
    return f * f < outlier_threshold_ * at.variance;
  }
  bool IsOnLine(int i, const Eigen::Vector2d& q) const {
    LineIntersection at;
    return Intersect(i, {q.x(), q.y(), 1.0}, &at) && IsOnLine(at);
  }

  // TrimToLine leaves out beams at both ends that are not on the line, and the few on it that
  // more beams off it part from the rest: a face seen at a grazing angle, continued, meets the
  // wall far behind it somewhere, for a beam or two. One beam stays.
  void TrimToLine(const Eigen::Vector2d& q, int* first, int* last) const {
    *first = TrimmedEnd(*first, *last, q);
    *last = TrimmedEnd(*last, *first, q);
  }

  // SumOnLine returns the normal equations for a change of q from the beams first .. last that
  // are on the line.
  LineEquations SumOnLine(int first,
                          int last,
                          const Eigen::Vector2d& q,
                          int* num_points) const;

  // Deviations returns the squared whitened range residuals of the beams first .. first +
  // kBlock - 1, each at most the outlier threshold; 0 without a return and past the last beam.
  static constexpr int kBlock = 4;
  Eigen::Array4d Deviations(int first, const Eigen::Vector2d& q) const;

  // Difference of the ranges that two lines predict in standard deviations of a range.
  struct Separation {
    double square;  // infinite unless the beam meets both lines
    bool is_above;  // the first predicts the longer range
  };
  Separation Separate(int i, const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
    LineIntersection in_a, in_b;
    if (!Intersect(i, {a.x(), a.y(), 1.0}, &in_a) ||
        !Intersect(i, {b.x(), b.y(), 1.0}, &in_b)) {
      return {std::numeric_limits<double>::infinity(), true};
    }
    const double product = in_a.slope * in_b.slope;
    const double difference = in_a.numerator * in_b.slope - in_b.numerator * in_a.slope;
    const double a2 = in_a.slope * in_a.slope;
    const double b2 = in_b.slope * in_b.slope;
    return {2.0 * difference * difference * (product * product) /
                (in_a.variance * (b2 * b2) + in_b.variance * (a2 * a2)),
            difference > 0.0};
  }

  // Returns where the beam meets the line.
  Eigen::Vector2d PointOnLine(int i, const Eigen::Vector2d& q) const {
    const Beam b = beam(i);
    return b.origin + (1.0 - q.dot(b.origin)) / q.dot(b.direction) * b.direction;
  }

 private:
  void TakeAngles(const std::vector<double>& angles, double turn);
  int TrimmedEnd(int end, int other_end, const Eigen::Vector2d& q) const;
  struct FourIntersections;
  FourIntersections IntersectFour(int i, const Eigen::Vector2d& q) const;

  int num_beams_;
  double range_variance_;  // sigma_range^2
  double noise_growth_;    // gamma^2
  double angle_noise_;
  double max_range_;
  double outlier_threshold_;
  // A column for each coordinate; kBlock beams without a return follow the last.
  std::unique_ptr<double[]> columns_;
  double* origin_x_;
  double* origin_y_;
  double* direction_x_;
  double* direction_y_;
  double* range_;
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/rig.h"
#include "core/scan_line.h"
#include "core/segmentation.h"

namespace plumbline {

// Least squares for the two parameters of a line: sums over observations row . q = value.
struct NormalEquations {
  double xx = 0.0, xy = 0.0, yy = 0.0;  // sum weight row row^T
  double x = 0.0, y = 0.0;              // sum weight row value
  double square = 0.0;                  // sum weight value^2

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

  NormalEquations operator-(const NormalEquations& other) const {
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

  // Variance of row . q.
  double VarianceOf(const Eigen::Vector2d& row) const {
    return (yy * row.x() * row.x() - 2.0 * xy * row.x() * row.y() + xx * row.y() * row.y()) /
           Determinant();
  }

  // Least sum of squares; 0 where the observations do not determine q.
  double Chi2() const {
    if (!IsSolvable()) return 0.0;
    const Eigen::Vector2d q = Solve();
    return square - x * q.x() - y * q.y();
  }
};

// The beams of one scan line with the motion taken out, and their measurement model.
//
// Beam i starts at o and points along the unit vector u, both in the scanner frame at the
// middle time. A line is kept as q = n / d with q . p = 1 for its points and n pointing away
// from the scanner, so that it predicts the range (1 - q . o) / (q . u), whose derivative by q
// is
// -(o + range u) / (q . u). Its variance is sigma_range^2 plus that of the beam's direction
// times the squared derivative of the range by the angle.
class BeamFan {
 public:
  struct Beam {
    Eigen::Vector2d origin;
    Eigen::Vector2d direction;
    double range;
    bool is_valid;
  };
  struct Prediction {
    double range;
    double variance;
    Eigen::Vector2d row;  // minus the derivative of the range by q
  };

  // Beams whose squared whitened residual exceeds `outlier_threshold` are not on a line.
  BeamFan(const ScanLine& scan_line,
          const Scanner& scanner,
          const ScannerMotion& motion,
          double outlier_threshold);

  int num_beams() const { return static_cast<int>(beams_.size()); }
  const Beam& beam(int i) const { return beams_[static_cast<size_t>(i)]; }
  double range_variance() const { return range_variance_; }
  double outlier_threshold() const { return outlier_threshold_; }

  // False when the beam does not meet the line or does so far outside the scanner's range.
  bool Predict(int i, const Eigen::Vector2d& q, Prediction* prediction) const {
    const Beam& b = beam(i);
    const double slope = q.dot(b.direction);
    const double numerator = 1.0 - q.dot(b.origin);
    if (!(numerator > 0.0 && slope * 2.0 * max_range_ > numerator)) return false;
    const double inverse = 1.0 / slope;
    const double range = numerator * inverse;
    const double cross = q.y() * b.direction.x() - q.x() * b.direction.y();
    const double by_angle = angle_noise_ * range * cross * inverse;
    prediction->range = range;
    prediction->variance = range_variance_ + by_angle * by_angle;
    prediction->row = inverse * (b.origin + range * b.direction);
    return true;
  }

  // Squared whitened range residual, at most the outlier threshold; 0 without a return.
  double Deviation(int i, const Eigen::Vector2d& q) const {
    if (!beam(i).is_valid) return 0.0;
    Prediction prediction;
    if (!Predict(i, q, &prediction)) return outlier_threshold_;
    const double residual = beam(i).range - prediction.range;
    const double deviation = residual * residual / prediction.variance;
    return deviation < outlier_threshold_ ? deviation : outlier_threshold_;
  }

  // True for a beam on the line; `residual` is measured minus predicted range.
  bool Match(int i, const Eigen::Vector2d& q, Prediction* prediction, double* residual) const {
    if (!beam(i).is_valid || !Predict(i, q, prediction)) return false;
    *residual = beam(i).range - prediction->range;
    return *residual * *residual < outlier_threshold_ * prediction->variance;
  }

  bool IsOnLine(int i, const Eigen::Vector2d& q) const {
    Prediction prediction;
    double residual;
    return Match(i, q, &prediction, &residual);
  }

  // Where the beam meets the line.
  Eigen::Vector2d PointOnLine(int i, const Eigen::Vector2d& q) const {
    const Beam& b = beam(i);
    return b.origin + (1.0 - q.dot(b.origin)) / q.dot(b.direction) * b.direction;
  }

 private:
  double range_variance_;
  double angle_noise_;
  double max_range_;
  double outlier_threshold_;
  std::vector<Beam> beams_;
};

}  // namespace plumbline

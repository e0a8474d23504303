#include "core/motion_noise.h"

#include <cmath>
#include <vector>

#include "core/estimation_problem.h"
#include "core/map_covariance.h"

namespace plumbline {
namespace {

// Accelerations that the scans have to determine: a standard deviation from so many is right
// to a fifth.
constexpr double kMinDetermined = 12.0;

// Accelerations of one kind.
class Accelerations {
 public:
  void Add(double value, double variance) {
    sum_squares_ += value * value;
    sum_variances_ += variance;
    ++count_;
  }

  double Reestimate(double assumed) const {
    const double determined = count_ - sum_variances_ / (assumed * assumed);
    return determined < kMinDetermined ? assumed : std::sqrt(sum_squares_ / determined);
  }

 private:
  double sum_squares_ = 0.0;
  double sum_variances_ = 0.0;
  int count_ = 0;
};

}  // namespace

MotionNoise MotionNoise::Of(const TrajectoryOptions& options) {
  return {options.acceleration_stddev_m_s2,
          options.acceleration_stddev_m_s2,
          options.angular_acceleration_stddev_deg_s2 * M_PI / 180.0};
}

MotionNoise ReestimateMotionNoise(const MotionNoise& assumed,
                                  const MapCovariance& covariance,
                                  const EstimationProblem& accelerations) {
  const BlockLayout layout = accelerations.Layout();
  const int rotation_size = accelerations.TangentSize(RotationBlock(0));
  const int control_point_size = rotation_size + accelerations.TangentSize(PositionBlock(0));
  Accelerations horizontal, vertical, angular;
  accelerations.ForEachResidualBlock(
      layout,
      [&](const std::vector<int>& columns,
          const Eigen::MatrixXd& jacobian,
          const Eigen::VectorXd& residuals) {
        const int first = columns.front();
        std::vector<int> within;
        for (const int column : columns) within.push_back(column - first);
        const Eigen::MatrixXd control_points =
            covariance.ControlPoints(first, within.back() + 1)(within, within);
        const bool is_rotation = first % control_point_size < rotation_size;
        for (int axis = 0; axis < 3; ++axis) {
          const Eigen::RowVectorXd row = jacobian.row(axis);
          if (row.isZero()) continue;  // held, in planar motion
          Accelerations& kind = is_rotation ? angular : (axis < 2 ? horizontal : vertical);
          kind.Add(residuals[axis], row * control_points * row.transpose());
        }
      });
  return {horizontal.Reestimate(assumed.horizontal_m_s2),
          vertical.Reestimate(assumed.vertical_m_s2),
          angular.Reestimate(assumed.angular_rad_s2)};
}

}  // namespace plumbline

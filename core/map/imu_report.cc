#include "core/map/imu_report.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/angles.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

struct ParameterName {
  const char* name;
  const char* words;
  double unit;  // in the block's
};
constexpr std::array<ParameterName, kImuBlockSize> kParameters = {{
    {"roll_deg", "roll", kRadiansPerDegree},
    {"pitch_deg", "pitch", kRadiansPerDegree},
    {"yaw_deg", "yaw", kRadiansPerDegree},
    {"x_m", "position along x", 1.0},
    {"y_m", "position along y", 1.0},
    {"z_m", "height", 1.0},
    {"time_s", "clock", 1.0},
    {"gyroscope_scale_x", "scale of the gyroscope's x axis", 1.0},
    {"gyroscope_scale_y", "scale of the gyroscope's y axis", 1.0},
    {"gyroscope_scale_z", "scale of the gyroscope's z axis", 1.0},
    {"accelerometer_scale_x", "scale of the accelerometer's x axis", 1.0},
    {"accelerometer_scale_y", "scale of the accelerometer's y axis", 1.0},
    {"accelerometer_scale_z", "scale of the accelerometer's z axis", 1.0},
    {"gravity_x_deg", "lean of gravity about x", kRadiansPerDegree},
    {"gravity_y_deg", "lean of gravity about y", kRadiansPerDegree},
}};

double LargestSigma(const ImuMatrix& covariance, int first, int count) {
  return std::sqrt(std::max(0.0, covariance.diagonal().segment(first, count).maxCoeff()));
}

Eigen::Vector3d SigmasOf(const Eigen::Matrix3d& covariance) {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

}  // namespace

CalibratedImu DescribeImu(const MapState& state) {
  const ImuEstimate& imu = *state.calibration.imu;
  CalibratedImu described;
  for (size_t k = 0; k < kParameters.size(); ++k) {
    const auto& [name, words, unit] = kParameters[k];
    const auto row = static_cast<Eigen::Index>(k);
    described.parameters.push_back({name,
                                    words,
                                    imu.block[k] / unit,
                                    std::sqrt(std::max(0.0, imu.covariance(row, row))) / unit,
                                    imu.prior_sigma[k] / unit});
  }
  const int num_intervals = state.trajectory.num_control_points() - kSplineOrder + 1;
  const int num_nodes = (num_intervals - 1) / imu.intervals_per_bias + 2;
  for (int node = 0; node < std::min(num_nodes, imu.num_biases()); ++node) {
    const ImuBiases& biases = imu.biases[static_cast<size_t>(node)];
    described.biases.push_back(
        {state.trajectory.start_ns() +
             node * imu.intervals_per_bias * state.trajectory.knot_interval_ns(),
         Eigen::Vector3d(biases.gyroscope.data()) / kRadiansPerDegree,
         SigmasOf(biases.gyroscope_covariance) / kRadiansPerDegree,
         Eigen::Vector3d(biases.accelerometer.data()),
         SigmasOf(biases.accelerometer_covariance)});
  }
  return described;
}

Imu ImuAsEstimated(const ImuEstimate& estimate) {
  Imu imu = estimate.stated;
  const ImuBlock& block = estimate.block;
  imu.body_from_imu.rotation =
      Exp(Eigen::Vector3d(block.data() + kImuTurnAt)) * imu.body_from_imu.rotation;
  imu.body_from_imu.translation += Eigen::Vector3d(block.data() + kImuShiftAt);
  imu.time_offset_s += block[kImuDelayAt];
  // What a rig that moves in the plane does not show is as uncertain as it was.
  imu.time_s = LargestSigma(estimate.covariance, kImuDelayAt, 1);
  if (estimate.planar) return imu;
  imu.rotation_rad = LargestSigma(estimate.covariance, kImuTurnAt, 3);
  imu.translation_m = LargestSigma(estimate.covariance, kImuShiftAt, 3);
  return imu;
}

}  // namespace plumbline

#include "core/map/imu_estimate.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angles.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

// From one node of the biases to the next where they hardly wander. The tiles of the normal
// matrix are as long.
constexpr double kBiasSpacing = 0.4;  // s
// Standard deviation of the tilt of floors.
constexpr double kLean = 3.0 * kRadiansPerDegree;

// The time over which a bias wanders by as much as the mean of the readings is uncertain by
// their white noise. Between nodes that lie further apart a random walk leaves the line by
// more than that mean allows, and the biases would be stated too exact.
double WanderingTime(const InertialErrors& errors) {
  const double walk = errors.BiasWalk();
  return walk > 0.0 ? errors.noise / walk : kBiasSpacing;
}

Eigen::Matrix3d Isotropic(double sigma) { return sigma * sigma * Eigen::Matrix3d::Identity(); }

}  // namespace

ImuEstimate::ImuEstimate(const Imu& stated, bool planar, double knot_interval_s)
    : stated(stated), planar(planar) {
  double spacing_s = std::min(kBiasSpacing, WanderingTime(stated.gyroscope));
  if (!planar) spacing_s = std::min(spacing_s, WanderingTime(stated.accelerometer));
  // Not shorter than tiles without biases.
  intervals_per_bias =
      std::max(2 * kSplineOrder, static_cast<int>(std::lround(spacing_s / knot_interval_s)));
  const auto fill = [&](int first, int count, double sigma) {
    std::fill_n(prior_sigma.begin() + first, count, sigma);
  };
  fill(kImuDelayAt, 1, stated.time_s);
  fill(kImuGyroscopeScaleAt, 3, stated.gyroscope.scale);
  if (!planar) {
    fill(kImuTurnAt, 3, stated.rotation_rad);
    fill(kImuShiftAt, 3, stated.translation_m);
    fill(kImuAccelerometerScaleAt, 3, stated.accelerometer.scale);
    fill(kImuLeanAt, 2, kLean);
  }
  for (int i = 0; i < kImuBlockSize; ++i) {
    covariance(i, i) = std::pow(prior_sigma[static_cast<size_t>(i)], 2);
  }
  biases.push_back(
      {{}, {}, Isotropic(stated.gyroscope.bias), Isotropic(stated.accelerometer.bias)});
}

void ImuEstimate::ExtendTo(int knot_interval) {
  while ((num_biases() - 1) * intervals_per_bias < knot_interval) {
    biases.push_back(biases.back());
  }
}

}  // namespace plumbline

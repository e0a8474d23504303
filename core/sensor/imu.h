#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace plumbline {

// Standard gravity, m/s^2.
inline constexpr double kStandardGravity = 9.80665;

// InertialErrors are the errors of the three axes of a gyroscope (unit: rad/s) or an
// accelerometer (unit: m/s^2), as data sheets state them. Standard deviations, of each axis.
struct InertialErrors {
  double noise = 0.0;             // white, per square root of 1 Hz
  double bias_instability = 0.0;  // the least Allan deviation; 0: the bias does not change
  double bias = 0.0;              // of a reading at rest when it is switched on
  double scale = 0.0;             // share of a reading
  double range = std::numeric_limits<double>::infinity();  // no reading is larger

  // Density of the random walk of the bias, per second times the square root of 1 Hz. White
  // noise N and a random walk K have the Allan variance N^2 / T + K^2 T / 3, whose least value
  // over T is 2 N K / sqrt(3).
  double BiasWalk() const {
    return noise > 0.0 ? std::sqrt(0.75) * bias_instability * bias_instability / noise : 0.0;
  }
};

// Imu describes an inertial measurement unit of the rig: where it sits, how well it measures.
struct Imu {
  std::string topic;  // of its sensor_msgs/Imu messages
  Rigid3d body_from_imu;
  InertialErrors gyroscope;
  InertialErrors accelerometer;
  double time_offset_s = 0.0;  // time of a reading = stamp + time_offset
  // Standard deviations of pose and clock as stated; 0: known exactly.
  double rotation_rad = 0.0;
  double translation_m = 0.0;
  double time_s = 0.0;
};

// ImuSample is what an IMU read at an instant, along its own axes.
struct ImuSample {
  int64_t time_ns = 0;
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();    // rad/s
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();  // m/s^2; at rest upwards
};

// ImuMean is the mean of the readings of a stretch of time.
struct ImuMean {
  Eigen::Vector3d angular_rate = Eigen::Vector3d::Zero();
  Eigen::Vector3d specific_force = Eigen::Vector3d::Zero();
  int num_samples = 0;         // 0: there is no mean
  double time_s = 0.0;         // mean of the samples' times after the stretch's begin
  double time_stddev_s = 0.0;  // their standard deviation about it
};

// ImuReadings holds the readings of a recording by time.
class ImuReadings {
 public:
  ImuReadings() = default;
  // Takes the samples in any order; of several of one instant it keeps the first one. Samples
  // whose numbers are not finite are left out.
  ImuReadings(std::vector<ImuSample> samples, const Imu& imu);

  bool empty() const { return samples_.empty(); }
  size_t size() const { return samples_.size(); }
  double period_s() const { return period_s_; }  // median time from reading to reading
  // The mean from one instant (inclusive) to a later one (exclusive); none where a reading of
  // the time is at the end of its range.
  ImuMean MeanOf(int64_t begin_ns, int64_t end_ns) const;

  // Why the readings can not be an IMU's in rad/s and m/s^2, in words; empty where they can.
  std::string Fault() const;

 private:
  std::vector<ImuSample> samples_;
  double rate_range_ = std::numeric_limits<double>::infinity();
  double force_range_ = std::numeric_limits<double>::infinity();
  double period_s_ = 0.0;
};

}  // namespace plumbline

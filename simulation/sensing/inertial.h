#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/sensor/imu.h"
#include "core/util/yaml_node.h"
#include "simulation/world/path.h"

namespace plumbline {

// InertialOptions say how the IMU of the rig file is simulated.
struct InertialOptions {
  double rate_hz = 200.0;
  // Of all errors that the rig file states: noise, biases and their walk, scale errors, pose
  // and clock. 0: a perfect IMU.
  double errors = 1.0;
  // The direction of gravity leans from the building's vertical by this about x and y.
  Eigen::Vector2d lean_rad = Eigen::Vector2d::Zero();  // lean_deg in the file
};

// Reads the section "imu" of an experiment. Throws Error with file and line.
InertialOptions ReadInertial(const YamlNode& node);

// InertialTruth is an IMU as it is, drawn about what the rig file states.
struct InertialTruth {
  Rigid3d body_from_imu;
  double late_s = 0.0;  // readings are taken later than stamped
  Eigen::Vector3d gyroscope_scale =
      Eigen::Vector3d::Zero();  // a reading is 1 + scale of the rate
  Eigen::Vector3d accelerometer_scale = Eigen::Vector3d::Zero();
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  // m/s^2, in the building
  // Biases at each reading.
  std::vector<Eigen::Vector3d> gyroscope_bias;      // rad/s
  std::vector<Eigen::Vector3d> accelerometer_bias;  // m/s^2
};

// What an IMU reads along the whole path, and the truth about it. Rates and accelerations are
// those of the analytic path, by differences of its poses. The random numbers depend only on
// the seed.
struct SimulatedImu {
  std::vector<ImuSample> samples;
  InertialTruth truth;
};
SimulatedImu SimulateImu(const Path& path,
                         const Imu& stated,
                         const InertialOptions& options,
                         uint64_t seed);

// The truth as truth_imu.json: pose, clock, scales, gravity, and biases every second.
std::string FormatInertialTruth(const SimulatedImu& simulated);

}  // namespace plumbline

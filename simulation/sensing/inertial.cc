#include "simulation/sensing/inertial.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/geometry/angles.h"
#include "core/util/time.h"
#include "simulation/world/random.h"

namespace plumbline {
namespace {

constexpr uint64_t kKey = 0x696d7531;  // of the IMU's random numbers, apart from all others
// Poses this far to either side give rates and accelerations to 1e-4 of themselves at 2 Hz.
constexpr int64_t kHalfStepNs = 1000000;

Eigen::Vector3d Gaussian3(Random* random) {
  const double x = random->Gaussian();
  const double y = random->Gaussian();
  return {x, y, random->Gaussian()};
}

// One sensor's errors while it runs.
class Axes {
 public:
  Axes(const InertialErrors& stated, double errors, double period_s, Random* random)
      : noise_(errors * stated.noise / std::sqrt(period_s)),
        walk_(errors * stated.BiasWalk() * std::sqrt(period_s)),
        range_(stated.range),
        scale_(errors * stated.scale * Gaussian3(random)),
        bias_(errors * stated.bias * Gaussian3(random)),
        random_(random) {}

  const Eigen::Vector3d& scale() const { return scale_; }
  const Eigen::Vector3d& bias() const { return bias_; }

  Eigen::Vector3d Read(const Eigen::Vector3d& value) {
    bias_ += walk_ * Gaussian3(random_);
    const Eigen::Vector3d reading =
        value + scale_.cwiseProduct(value) + bias_ + noise_ * Gaussian3(random_);
    return reading.cwiseMax(-range_).cwiseMin(range_);
  }

 private:
  double noise_;
  double walk_;
  double range_;
  Eigen::Vector3d scale_;
  Eigen::Vector3d bias_;
  Random* random_;
};

// Rotation vector of a small turn.
Eigen::Vector3d TurnOf(const Eigen::Quaterniond& turn) {
  const Eigen::AngleAxisd angle_axis(turn.w() < 0.0 ? Eigen::Quaterniond(-turn.coeffs())
                                                    : turn);
  return angle_axis.angle() * angle_axis.axis();
}

std::vector<double> List(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

InertialOptions ReadInertial(const YamlNode& node) {
  InertialOptions options;
  node.Optional("rate_hz", &options.rate_hz, 1.0, 10000.0);
  node.Optional("errors", &options.errors, 0.0, 1000.0);
  if (node.Has("lean_deg")) {
    const std::vector<double> lean = node["lean_deg"].AsDoubles(2, -90.0, 90.0);
    options.lean_rad = kRadiansPerDegree * Eigen::Vector2d(lean[0], lean[1]);
  }
  node.RejectUnreadKeys();
  return options;
}

SimulatedImu SimulateImu(const Path& path,
                         const Imu& stated,
                         const InertialOptions& options,
                         uint64_t seed) {
  Random random({seed, kKey});
  SimulatedImu simulated;
  InertialTruth& truth = simulated.truth;
  const double e = options.errors;
  const double period_s = 1.0 / options.rate_hz;
  Axes gyroscope(stated.gyroscope, e, period_s, &random);
  Axes accelerometer(stated.accelerometer, e, period_s, &random);
  const Eigen::Vector3d turn = e * stated.rotation_rad * Gaussian3(&random);
  truth.body_from_imu = {
      Eigen::AngleAxisd(turn.norm(), turn.stableNormalized()) * stated.body_from_imu.rotation,
      stated.body_from_imu.translation + e * stated.translation_m * Gaussian3(&random)};
  truth.late_s = e * stated.time_s * random.Gaussian();
  truth.gyroscope_scale = gyroscope.scale();
  truth.accelerometer_scale = accelerometer.scale();
  const Eigen::Vector3d lean(options.lean_rad.x(), options.lean_rad.y(), 0.0);
  truth.gravity = Eigen::AngleAxisd(lean.norm(), lean.stableNormalized()) *
                  Eigen::Vector3d(0.0, 0.0, -kStandardGravity);
  const double half_step_s = SecondsBetween(0, kHalfStepNs);
  const auto pose_of_imu = [&](int64_t time_ns) {
    return path.PoseAt(time_ns) * truth.body_from_imu;
  };
  const int64_t stamp_to_time_ns = NanosecondsFromSeconds(stated.time_offset_s + truth.late_s);
  const int64_t period_ns = NanosecondsFromSeconds(period_s);
  for (int64_t time_ns = path.start_ns() + kHalfStepNs; time_ns + kHalfStepNs <= path.end_ns();
       time_ns += period_ns) {
    const Rigid3d before = pose_of_imu(time_ns - kHalfStepNs);
    const Rigid3d now = pose_of_imu(time_ns);
    const Rigid3d after = pose_of_imu(time_ns + kHalfStepNs);
    const Eigen::Vector3d rate =
        TurnOf(before.rotation.conjugate() * after.rotation) / (2.0 * half_step_s);
    const Eigen::Vector3d acceleration =
        (after.translation - 2.0 * now.translation + before.translation) /
        (half_step_s * half_step_s);
    ImuSample sample;
    sample.time_ns = time_ns - stamp_to_time_ns;
    sample.angular_rate = gyroscope.Read(rate);
    sample.specific_force =
        accelerometer.Read(now.rotation.conjugate() * (acceleration - truth.gravity));
    simulated.samples.push_back(sample);
    truth.gyroscope_bias.push_back(gyroscope.bias());
    truth.accelerometer_bias.push_back(accelerometer.bias());
  }
  return simulated;
}

std::string FormatInertialTruth(const SimulatedImu& simulated) {
  const InertialTruth& truth = simulated.truth;
  const Eigen::Quaterniond& q = truth.body_from_imu.rotation;
  nlohmann::ordered_json biases = nlohmann::ordered_json::array();
  int64_t next_ns = simulated.samples.empty() ? 0 : simulated.samples.front().time_ns;
  for (size_t i = 0; i < simulated.samples.size(); ++i) {
    if (simulated.samples[i].time_ns < next_ns) continue;
    next_ns += NanosecondsFromSeconds(1.0);
    biases.push_back({{"time_ns", simulated.samples[i].time_ns},
                      {"gyroscope_rad_s", List(truth.gyroscope_bias[i])},
                      {"accelerometer_m_s2", List(truth.accelerometer_bias[i])}});
  }
  const nlohmann::ordered_json json = {
      {"body_from_imu",
       {{"translation_m", List(truth.body_from_imu.translation)},
        {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}}},
      {"late_s", truth.late_s},
      {"gyroscope_scale", List(truth.gyroscope_scale)},
      {"accelerometer_scale", List(truth.accelerometer_scale)},
      {"gravity_m_s2", List(truth.gravity)},
      {"biases", biases}};
  return json.dump(1) + "\n";
}

}  // namespace plumbline

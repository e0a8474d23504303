#include "simulation/sensing/inertial.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int kDraws = 300;
// Sampled standard deviations are good to 1 / sqrt(2 * 3 * 300) = 2.4 %, four sigmas.
constexpr double kTolerance = 0.1;

// Round a corner to the left, rolling.
Path Way() {
  PathOptions options;
  options.way_points = {{{1.0, 2.0}, ""}, {{1.0, 5.0}, ""}, {{-5.0, 5.0}, ""}};
  options.length_m = 6.0;
  options.roll = {0.1, 1.3, 0.4};
  options.height = {0.02, 1.8, 0.0};
  options.start_ns = 1'400'000'000'000'000'000;
  return Path(options);
}

Imu Cheap() {
  Imu imu;
  imu.body_from_imu = {Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitX())),
                       Eigen::Vector3d(0.1, -0.2, 0.05)};
  imu.gyroscope = {1e-4, 1e-5, 0.02, 0.03};
  imu.accelerometer = {4e-3, 1e-3, 0.3, 0.02};
  imu.rotation_rad = 0.01;
  imu.translation_m = 0.005;
  imu.time_s = 0.002;
  return imu;
}

InertialOptions Perfect() {
  InertialOptions options;
  options.errors = 0.0;
  return options;
}

TEST(InertialTest, APerfectImuReadsWhatThePathDoes) {
  const Path path = Way();
  const Imu imu = Cheap();
  const SimulatedImu simulated = SimulateImu(path, imu, Perfect(), 1);
  ASSERT_GT(simulated.samples.size(), 1000u);
  // Its rates and forces, integrated from one instant to another, lead along the path.
  constexpr size_t kFirst = 300;
  const Rigid3d start = path.PoseAt(simulated.samples[kFirst].time_ns) * imu.body_from_imu;
  const Rigid3d next =
      path.PoseAt(simulated.samples[kFirst].time_ns + 1'000'000) * imu.body_from_imu;
  const Rigid3d last =
      path.PoseAt(simulated.samples[kFirst].time_ns - 1'000'000) * imu.body_from_imu;
  Eigen::Quaterniond rotation = start.rotation;
  Eigen::Vector3d position = start.translation;
  Eigen::Vector3d velocity = (next.translation - last.translation) / 2e-3;
  constexpr double kPeriod = 0.005;
  for (size_t i = kFirst; i < kFirst + 400; ++i) {
    // By the trapezium rule.
    const ImuSample& from = simulated.samples[i];
    const ImuSample& to = simulated.samples[i + 1];
    const Eigen::Vector3d turn = 0.5 * kPeriod * (from.angular_rate + to.angular_rate);
    const Eigen::Quaterniond after =
        rotation * Eigen::AngleAxisd(turn.norm(), turn.stableNormalized());
    const Eigen::Vector3d acceleration =
        0.5 * (rotation * from.specific_force + after * to.specific_force) -
        kStandardGravity * Eigen::Vector3d::UnitZ();
    position += kPeriod * velocity + 0.5 * kPeriod * kPeriod * acceleration;
    velocity += kPeriod * acceleration;
    rotation = after;
  }
  const Rigid3d end = path.PoseAt(simulated.samples[kFirst + 400].time_ns) * imu.body_from_imu;
  EXPECT_LT((position - end.translation).norm(), 1e-3);
  EXPECT_LT(rotation.angularDistance(end.rotation), 1e-4);
}

TEST(InertialTest, ErrorsAreAsLargeAsStated) {
  const Path path = Way();
  const Imu imu = Cheap();
  Eigen::Vector4d squares = Eigen::Vector4d::Zero();
  double walk = 0.0;
  for (int seed = 1; seed <= kDraws; ++seed) {
    InertialOptions options;
    options.rate_hz = 20.0;
    const InertialTruth truth = SimulateImu(path, imu, options, seed).truth;
    squares[0] += truth.gyroscope_bias.front().squaredNorm();
    squares[1] += truth.accelerometer_bias.front().squaredNorm();
    squares[2] += truth.gyroscope_scale.squaredNorm();
    squares[3] +=
        (truth.body_from_imu.translation - imu.body_from_imu.translation).squaredNorm();
    const double duration_s =
        static_cast<double>(truth.accelerometer_bias.size() - 1) / options.rate_hz;
    walk +=
        (truth.accelerometer_bias.back() - truth.accelerometer_bias.front()).squaredNorm() /
        duration_s;
  }
  const Eigen::Vector4d stddevs = (squares / (3.0 * kDraws)).cwiseSqrt();
  EXPECT_NEAR(stddevs[0] / imu.gyroscope.bias, 1.0, kTolerance);
  EXPECT_NEAR(stddevs[1] / imu.accelerometer.bias, 1.0, kTolerance);
  EXPECT_NEAR(stddevs[2] / imu.gyroscope.scale, 1.0, kTolerance);
  EXPECT_NEAR(stddevs[3] / imu.translation_m, 1.0, kTolerance);
  EXPECT_NEAR(
      std::sqrt(walk / (3.0 * kDraws)) / imu.accelerometer.BiasWalk(), 1.0, kTolerance);
}

TEST(InertialTest, ReadingsEndAtTheRange) {
  Imu imu = Cheap();
  imu.gyroscope.range = 0.3;
  const SimulatedImu simulated = SimulateImu(Way(), imu, Perfect(), 1);
  double largest = 0.0;
  for (const ImuSample& sample : simulated.samples) {
    largest = std::max(largest, sample.angular_rate.cwiseAbs().maxCoeff());
  }
  EXPECT_EQ(largest, 0.3);  // the path rolls by 0.8 rad/s
}

TEST(InertialTest, StampsAreLateByTheClock) {
  Imu imu = Cheap();
  imu.time_offset_s = 0.25;
  const SimulatedImu stamped = SimulateImu(Way(), imu, Perfect(), 1);
  const SimulatedImu exact = SimulateImu(Way(), Cheap(), Perfect(), 1);
  EXPECT_EQ(SecondsBetween(stamped.samples.front().time_ns, exact.samples.front().time_ns),
            0.25);
}

}  // namespace
}  // namespace plumbline

#include "core/sensor/gravity.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <vector>

#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int64_t kStartNs = 5'000'000'000;
constexpr double kPeriod = 0.005;  // s, from reading to reading
constexpr double kUsual = 0.7;     // density of a rig's accelerations, m/s^2 per root of 1 Hz
constexpr double kDegree = M_PI / 180.0;

// An IMU that sits askew on the body.
Imu AskewImu() {
  Imu imu;
  imu.body_from_imu.rotation = Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, -1).normalized());
  return imu;
}

// What it reads for twenty seconds. pitch_rad: of the body, by the time in s; forwards: its
// acceleration along the world's x axis.
template <typename Pitch, typename Acceleration>
ImuReadings Read(const Imu& imu,
                 const Eigen::Vector3d& gyroscope_bias,
                 const Pitch& pitch_rad,
                 const Acceleration& forwards_m_s2) {
  std::vector<ImuSample> samples;
  for (int i = 0; i < 4000; ++i) {
    const double time_s = i * kPeriod;
    const double rate = (pitch_rad(time_s + 1e-4) - pitch_rad(time_s - 1e-4)) / 2e-4;
    const Eigen::Quaterniond imu_from_world =
        imu.body_from_imu.rotation.conjugate() *
        Eigen::AngleAxisd(-pitch_rad(time_s), Eigen::Vector3d::UnitY());
    const Eigen::Vector3d force(forwards_m_s2(time_s), 0.0, kStandardGravity);
    samples.push_back(
        {kStartNs + NanosecondsFromSeconds(time_s),
         imu.body_from_imu.rotation.conjugate() * Eigen::Vector3d(0, rate, 0) + gyroscope_bias,
         imu_from_world * force});
  }
  return ImuReadings(samples, imu);
}

double Nothing(double) { return 0.0; }
double Nod(double time_s) { return 0.5 * std::sin(2.0 * M_PI * time_s + 0.7); }

// The angle between the direction found and the true one, at a pitch.
double ErrorOf(const UpDirection& found, double pitch_rad) {
  const Eigen::Vector3d truth(-std::sin(pitch_rad), 0.0, std::cos(pitch_rad));
  return std::acos(std::min(1.0, truth.dot(found.up_body)));
}

TEST(GravityTest, ARigAtRestLeansAsItsAccelerometerReads) {
  const ImuReadings readings = Read(
      AskewImu(), Eigen::Vector3d::Zero(), [](double) { return 0.4; }, Nothing);
  const auto up = FindUp(readings, AskewImu(), kStartNs, kUsual);
  ASSERT_TRUE(up);
  EXPECT_LT(ErrorOf(*up, 0.4), 1e-6);
}

TEST(GravityTest, TheNodOfTheRigIsTakenOffByTheGyroscope) {
  const ImuReadings readings = Read(AskewImu(), Eigen::Vector3d::Zero(), Nod, Nothing);
  for (const double time_s : {0.0, 0.25, 0.6}) {
    const auto up =
        FindUp(readings, AskewImu(), kStartNs + NanosecondsFromSeconds(time_s), kUsual);
    ASSERT_TRUE(up);
    EXPECT_LT(ErrorOf(*up, Nod(time_s)), 0.2 * kDegree);
  }
}

// Starts off and comes to a halt; a gyroscope that drifts: over a short time the one, over a
// long one the other would turn the mean.
TEST(GravityTest, StatesWhatMotionAndGyroscopeLeaveOpen) {
  Imu imu = AskewImu();
  const auto push = [](double time_s) { return time_s < 0.5 ? 1.5 : 0.0; };
  double before_rad = 0.0;
  for (const double bias : {0.1 * kDegree, 1.0 * kDegree, 5.0 * kDegree}) {
    imu.gyroscope.bias = bias;
    const ImuReadings readings = Read(imu, Eigen::Vector3d::Constant(bias), Nod, push);
    const auto up = FindUp(readings, imu, kStartNs, kUsual);
    ASSERT_TRUE(up);
    EXPECT_LT(ErrorOf(*up, Nod(0.0)), 3.0 * up->stddev_rad) << bias;
    EXPECT_GT(up->stddev_rad, before_rad) << "a worse gyroscope says less";
    EXPECT_LT(up->stddev_rad, 6.0 * kDegree);
    before_rad = up->stddev_rad;
  }
}

TEST(GravityTest, TakesWhatTheAccelerometerMayBeOff) {
  Imu imu = AskewImu();
  imu.accelerometer.bias = 0.1 * kStandardGravity;
  const ImuReadings readings = Read(imu, Eigen::Vector3d::Zero(), Nothing, Nothing);
  EXPECT_GT(FindUp(readings, imu, kStartNs, kUsual)->stddev_rad, 0.1);
}

TEST(GravityTest, KnowsNothingWhereNothingWasRead) {
  const ImuReadings readings = Read(AskewImu(), Eigen::Vector3d::Zero(), Nothing, Nothing);
  EXPECT_FALSE(FindUp(readings, AskewImu(), kStartNs + NanosecondsFromSeconds(60.0), kUsual));
  EXPECT_FALSE(FindUp(ImuReadings(), AskewImu(), kStartNs, kUsual));
}

}  // namespace
}  // namespace plumbline

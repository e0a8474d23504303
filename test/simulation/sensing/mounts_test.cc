#include "simulation/sensing/mounts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'000;
constexpr int64_t kEnd = kStart + 4'000'000'000;

Rig NoddingRig() {
  Rig rig;
  rig.scanners.resize(2);
  rig.scanners[1].name = "nodding";
  Mount mount;
  mount.axis = Eigen::Vector3d::UnitY();
  mount.joint_topic = "/joint_states";
  mount.swing = Swing{0.5, 1.0, 0.0};
  mount.time_offset_s = 0.05;
  mount.uncertainty = {0.02, 0.003, 0.0, 0.01, 0.004};
  rig.scanners[1].mount = mount;
  return rig;
}

MountOptions Exact() {
  MountOptions options;
  options.errors = 0.0;
  return options;
}

TEST(MountsTest, AnExactMountIsReadAsItStands) {
  Rig rig = NoddingRig();
  const SimulatedMounts simulated = SimulateMounts(Exact(), kStart, kStart, kEnd, 3, &rig);
  ASSERT_EQ(simulated.truths.size(), 1u);
  ASSERT_GT(simulated.readings.size(), 400u);
  for (const MountReading& reading : simulated.readings) {
    EXPECT_EQ(reading.scanner, 1u);
    const int64_t time_ns = reading.stamp_ns + NanosecondsFromSeconds(0.05);
    EXPECT_NEAR(
        reading.angle_rad, 0.5 * std::sin(2.0 * M_PI * SecondsBetween(kStart, time_ns)), 1e-6);
    EXPECT_NEAR(rig.scanners[1].mount->AngleAt(time_ns, 0.0), reading.angle_rad, 1e-6);
  }
}

TEST(MountsTest, ErrorsAreDrawnAboutWhatIsStated) {
  constexpr int kDraws = 200;
  double zero2 = 0.0;
  double late2 = 0.0;
  double tilt2 = 0.0;
  double shift2 = 0.0;
  for (int seed = 0; seed < kDraws; ++seed) {
    Rig rig = NoddingRig();
    const MountTruth truth = SimulateMounts(MountOptions(),
                                            kStart,
                                            kStart,
                                            kStart + 100'000'000,
                                            static_cast<uint64_t>(seed),
                                            &rig)
                                 .truths.front();
    zero2 += truth.zero_rad * truth.zero_rad;
    late2 += truth.late_s * truth.late_s;
    tilt2 += 0.5 * truth.tilts.squaredNorm();
    shift2 += 0.5 * truth.shifts.squaredNorm();
    EXPECT_EQ(truth.rate, 0.0);
    EXPECT_NEAR(rig.scanners[1].mount->zero_rad, truth.zero_rad, 1e-12);
  }
  // Sampled standard deviations are good to 1 / sqrt(2 * 200) = 5 %, four sigmas.
  EXPECT_NEAR(std::sqrt(zero2 / kDraws) / 0.02, 1.0, 0.2);
  EXPECT_NEAR(std::sqrt(late2 / kDraws) / 0.003, 1.0, 0.2);
  EXPECT_NEAR(std::sqrt(tilt2 / kDraws) / 0.01, 1.0, 0.2);
  EXPECT_NEAR(std::sqrt(shift2 / kDraws) / 0.004, 1.0, 0.2);
}

TEST(MountsTest, TheScannerFollowsItsDriveWithPlay) {
  Rig rig = NoddingRig();
  MountOptions options = Exact();
  options.backlash_rad = 0.02;
  const SimulatedMounts simulated = SimulateMounts(options, kStart, kStart, kEnd, 3, &rig);
  double most = 0.0;
  for (const MountReading& reading : simulated.readings) {
    const int64_t time_ns = reading.stamp_ns + NanosecondsFromSeconds(0.05);
    const double off = reading.angle_rad - rig.scanners[1].mount->AngleAt(time_ns, 0.0);
    most = std::max(most, std::abs(off));
    const double rate = std::cos(2.0 * M_PI * SecondsBetween(kStart, time_ns));
    // Away from the turning points the scanner trails behind.
    if (std::abs(rate) > 0.5 && time_ns > kStart) {
      EXPECT_NEAR(off, std::copysign(0.01, rate), 1e-6);
    }
  }
  EXPECT_NEAR(most, 0.01, 1e-6);
}

TEST(MountsTest, ADriveThatNobodyReadsIsFasterAndShakes) {
  Rig rig = NoddingRig();
  Mount& mount = *rig.scanners[1].mount;
  mount.joint_topic.clear();
  mount.swing.reset();
  mount.rate_rad_s = 2.0;
  mount.uncertainty = {0.0, 0.0, 0.01, 0.0, 0.0};
  mount.time_offset_s = 0.0;
  MountOptions options;
  options.jitter_rad = 0.001;
  const SimulatedMounts simulated = SimulateMounts(options, kStart, kStart, kEnd, 3, &rig);
  EXPECT_TRUE(simulated.readings.empty());
  const double rate = simulated.truths.front().rate;
  EXPECT_NE(rate, 0.0);
  double squares = 0.0;
  constexpr int kTimes = 150;
  for (int i = 0; i < kTimes; ++i) {
    const int64_t time_ns = kStart + int64_t{20'000'000} * i;  // where it has been drawn
    const double off = rig.scanners[1].mount->AngleAt(time_ns, 0.0) -
                       2.0 * (1.0 + rate) * SecondsBetween(kStart, time_ns);
    squares += off * off;
  }
  // Good to 1 / sqrt(2 * 150) = 6 %, four sigmas.
  EXPECT_NEAR(std::sqrt(squares / kTimes) / 0.001, 1.0, 0.24);
}

TEST(MountsTest, TheTruthIsWrittenInTheUnitsOfTheCalibration) {
  MountTruth truth;
  truth.scanner = "nodding";
  truth.zero_rad = M_PI / 180.0;
  truth.late_s = 0.002;
  const auto json = nlohmann::json::parse(FormatMountTruth({truth}));
  EXPECT_EQ(json["scanners"][0]["name"], "nodding");
  EXPECT_NEAR(json["scanners"][0]["mount_zero_deg"].get<double>(), 1.0, 1e-12);
  EXPECT_EQ(json["scanners"][0]["mount_time_s"], 0.002);
}

}  // namespace
}  // namespace plumbline

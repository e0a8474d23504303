#include "core/judging/nodding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "test/core/judging/turning_rig.h"

namespace plumbline {
namespace {

// A hall so high that a scanner sees other ranges upwards than downwards.
PlaneScene Hall() {
  constexpr double kDegree = M_PI / 180.0;
  return MakeRoom({{0.0, 8.5},
                   {65.0 * kDegree, 9.0},
                   {125.0 * kDegree, 7.2},
                   {190.0 * kDegree, 10.5},
                   {245.0 * kDegree, 8.7},
                   {300.0 * kDegree, 9.2}},
                  -1.2,
                  12.0);
}

// A slow walk straight on.
Rigid3d Walk(int64_t time_ns) {
  return {
      Eigen::Quaterniond::Identity(),
      Eigen::Vector3d(0.1 * SecondsBetween(TurningRig::kStartNs, time_ns) - 0.5, 0.2, 0.0)};
}

// Lines of ten seconds of the paper's rig, whose first scanner is on a mount, or is not.
template <typename Pose>
std::vector<ScanLine> LinesOf(const Pose& world_from_body,
                              const std::optional<Mount>& mount,
                              size_t scanner) {
  Rig rig = MakePaperRig();
  for (Scanner& each : rig.scanners) each.scan_rate_hz = TurningRig::kRate;
  rig.scanners[0].mount = mount;
  std::vector<ScanLine> lines;
  std::mt19937_64 random(1);
  for (int k = 0; k < static_cast<int>(10.0 * TurningRig::kRate); ++k) {
    const int64_t stamp_ns =
        TurningRig::kStartNs + NanosecondsFromSeconds(k / TurningRig::kRate);
    lines.push_back(SixWalls::Take(Hall(), rig, stamp_ns, world_from_body, &random)[scanner]);
  }
  return lines;
}

Mount Nodding(double period_s) {
  Mount mount;
  mount.axis = Eigen::Vector3d::UnitY();
  mount.swing = Swing{M_PI / 6.0, period_s, 0.3};
  mount.start_ns = TurningRig::kStartNs;
  return mount;
}

TEST(NoddingTest, FindsPeriodAndAxis) {
  for (const double period_s : {1.0, 1.7}) {
    const std::optional<Nod> nod = FindNod(LinesOf(Walk, Nodding(period_s), 0));
    ASSERT_TRUE(nod);
    EXPECT_NEAR(nod->period_s, period_s, 0.05);
    // The scanner's axis x points to the right, along the mount's.
    EXPECT_LT(std::abs(std::remainder(nod->axis_rad, M_PI)), 0.2);
    EXPECT_LT(nod->returned_share, 0.7 * nod->changed_share);
  }
}

// The walk of somebody whose hands sway.
Rigid3d Sway(int64_t time_ns) {
  const double time_s = SecondsBetween(TurningRig::kStartNs, time_ns);
  const double roll_rad = 0.05 * std::sin(2.0 * M_PI * 0.9 * time_s);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitX())),
          Walk(time_ns).translation};
}

TEST(NoddingTest, ARigThatSwaysDoesNotNod) {
  for (const size_t scanner : {0, 1, 2}) {
    EXPECT_FALSE(FindNod(LinesOf(Sway, {}, scanner))) << scanner;
  }
}

TEST(NoddingTest, AScannerThatStandsDoesNotNod) {
  for (const size_t scanner : {0, 1, 2}) {
    EXPECT_FALSE(FindNod(LinesOf(Walk, {}, scanner))) << scanner;
    EXPECT_FALSE(FindNod(LinesOf(TurningRig::WorldFromBody, {}, scanner))) << scanner;
  }
  EXPECT_FALSE(FindNod({}));
}

// What an IMU of the body reads of its turns.
template <typename Pose>
ImuReadings ReadTurns(const Pose& world_from_body) {
  constexpr int64_t kStep = 5'000'000;  // ns
  std::vector<ImuSample> samples;
  for (int i = 0; i < 2000; ++i) {
    const int64_t time_ns = TurningRig::kStartNs + i * kStep;
    const Eigen::AngleAxisd turn(world_from_body(time_ns).rotation.conjugate() *
                                 world_from_body(time_ns + kStep).rotation);
    samples.push_back(
        {time_ns, turn.angle() / (1e-9 * kStep) * turn.axis(), Eigen::Vector3d::Zero()});
  }
  return ImuReadings(samples, Imu());
}

// The head of a rig that nods as a whole.
Rigid3d NodOfRig(int64_t time_ns) {
  const double time_s = SecondsBetween(TurningRig::kStartNs, time_ns);
  const double pitch_rad = M_PI / 6.0 * std::sin(2.0 * M_PI * time_s + 0.3);
  return {Eigen::Quaterniond(Eigen::AngleAxisd(pitch_rad, Eigen::Vector3d::UnitY())),
          Walk(time_ns).translation};
}

TEST(NoddingTest, TheGyroscopeTellsARigThatNodsFromAScannerThatDoes) {
  const Scanner scanner = MakePaperRig().scanners[0];
  const std::vector<ScanLine> of_rig = LinesOf(NodOfRig, {}, 0);
  const std::optional<Nod> nod = FindNod(of_rig);
  ASSERT_TRUE(nod);
  EXPECT_TRUE(IsOfRig(*nod, of_rig, scanner, Imu(), ReadTurns(NodOfRig)));
  const std::vector<ScanLine> of_mount = LinesOf(Sway, Nodding(1.0), 0);
  const std::optional<Nod> of_scanner = FindNod(of_mount);
  ASSERT_TRUE(of_scanner);
  EXPECT_FALSE(IsOfRig(*of_scanner, of_mount, scanner, Imu(), ReadTurns(Sway)));
  EXPECT_FALSE(IsOfRig(*of_scanner, of_mount, scanner, Imu(), ImuReadings()));
}

}  // namespace
}  // namespace plumbline

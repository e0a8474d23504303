#include "core/judging/start_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "test/testing/six_walls.h"

namespace plumbline {
namespace {

constexpr double kDegree = M_PI / 180.0;

// The lines of a rig that rests for a second in a room, its body tilted by an angle.
std::vector<std::vector<ScanLine>> TakeLines(const Rig& rig,
                                             const PlaneScene& room,
                                             double tilt_rad) {
  std::vector<std::vector<ScanLine>> lines(rig.scanners.size());
  std::mt19937_64 random(5);
  const Rigid3d pose = {RotationFromRollPitchYaw(tilt_rad, 0.0, 0.3), Eigen::Vector3d::Zero()};
  for (int k = 0; k < 20; ++k) {
    const auto scan = SixWalls::Take(
        room,
        rig,
        SixWalls::kStartNs + k * 50'000'000,
        [&](int64_t) { return pose; },
        &random);
    for (size_t i = 0; i < scan.size(); ++i) lines[i].push_back(scan[i]);
  }
  return lines;
}

StartSearch Find(const Rig& rig, const std::vector<std::vector<ScanLine>>& lines) {
  std::vector<const std::vector<ScanLine>*> pointers;
  for (const std::vector<ScanLine>& of_scanner : lines) pointers.push_back(&of_scanner);
  return FindStarts(rig, pointers);
}

TEST(StartSearchTest, RoomWithFloorAndWallsIsAStartFromEveryScan) {
  const Rig rig = MakePaperRig();
  for (const double tilt_deg : {0.0, 6.0}) {
    const StartSearch search = Find(rig, TakeLines(rig, SixWalls::Room(), tilt_deg * kDegree));
    EXPECT_EQ(search.num_scans, 20);
    EXPECT_EQ(search.num_starts, 20);
    EXPECT_NEAR(search.tilt_deg, tilt_deg, 0.5);
  }
}

// Neither floor nor ceiling is within reach of the scanners.
TEST(StartSearchTest, WallsAloneAreNoStartOfARigInSpace) {
  const Rig rig = MakePaperRig();
  const PlaneScene walls = MakeRoom(
      {{0.0, 2.5}, {90.0 * kDegree, 3.0}, {180.0 * kDegree, 2.0}, {270.0 * kDegree, 4.0}},
      -50.0,
      50.0);
  const StartSearch search = Find(rig, TakeLines(rig, walls, 0.0));
  EXPECT_EQ(search.num_scans, 20);
  EXPECT_EQ(search.num_starts, 0);
}

TEST(StartSearchTest, WallIsEnoughInThePlane) {
  Rig rig;
  rig.scanners.resize(1);
  ASSERT_TRUE(IsPlanar(rig));
  const StartSearch search = Find(rig, TakeLines(rig, SixWalls::Room(), 0.0));
  EXPECT_EQ(search.num_starts, 20);
}

TEST(StartSearchTest, WithoutLinesNothingIsLookedAt) {
  const Rig rig = MakePaperRig();
  EXPECT_EQ(FindStarts(rig, {}).num_scans, 0);
  EXPECT_EQ(Find(rig, std::vector<std::vector<ScanLine>>(3)).num_scans, 0);
}

// The tilted scanners began much later: what they saw belongs to no scan.
TEST(StartSearchTest, LinesOfAnotherTimeAreNotTakenTogether) {
  const Rig rig = MakePaperRig();
  std::vector<std::vector<ScanLine>> lines = TakeLines(rig, SixWalls::Room(), 0.0);
  for (const size_t tilted : {1u, 2u}) {
    for (ScanLine& line : lines[tilted]) line.stamp_ns += 10'000'000'000;
  }
  const StartSearch search = Find(rig, lines);
  EXPECT_EQ(search.num_scans, 20);
  EXPECT_EQ(search.num_starts, 0);
}

}  // namespace
}  // namespace plumbline

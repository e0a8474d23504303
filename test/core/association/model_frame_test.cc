#include "core/association/model_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'000;
const double kDegree = M_PI / 180.0;
// Wall normals' headings, no two parallel or perpendicular, and distances.
const std::vector<std::pair<double, double>> kWalls = {
    {0.1, 3.0}, {1.4, 2.2}, {2.5, 3.5}, {3.6, 2.5}, {4.9, 3.1}};

std::vector<Observation> TakeScan(const Rig& rig,
                                  const PlaneScene& scene,
                                  const Rigid3d& world_from_body,
                                  double sigma_m,
                                  std::mt19937_64* random) {
  std::vector<Observation> scan;
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const ScanLine line = TakeScanLine(
        scene,
        rig.scanners[i],
        static_cast<int>(i),
        kStart,
        [&](int64_t) { return world_from_body; },
        sigma_m,
        random);
    for (const Segment& segment : SegmentScanLine(line, rig.scanners[i], {}, {})) {
      scan.push_back(MakeObservation(line, rig.scanners[i], segment, false));
    }
  }
  return scan;
}

// Angle between the true vertical and the frame's, and the frame's x axis and the nearest wall
// normal, in rad.
struct FrameErrors {
  double vertical;
  double heading;
};

FrameErrors ErrorsOf(const ModelFrame& frame, const Rigid3d& world_from_body) {
  const Eigen::Quaterniond model_from_world =
      frame.world_from_body * world_from_body.rotation.conjugate();
  FrameErrors errors;
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  errors.vertical =
      angle(model_from_world * Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitZ());
  errors.heading = M_PI;
  for (const auto& wall : kWalls) {
    const Eigen::Vector3d normal(std::cos(wall.first), std::sin(wall.first), 0.0);
    errors.heading =
        std::min(errors.heading, angle(model_from_world * normal, Eigen::Vector3d::UnitX()));
  }
  return errors;
}

Rigid3d Pose(int roll_deg, int pitch_deg, int heading_deg) {
  return {
      RotationFromRollPitchYaw(roll_deg * kDegree, pitch_deg * kDegree, heading_deg * kDegree),
      Eigen::Vector3d(0.3, -0.2, 1.3)};
}

class InitialisationTest : public testing::TestWithParam<int> {};

// A tilt of up to 20 degrees towards any side.
TEST_P(InitialisationTest, FindsTheFrameOfATiltedRig) {
  const Rig rig = MakePaperRig();
  const PlaneScene scene = MakeRoom(kWalls, 0.0, 2.8);
  const int heading_deg = GetParam();
  std::mt19937_64 random(static_cast<uint64_t>(1000 + heading_deg));
  for (const auto& [roll_deg, pitch_deg] :
       {std::pair{0, 0}, {20, 0}, {-20, 0}, {0, 20}, {0, -20}, {14, -14}, {-14, -14}}) {
    SCOPED_TRACE(testing::Message() << "roll " << roll_deg << " pitch " << pitch_deg);
    const Rigid3d pose = Pose(roll_deg, pitch_deg, heading_deg);
    const auto scan = TakeScan(rig, scene, pose, 0.03, &random);
    const std::optional<ModelFrame> frame = FindModelFrame(rig, false, scan);
    ASSERT_TRUE(frame.has_value());
    const FrameErrors errors = ErrorsOf(*frame, pose);
    // FindModelFrame promises 0.03 rad as standard deviation of the vertical at worst.
    EXPECT_LT(errors.vertical, 3.0 * 0.03);
    EXPECT_LT(errors.heading, 3.0 * std::hypot(0.03, 0.05));
    ASSERT_GE(frame->reference_observation, 0);
    ASSERT_LT(frame->reference_observation, static_cast<int>(scan.size()));
  }
}

INSTANTIATE_TEST_SUITE_P(Headings,
                         InitialisationTest,
                         testing::Values(0, 50, 100, 170, 230, 300));

TEST(InitialisationDetailsTest, PerfectRangesGiveAPerfectFrame) {
  Rig rig = MakePaperRig();
  std::mt19937_64 random(1);
  const Rigid3d pose = Pose(10, -12, 75);
  const auto scan = TakeScan(rig, MakeRoom(kWalls, 0.0, 2.8), pose, 0.0, &random);
  const std::optional<ModelFrame> frame = FindModelFrame(rig, false, scan);
  ASSERT_TRUE(frame.has_value());
  const FrameErrors errors = ErrorsOf(*frame, pose);
  EXPECT_LT(errors.vertical, 1e-3);
  EXPECT_LT(errors.heading, 1e-3);
}

TEST(InitialisationDetailsTest, ReferenceIsTheWallOfTheXAxis) {
  const Rig rig = MakePaperRig();
  std::mt19937_64 random(1);
  const Rigid3d pose = Pose(3, -5, 200);
  const auto scan = TakeScan(rig, MakeRoom(kWalls, 0.0, 2.8), pose, 0.03, &random);
  const std::optional<ModelFrame> frame = FindModelFrame(rig, false, scan);
  ASSERT_TRUE(frame.has_value());
  const Observation& reference = scan[static_cast<size_t>(frame->reference_observation)];
  const Eigen::Quaterniond model_from_scanner =
      frame->world_from_body *
      rig.scanners[static_cast<size_t>(reference.scanner_index)].body_from_scanner.rotation;
  const Eigen::Vector3d direction =
      model_from_scanner *
      Eigen::Vector3d(reference.tangent().x(), reference.tangent().y(), 0.0);
  EXPECT_NEAR(direction.x(), 0.0, 1e-9);
  // The normal points from the wall to the scanner.
  const Eigen::Vector3d to_wall =
      model_from_scanner *
      Eigen::Vector3d(reference.centroid().x(), reference.centroid().y(), 0.0);
  EXPECT_LT(to_wall.x(), 0.0);
}

TEST(InitialisationDetailsTest, OneWallAloneGivesNoFrame) {
  const Rig rig = MakePaperRig();
  std::mt19937_64 random(1);
  for (const int heading_deg : {0, 60, 120, 180, 240, 300}) {
    const PlaneScene one_wall = {MakeRoom(kWalls, 0.0, 2.8).front()};
    const auto scan = TakeScan(rig, one_wall, Pose(2, -3, heading_deg), 0.03, &random);
    EXPECT_FALSE(FindModelFrame(rig, false, scan).has_value()) << heading_deg;
  }
  EXPECT_FALSE(FindModelFrame(rig, false, {}).has_value());
}

// Without floor and ceiling, a vertical that is given must be right: it then comes from walls.
TEST(InitialisationDetailsTest, WithoutFloorNothingWrongIsFound) {
  const Rig rig = MakePaperRig();
  std::mt19937_64 random(1);
  PlaneScene walls = MakeRoom(kWalls, 0.0, 2.8);
  walls.resize(kWalls.size());
  for (const int heading_deg : {0, 40, 80, 120, 160, 200, 240, 280, 320}) {
    const Rigid3d pose = Pose(4, -6, heading_deg);
    const auto frame = FindModelFrame(rig, false, TakeScan(rig, walls, pose, 0.03, &random));
    if (frame) {
      EXPECT_LT(ErrorsOf(*frame, pose).vertical, 3.0 * 0.03) << heading_deg;
    }
  }
}

// Mirrored scanners have parallel traces on a corridor's walls, as long as those on floor and
// ceiling; with the walls' normals they agree on an axis 35.3 degrees from the vertical,
// within the noise of what a body may be tilted by.
TEST(InitialisationDetailsTest, TracesAlongACorridorAreNoFloor) {
  const Rig rig = MakePaperRig();
  std::mt19937_64 random(1);
  const PlaneScene corridor =
      MakeRoom({{0.0, 1.2}, {0.5 * M_PI, 1.0}, {M_PI, 20.0}, {1.5 * M_PI, 1.0}}, 0.0, 2.8);
  const Rigid3d pose = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.0, 0.0, 1.4)};
  for (int i = 0; i < 50; ++i) {
    const auto scan = TakeScan(rig, corridor, pose, 0.03, &random);
    const std::optional<ModelFrame> frame = FindModelFrame(rig, false, scan);
    ASSERT_TRUE(frame.has_value()) << i;
    EXPECT_LT(ErrorsOf(*frame, pose).vertical, 3.0 * 0.03) << i;
  }
}

TEST(InitialisationDetailsTest, FloorWithoutWallGivesNoFrame) {
  const Rig rig = MakePaperRig();
  std::mt19937_64 random(1);
  const auto scan = TakeScan(rig, MakeRoom({}, 0.0, 2.8), Pose(0, 0, 10), 0.03, &random);
  EXPECT_FALSE(FindModelFrame(rig, false, scan).has_value());
}

TEST(InitialisationDetailsTest, PlanarRigNeedsAWallOnly) {
  Rig rig = MakePaperRig();
  rig.scanners.resize(1);
  std::mt19937_64 random(1);
  const Rigid3d pose = Pose(0, 0, 130);
  const auto scan = TakeScan(rig, MakeRoom(kWalls, 0.0, 2.8), pose, 0.03, &random);
  const std::optional<ModelFrame> frame = FindModelFrame(rig, true, scan);
  ASSERT_TRUE(frame.has_value());
  const FrameErrors errors = ErrorsOf(*frame, pose);
  EXPECT_LT(errors.vertical, 1e-9);
  EXPECT_LT(errors.heading, 3.0 * 0.05);
  EXPECT_FALSE(FindModelFrame(rig, true, {}).has_value());
}

}  // namespace
}  // namespace plumbline

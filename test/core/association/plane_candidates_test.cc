#include "core/association/plane_candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/geometry/matrix_types.h"
#include "core/segmentation/segmentation.h"
#include "core/surface/landmark_view.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'000;
constexpr int64_t kPeriod = 25'000'000;
constexpr double kSigma = 0.01;         // rad
constexpr double kSignificance = 1e-4;  // 4.3 sigma
const double kDegree = M_PI / 180.0;

// Trace of a plane in the scan plane, as an observation that knows no more than its direction.
Observation TraceOf(const Eigen::Vector3d& normal_world,
                    const Eigen::Quaterniond& world_from_scanner) {
  const Eigen::Vector3d normal = world_from_scanner.conjugate() * normal_world;
  const Eigen::Vector2d tangent = Eigen::Vector2d(-normal.y(), normal.x()).normalized();
  Observation observation;
  observation.measurement =
      PackedSegment({}, {Eigen::Vector2f::Zero(), tangent.cast<float>()});
  return observation;
}

TypeEvidence Judge(const Eigen::Vector3d& normal_world, double pitch_deg, double yaw_deg) {
  const Eigen::Quaterniond world_from_scanner =
      RotationFromRollPitchYaw(0.0, pitch_deg * kDegree, yaw_deg * kDegree);
  return JudgeType(
      TraceOf(normal_world, world_from_scanner), world_from_scanner, kSigma, kSignificance);
}

Eigen::Vector3d WallNormal(double heading_deg) {
  return {std::cos(heading_deg * kDegree), std::sin(heading_deg * kDegree), 0.0};
}

// The trace of the floor is horizontal; a wall along it would have the same trace.
TEST(JudgeTypeTest, FloorSeenByTiltedScannerCanBeHorizontal) {
  for (const double yaw_deg : {0.0, 45.0, 200.0}) {
    const TypeEvidence evidence = Judge(Eigen::Vector3d::UnitZ(), 45.0, yaw_deg);
    EXPECT_TRUE(evidence.can_be_horizontal);
    EXPECT_TRUE(evidence.can_be_vertical);
  }
}

TEST(JudgeTypeTest, WallAcrossTiltedScannerCanOnlyBeVertical) {
  // Normals at 90 and 45 degrees to the horizontal direction of the scan plane's tilt.
  for (const double heading_deg : {90.0, 45.0, -45.0, 135.0}) {
    const TypeEvidence evidence = Judge(WallNormal(heading_deg), 45.0, 0.0);
    EXPECT_FALSE(evidence.can_be_horizontal) << heading_deg;
    EXPECT_TRUE(evidence.can_be_vertical) << heading_deg;
  }
}

TEST(JudgeTypeTest, WallAlongTiltedScannerLeavesBoth) {
  for (const double heading_deg : {0.0, 180.0, 1.0}) {
    const TypeEvidence evidence = Judge(WallNormal(heading_deg), 45.0, 0.0);
    EXPECT_TRUE(evidence.can_be_horizontal) << heading_deg;
    EXPECT_TRUE(evidence.can_be_vertical) << heading_deg;
  }
}

TEST(JudgeTypeTest, LevelScannerSeesWallsOnly) {
  for (const double heading_deg : {0.0, 30.0, 90.0}) {
    for (const double pitch_deg : {0.0, 10.0}) {
      const TypeEvidence evidence = Judge(WallNormal(heading_deg), pitch_deg, 0.0);
      EXPECT_FALSE(evidence.can_be_horizontal);
      EXPECT_TRUE(evidence.can_be_vertical);
      EXPECT_FALSE(evidence.Allows(HorizontalPlane{}));
      EXPECT_TRUE(evidence.Allows(VerticalPlane{}));
    }
  }
}

// A trace is no steeper than the plane that it lies on.
TEST(JudgeTypeTest, SteepTracesOfTiltedScannersLieOnNoRamp) {
  EXPECT_TRUE(Judge(WallNormal(90.0), 45.0, 0.0).is_wall);   // 45 degrees steep
  EXPECT_FALSE(Judge(WallNormal(20.0), 45.0, 0.0).is_wall);  // 19 degrees
  const double slope = 15.0 * kDegree;
  for (const double yaw_deg : {0.0, 60.0, 90.0, 150.0}) {
    const Eigen::Vector3d ramp(std::sin(slope), 0.0, std::cos(slope));
    EXPECT_FALSE(Judge(ramp, 45.0, yaw_deg).is_wall) << yaw_deg;
  }
}

TEST(JudgeTypeTest, UprightScannerDoesNotTellAWallsDirection) {
  const TypeEvidence evidence = Judge(WallNormal(90.0), 90.0, 0.0);
  EXPECT_FALSE(evidence.can_be_horizontal);
  EXPECT_FALSE(evidence.can_be_vertical);
}

// The paper's rig walks through a room and offers what its scanners see.
class TentativePlanesTest : public testing::Test {
 protected:
  void Walk(const PlaneScene& scene,
            const std::vector<int>& scanners,
            int num_scans,
            double speed_m_s,
            double heading) {
    for (int i = 0; i < num_scans; ++i) {
      const int64_t now_ns = kStart + scan_ * kPeriod;
      const Rigid3d pose(
          RotationFromRollPitchYaw(0.0, 0.0, heading),
          Eigen::Vector3d(speed_m_s * 1e-9 * static_cast<double>(now_ns - kStart), 0.1, 1.4));
      const Trajectory trajectory(now_ns, kPeriod, pose);
      for (const int scanner_index : scanners) {
        const Scanner& scanner = rig_.scanners[static_cast<size_t>(scanner_index)];
        const ScanLine line = TakeScanLine(
            scene,
            scanner,
            scanner_index,
            now_ns,
            [&](int64_t) { return pose; },
            noise_share_ * scanner.range_noise_m,
            &random_);
        for (const Segment& segment : SegmentScanLine(line, scanner, {}, {})) {
          Observation observation = MakeObservation(line, scanner, segment, false);
          observation.scan_index = scan_;
          observation.scan_line_index = 3 * scan_ + scanner_index;
          candidates_.Offer(observation,
                            num_offered_++,
                            ObservationPoses(trajectory, scanner, observation),
                            Matrix6d::Zero());
        }
      }
      ++scan_;
    }
  }

  static const ScenePlane* TruthOf(const PlaneScene& scene, const Landmark& landmark) {
    for (const ScenePlane& plane : scene) {
      if (plane.normal.dot(landmark.Normal()) > std::cos(5.0 * kDegree) &&
          std::abs(landmark.SignedDistance(plane.distance * plane.normal)) < 0.1) {
        return &plane;
      }
    }
    return nullptr;
  }

  // What the level scanner sees of a front of this width, ahead of a body at rest.
  Observation ObserveFront(const ScenePlane& front, double width_m, int scan) {
    const Scanner& scanner = rig_.scanners[0];
    const Rigid3d pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.4});
    const ScanLine line = TakeScanLine(
        {front},
        scanner,
        0,
        kStart + scan * kPeriod,
        [&](int64_t) { return pose; },
        0.0,
        &random_);
    int first = -1;
    int last = -1;
    for (int beam = 0; beam < line.num_beams(); ++beam) {
      const Eigen::Vector2d p =
          line.ranges[static_cast<size_t>(beam)] * line.BeamDirection(beam);
      const Eigen::Vector3d p_body =
          scanner.body_from_scanner * Eigen::Vector3d(p.x(), p.y(), 0.0);
      if (!p_body.allFinite() || std::abs(p_body.y()) > 0.5 * width_m) continue;
      if (first < 0) first = beam;
      last = beam;
    }
    Observation observation = ObservePlane(line, scanner, pose, front, first, last);
    observation.scan_index = scan;
    return observation;
  }

  Rig rig_ = MakePaperRig();
  MapperOptions options_;
  TentativePlanes candidates_{false, options_, 0.03};
  double noise_share_ = 1.0;  // of the scanners' range noise
  std::mt19937_64 random_{3};
  int scan_ = 0;
  int num_offered_ = 0;
};

TEST_F(TentativePlanesTest, BecomePlanesOfTheRoom) {
  const PlaneScene room = MakeRoom({{0.2, 2.5}, {1.9, 2.0}, {3.4, 2.8}, {4.8, 2.2}}, 0.0, 2.7);
  Walk(room, {0, 1, 2}, options_.planes.min_scans, 0.5, 0.3);
  std::vector<TentativePlane> ready = candidates_.TakeReady(options_.planes.min_scans, true);
  EXPECT_GE(ready.size(), 6u);
  std::set<const ScenePlane*> found;
  for (const TentativePlane& candidate : ready) {
    const ScenePlane* truth = TruthOf(room, candidate.landmark);
    ASSERT_NE(truth, nullptr) << candidate.landmark.Normal().transpose() << " "
                              << candidate.landmark.Distance();
    found.insert(truth);
    EXPECT_GE(static_cast<int>(candidate.scans.size()), options_.planes.min_scans);
    EXPECT_FALSE(candidate.landmark.extent.empty());
  }
  EXPECT_EQ(found.size(), 6u);
  EXPECT_TRUE(candidates_.TakeReady(options_.planes.min_scans, true).empty())
      << "taken is gone";
}

TEST_F(TentativePlanesTest, FewScansAreNotEnough) {
  const PlaneScene room = MakeRoom({{0.2, 2.5}, {1.9, 2.0}, {3.4, 2.8}, {4.8, 2.2}}, 0.0, 2.7);
  Walk(room, {0, 1, 2}, options_.planes.min_scans - 1, 0.5, 0.3);
  EXPECT_TRUE(candidates_.TakeReady(options_.planes.min_scans, true).empty());
  EXPECT_FALSE(candidates_.TakeReady(options_.planes.min_scans - 1, true).empty());
}

TEST_F(TentativePlanesTest, StaleOnesAreDropped) {
  const PlaneScene room = MakeRoom({{0.2, 2.5}, {1.9, 2.0}, {3.4, 2.8}, {4.8, 2.2}}, 0.0, 2.7);
  Walk(room, {0, 1, 2}, options_.planes.min_scans, 0.5, 0.3);
  const int64_t last_ns = kStart + scan_ * kPeriod;
  candidates_.DropStale(last_ns + NanosecondsFromSeconds(options_.planes.max_tentative_age_s));
  EXPECT_TRUE(candidates_.TakeReady(1, false).empty());
}

// One tilted scanner alone, standing still: a horizontal trace on a wall looks like a floor's.
TEST_F(TentativePlanesTest, StandingStillOneScannerDoesNotMakeAFloor) {
  // The left scanner's traces are horizontal on walls across its tilt, at heading 45 degrees.
  const PlaneScene wall = {{WallNormal(225.0), -2.0}};
  Walk(wall, {1}, 40, 0.0, 0.0);
  EXPECT_GT(num_offered_, 0);
  EXPECT_TRUE(candidates_.TakeReady(options_.planes.min_scans, true).empty());
}

// Motion tells: what fits a horizontal plane while the rig moves on is one.
TEST_F(TentativePlanesTest, MotionTellsFloorFromWall) {
  const PlaneScene floor = {{Eigen::Vector3d::UnitZ(), 0.0}};
  Walk(floor, {2}, 40, 0.5, 0.0);
  const auto ready = candidates_.TakeReady(options_.planes.min_scans, true);
  // Pieces far from each other may be candidates of their own.
  ASSERT_FALSE(ready.empty());
  for (const TentativePlane& candidate : ready) {
    EXPECT_EQ(candidate.landmark.model, PlaneModel::kHorizontal);
    EXPECT_NEAR(candidate.landmark.Distance(), 0.0, 0.02);
  }
}

// So do the rig's turns, where an IMU reads them.
TEST_F(TentativePlanesTest, ANodTellsFloorFromWallWhereTheTurnsAreKnown) {
  const auto models_of = [&](const PlaneScene& scene, bool knows_turns) {
    TentativePlanes planes(false, options_, 0.03, knows_turns);
    std::vector<PlaneModel> models;
    for (int scan = 0; scan < 12; ++scan) {
      const Rigid3d pose(
          Eigen::Quaterniond(Eigen::AngleAxisd(0.3 + 0.02 * scan, Eigen::Vector3d::UnitY())),
          {0.0, 0.0, 1.4});
      const Scanner& scanner = rig_.scanners[0];  // level at rest
      const ScanLine line = TakeScanLine(
          scene,
          scanner,
          0,
          kStart + scan * kPeriod,
          [&](int64_t) { return pose; },
          0.0,
          &random_);
      for (const Segment& segment : SegmentScanLine(line, scanner, {}, {})) {
        Observation observation = MakeObservation(line, scanner, segment, false);
        observation.scan_index = scan;
        planes.Offer(observation,
                     scan,
                     ObservationPoses(
                         observation.measurement.node_times_ns(), {pose, pose, pose}, scanner),
                     Matrix6d::Zero());
      }
    }
    for (const TentativePlane& plane : planes.TakeReady(options_.planes.min_scans, false)) {
      models.push_back(plane.landmark.model);
    }
    return models;
  };
  const PlaneScene floor = {{Eigen::Vector3d::UnitZ(), 0.0}};
  EXPECT_TRUE(models_of(floor, false).empty());
  EXPECT_EQ(models_of(floor, true), std::vector<PlaneModel>{PlaneModel::kHorizontal});
  const std::vector<PlaneModel> of_wall = models_of({{WallNormal(180.0), -2.0}}, true);
  EXPECT_EQ(std::count(of_wall.begin(), of_wall.end(), PlaneModel::kHorizontal), 0);
}

// A sloping trace of a tilted scan plane may lie on a wall as well as on a ramp. One scanner
// tells which while the rig moves on, and not before.
TEST_F(TentativePlanesTest, SlopingTracesOfOneScannerDecideNothingAtRest) {
  const PlaneScene wall = {{WallNormal(190.0), -2.0}};
  Walk(wall, {1}, 40, 0.0, 0.0);
  EXPECT_TRUE(candidates_.TakeReady(options_.planes.min_scans, false).empty());
  Walk(wall, {1}, 30, 1.0, 0.0);
  const std::vector<TentativePlane> ready =
      candidates_.TakeReady(options_.planes.min_scans, false);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready.front().landmark.model, PlaneModel::kVertical);
  EXPECT_GT(ready.front().landmark.Normal().dot(WallNormal(190.0)), std::cos(2.0 * kDegree));
}

// On a ramp, the traces of the floor slope like a wall's.
TEST_F(TentativePlanesTest, ARampIsAGeneralPlane) {
  const Eigen::Vector3d normal(-std::sin(8.0 * kDegree), 0.0, std::cos(8.0 * kDegree));
  for (const bool by_two : {true, false}) {
    Walk({{normal, 0.0}}, by_two ? std::vector<int>{1, 2} : std::vector<int>{1}, 50, 1.0, 0.0);
    const std::vector<TentativePlane> ready =
        candidates_.TakeReady(options_.planes.min_scans, false);
    // Pieces far from each other may be candidates of their own.
    ASSERT_FALSE(ready.empty()) << by_two;
    for (const TentativePlane& plane : ready) {
      const Landmark& ramp = plane.landmark;
      EXPECT_EQ(ramp.model, PlaneModel::kGeneral);
      EXPECT_NEAR(ramp.Normal().dot(normal), 1.0, 1e-3);
      // Within four standard deviations where it was seen.
      const Eigen::Vector3d middle = ramp.extent.Centre();
      const LandmarkView view(ramp);
      EXPECT_LT(std::abs(normal.dot(middle - ramp.SignedDistance(middle) * ramp.Normal())),
                4.0 * std::sqrt(view.DistanceVariance(middle)));
    }
  }
}

// A level trace on a roof looks like a wall's: it makes none once others show the roof.
TEST_F(TentativePlanesTest, ALevelTraceOnARoofMakesNoWall) {
  const Eigen::Vector3d normal(-std::cos(35.0 * kDegree), 0.0, -std::sin(35.0 * kDegree));
  const PlaneScene roof = {{normal, normal.dot(Eigen::Vector3d(3.0, 0.0, 1.4))}};
  Walk(roof, {0, 1, 2}, 20, 1.0, 0.0);
  const std::vector<TentativePlane> ready =
      candidates_.TakeReady(options_.planes.min_scans, false);
  ASSERT_EQ(ready.size(), 1u);
  EXPECT_EQ(ready.front().landmark.model, PlaneModel::kGeneral);
  EXPECT_EQ(ready.front().scanners.size(), 3u);
}

TEST_F(TentativePlanesTest, MovingTowardsAWallMakesNoFloor) {
  const PlaneScene wall = {{WallNormal(225.0), -3.0}};
  Walk(wall, {1}, 40, 0.8, 0.0);
  for (const TentativePlane& candidate :
       candidates_.TakeReady(options_.planes.min_scans, true)) {
    EXPECT_NE(candidate.landmark.model, PlaneModel::kHorizontal)
        << candidate.landmark.Distance();
  }
}

// Somebody is as high as a piece of wall, and makes no plane until it stands still for longer.
TEST_F(TentativePlanesTest, HighAndNarrowIsSmall) {
  constexpr double kWidth = 0.6;  // m
  const Rigid3d pose(Eigen::Quaterniond::Identity(), {0.0, 0.0, 1.4});
  const Trajectory trajectory(kStart, 200 * kPeriod, pose);
  const ScenePlane front = {WallNormal(180.0), -2.0};
  const auto is_ready_after = [&](double width_m, double duration_s, bool needs_age = true) {
    TentativePlanes planes(false, options_, 0.03);
    const int num_scans = static_cast<int>(duration_s / 0.025) + 1;
    for (int scan = 0; scan < num_scans; ++scan) {
      Observation observation = ObserveFront(front, width_m, scan);
      planes.Offer(observation,
                   scan,
                   ObservationPoses(trajectory, rig_.scanners[0], observation),
                   Matrix6d::Zero());
    }
    return !planes.TakeReady(options_.planes.min_scans, needs_age).empty();
  };
  const double age_s = options_.planes.min_age_of_small_s;
  const double few_scans_s = 0.025 * options_.planes.min_scans;
  EXPECT_TRUE(is_ready_after(1.5, few_scans_s + 0.1));
  EXPECT_FALSE(is_ready_after(kWidth, age_s - 0.1));
  EXPECT_TRUE(is_ready_after(kWidth, age_s - 0.1, false)) << "where nothing moves";
  EXPECT_TRUE(is_ready_after(kWidth, age_s + 0.1));
}

}  // namespace
}  // namespace plumbline

#include "core/association/association.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/geometry/matrix_types.h"
#include "core/surface/landmark_view.h"
#include "core/surface/patch_extent.h"
#include "core/util/quantiles.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'000;

TEST(GapRuleTest, HoldsOnlyWithoutLoopClosure) {
  Landmark landmark;
  landmark.first_scan = 50;
  landmark.last_scan = 60;
  LoopClosureOptions options;
  options.max_gap_scans = 100;
  options.enabled = false;
  EXPECT_TRUE(IsWithinGap(landmark, 160, options));
  EXPECT_FALSE(IsWithinGap(landmark, 161, options));
  options.enabled = true;
  EXPECT_TRUE(IsWithinGap(landmark, 100'000, options));
}

// On the way, what was seen a lap ago counts only if its segments lay on one plane.
TEST(GapRuleTest, ContradictedPlanesAreNotTakenUpAgain) {
  LoopClosureOptions options;
  options.max_gap_scans = 100;
  Landmark landmark;
  landmark.last_scan = 60;
  EXPECT_TRUE(MayBeTakenUp(landmark, 160, options));  // still in sight, or nearly
  landmark.num_judged = 50;
  landmark.sum_deviations = 1.5 * landmark.num_judged;
  EXPECT_TRUE(MayBeTakenUp(landmark, 161, options));
  landmark.sum_deviations = 4.5 * landmark.num_judged;
  EXPECT_FALSE(MayBeTakenUp(landmark, 161, options));
  EXPECT_TRUE(MayBeTakenUp(landmark, 160, options));
  landmark.sum_deviations = 0.0;
  options.enabled = false;
  EXPECT_FALSE(MayBeTakenUp(landmark, 161, options));
}

TEST(FlatnessTest, ShortSegmentsSayLittleOfTheDirection) {
  const Eigen::Matrix2d longer = FlatnessCovariance(2.0, 0.004);
  EXPECT_NEAR(std::sqrt(longer(0, 0)), 0.004, 1e-12);
  EXPECT_NEAR(std::sqrt(longer(1, 1)), 0.004, 1e-12);  // rad
  EXPECT_NEAR(FlatnessCovariance(1.0, 0.004)(1, 1), 4.0 * longer(1, 1), 1e-12);
  EXPECT_TRUE(FlatnessCovariance(0.0, 0.004).allFinite());
  EXPECT_TRUE(FlatnessCovariance(1.0, 0.0).isZero());
}

TEST(QuantileTest, IsThatOfChiSquareOfTwoDegrees) {
  // P(chi^2 > x) = exp(-x / 2)
  EXPECT_NEAR(std::exp(-0.5 * TwoDegreesQuantile(1e-4)), 1e-4, 1e-15);
}

// A level scanner 2 m in front of the wall y = 2, which it sees from x = -1 to 1.
class AssociationTest : public testing::Test {
 protected:
  AssociationTest() {
    scanner_.body_from_scanner.rotation = RotationFromRollPitchYaw(0.0, 0.0, M_PI / 2.0);
    scanner_.beams = 91;
    scanner_.field_of_view_deg = 53.0;
    scanner_.range_noise_m = 0.01;
    std::mt19937_64 random(1);
    const ScanLine line = TakeScanLine(
        {wall_}, scanner_, 0, kStart, [](int64_t) { return Rigid3d(); }, 0.0, &random);
    observation_ = ObservePlane(line, scanner_, Rigid3d(), wall_, 0, 90);
    options_.surface_flatness_m = 0.0;
  }

  // A wall seen before, moved against the true one.
  int AddWall(double shift, double turn, double first_x, double last_x) {
    Landmark landmark = MakeVerticalLandmark(wall_.normal, {0.0, 2.0 + shift, 0.0});
    landmark.id = static_cast<int>(landmarks_.size());
    landmark.parameters[0] += turn;
    landmark.parameters[1] = landmark.Normal().dot(Eigen::Vector3d(0.0, 2.0 + shift, 0.0));
    landmark.extent.AddSegment({first_x, 2.0, 0.0}, {last_x, 2.0, 0.0});
    landmarks_.push_back(landmark);
    return landmark.id;
  }

  int Find(const Matrix6d& pose_covariance = Matrix6d::Zero()) const {
    std::vector<LandmarkView> candidates;
    for (const Landmark& landmark : landmarks_) {
      candidates.emplace_back(landmark);
    }
    return FindLandmark(observation_,
                        ObservationPoses(trajectory_, scanner_, observation_),
                        pose_covariance,
                        candidates,
                        options_);
  }

  // Standard deviations of offset and direction of the observed line.
  double SigmaOffset() const { return 0.01 / std::sqrt(91.0); }

  ScenePlane wall_ = {-Eigen::Vector3d::UnitY(), -2.0};
  Scanner scanner_;
  Trajectory trajectory_{kStart, 1'000'000'000, Rigid3d()};
  Observation observation_;
  std::deque<Landmark> landmarks_;
  AssociationOptions options_;
};

// The scan sees as far as 2.24 m, with margins of 1.5 m for the gap and 1 m for motion.
TEST_F(AssociationTest, CandidatesOfAScanAreThoseInItsReach) {
  options_.max_gap_m = 1.0;
  const int ahead = AddWall(0.0, 0.0, -1.0, 1.0);
  const int beside = AddWall(0.0, 0.0, 3.0, 4.0);
  AddWall(0.0, 0.0, 5.0, 9.0);
  AddWall(10.0, 0.0, -1.0, 1.0);
  landmarks_[3].extent = PatchExtent(
      {0.0, 12.0, 0.0}, landmarks_[3].extent.axes().u, landmarks_[3].extent.axes().v);
  landmarks_[3].extent.AddSegment({-1.0, 12.0, 0.0}, {1.0, 12.0, 0.0});
  for (Landmark& landmark : landmarks_) landmark.num_segments = 1;
  const std::vector<LandmarkView> all = ViewsWithinGap(landmarks_, 0, {});
  ASSERT_EQ(all.size(), 4u);
  Rig rig;
  rig.scanners.push_back(scanner_);
  Observation of_next_scan = observation_;
  of_next_scan.scan_index = observation_.scan_index + 1;
  of_next_scan.last_point = {50.0F, 0.0F};
  const std::deque<Observation> observations = {observation_, of_next_scan};
  Matrix6d pose_covariance = Matrix6d::Zero();
  const auto ids_of = [](const std::vector<LandmarkView>& candidates) {
    std::vector<int> ids;
    for (const LandmarkView& candidate : candidates) ids.push_back(candidate.landmark->id);
    return ids;
  };
  const auto found = [&](size_t first) {
    const Reach reach = ReachOfScan(
        rig, observations, first, Eigen::Vector3d::Zero(), pose_covariance, options_);
    const std::vector<int> ids = ids_of(ViewsWithin(reach, all));
    const LoopClosureOptions closure;
    EXPECT_EQ(ids_of(ViewsWithin(reach, LandmarksWithinGap{landmarks_, 0, closure})), ids);
    return ids;
  };
  EXPECT_EQ(found(0), (std::vector<int>{ahead, beside}));
  EXPECT_EQ(found(1), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(found(2), std::vector<int>{ahead}) << "without observations the margins alone";
  pose_covariance(3, 3) = 1.0;  // may be 12 m off
  EXPECT_EQ(found(0), (std::vector<int>{0, 1, 2, 3}));
}

// The scan plane tilts about its x axis: its beams sweep past much that it does not hold in
// the middle of the scan line.
TEST(ScanSlab, TouchesWhatBeamsPassWithinItsMargin) {
  constexpr double kFarthest = 10.0;
  constexpr double kMargin = 1.0;
  const auto pose_at = [](double seconds) -> Rigid3d {
    return {RotationFromRollPitchYaw(0.3 + 5.0 * seconds, 0.0, 0.0),
            Eigen::Vector3d(1.0, 2.0, 0.8 * seconds)};
  };
  const ScanSlab slab(ScanMotion({kStart, kStart + 10'000'000, kStart + 20'000'000},
                                 {pose_at(0.0), pose_at(0.01), pose_at(0.02)}),
                      kFarthest,
                      kMargin);
  // A piece of wall, half a metre long, around a place.
  const auto touches = [&](const Eigen::Vector3d& p_world) {
    Landmark wall = MakeVerticalLandmark({0.0, -1.0, 0.0}, p_world);
    wall.extent.AddSegment(p_world - 0.25 * Eigen::Vector3d::UnitX(),
                           p_world + 0.25 * Eigen::Vector3d::UnitX());
    return slab.Touches(LandmarkView(wall));
  };
  for (const double seconds : {0.0, 0.005, 0.01, 0.017, 0.02}) {
    const Rigid3d pose = pose_at(seconds);
    const Eigen::Vector3d normal = pose.rotation * Eigen::Vector3d::UnitZ();
    for (double angle = 0.0; angle < 2.0 * M_PI; angle += 0.1) {
      for (const double range : {0.0, 4.0, kFarthest}) {
        const Eigen::Vector3d p =
            pose * Eigen::Vector3d(range * std::cos(angle), range * std::sin(angle), 0.0);
        for (const double beside : {-kMargin, 0.0, kMargin}) {
          EXPECT_TRUE(touches(p + 0.999 * beside * normal)) << seconds << " " << angle;
        }
      }
    }
  }
  // Along the axis little moves.
  const Rigid3d middle = pose_at(0.01);
  for (const double beside : {-2.0, 2.0}) {
    EXPECT_FALSE(touches(middle * Eigen::Vector3d(8.0, 0.0, beside)));
  }
}

TEST_F(AssociationTest, FindsTheWall) {
  EXPECT_EQ(Find(), -1);
  const int id = AddWall(0.0, 0.0, -1.0, 1.0);
  EXPECT_EQ(Find(), id);
}

// chi^2 of two degrees: 18.4 at 1e-4, so 4.29 standard deviations of the offset alone.
TEST_F(AssociationTest, GateIsThatOfTheSignificance) {
  const int id = AddWall(4.1 * SigmaOffset(), 0.0, -1.0, 1.0);
  EXPECT_EQ(Find(), id);
  landmarks_.clear();
  AddWall(4.5 * SigmaOffset(), 0.0, -1.0, 1.0);
  EXPECT_EQ(Find(), -1);
  options_.significance = 1e-6;
  EXPECT_EQ(Find(), 0);
}

TEST_F(AssociationTest, DirectionCountsToo) {
  const Landmark wall = MakeVerticalLandmark(wall_.normal, {0.0, 2.0, 0.0});
  const LineDeviation deviation = DeviationFromPlane(
      observation_, ObservationPoses(trajectory_, scanner_, observation_), LandmarkView(wall));
  const double sigma_direction = std::sqrt(deviation.covariance(1, 1));
  EXPECT_NEAR(sigma_direction, SigmaOffset() * std::sqrt(12.0) / 2.0, 0.2 * sigma_direction);
  AddWall(0.0, 4.1 * sigma_direction, -1.0, 1.0);
  EXPECT_EQ(Find(), 0);
  landmarks_.clear();
  AddWall(0.0, 4.5 * sigma_direction, -1.0, 1.0);
  EXPECT_EQ(Find(), -1);
}

TEST_F(AssociationTest, EveryUncertaintyWidensTheGate) {
  AddWall(10.0 * SigmaOffset(), 0.0, -1.0, 1.0);
  EXPECT_EQ(Find(), -1);
  Matrix6d pose_covariance = Matrix6d::Zero();
  pose_covariance(4, 4) = std::pow(5.0 * SigmaOffset(), 2);
  EXPECT_EQ(Find(pose_covariance), 0);
  Matrix6d along_the_wall = Matrix6d::Zero();
  along_the_wall(3, 3) = 1.0;
  EXPECT_EQ(Find(along_the_wall), -1);
  options_.surface_flatness_m = 5.0 * SigmaOffset();
  EXPECT_EQ(Find(), 0);
  options_.surface_flatness_m = 0.0;
  landmarks_[0].covariance(1, 1) = std::pow(5.0 * SigmaOffset(), 2);
  EXPECT_EQ(Find(), 0);
}

TEST_F(AssociationTest, WallIsSeenFromItsFrontOnly) {
  Landmark back = MakeVerticalLandmark(-wall_.normal, {0.0, 2.0, 0.0});
  back.extent.AddSegment({-1.0, 2.0, 0.0}, {1.0, 2.0, 0.0});
  landmarks_.push_back(back);
  EXPECT_EQ(Find(), -1);
}

// An upright scan plane in a doorway: what it sees of other surfaces lies in the wall's plane.
TEST_F(AssociationTest, AScanPlaneAlongTheWallCanNotHitIt) {
  AddWall(0.0, 0.0, -1.0, 4.0);
  const ScenePlane other = {-Eigen::Vector3d::UnitX(), -3.0};
  std::mt19937_64 random(1);
  scanner_.body_from_scanner = {RotationFromRollPitchYaw(M_PI / 2.0, 0.0, 0.0),
                                {0.0, 1.998, 0.0}};
  const ScanLine line = TakeScanLine(
      {other}, scanner_, 0, kStart, [](int64_t) { return Rigid3d(); }, 0.0, &random);
  observation_ = ObservePlane(line, scanner_, Rigid3d(), other, 0, 90);
  EXPECT_EQ(Find(), -1);
}

TEST_F(AssociationTest, WallEndsWhereItWasSeen) {
  options_.max_gap_m = 1.0;
  AddWall(0.0, 0.0, 3.0, 6.0);
  EXPECT_EQ(Find(), -1);
  options_.max_gap_m = 3.0;
  EXPECT_EQ(Find(), 0);
  options_.max_gap_m = 1.0;
  AddWall(0.0, 0.0, 1.5, 6.0);
  EXPECT_EQ(Find(), 1);
}

// At 1.25 rad/s a wall is seen up to 13 m away, by beams 4 ms on average from the middle of
// the scan line: at the pose then, its points would lie 4 cm off.
TEST_F(AssociationTest, FindsTheWallInATurn) {
  trajectory_ = Trajectory(kStart, 50'000'000, Rigid3d());
  for (int i = 0; i < 4; ++i) {
    Eigen::Map<Eigen::Quaterniond>(trajectory_.control_point(i).rotation.data()) =
        RotationFromRollPitchYaw(0.0, 0.0, 1.25 * 0.05 * i);
  }
  scanner_.body_from_scanner.rotation.setIdentity();
  scanner_.beams = 270;
  scanner_.field_of_view_deg = 270.0;
  scanner_.scan_rate_hz = 40.0;
  std::mt19937_64 random(1);
  const auto pose_at = [&](int64_t time_ns) { return trajectory_.WorldFromBody(time_ns); };
  const ScanLine line = TakeScanLine({wall_}, scanner_, 0, kStart, pose_at, 0.0, &random);
  constexpr int kFirstBeam = 139;
  constexpr int kLastBeam = 224;
  EXPECT_NEAR(line.ranges[kFirstBeam], 13.0, 1.5);
  observation_ =
      ObservePlane(line, scanner_, pose_at(line.BeamTime(135)), wall_, kFirstBeam, kLastBeam);
  const int id = AddWall(0.0, 0.0, -5.0, 30.0);
  EXPECT_EQ(Find(), id);
}

TEST_F(AssociationTest, TakesTheMostProbable) {
  AddWall(3.0 * SigmaOffset(), 0.0, -1.0, 1.0);
  AddWall(1.0 * SigmaOffset(), 0.0, -1.0, 1.0);
  AddWall(-2.0 * SigmaOffset(), 0.0, -1.0, 1.0);
  EXPECT_EQ(Find(), 1);
}

// A scanner that nods looks along a ceiling, which it cuts in a line before it.
class GrazedCeilingTest : public AssociationTest {
 protected:
  // How the ceiling is seen by a scan plane pitched by so much.
  void Look(double pitch_deg) {
    const double pitch = pitch_deg * M_PI / 180.0;
    Rigid3d world_from_body;
    world_from_body.rotation =
        Eigen::Quaterniond(Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()));
    trajectory_ = Trajectory(kStart, 1'000'000'000, world_from_body);
    const ScenePlane ceiling = {-Eigen::Vector3d::UnitZ(), -1.0};
    std::mt19937_64 random(1);
    const ScanLine line = TakeScanLine(
        {ceiling},
        scanner_,
        0,
        kStart,
        [&](int64_t) { return world_from_body; },
        0.0,
        &random);
    observation_ = ObservePlane(line, scanner_, world_from_body, ceiling, 0, 90);
    Landmark landmark = MakeHorizontalLandmark(-1.0, {0.0, 0.0, 1.0});
    landmark.id = 0;
    landmark.num_segments = 1;
    for (double y = 1.0; y < 12.0; y += 0.5) {
      landmark.extent.AddSegment({-3.0, y, 1.0}, {3.0, y, 1.0});
    }
    landmarks_ = {landmark};
  }

  bool IsGrazed() const {
    return Grazes(
        observation_, ObservationPoses(trajectory_, scanner_, observation_), landmarks_, 0.15);
  }
};

TEST_F(GrazedCeilingTest, HoldsNoPoseAndFoundsNoWall) {
  Look(8.0);
  EXPECT_EQ(Find(), -1);
  EXPECT_TRUE(IsGrazed());
  landmarks_.front().parameters[0] += 0.2;  // another one lies there
  EXPECT_FALSE(IsGrazed());
}

TEST_F(GrazedCeilingTest, IsACeilingToATiltedScanner) {
  Look(30.0);
  EXPECT_EQ(Find(), 0);
  EXPECT_FALSE(IsGrazed());
}

}  // namespace
}  // namespace plumbline

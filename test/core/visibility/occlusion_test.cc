#include "core/visibility/occlusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/surface/landmark_view.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr double kDegree = M_PI / 180.0;
constexpr double kHeight = 1.5;

// A scanner at rest, 1.5 m above the floor, turns in the plane x = 0: beam i meets the floor
// at y = 1.5 m tan(i degrees), and the wall y = 4 m beyond that.
class OcclusionTest : public ::testing::Test {
 protected:
  OcclusionTest() : trajectory_(kStart, 125'000'000, Rigid3d()) {
    trajectory_.ExtendTo(kStart + 100'000'000);
    Eigen::Matrix3d rotation;
    rotation.col(0) = -Eigen::Vector3d::UnitZ();
    rotation.col(1) = Eigen::Vector3d::UnitY();
    rotation.col(2) = Eigen::Vector3d::UnitX();
    scanner_.body_from_scanner = {Eigen::Quaterniond(rotation), {0.0, 0.0, kHeight}};
    line_.stamp_ns = kStart;
    line_.angle_increment = kDegree;
    line_.time_increment_s = 1e-5;
    line_.ranges.assign(100, 1.0f);
    sampler_.emplace(trajectory_);
    poses_.emplace(NodesOfSpan(kStart, line_.BeamTime(99)), scanner_, &*sampler_);
  }

  static LandmarkView Candidate(const Landmark& landmark) { return LandmarkView(landmark); }
  // A wall through the point, seen 0.5 m to both sides of it.
  static Landmark Wall(const Eigen::Vector3d& normal, const Eigen::Vector3d& p) {
    Landmark wall = MakeVerticalLandmark(normal.normalized(), p);
    const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(normal).normalized();
    wall.extent.AddSegment(p - 0.5 * along, p + 0.5 * along);
    const Eigen::Vector3d up = p + Eigen::Vector3d::UnitZ();
    wall.extent.AddSegment(up - 0.5 * along, up + 0.5 * along);
    return wall;
  }
  Occlusion Beams(const LandmarkView& plane, int first, int last) const {
    return {line_, scanner_, *poses_, plane, first, last};
  }

  Trajectory trajectory_;
  Scanner scanner_;
  ScanLine line_;
  std::optional<PoseSampler> sampler_;
  std::optional<ObservationPoses> poses_;
};

// The corner's edge stands at (0.1, 2.0): behind both faces the segment runs from y = 1.9 to
// 2.1 m, beams 51.7 to 54.5.
TEST_F(OcclusionTest, FloorBehindACornerIsHidden) {
  const Landmark floor = MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0});
  const Landmark near = Wall({1.0, -1.0, 0.0}, {0.0, 1.9, 0.0});
  const Landmark far = Wall({1.0, 1.0, 0.0}, {0.0, 2.1, 0.0});
  const LandmarkView plane = Candidate(floor);
  const std::vector<LandmarkView> walls = {Candidate(near), Candidate(far)};
  EXPECT_EQ(Beams(plane, 20, 65).BehindCorners(walls), std::vector<int>({51, 52, 53, 54, 55}));
  EXPECT_EQ(Beams(plane, 53, 54).BehindCorners(walls), std::vector<int>()) << "within it";
  EXPECT_TRUE(Beams(plane, 20, 65).BehindCorners({Candidate(near)}).empty());
}

TEST_F(OcclusionTest, FloorInFrontOfARecessIsNot) {
  const Landmark floor = MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0});
  const Landmark near = Wall({1.0, -1.0, 0.0}, {0.0, 2.1, 0.0});
  const Landmark far = Wall({1.0, 1.0, 0.0}, {0.0, 1.9, 0.0});
  EXPECT_TRUE(Beams(Candidate(floor), 20, 65)
                  .BehindCorners({Candidate(near), Candidate(far)})
                  .empty());
}

// From one room through its door into the next, which has a door of its own farther on.
TEST_F(OcclusionTest, FloorBetweenDistantWallsIsNotHidden) {
  const Landmark floor = MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0});
  const Landmark near = Wall({1.0, -1.0, 0.0}, {0.0, 0.6, 0.0});
  const Landmark far = Wall({1.0, 1.0, 0.0}, {0.0, 3.0, 0.0});
  EXPECT_TRUE(Beams(Candidate(floor), 20, 65)
                  .BehindCorners({Candidate(near), Candidate(far)})
                  .empty());
}

// Down to 0.25 m behind the wall, y = 1.9 to 2.25 m, or 2.1 to 1.75 m.
TEST_F(OcclusionTest, FloorCloseBehindAWallIsHidden) {
  const Landmark floor = MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0});
  const Landmark near = Wall({1.0, -1.0, 0.0}, {0.0, 1.9, 0.0});
  const Landmark far = Wall({1.0, 1.0, 0.0}, {0.0, 2.1, 0.0});
  const LandmarkView plane = Candidate(floor);
  EXPECT_EQ(Beams(plane, 20, 65).BehindWalls({Candidate(near)}),
            std::vector<int>({52, 53, 54, 55, 56}));
  EXPECT_EQ(Beams(plane, 20, 65).BehindWalls({Candidate(far)}),
            std::vector<int>({54, 53, 52, 51, 50}));
  EXPECT_TRUE(Beams(plane, 20, 45).BehindWalls({Candidate(near)}).empty()) << "in front";
  EXPECT_TRUE(Beams(Candidate(far), 20, 65).BehindWalls({Candidate(near)}).empty())
      << "a wall";
}

// As through a door, or past the wall's end.
TEST_F(OcclusionTest, FloorBesideWhatIsSeenOfAWallIsNotHidden) {
  const Landmark floor = MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0});
  const Eigen::Vector3d along = Eigen::Vector3d(1.0, 1.0, 0.0).normalized();
  const Landmark aside = Wall({1.0, -1.0, 0.0}, Eigen::Vector3d(0.0, 1.9, 0.0) + 1.3 * along);
  EXPECT_TRUE(Beams(Candidate(floor), 20, 65).BehindWalls({Candidate(aside)}).empty());
}

TEST_F(OcclusionTest, BeamsInAKnownOpeningAreFound) {
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {0.0, 4.0, 1.0});
  const LandmarkView plane = Candidate(wall);
  OccupancyGrids openings;
  EXPECT_TRUE(Beams(plane, 72, 88).InOpenings(openings.OpeningsOf(wall)).empty());
  const Eigen::Vector3d in_opening(0.0, 4.0, kHeight - 4.0 / std::tan(80.0 * kDegree));
  for (int i = 0; i < 2; ++i) openings.CountPassage(wall, in_opening);
  openings.CountHit(wall, {0.0, 4.0, kHeight - 4.0 / std::tan(86.0 * kDegree)});
  const std::vector<int> beams = Beams(plane, 72, 88).InOpenings(openings.OpeningsOf(wall));
  EXPECT_NE(std::find(beams.begin(), beams.end(), 80), beams.end());
  EXPECT_EQ(std::find(beams.begin(), beams.end(), 74), beams.end());
  EXPECT_EQ(std::find(beams.begin(), beams.end(), 86), beams.end());
}

// Where along the wall a beam at 1 or 2 degrees lies, 1.36 m below the origin or 0.07 m above
// it, is for the pose to say, to decimetres.
TEST_F(OcclusionTest, GrazingBeamsNearAnOpeningMayLieInIt) {
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {0.0, 0.05, 0.0});
  const auto hidden_with_opening_at = [&](double height) {
    OccupancyGrids openings;
    for (int i = 0; i < 2; ++i) openings.CountPassage(wall, {0.0, 0.05, height});
    return Beams(Candidate(wall), 1, 10).InOpenings(openings.OpeningsOf(wall));
  };
  EXPECT_EQ(hidden_with_opening_at(-0.8), std::vector<int>{1});
  EXPECT_EQ(hidden_with_opening_at(0.1), std::vector<int>{2});
  const OccupancyGrids none;
  EXPECT_TRUE(Beams(Candidate(wall), 1, 10).InOpenings(none.OpeningsOf(wall)).empty());
}

TEST_F(OcclusionTest, BeamsAlmostAlongAPlaneWithOpeningsMayLieInAny) {
  line_.angle_increment = 0.1 * kDegree;
  const Landmark wall = Wall({0.0, -1.0, 0.0}, {0.0, 0.05, 0.0});
  OccupancyGrids openings;
  for (int i = 0; i < 2; ++i) openings.CountPassage(wall, {0.0, 0.05, 0.1});
  EXPECT_EQ(Beams(Candidate(wall), 2, 3).InOpenings(openings.OpeningsOf(wall)),
            std::vector<int>{2});
}

// Every beam for itself, with the rig in motion: 2 m/s along the wall and up, 3 rad/s about
// it.
TEST_F(OcclusionTest, OpeningsAreFoundOnTheMove) {
  for (int i = 0; i < trajectory_.num_control_points(); ++i) {
    const double time_s = 0.125 * i;
    const double half_turn = 0.5 * 3.0 * time_s;
    ControlPoint& point = trajectory_.control_point(i);
    point.position = {2.0 * time_s, 0.0, 2.0 * time_s};
    point.rotation = {0.0, std::sin(half_turn), 0.0, std::cos(half_turn)};
  }
  line_.angle_increment = 0.1 * kDegree;
  line_.ranges.assign(900, 1.0f);
  line_.time_increment_s = 2e-5;
  sampler_.emplace(trajectory_);
  poses_.emplace(NodesOfSpan(kStart, line_.BeamTime(899)), scanner_, &*sampler_);
  Landmark wall = MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.0, 4.0, 0.0});
  wall.extent.AddSegment({-5.0, 4.0, -5.0}, {5.0, 4.0, 5.0});
  const LandmarkView plane = Candidate(wall);
  // Where the beam from the scanner's pose at that very instant meets the wall.
  const auto meeting_point = [&](int beam) {
    const Rigid3d world_from_scanner =
        trajectory_.WorldFromBody(line_.BeamTime(beam)) * scanner_.body_from_scanner;
    const Eigen::Vector2d direction = line_.BeamDirection(beam);
    const Eigen::Vector3d direction_world =
        world_from_scanner.rotation * Eigen::Vector3d(direction.x(), direction.y(), 0.0);
    const Eigen::Vector3d& origin = world_from_scanner.translation;
    return Eigen::Vector3d(origin +
                           (4.0 - origin.y()) / direction_world.y() * direction_world);
  };
  OccupancyGrids counted;
  for (const int beam : {320, 500, 503, 700, 850}) {
    for (int i = 0; i < 2; ++i) counted.CountPassage(wall, meeting_point(beam));
  }
  const PlaneOpenings openings = counted.OpeningsOf(wall);
  std::vector<int> expected;
  for (int beam = 300; beam < 900; ++beam) {
    if (openings.IsAt(meeting_point(beam))) expected.push_back(beam);
  }
  EXPECT_GT(expected.size(), 30u);
  EXPECT_LT(expected.size(), 200u);
  EXPECT_EQ(Beams(plane, 300, 899).InOpenings(openings), expected);
}

// A door of 0.9 m in a wall 1 m away: of beams a quarter of a degree apart, eight cover 4 cm
// of it.
TEST_F(OcclusionTest, AnOpeningIsKnownFromEdgeToEdge) {
  constexpr double kLow = 1.3, kHigh = 2.2;
  line_.angle_increment = 0.25 * kDegree;
  line_.ranges.assign(600, 0.0f);
  const auto height_of = [&](int beam) {
    return kHeight - 1.0 / std::tan(line_.BeamAngle(beam));
  };
  int last_below = 0;
  for (int beam = 100; beam < 600; ++beam) {
    const double height = height_of(beam);
    const bool passes = height > kLow && height < kHigh;
    line_.ranges[static_cast<size_t>(beam)] =
        static_cast<float>((passes ? 3.0 : 1.0) / std::sin(line_.BeamAngle(beam)));
    if (height < kLow) last_below = beam;
  }
  Landmark wall = MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.0, 1.0, 0.0});
  wall.extent.AddSegment({-0.5, 1.0, 0.0}, {0.5, 1.0, 2.8});
  const ScanPlacement placement = PlacementOf(poses_->world_from_scanner);
  const Trace trace(placement, Candidate(wall));
  OccupancyGrids counted;
  const SegmentEnd end{line_, scanner_, placement, trace, wall, last_below, 1, 200};
  for (int i = 0; i < 2; ++i) {
    CountPassages(end, &counted);
    CountHitsAtEnd(end, &counted);
  }
  const PlaneOpenings openings = counted.OpeningsOf(wall);
  for (double height = kLow + 0.03; height < kHigh; height += 0.01) {
    EXPECT_TRUE(openings.IsAt({0.0, 1.0, height})) << height;
  }
  EXPECT_FALSE(openings.IsAt({0.0, 1.0, kLow - 0.6}));
  EXPECT_FALSE(openings.IsAt({0.0, 1.0, kHigh + 0.55}));
}

// Two beams that seem to go through a wall that hundreds lie on make no opening, wherever on
// it.
TEST_F(OcclusionTest, BeamsOnAPlaneSpeakAgainstAnOpening) {
  line_.angle_increment = 0.25 * kDegree;
  line_.ranges.assign(600, 0.0f);
  for (int beam = 200; beam < 520; ++beam) {
    line_.ranges[static_cast<size_t>(beam)] =
        static_cast<float>(1.0 / std::sin(line_.BeamAngle(beam)));
  }
  Landmark wall = MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.01, 1.0, 0.0});
  wall.extent.AddSegment({-0.5, 1.0, 0.0}, {0.5, 1.0, 2.8});
  OccupancyGrids counted;
  for (double height = 0.9; height < 2.15; height += 0.1) {
    for (int i = 0; i < 2; ++i) counted.CountPassage(wall, {0.0, 1.0, height});
  }
  EXPECT_FALSE(Beams(Candidate(wall), 200, 519).InOpenings(counted.OpeningsOf(wall)).empty());
  // Few of their beams count: of so many segments, one on each beam twice.
  for (int i = 0; i < 80; ++i) Beams(Candidate(wall), 180 + i, 500 + i).CountHits(&counted);
  EXPECT_TRUE(Beams(Candidate(wall), 200, 519).InOpenings(counted.OpeningsOf(wall)).empty());
}

// A quarter of a metre of its beams sees a board 4 cm before the wall.
TEST_F(OcclusionTest, HitsTellByHowMuchTheyDeviate) {
  line_.angle_increment = 0.25 * kDegree;
  line_.ranges.assign(600, 0.0f);
  Landmark wall = MakeVerticalLandmark({0.0, -1.0, 0.0}, {0.01, 1.0, 0.0});
  wall.extent.AddSegment({0.0, 1.0, 0.0}, {0.0, 1.0, 2.8});
  const double board = 0.04;
  for (int beam = 200; beam < 520; ++beam) {
    const double angle = line_.BeamAngle(beam);
    const bool is_on_board = std::cos(angle) / std::sin(angle) > 0.6;
    line_.ranges[static_cast<size_t>(beam)] =
        static_cast<float>((is_on_board ? 1.0 - board : 1.0) / std::sin(angle));
  }
  OccupancyGrids counted;
  for (int i = 0; i < 400; ++i) {
    Beams(Candidate(wall), 200 + i % 40, 480 + i % 40).CountHits(&counted);
  }
  std::vector<LevelOnSurface> levels;
  EXPECT_FALSE(counted.OpeningsOf({wall}, 0.0, &levels)[0].none());
}

}  // namespace
}  // namespace plumbline

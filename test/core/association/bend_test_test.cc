#include "core/association/bend_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "core/map/observation_poses.h"
#include "core/segmentation/segmentation.h"

namespace plumbline {
namespace {

constexpr double kFlatness = 0.003;  // m
constexpr double kNoise = 0.02;      // m

// A level scanner at rest looks at a wall several times.
class BendTestTest : public testing::Test {
 protected:
  // range(angle): of the wall, for beams about the x axis.
  std::optional<Landmark> Look(const std::function<double(double)>& range, int num_scans) {
    return Look(range, std::vector<Rigid3d>(static_cast<size_t>(num_scans)));
  }

  // world_from_scanner: of each scan, as it is believed to be.
  std::optional<Landmark> Look(const std::function<double(double)>& range,
                               const std::vector<Rigid3d>& world_from_scanner) {
    Scanner scanner;
    scanner.range_noise_m = kNoise;
    std::optional<BendTest> test;
    for (const Rigid3d& pose : world_from_scanner) {
      ScanLine line;
      line.angle_min = -0.4;
      line.angle_increment = 0.008;
      line.time_increment_s = 1e-5;
      for (int i = 0; i <= 100; ++i) {
        line.ranges.push_back(
            static_cast<float>(range(line.BeamAngle(i)) + kNoise * noise_(random_)));
      }
      for (const Segment& segment : SegmentScanLine(line, scanner, {}, {})) {
        const Observation observation = MakeObservation(line, scanner, segment, false);
        const ObservationPoses poses(
            observation.measurement.node_times_ns(), {pose, pose, pose}, scanner);
        if (!test) {
          const Eigen::Vector2d centre = observation.centroid();
          test.emplace(
              MakeVerticalLandmark(-Eigen::Vector3d::UnitX(), {centre.x(), centre.y(), 0.0}),
              kFlatness,
              kNoise);
        }
        test->Add(observation, poses, Matrix6d::Zero());
      }
    }
    return test ? test->Solve() : std::nullopt;
  }

  std::mt19937_64 random_{4};
  std::normal_distribution<double> noise_;
};

TEST(MayBendTest, OnlyWhatIsUprightAndTurnsLittle) {
  const Eigen::Vector3d p(1.0, 2.0, 0.3);
  const auto seen = [](Landmark landmark, double width_m) {
    const PlaneAxes axes = landmark.extent.axes();
    landmark.extent.AddSegment(axes.anchor, axes.ToWorld({width_m, 0.0}));
    return landmark;
  };
  Landmark wall = seen(MakeVerticalLandmark({0.6, 0.8, 0.0}, p), 9.0);
  EXPECT_TRUE(MayBend(wall));
  wall.heading_fixed = true;
  EXPECT_FALSE(MayBend(wall));
  EXPECT_FALSE(MayBend(seen(MakeHorizontalLandmark(1.0, p), 9.0)));
  EXPECT_FALSE(MayBend(seen(MakeGeneralLandmark({0.6, 0.0, 0.8}, p), 9.0)));
  EXPECT_TRUE(MayBend(seen(MakeCylinderLandmark({0.6, 0.8, 0.0}, 0.2, p), 2.0)));
  EXPECT_FALSE(MayBend(seen(MakeCylinderLandmark({0.6, 0.8, 0.0}, 0.2, p), 3.0)));
}

TEST_F(BendTestTest, AnArcIsACylinder) {
  // Round the scanner's side: seen from within a circle about (-2, 0), and from outside one
  // about (7, 0.5).
  const auto inside = [](double angle) {
    const double c = 2.0 * std::cos(angle);
    return -c + std::sqrt(c * c + 36.0 - 4.0);
  };
  const std::optional<Landmark> concave = Look(inside, 10);
  ASSERT_TRUE(concave);
  EXPECT_EQ(concave->model, PlaneModel::kCylinder);
  const double sigma = std::sqrt(concave->covariance(1, 1));
  EXPECT_NEAR(concave->Curvature(), -1.0 / 6.0, 4.0 * sigma);
  EXPECT_LT(sigma, 0.02);
  const auto outside = [](double angle) {
    const double b = 7.0 * std::cos(angle) + 0.5 * std::sin(angle);
    return b - std::sqrt(std::max(0.0, b * b - 49.25 + 16.0));
  };
  const std::optional<Landmark> convex = Look(outside, 10);
  ASSERT_TRUE(convex);
  // The chords' ends, which beams meet obliquely, bias it by some per cent: a start, no
  // result.
  EXPECT_NEAR(convex->Curvature(), 0.25, 0.03);
}

TEST_F(BendTestTest, AFlatWallStaysAPlane) {
  EXPECT_FALSE(Look([](double angle) { return 4.0 / std::cos(angle - 0.2); }, 40));
}

// Two walls that meet at a flat corner are no arc, however often they are seen.
TEST_F(BendTestTest, ACornerIsNoArc) {
  const auto corner = [](double angle) {
    const double along = angle > 0.0 ? 0.25 : -0.25;
    return 4.0 / (std::cos(angle) - along * std::sin(angle));
  };
  EXPECT_FALSE(Look(corner, 40));
}

// A rig that drives along a straight wall and believes that it turns by 6 degrees, without
// noticing: all segments together lie on an arc of 100 m, but none of them bows.
TEST_F(BendTestTest, AWallThatDriftBendsIsNoArc) {
  std::vector<Rigid3d> poses;
  for (double way = -5.0; way <= 5.0; way += 0.25) {
    const double turn = way / 100.0;
    poses.push_back({Eigen::Quaterniond(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ())),
                     {-0.5 * way * turn, way, 0.0}});
  }
  EXPECT_FALSE(Look([](double angle) { return 3.0 / std::cos(angle); }, poses));
}

}  // namespace
}  // namespace plumbline

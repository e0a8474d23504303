#include "core/map/observation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>

#include "core/association/line_deviation.h"
#include "core/surface/landmark_view.h"
#include "factors/segment/segment_measurement.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'400'000'000'000'000'000;
constexpr int kFirstBeam = 60;
constexpr int kLastBeam = 139;

Scanner MakeScanner() {
  Scanner scanner;
  scanner.body_from_scanner = {RotationFromRollPitchYaw(0.3, 0.6, -0.4), {0.1, -0.2, 0.3}};
  scanner.beams = 200;
  scanner.field_of_view_deg = 90.0;
  scanner.range_noise_m = 0.02;
  scanner.angle_noise_rad = 0.002;
  scanner.time_offset_s = 0.005;
  return scanner;
}

Rigid3d BodyPose() {
  return {RotationFromRollPitchYaw(-0.1, 0.2, 0.9), Eigen::Vector3d(0.5, 1.0, 1.2)};
}

// A wall that the scanner faces at a slant.
ScenePlane FacedWall(const Scanner& scanner) {
  const Rigid3d world_from_scanner = BodyPose() * scanner.body_from_scanner;
  const Eigen::Vector3d ahead = world_from_scanner.rotation * Eigen::Vector3d::UnitX();
  const double heading = std::atan2(-ahead.y(), -ahead.x()) + 0.4;
  const Eigen::Vector3d normal(std::cos(heading), std::sin(heading), 0.0);
  return {normal, normal.dot(world_from_scanner.translation + 3.0 * ahead)};
}

class ObservationTest : public testing::Test {
 protected:
  Observation Observe(double sigma_m) {
    const ScanLine line = TakeScanLine(
        {wall_}, scanner_, 0, kStart, [](int64_t) { return BodyPose(); }, sigma_m, &random_);
    return ObservePlane(line, scanner_, BodyPose(), wall_, kFirstBeam, kLastBeam);
  }
  Landmark WallLandmark() const {
    return MakeVerticalLandmark(wall_.normal, wall_.distance * wall_.normal);
  }
  LineDeviation Deviation(const Observation& observation,
                          const Rigid3d& pose,
                          const Landmark& landmark) const {
    const Trajectory trajectory(kStart, 1'000'000'000, pose);
    return DeviationFromPlane(observation,
                              ObservationPoses(trajectory, scanner_, observation),
                              LandmarkView(landmark));
  }

  Scanner scanner_ = MakeScanner();
  ScenePlane wall_ = FacedWall(scanner_);
  std::mt19937_64 random_{5};
};

TEST_F(ObservationTest, KeepsWhatTheSegmentSays) {
  const ScanLine line = TakeScanLine(
      {wall_}, scanner_, 2, kStart, [](int64_t) { return BodyPose(); }, 0.0, &random_);
  Segment segment;
  segment.first_beam = 10;
  segment.last_beam = 19;
  segment.excluded_beams = {12, 13, 17};
  segment.num_points = 7;
  segment.normal = {1.0, 0.0};
  segment.sigma_direction_rad = 0.07;
  const Observation observation = MakeObservation(line, scanner_, segment, true);
  EXPECT_EQ(observation.scanner_index, 2);
  EXPECT_EQ(observation.num_points, 7);
  EXPECT_EQ(observation.excluded_beams, segment.excluded_beams);
  EXPECT_EQ(observation.start_time_ns(), line.BeamTime(10) + 5'000'000);
  EXPECT_EQ(observation.end_time_ns(), line.BeamTime(19) + 5'000'000);
  EXPECT_EQ(observation.sigma_direction_rad, 0.07F);
  // Ranges without noise have single precision: that far the points lie off their line.
  EXPECT_LT((observation.start() - line.ranges[10] * line.BeamDirection(10)).norm(), 1e-6);
  EXPECT_LT((observation.end() - line.ranges[19] * line.BeamDirection(19)).norm(), 1e-6);
  ASSERT_EQ(observation.points.size(), 7u);
  EXPECT_LT((observation.points[2].position - line.ranges[14] * line.BeamDirection(14)).norm(),
            1e-6);
  EXPECT_EQ(observation.points[2].time_ns, line.BeamTime(14) + 5'000'000);
  EXPECT_TRUE(MakeObservation(line, scanner_, segment, false).points.empty());
}

// The beams' noise leaves their places on the line: points lie on it, offsets hold the rest.
TEST_F(ObservationTest, SplitsRangesIntoLineAndOffsets) {
  const ScanLine line = TakeScanLine(
      {wall_}, scanner_, 0, kStart, [](int64_t) { return BodyPose(); }, 0.02, &random_);
  const Observation observation =
      ObservePlane(line, scanner_, BodyPose(), wall_, kFirstBeam, kLastBeam);
  const Eigen::Vector2d tangent =
      (observation.points[0].position - observation.points.end()[-1].position).normalized();
  EXPECT_LT((observation.tangent() - tangent).norm(), 1e-7);  // kept in single precision
  const Eigen::Vector2d normal(tangent.y(), -tangent.x());
  double sum_squares = 0.0;
  for (size_t i = 0; i < observation.points.size(); ++i) {
    const Eigen::Vector2d& point = observation.points[i].position;
    EXPECT_NEAR(normal.dot(point), normal.dot(observation.points[0].position), 1e-9);
    const int beam = kFirstBeam + static_cast<int>(i);
    const double range = line.ranges[static_cast<size_t>(beam)];
    const Eigen::Vector2d direction = line.BeamDirection(beam);
    EXPECT_LT(std::abs(point.x() * direction.y() - point.y() * direction.x()), 1e-9);
    // The line's normal points to the scanner, as that of a plane that is seen does.
    const double whitened = -observation.points[i].whitening *
                            std::abs(normal.dot(direction)) * (range - point.norm());
    EXPECT_NEAR(observation.points[i].offset, whitened, 1e-6);
    sum_squares += whitened * whitened;
  }
  const double num_points = static_cast<double>(observation.points.size());
  // Range noise of 0.02 m, as the scanner states it: chi-square of num_points - 2.
  EXPECT_NEAR(sum_squares, num_points - 2.0, 4.5 * std::sqrt(2.0 * num_points));
}

TEST_F(ObservationTest, DoesNotDeviateFromItsPlane) {
  const LineDeviation deviation = Deviation(Observe(0.0), BodyPose(), WallLandmark());
  EXPECT_LT(std::abs(deviation.value[0]), 1e-6);  // ranges have single precision
  EXPECT_LT(std::abs(deviation.value[1]), 1e-6);
  EXPECT_LT(deviation.chi2, 1e-3);
}

// The rig turns and accelerates while the scan line is taken.
TEST_F(ObservationTest, TakesTheMotionIntoAccount) {
  Trajectory trajectory(kStart, 50'000'000, BodyPose());
  for (int i = 0; i < 4; ++i) {
    ControlPoint& control_point = trajectory.control_point(i);
    Eigen::Map<Eigen::Vector3d>(control_point.position.data()) +=
        Eigen::Vector3d(0.05 * i, -0.03 * i, 0.002 * i * i);
    Eigen::Map<Eigen::Quaterniond> rotation(control_point.rotation.data());
    rotation = rotation * RotationFromRollPitchYaw(0.01 * i, 0.002 * i * i, 0.06 * i);
  }
  const ScanLine line = TakeScanLine(
      {wall_},
      scanner_,
      0,
      kStart,
      [&](int64_t time_ns) { return trajectory.WorldFromBody(time_ns + 5'000'000); },
      0.0,
      &random_);
  const Observation observation =
      ObservePlane(line, scanner_, BodyPose(), wall_, kFirstBeam, kLastBeam);
  const Landmark wall = WallLandmark();
  const LineDeviation deviation = DeviationFromPlane(
      observation, ObservationPoses(trajectory, scanner_, observation), LandmarkView(wall));
  // The quadratic through the nodes follows the motion far below the noise.
  EXPECT_LT(std::abs(deviation.value[0]), 1e-5);
  EXPECT_LT(std::abs(deviation.value[1]), 1e-5);
  EXPECT_LT(deviation.chi2, 1e-3);
  // Without the motion the wall would seem to be elsewhere.
  EXPECT_GT(Deviation(observation, BodyPose(), WallLandmark()).chi2, 100.0);
}

TEST_F(ObservationTest, JacobianByPoseAgreesWithFiniteDifferences) {
  const Observation observation = Observe(0.0);
  const LineDeviation deviation = Deviation(observation, BodyPose(), WallLandmark());
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 6; ++i) {
    const auto moved = [&](double step) {
      Rigid3d pose = BodyPose();
      if (i < 3) {
        pose.rotation = Eigen::AngleAxisd(step, Eigen::Vector3d::Unit(i)) * pose.rotation;
      } else {
        pose.translation[i - 3] += step;
      }
      return Deviation(observation, pose, WallLandmark()).value;
    };
    const Eigen::Vector2d expected = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
    EXPECT_LT((deviation.by_pose.col(i) - expected).norm(), 1e-4) << i;
  }
}

TEST_F(ObservationTest, JacobianByPlaneAgreesWithFiniteDifferences) {
  const Observation observation = Observe(0.0);
  const Landmark landmark = WallLandmark();
  const LineDeviation deviation = Deviation(observation, BodyPose(), landmark);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 2; ++i) {
    const auto moved = [&](double step) {
      Landmark other = landmark;
      other.parameters[static_cast<size_t>(i)] += step;
      return Deviation(observation, BodyPose(), other).value;
    };
    const Eigen::Vector2d expected = (moved(kStep) - moved(-kStep)) / (2.0 * kStep);
    EXPECT_LT((deviation.by_plane.col(i) - expected).norm(), 1e-4) << i;
  }
}

// Offset and slope of the points' distances to the plane by ordinary weighted least squares.
TEST_F(ObservationTest, ValueAndCovarianceAreThoseOfALineFit) {
  const Observation observation = Observe(0.02);
  const Rigid3d world_from_scanner = BodyPose() * scanner_.body_from_scanner;
  const SegmentWeights weights =
      WeightsOn(observation, world_from_scanner.rotation, wall_.normal);
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right_side = Eigen::Vector2d::Zero();
  double chi2 = 0.0;
  for (size_t i = 0; i < observation.points.size(); ++i) {
    const Eigen::Vector2d& s = observation.points[i].position;
    const double distance =
        wall_.normal.dot(world_from_scanner * Eigen::Vector3d(s.x(), s.y(), 0.0)) -
        wall_.distance;
    const Eigen::Vector2d row(1.0, observation.tangent().dot(s - observation.centroid()));
    const double whitening = weights.scale * observation.points[i].whitening;
    const double residual =
        whitening * distance + weights.offset * observation.points[i].offset;
    information += whitening * whitening * row * row.transpose();
    right_side += whitening * row * residual;
    chi2 += residual * residual;
  }
  const Eigen::Matrix2d covariance = information.inverse();
  const Eigen::Vector2d value = covariance * right_side;
  const LineDeviation deviation = Deviation(observation, BodyPose(), WallLandmark());
  // The compression may leave out a thousandth of a standard deviation.
  EXPECT_LT(std::abs(deviation.value[0] - value[0]), 3e-3 * std::sqrt(covariance(0, 0)));
  EXPECT_LT(std::abs(deviation.value[1] - value[1]), 3e-3 * std::sqrt(covariance(1, 1)));
  EXPECT_LT((deviation.covariance - covariance).norm(), 3e-3 * covariance.norm());
  EXPECT_NEAR(deviation.chi2, chi2, 1e-2 * chi2);
  // 80 points: chi-square within 4.5 of its standard deviations.
  EXPECT_NEAR(deviation.chi2, 80.0, 4.5 * std::sqrt(2.0 * 80.0));
}

// One beam's variance of the distance to the plane, from range and both angles.
TEST_F(ObservationTest, WhiteningIsThatOfTheDistanceToThePlane) {
  scanner_.angle_noise_rad = 0.01;  // so that it matters
  const Observation observation = [&] {
    const ScanLine line = TakeScanLine(
        {wall_}, scanner_, 0, kStart, [](int64_t) { return BodyPose(); }, 0.0, &random_);
    return ObservePlane(line, scanner_, BodyPose(), wall_, 100, 102);
  }();
  const Eigen::Quaterniond world_from_scanner =
      BodyPose().rotation * scanner_.body_from_scanner.rotation;
  const Eigen::Vector3d normal = world_from_scanner.conjugate() * wall_.normal;
  const Eigen::Vector2d point = observation.points[1].position;
  const double range = point.norm();
  const Eigen::Vector2d beam = point / range;
  const double by_range = normal.head<2>().dot(beam);
  const double by_angle = range * normal.head<2>().dot(Eigen::Vector2d(-beam.y(), beam.x()));
  const double by_tilt = range * normal.z();
  const double variance = std::pow(0.02 * by_range, 2) + std::pow(0.01 * by_angle, 2) +
                          std::pow(0.01 * by_tilt, 2);
  // The three beams differ a little in range.
  EXPECT_NEAR(WeightsOn(observation, world_from_scanner, wall_.normal).scale *
                  observation.points[1].whitening,
              1.0 / std::sqrt(variance),
              2e-3 / std::sqrt(variance));
}

// A beam that grazes its plane meets it far behind where it ended: the surface is no longer
// for that. An end that lies inwards of its point stays.
TEST_F(ObservationTest, EndsAtItsPointsWhereBeamsGraze) {
  Scanner scanner;
  scanner.range_noise_m = 0.02;
  ScanLine line;
  line.stamp_ns = kStart;
  line.angle_min = 0.004;
  line.angle_increment = 0.006;
  line.time_increment_s = 1e-5;
  line.ranges = {5.2F, 4.9F};
  Segment segment;
  segment.first_beam = 0;
  segment.last_beam = 1;
  segment.num_points = 2;
  const Rigid3d at_rest;
  const ObservationPoses poses(
      {kStart, kStart + 5'000, kStart + 10'000}, {at_rest, at_rest, at_rest}, scanner);
  const PlaneTrace trace = poses.motion.TraceOf(Eigen::Vector3d::UnitY(), 0.05);
  Observation observation = MakeObservationOn(trace, line, scanner, segment, false);
  ASSERT_NEAR(observation.start().x(), 12.5, 0.01);
  EndAtPoints(line, &observation);
  EXPECT_NEAR(observation.start().x(), 5.2, 0.01);
  EXPECT_NEAR(observation.start().y(), 0.05, 1e-6);
  EXPECT_NEAR(observation.end().x(), 5.0, 0.01);
}

}  // namespace
}  // namespace plumbline

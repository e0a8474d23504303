// The covariances that a map states are those of its errors: over many maps of the same walk,
// each with noise of its own, the normalised squared errors follow chi-square distributions.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/result/result_reader.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

// A sum of normalised estimation errors squared, e' C^-1 e, of independent errors e: where
// their covariances C are right, chi-square distributed with as many degrees of freedom as the
// errors have components.
class NormalisedErrors {
 public:
  void Add(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
    sum_ += error.dot(covariance.ldlt().solve(error));
    freedom_ += static_cast<double>(error.size());
  }

  // The same errors, had covariances been stated that are `factor` times as large.
  NormalisedErrors WithCovariancesTimes(double factor) const {
    NormalisedErrors scaled = *this;
    scaled.sum_ /= factor;
    return scaled;
  }

  // True when the sum lies between the 2.5 % and the 97.5 % quantiles of its distribution, by
  // Wilson and Hilferty's approximation, which is good to 0.1 % from 30 degrees of freedom on.
  bool AreConsistent() const {
    const auto quantile = [&](double sigmas) {
      const double variance = 2.0 / (9.0 * freedom_);
      return freedom_ * std::pow(1.0 - variance + sigmas * std::sqrt(variance), 3);
    };
    return sum_ > quantile(-1.96) && sum_ < quantile(1.96);
  }

  double PerDegreeOfFreedom() const { return sum_ / freedom_; }

 private:
  double sum_ = 0.0;
  double freedom_ = 0.0;
};

// Errors and stated covariance of all planes of a map together: the angles of walls, but the
// reference wall's, which the model frame fixes, and all distances from the origin.
void AddPlanes(const Evaluation& evaluation,
               const SimulatedRecording& recording,
               const PlaneCovariance& stated,
               NormalisedErrors* planes) {
  std::map<int, PlanePatch> faces;
  for (const PlanePatch& face : recording.truth_planes) {
    faces[face.id] = TransformPatch(evaluation.frame.model_from_truth, face);
  }
  std::vector<double> errors;
  std::vector<int> rows;  // of the covariance
  int row = 0;
  for (size_t i = 0; i < stated.planes().size(); ++i) {
    const PlanePatch& plane = stated.planes()[i];
    const PlanePatch& face = faces.at(evaluation.planes.list[i].face_ids.front());
    for (const std::string& parameter : FieldsOf(plane.type).parameters) {
      const double angle = std::atan2(plane.normal.y(), plane.normal.x());
      const double true_angle = std::atan2(face.normal.y(), face.normal.x());
      if (stated.covariance()(row, row) > 0.0) {
        errors.push_back(parameter == "angle" ? std::remainder(angle - true_angle, 2.0 * M_PI)
                                              : plane.distance - face.distance);
        rows.push_back(row);
      }
      ++row;
    }
  }
  planes->Add(Eigen::Map<const Eigen::VectorXd>(errors.data(),
                                                static_cast<Eigen::Index>(errors.size())),
              stated.covariance()(rows, rows));
}

// One line of trajectory_covariance.csv: time, upper triangle of position and rotation.
Matrix6d ReadPoseCovariance(const std::string& path, size_t index) {
  std::ifstream file(path);
  std::string line;
  for (size_t i = 0; i < index + 2; ++i) std::getline(file, line);  // the first is the header
  std::replace(line.begin(), line.end(), ',', ' ');
  std::istringstream values(line);
  double time = 0.0;
  values >> time;
  Matrix6d covariance;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      values >> covariance(i, j);
      covariance(j, i) = covariance(i, j);
    }
  }
  EXPECT_TRUE(values) << path;
  return covariance;
}

class ConsistencyTest : public MappingTest {
 protected:
  // The pose at a share of the map's poses.
  void AddPose(const Evaluation& evaluation,
               const SimulatedRecording& recording,
               double share,
               NormalisedErrors* poses) {
    const std::vector<StampedPose> trajectory = ReadTrajectory(Path("result/trajectory.tum"));
    const auto index = static_cast<size_t>(share * static_cast<double>(trajectory.size()));
    const Rigid3d& pose = trajectory[index].world_from_body;
    const Rigid3d true_pose =
        evaluation.frame.model_from_truth *
        InterpolatedTrajectory(recording.truth_trajectory).Pose(trajectory[index].time_ns);
    const Eigen::AngleAxisd turned(pose.rotation * true_pose.rotation.conjugate());
    Eigen::VectorXd error(6);
    error << pose.translation - true_pose.translation, turned.angle() * turned.axis();
    poses->Add(error, ReadPoseCovariance(Path("result/trajectory_covariance.csv"), index));
  }
};

// At 0.8 m/s the rig turns at up to 180 deg/s in the corners.
TEST_F(ConsistencyTest, ErrorsAreAsLargeAsStated) {
  constexpr int kNumMaps = 60;
  Scenario scenario;
  scenario.building = PillarRoom();
  scenario.scanners = TiltedRig();
  scenario.path = PillarWalk(8.0, 0.8);
  NormalisedErrors planes, poses;
  double sum_variance_factors = 0.0, num_points = 0.0;
  for (int i = 0; i < kNumMaps; ++i) {
    const SimulatedRecording recording = Simulate(scenario, static_cast<uint64_t>(i + 1));
    WriteRecording(recording);
    Map();
    const Evaluation evaluation = EvaluateResult(recording);
    ASSERT_EQ(evaluation.planes.num_wrong + evaluation.planes.num_missed, 0) << "map " << i;
    AddPlanes(evaluation, recording, ReadPlaneCovariance(Path("result")), &planes);
    // A map's poses share its errors. One of each map is independent of all others, and over
    // the maps they cover the walk: where it goes straight and where it turns.
    AddPose(evaluation, recording, (i + 0.5) / kNumMaps, &poses);
    sum_variance_factors += summary_.variance_factor;
    num_points += static_cast<double>(summary_.points_used);
  }
  // For --gtest_output=xml.
  RecordProperty("planes", std::to_string(planes.PerDegreeOfFreedom()));
  RecordProperty("poses", std::to_string(poses.PerDegreeOfFreedom()));
  RecordProperty("variance_factor", std::to_string(sum_variance_factors / kNumMaps));
  EXPECT_TRUE(planes.AreConsistent()) << planes.PerDegreeOfFreedom();
  // Poses are better than stated, by up to 15 % of the deviation: a figure that is missed
  // (docs/decisions/018-motion-noise.md).
  constexpr double kLargestShare = 1.15 * 1.15;
  EXPECT_LT(poses.PerDegreeOfFreedom(), 1.0 + 1.96 * std::sqrt(2.0 / (6.0 * kNumMaps)));
  EXPECT_GT(poses.PerDegreeOfFreedom(), 1.0 / kLargestShare);
  // These series are long enough to tell covariances that are wrong by half.
  for (const double factor : {1.5, 1.0 / 1.5}) {
    EXPECT_FALSE(planes.WithCovariancesTimes(factor).AreConsistent()) << factor;
    EXPECT_FALSE(poses.WithCovariancesTimes(factor).AreConsistent()) << factor;
  }
  // Squared residuals of all points over their variances; the unknowns are few beside them.
  EXPECT_NEAR(sum_variance_factors / kNumMaps, 1.0, 1.96 * std::sqrt(2.0 / num_points));
}

// Errors of all planes of some maps of one walk, in worlds that are otherwise than the rig
// file and the planes say: the same from scan to scan.
class RepeatedErrorsTest : public ConsistencyTest {
 protected:
  struct Found {
    double planes = 0.0;  // NEES per degree of freedom
    double poses = 0.0;
  };
  Found Errors(const std::string& faults,
               float range_bias_m,  // of the second scanner
               const std::string& correlated_errors) {
    constexpr int kNumMaps = 8;
    Scenario scenario;
    scenario.building = PillarRoom();
    scenario.scanners = TiltedRig();
    scenario.path = PillarWalk(8.0, 0.8);
    scenario.more = faults;
    NormalisedErrors planes, poses;
    for (int i = 0; i < kNumMaps; ++i) {
      SimulatedRecording recording = Simulate(scenario, static_cast<uint64_t>(i + 1));
      for (ScanLine& line : recording.scan_lines) {
        if (line.scanner_index != 1) continue;
        for (float& range : line.ranges) range += range_bias_m;
      }
      WriteRecording(recording);
      Map("batch: {correlated_errors: " + correlated_errors + "}\n");
      const Evaluation evaluation = EvaluateResult(recording);
      EXPECT_EQ(evaluation.planes.num_wrong + evaluation.planes.num_missed, 0) << "map " << i;
      AddPlanes(evaluation, recording, ReadPlaneCovariance(Path("result")), &planes);
      AddPose(evaluation, recording, (i + 0.5) / kNumMaps, &poses);
    }
    return {planes.PerDegreeOfFreedom(), poses.PerDegreeOfFreedom()};
  }
};

TEST_F(RepeatedErrorsTest, UnevenSurfacesAreStated) {
  const std::string faults = "faults:\n  surfaces: {stddev_m: 0.004, correlation_m: 0.5}\n";
  const Found found = Errors(faults, 0.0F, "estimated");
  EXPECT_GT(found.planes, 0.6);
  EXPECT_LT(found.planes, 1.5);
  EXPECT_LT(found.poses, 1.6);
  EXPECT_GT(Errors(faults, 0.0F, "off").planes, 3.0) << "else the walls are as good as even";
}

TEST_F(RepeatedErrorsTest, AScannerThatMeasuresTooFarIsStated) {
  const Found found = Errors("", 0.01F, "estimated");
  EXPECT_GT(found.planes, 0.6);
  EXPECT_LT(found.planes, 1.5);
  EXPECT_LT(found.poses, 1.6);
  EXPECT_GT(Errors("", 0.01F, "off").planes, 3.0);
}

}  // namespace
}  // namespace plumbline

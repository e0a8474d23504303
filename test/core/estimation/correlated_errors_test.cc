#include "core/estimation/correlated_errors.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/error_patterns.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/gauss_newton_solver.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/pose_prior.h"
#include "core/geometry/matrix_types.h"
#include "core/trajectory/motion_noise.h"
#include "test/testing/plane_scene.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'600'000'000'000'000'000;
constexpr int64_t kKnot = 200'000'000;
constexpr int kNumScans = 120;
constexpr int64_t kPeriod = 50'000'000;
constexpr double kNoise = 0.02;
constexpr int kRoughWall = 2;

// What is wrong in one world, besides the noise.
struct Errors {
  double unevenness_m = 0.0;  // of 1 m squares, each by itself
  double range_bias_m = 0.0;  // of scanner 1
  double turn_rad = 0.0;      // of scanner 1, about the body's z axis
  double roughness_m = 0.0;   // of one wall's squares, besides
};

// The paper's rig on a straight walk through a room of five walls.
class CorrelatedErrorsTest : public testing::Test {
 protected:
  CorrelatedErrorsTest() : rig_(MakePaperRig()) {
    for (Scanner& scanner : rig_.scanners) {
      scanner.beams = 135;
      scanner.field_of_view_deg = 270.0;
      scanner.scan_rate_hz = 20.0;
      scanner.range_noise_m = kNoise;
    }
  }

  static Rigid3d TruePose(int64_t time_ns) {
    const double time_s = static_cast<double>(time_ns - kStart) * 1e-9;
    return {Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.6, 0.25, 0.0) * time_s};
  }

  // The plane that a beam meets first, and where.
  int Hit(const Rigid3d& world_from_scanner,
          const Eigen::Vector2d& direction,
          Eigen::Vector3d* p_world) const {
    const Eigen::Vector3d& origin = world_from_scanner.translation;
    const Eigen::Vector3d ray =
        world_from_scanner.rotation * Eigen::Vector3d(direction.x(), direction.y(), 0.0);
    const double range = CastRay(room_, origin, ray);
    *p_world = origin + range * ray;
    for (size_t i = 0; i < room_.size(); ++i) {
      if (std::abs(room_[i].normal.dot(*p_world) - room_[i].distance) < 1e-9 &&
          room_[i].normal.dot(ray) < 0.0) {
        return static_cast<int>(i);
      }
    }
    return -1;
  }

  void Measure(const Errors& errors, uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> gaussian(0.0, 1.0);
    std::map<std::tuple<int, int, int, int>, double> heights;  // of the squares
    Rig true_rig = rig_;
    Rigid3d& turned = true_rig.scanners[1].body_from_scanner;
    turned.rotation =
        Eigen::AngleAxisd(errors.turn_rad, Eigen::Vector3d::UnitZ()) * turned.rotation;
    observations_.clear();
    for (int i = 0; i < 3 * kNumScans; ++i) {
      const int s = i % 3;
      const Scanner& scanner = true_rig.scanners[static_cast<size_t>(s)];
      ScanLine line =
          TakeScanLine(room_, scanner, s, kStart + i / 3 * kPeriod, TruePose, kNoise, &random);
      std::vector<int> planes;
      for (int beam = 0; beam < scanner.beams; ++beam) {
        const Rigid3d world_from_scanner =
            TruePose(line.BeamTime(beam)) * scanner.body_from_scanner;
        Eigen::Vector3d p;
        planes.push_back(Hit(world_from_scanner, line.BeamDirection(beam), &p));
        const Eigen::Vector3d& normal = room_[static_cast<size_t>(planes.back())].normal;
        const auto [square, is_new] =
            heights.try_emplace({planes.back(),
                                 static_cast<int>(std::floor(p.x())),
                                 static_cast<int>(std::floor(p.y())),
                                 static_cast<int>(std::floor(p.z()))},
                                0.0);
        if (is_new) {
          square->second = (errors.unevenness_m +
                            (planes.back() == kRoughWall ? errors.roughness_m : 0.0)) *
                           gaussian(random);
        }
        const double cosine = -normal.dot((p - world_from_scanner.translation).normalized());
        line.ranges[static_cast<size_t>(beam)] +=
            static_cast<float>((s == 1 ? errors.range_bias_m : 0.0) - square->second / cosine);
      }
      Observe(line, planes);
    }
  }

  // The runs of beams on one plane, without the grazing ends.
  void Observe(const ScanLine& line, const std::vector<int>& planes) {
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(line.scanner_index)];
    for (int first = 0, end = 0; first < scanner.beams; first = end) {
      const int plane = planes[static_cast<size_t>(first)];
      while (end < scanner.beams && planes[static_cast<size_t>(end)] == plane) ++end;
      if (end - first < 8) continue;
      observations_.push_back(ObservePlane(line,
                                           scanner,
                                           TruePose(line.stamp_ns),
                                           room_[static_cast<size_t>(plane)],
                                           first,
                                           end - 1));
      observations_.back().landmark_id = plane;
      observations_.back().scanner_index = line.scanner_index;
    }
  }

  // Estimates the room from the truth on.
  void Estimate() {
    trajectory_ = Trajectory(kStart, kKnot, Rigid3d());
    trajectory_.ExtendTo(kStart + (kNumScans + 1) * kPeriod);
    for (int i = 0; i < trajectory_.num_control_points(); ++i) {
      Eigen::Map<Eigen::Vector3d>(trajectory_.control_point(i).position.data()) =
          TruePose(kStart + (i - 1) * kKnot).translation;
    }
    landmarks_.clear();
    for (const ScenePlane& plane : room_) {
      const Eigen::Vector3d on_plane = plane.distance * plane.normal;
      landmarks_.push_back(std::abs(plane.normal.z()) > 0.5
                               ? MakeHorizontalLandmark(plane.normal.z(), on_plane)
                               : MakeVerticalLandmark(plane.normal, on_plane));
      landmarks_.back().id = static_cast<int>(landmarks_.size()) - 1;
    }
    landmarks_[0].heading_fixed = true;
    calibration_ = RigCalibration(rig_, false);
    problem_ = std::make_unique<EstimationProblem>(
        rig_, false, &trajectory_, &landmarks_, &calibration_);
    problem_->AddTrajectoryTerms(
        TrajectoryOptions(),
        MotionProfile::Uniform(MotionNoise::Of(TrajectoryOptions()), trajectory_),
        kStart);
    std::vector<const Observation*> observations;
    for (const Observation& observation : observations_) observations.push_back(&observation);
    problem_->AddSegments(observations, 0.0);
    AddScannerPriors(calibration_, problem_.get());
    GaussNewtonSolver<ArrowheadEquations>({30, 0.0, 1e-4}).Solve(problem_.get());
    posed_rig_ = calibration_.Posed(rig_);
  }

  CorrelatedErrors FindCorrelatedErrors(const ArrowheadCholesky& factor) {
    const BlockLayout layout = problem_->Layout();
    const auto for_each = [&](const auto& visit) {
      for (const Observation& observation : observations_) visit(observation);
    };
    const auto make = [&](const auto&... with_factor) {
      return ErrorPatterns(
          posed_rig_, calibration_, trajectory_, landmarks_, layout, false, with_factor...);
    };
    ErrorPatterns shown = make();
    for_each([&](const Observation& observation) { shown.Add(observation); });
    const std::optional<std::vector<double>> deviations =
        EstimateDeviations(factor, for_each, &shown);
    shown_ = deviations.has_value();
    if (!shown_) return {};
    ErrorPatterns patterns = make(factor);
    if (own_deviations_) patterns.SetDeviations(*deviations);
    for_each([&](const Observation& observation) { patterns.Add(observation); });
    return EstimateCorrelatedErrors(factor, for_each, &patterns);
  }

  MapCovariance Covariance() {
    return MapCovariance::Of(*problem_,
                             LineariseArrowhead(*problem_, problem_->Layout()),
                             [&](const ArrowheadCholesky& factor) {
                               return found_ = FindCorrelatedErrors(factor);
                             });
  }

  // Squared errors of all planes over their covariance, per degree of freedom.
  double PlaneErrors(const Eigen::MatrixXd& covariance) const {
    std::vector<double> errors;
    std::vector<int> rows;
    int row = 0;
    for (size_t i = 0; i < room_.size(); ++i) {
      const Landmark& landmark = landmarks_[i];
      if (landmark.model == PlaneModel::kVertical) {
        if (!landmark.heading_fixed) {
          rows.push_back(row);
          errors.push_back(std::remainder(
              landmark.parameters[0] - std::atan2(room_[i].normal.y(), room_[i].normal.x()),
              2.0 * M_PI));
        }
        ++row;
      }
      rows.push_back(row++);
      errors.push_back(landmark.Distance() - room_[i].distance);
    }
    const Eigen::Map<const Eigen::VectorXd> error(errors.data(),
                                                  static_cast<Eigen::Index>(errors.size()));
    const Eigen::MatrixXd free = covariance(rows, rows);
    const Eigen::VectorXd scale = free.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd white = scale.cwiseProduct(error);
    const Eigen::MatrixXd correlation = scale.asDiagonal() * free * scale.asDiagonal();
    return white.dot(correlation.ldlt().solve(white)) / static_cast<double>(errors.size());
  }

  struct Mean {
    double independent = 0.0;  // NEES per degree of freedom, errors taken as independent
    double correlated = 0.0;
    double unevenness_m = 0.0;
    double range_bias_m = 0.0;
    double rotation_rad = 0.0;
    int num_shown = 0;
  };
  Mean MeanErrors(const Errors& errors) {
    constexpr int kNumWorlds = 12;
    Mean mean;
    for (uint64_t seed = 1; seed <= kNumWorlds; ++seed) {
      Measure(errors, seed);
      Estimate();
      mean.independent += PlaneErrors(MapCovariance::Of(*problem_).landmarks()) / kNumWorlds;
      mean.correlated += PlaneErrors(Covariance().landmarks()) / kNumWorlds;
      mean.num_shown += shown_ ? 1 : 0;
      mean.unevenness_m += found_.unevenness_m / kNumWorlds;
      mean.range_bias_m += found_.range_bias_m / kNumWorlds;
      mean.rotation_rad += found_.rotation_rad / kNumWorlds;
    }
    return mean;
  }

  const PlaneScene room_ =
      MakeRoom({{0.0, 5.0}, {1.3, 4.5}, {2.5, 4.0}, {3.7, 5.0}, {5.1, 4.0}}, -1.5, 1.6);
  Rig rig_;
  Rig posed_rig_;
  RigCalibration calibration_;
  Trajectory trajectory_{kStart, kKnot, Rigid3d()};
  std::deque<Landmark> landmarks_;
  std::deque<Observation> observations_;
  std::unique_ptr<EstimationProblem> problem_;
  CorrelatedErrors found_;
  bool shown_ = false;
  bool own_deviations_ = true;
};

// The mean of 12 x 11 squares lies within 0.25 of one with 95 %.
TEST_F(CorrelatedErrorsTest, WithoutThemTheCovarianceStays) {
  const Mean mean = MeanErrors({});
  EXPECT_NEAR(mean.independent, 1.0, 0.25);
  EXPECT_NEAR(mean.correlated / mean.independent, 1.0, 0.05);
  EXPECT_LE(mean.num_shown, 2);
}

TEST_F(CorrelatedErrorsTest, UnevenSurfacesAreCovered) {
  const Mean mean = MeanErrors({0.006, 0.0, 0.0});
  EXPECT_GT(mean.independent, 4.0);
  EXPECT_EQ(mean.num_shown, 12);
  EXPECT_NEAR(mean.correlated, 1.0, 0.4);
  EXPECT_NEAR(mean.unevenness_m, 0.006, 0.0015);
}

TEST_F(CorrelatedErrorsTest, ARangeBiasIsCovered) {
  const Mean mean = MeanErrors({0.0, 0.01, 0.0});
  EXPECT_GT(mean.independent, 4.0);
  EXPECT_EQ(mean.num_shown, 12);
  EXPECT_NEAR(mean.correlated, 1.0, 0.4);
  EXPECT_NEAR(mean.range_bias_m, 0.01 / std::sqrt(3.0), 0.001) << "one of three scanners";
}

TEST_F(CorrelatedErrorsTest, ATurnedScannerIsCovered) {
  const Mean mean = MeanErrors({0.0, 0.0, 0.005});
  EXPECT_GT(mean.independent, 4.0);
  EXPECT_EQ(mean.num_shown, 12);
  EXPECT_NEAR(mean.correlated, 1.0, 0.4);
}

// Scanners whose poses, clocks and range biases are estimated, while the range scales are
// held.
TEST_F(CorrelatedErrorsTest, UnevenSurfacesAreCoveredBesideACalibration) {
  for (Scanner& scanner : rig_.scanners) scanner.uncertainty = {0.01, 0.01, 0.001, 0.01, 0.0};
  const Mean mean = MeanErrors({0.006, 0.0, 0.0});
  EXPECT_GT(mean.independent, 4.0);
  EXPECT_EQ(mean.num_shown, 12);
  EXPECT_NEAR(mean.correlated, 1.0, 0.4);
  EXPECT_NEAR(mean.unevenness_m, 0.006, 0.0015);
}

// A wall ten times as uneven as the others: one variance of all says too little of it. The
// others' is that of all, and says too much.
TEST_F(CorrelatedErrorsTest, SurfacesThatDeviateMoreHaveTheirOwnDeviations) {
  Errors errors;
  errors.unevenness_m = 0.003;
  errors.roughness_m = 0.03;
  EXPECT_LT(MeanErrors(errors).correlated, 1.4);
  own_deviations_ = false;
  EXPECT_GT(MeanErrors(errors).correlated, 2.0);
}

// Rows and columns belong to one joint covariance of control points and planes.
TEST_F(CorrelatedErrorsTest, WhatIsAddedIsPositive) {
  Measure({0.006, 0.01, 0.0}, 1);
  Estimate();
  const Eigen::MatrixXd before = MapCovariance::Of(*problem_).landmarks();
  const MapCovariance after = Covariance();
  const Eigen::MatrixXd added = after.landmarks() - before;
  EXPECT_LT((added - added.transpose()).norm(), 1e-9 * added.norm());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(added).eigenvalues().minCoeff(),
            -1e-9 * added.norm());
  const int64_t middle = kStart + kNumScans / 2 * kPeriod;
  const Matrix6d pose_added = after.PoseAt(trajectory_, middle) -
                              MapCovariance::Of(*problem_).PoseAt(trajectory_, middle);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Matrix6d>(pose_added).eigenvalues().minCoeff(),
            -1e-9 * pose_added.norm());
  // The probes' share of the planes agrees with the cells one by one.
  const Eigen::MatrixXd by_probes = found_.shift.bottomRows(added.rows()) *
                                    found_.shift.bottomRows(added.rows()).transpose();
  for (Eigen::Index i = 0; i < added.rows(); ++i) {
    if (added(i, i) <= 0.0) continue;
    EXPECT_NEAR(by_probes(i, i) / found_.landmarks(i, i), 1.0, 0.6) << i;
  }
}

}  // namespace
}  // namespace plumbline

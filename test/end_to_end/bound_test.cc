#include "simulation/bound/bound.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/batch/calibration_joining.h"
#include "core/result/calibration_text.h"
#include "core/result/result_reader.h"
#include "core/result/result_writer.h"
#include "simulation/sensing/experiment.h"
#include "test/testing/paths.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

constexpr ScannerUncertainty kByHand = {0.02, 0.01, 0.002, 0.01};
constexpr ScannerUncertainty kByEye = {0.1, 0.05, 0.02, 0.02};

class BoundTest : public MappingTest {
 protected:
  BoundTest() {
    scenario_.building = PillarRoom();
    scenario_.scanners = TiltedRig();
    scenario_.path = PillarWalk(4.0, 1.0);
  }

  Bound Compute(const MapperOptions& options = {}) {
    Simulate(scenario_);  // writes the experiment's files
    return ComputeBound(ReadExperiment(Path("experiment.yaml")), options, [](double) {});
  }

  // The bound where every scanner is so uncertain.
  Bound ComputeUncertain(const ScannerUncertainty& uncertainty) {
    Simulate(scenario_);
    return ComputeBound(UncertainExperiment(uncertainty), {}, [](double) {});
  }

  Experiment UncertainExperiment(const ScannerUncertainty& uncertainty) const {
    Experiment experiment = ReadExperiment(Path("experiment.yaml"));
    for (Scanner& scanner : experiment.rig.scanners) scanner.uncertainty = uncertainty;
    return experiment;
  }

  static double PoseVariance(const Bound& bound) {
    double sum = 0.0;
    for (const StampedCovariance& pose : bound.poses) sum += pose.covariance.trace();
    return sum;
  }

  static double FloorSigma(const Bound& bound) {
    for (const PlanePatch& plane : bound.planes.planes()) {
      if (plane.type == PlaneType::kHorizontal && plane.normal.z() > 0.0) {
        return plane.sigma_distance_m;
      }
    }
    return 0.0;
  }

  // Of the vertical plane with most beams but the reference.
  static const PlanePatch& LargestWall(const Bound& bound) {
    const PlanePatch* largest = nullptr;
    for (const PlanePatch& plane : bound.planes.planes()) {
      if (plane.type != PlaneType::kVertical || plane.sigma_angle_rad == 0.0) continue;
      if (largest == nullptr || plane.num_points > largest->num_points) largest = &plane;
    }
    return *largest;
  }

  Scenario scenario_;
};

TEST_F(BoundTest, KnowsEveryPlaneAndEveryScan) {
  const Bound bound = Compute();
  const size_t num_faces = Simulate(scenario_).truth_planes.size();
  EXPECT_GE(num_faces, 9u);  // 4 walls, 2 levels, most sides of the pillar
  EXPECT_EQ(bound.planes.planes().size(), num_faces);
  EXPECT_EQ(bound.face_ids.size(), num_faces);
  EXPECT_EQ(bound.poses.size(), bound.trajectory.size());
  EXPECT_NEAR(static_cast<double>(bound.poses.size()), 4.0 * 20.0, 2.0);
  // The origin is the first pose.
  EXPECT_LT(bound.trajectory.front().world_from_body.translation.norm(), 1e-3);
  const Eigen::Vector3d origin_variance = bound.poses.front().covariance.diagonal().head<3>();
  EXPECT_LT(origin_variance.sum(), 1e-6);
}

// All measurements are ranges: twice the noise, twice the standard deviations, but for the
// weak motion prior and the noise of the beams' directions. That of 0.005 degrees moves a
// point 4 m away by 0.35 mm, which adds 0.03 % to the variance of 20 mm.
TEST_F(BoundTest, ScalesWithTheRangeNoise) {
  const double sigma_rad = LargestWall(Compute()).sigma_angle_rad;
  for (ScenarioScanner& scanner : scenario_.scanners) scanner.range_noise_m *= 2.0;
  EXPECT_NEAR(LargestWall(Compute()).sigma_angle_rad / sigma_rad, 2.0, 0.02);
}

TEST_F(BoundTest, FourTimesTheBeamsHalveTheStandardDeviation) {
  // The motion prior, which does not depend on the beams, is as good as off.
  MapperOptions options;
  options.trajectory.estimate_densities = false;
  options.trajectory.knot_interval_s = 0.125;
  options.trajectory.acceleration_density_m_s2 *= 100.0;
  options.trajectory.angular_acceleration_density_deg_s2 *= 100.0;
  const double sigma_m = FloorSigma(Compute(options));
  ASSERT_GT(sigma_m, 0.0);
  for (ScenarioScanner& scanner : scenario_.scanners) scanner.beams *= 4;
  EXPECT_NEAR(FloorSigma(Compute(options)) / sigma_m, 0.5, 0.02);
}

TEST_F(BoundTest, WithoutClosureAPlaneComesBackAsAnother) {
  scenario_.path = PillarWalk(16.0, 1.0);  // more than once around
  MapperOptions options;
  options.loop_closure.enabled = false;
  options.loop_closure.max_gap_scans = 10;
  EXPECT_GT(Compute(options).planes.planes().size(), Compute().planes.planes().size());
}

// The standard deviations that the mapper states can not be better than the bound, and should
// be near it.
TEST_F(BoundTest, MapperStatesWhatTheBoundSays) {
  const Bound bound = Compute();
  Run(scenario_);
  const PlaneCovariance result = ReadPlaneCovariance(Path("result"));
  // Angles between walls do not depend on the model frame's reference: the two largest ones.
  const auto two_largest = [](const std::vector<PlanePatch>& planes) {
    std::vector<PlanePatch> walls;
    for (const PlanePatch& plane : planes) {
      if (plane.type == PlaneType::kVertical) walls.push_back(plane);
    }
    std::sort(walls.begin(), walls.end(), [](const PlanePatch& a, const PlanePatch& b) {
      return a.num_points > b.num_points;
    });
    return std::pair(walls[0].id, walls[1].id);
  };
  const auto [bound_a, bound_b] = two_largest(bound.planes.planes());
  const auto [result_a, result_b] = two_largest(result.planes());
  const double ratio =
      result.AngleStddev(result_a, result_b) / bound.planes.AngleStddev(bound_a, bound_b);
  // The mapper weighs each segment by noisy ranges: a per cent either way. It leaves out beams
  // at the segments' ends, at most two of some 20 at either: a fifth of the beams makes
  // 1 / sqrt(1 - 0.2) of the standard deviation.
  EXPECT_GT(ratio, 0.99);
  EXPECT_LT(ratio, 1.12);
}

// Every beam on its true plane, optimal weights: the errors are what the bound says.
TEST_F(BoundTest, WithTrueAssociationsTheBoundIsReached) {
  const double reference_rad = [&] {
    const Bound bound = Compute();
    const PlanePatch& wall = bound.planes.planes().front();
    return std::atan2(wall.normal.y(), wall.normal.x());
  }();
  const Experiment experiment = ReadExperiment(Path("experiment.yaml"));
  const auto true_angle = [&](int face) {
    const Eigen::Vector3d& normal =
        experiment.building.faces[static_cast<size_t>(face)].normal;
    return std::atan2(normal.y(), normal.x());
  };
  double sum = 0.0;
  int count = 0;
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    const Bound estimate =
        EstimateWithTrueAssociations(experiment, MapperOptions(), seed, [](double) {});
    const auto& planes = estimate.planes.planes();
    EXPECT_EQ(estimate.face_ids.size(), planes.size());
    for (size_t i = 1; i < planes.size(); ++i) {
      if (planes[i].type != PlaneType::kVertical) continue;
      const double turned = std::atan2(planes[i].normal.y(), planes[i].normal.x()) -
                            reference_rad - true_angle(estimate.face_ids[i]) +
                            true_angle(estimate.face_ids[0]);
      const double error = std::remainder(turned, 2.0 * M_PI) / planes[i].sigma_angle_rad;
      sum += error * error;
      ++count;
    }
  }
  ASSERT_GT(count, 60);
  // The walls of a run are hardly correlated: four standard errors.
  EXPECT_NEAR(sum / count, 1.0, 4.0 * std::sqrt(2.0 / count));
}

TEST_F(BoundTest, ScannersThatAreKnownWellChangeNothing) {
  const Bound exact = Compute();
  EXPECT_TRUE(exact.calibration.empty());
  const Bound bound = ComputeUncertain({1e-7, 1e-7, 1e-8, 1e-7});
  EXPECT_EQ(bound.calibration.scanners.size(), 3u);
  EXPECT_NEAR(PoseVariance(bound) / PoseVariance(exact), 1.0, 1e-5);
  EXPECT_NEAR(FloorSigma(bound) / FloorSigma(exact), 1.0, 1e-5);
}

TEST_F(BoundTest, TheLessIsKnownOfScannersTheLessIsKnownOfAll) {
  const Bound exact = Compute();
  const Bound by_hand = ComputeUncertain(kByHand);
  const Bound by_eye = ComputeUncertain(kByEye);
  EXPECT_GT(PoseVariance(by_hand), 1.01 * PoseVariance(exact));
  EXPECT_GT(PoseVariance(by_eye), PoseVariance(by_hand));
  EXPECT_GT(FloorSigma(by_hand), FloorSigma(exact));
  const std::vector<std::vector<bool>> observed = ObservedParameters(by_hand.calibration);
  for (size_t i = 0; i < by_hand.calibration.scanners.size(); ++i) {
    const auto& parameters = by_hand.calibration.scanners[i].parameters;
    for (size_t k = 0; k < parameters.size(); ++k) {
      const double sigma = parameters[k].sigma;
      EXPECT_LE(sigma, parameters[k].prior_sigma);
      EXPECT_LE(sigma, by_eye.calibration.scanners[i].parameters[k].sigma);
    }
    // What ranges of 20 mm say a thousand times over is better known than a ruler has it.
    EXPECT_TRUE(observed[i][CalibratedScanner::kRange]);
  }
}

// The best estimate of the scanners is off by what the bound says. Where the prior is about
// the truth, x^T C^-1 x of the estimates has the mean n - trace(P^-1 C), C being the bound and
// P the prior.
// Of what the bound shows: tilts of a level scanner show to second order only.
TEST_F(BoundTest, WithTrueAssociationsTheScannersBoundIsReached) {
  Compute();
  const Experiment experiment = UncertainExperiment(kByEye);
  const std::vector<std::vector<bool>> is_shown =
      ObservedParameters(ComputeUncertain(kByEye).calibration);
  double sum = 0.0;
  double expected = 0.0;
  constexpr int kRuns = 6;
  for (uint64_t seed = 1; seed <= kRuns; ++seed) {
    const Calibration found =
        EstimateWithTrueAssociations(experiment, MapperOptions(), seed, [](double) {
        }).calibration;
    std::vector<double> errors;
    std::vector<int> rows;  // of the covariance
    int row = 0;
    for (size_t i = 0; i < found.scanners.size(); ++i) {
      const std::vector<CalibratedParameter>& parameters = found.scanners[i].parameters;
      for (size_t k = 0; k < parameters.size(); ++k) {
        if (parameters[k].IsHeld()) continue;
        const int own_row = row++;
        if (!is_shown[i][k]) continue;
        rows.push_back(own_row);
        errors.push_back(parameters[k].value);
        expected += 1.0 - std::pow(parameters[k].sigma / parameters[k].prior_sigma, 2);
      }
    }
    const Eigen::Map<const Eigen::VectorXd> error(errors.data(),
                                                  static_cast<Eigen::Index>(errors.size()));
    sum += error.dot(Eigen::MatrixXd(found.covariance(rows, rows)).llt().solve(error));
  }
  ASSERT_GT(expected, kRuns * 10.0);
  // Four standard errors of a chi-square.
  EXPECT_NEAR(sum, expected, 4.0 * std::sqrt(2.0 * expected));
}

TEST_F(BoundTest, WritesWhatCanBeReadBack) {
  const Bound bound = Compute();
  WriteBound(bound, Path("bound"));
  const PlaneCovariance read = ReadPlaneCovariance(Path("bound"));
  EXPECT_EQ(read.planes().size(), bound.planes.planes().size());
  EXPECT_EQ(ReadTrajectory(Path("bound/trajectory.tum")).size(), bound.trajectory.size());
  EXPECT_TRUE(std::filesystem::exists(Path("bound/faces.csv")));
  EXPECT_NE(BoundTable(bound).find("poses: position"), std::string::npos);
  EXPECT_EQ(BoundTable(bound).find("scanners:"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(Path("bound/calibration.json")));
}

TEST_F(BoundTest, WritesWhatIsKnownOfScanners) {
  const Bound bound = ComputeUncertain(kByHand);
  WriteBound(bound, Path("bound"));
  const Calibration read = ReadCalibration(Path("bound/calibration.json"));
  ASSERT_EQ(read.scanners.size(), 3u);
  EXPECT_EQ(read.scanners[1].parameters[0].sigma,
            bound.calibration.scanners[1].parameters[0].sigma);
  EXPECT_EQ(read.covariance.rows(), 2 * 8 + 1);
  EXPECT_NE(BoundTable(bound).find("scanners: rotations "), std::string::npos);
  // What is left of it says nothing of a rig that is known exactly.
  WriteBound(Compute(), Path("bound"));
  EXPECT_FALSE(std::filesystem::exists(Path("bound/calibration.json")));
}

// A floor plan with a ramp and a round wall: every kind of surface has a bound.
TEST(Bound, KnowsRampsAndArcs) {
  const Experiment experiment =
      ReadExperiment(ConfigsDir() + "/experiments/ramp_and_arc.yaml");
  const Bound bound = ComputeBound(experiment, {}, [](double) {});
  int num_general = 0;
  int num_cylinders = 0;
  for (size_t i = 0; i < bound.face_ids.size(); ++i) {
    const PlanePatch& plane = bound.planes.planes()[i];
    const Face& face = experiment.building.faces[static_cast<size_t>(bound.face_ids[i])];
    EXPECT_EQ(plane.type, face.type);
    EXPECT_LT(plane.sigma_distance_m, 0.01);
    if (plane.type == PlaneType::kGeneral) {
      ++num_general;
      EXPECT_GT(plane.sigma_angle_rad, 0.0);
      EXPECT_LT(plane.sigma_angle_rad, 1e-3);
      EXPECT_NEAR(std::abs(plane.normal.z()), 6.0 / std::hypot(6.0, 0.6), 1e-9);
    } else if (plane.type == PlaneType::kCylinder) {
      ++num_cylinders;
      // Half a chord of 2.5 m, 1.2 m deep.
      EXPECT_NEAR(plane.Radius(), (2.5 * 2.5 + 1.2 * 1.2) / 2.4, 1e-6);
      EXPECT_GT(plane.sigma_radius_m, 0.0);
      EXPECT_LT(plane.sigma_radius_m, 0.01);
    }
  }
  EXPECT_EQ(num_general, 2);
  EXPECT_EQ(num_cylinders, 1);
}

// A better gyroscope and accelerometer hold poses better, and what the rig file says of them
// is found to better than it says.
TEST_F(BoundTest, KnowsTheImu) {
  Simulate(scenario_);
  Experiment experiment = ReadExperiment(Path("experiment.yaml"));
  experiment.rig.imu = ReadRig(ConfigsDir() + "/rigs/paper_imu.yaml").imu;
  experiment.inertial = InertialOptions();
  const auto compute = [&] { return ComputeBound(experiment, {}, [](double) {}); };
  const Bound bound = compute();
  ASSERT_TRUE(bound.calibration.imu);
  for (const CalibratedParameter& parameter : bound.calibration.imu->parameters) {
    EXPECT_NEAR(parameter.value, 0.0, 1e-12) << parameter.name;
    EXPECT_GT(parameter.sigma, 0.0) << parameter.name;
    if (parameter.IsHeld()) continue;
    EXPECT_LE(parameter.sigma, parameter.prior_sigma) << parameter.name;
  }
  for (InertialErrors* errors :
       {&experiment.rig.imu->gyroscope, &experiment.rig.imu->accelerometer}) {
    errors->noise *= 0.1;
    errors->bias_instability *= 0.1;
  }
  const Bound better = compute();
  EXPECT_LT(PoseVariance(better), PoseVariance(bound));
  for (size_t i = 0; i < bound.calibration.imu->parameters.size(); ++i) {
    EXPECT_LE(better.calibration.imu->parameters[i].sigma,
              bound.calibration.imu->parameters[i].sigma)
        << bound.calibration.imu->parameters[i].name;
  }
}

}  // namespace
}  // namespace plumbline

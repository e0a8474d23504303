#include <ceres/covariance.h>
#include <ceres/problem.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/ceres_solver.h"
#include "core/estimation/estimation_problem.h"
#include "core/estimation/gauss_newton_solver.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/map_covariance.h"
#include "core/estimation/motion_noise_estimation.h"
#include "core/estimation/normal_equations.h"
#include "core/geometry/matrix_types.h"
#include "core/mapping/mapper.h"
#include "core/options/config.h"
#include "core/sensor/recording.h"
#include "core/trajectory/motion_noise.h"
#include "factors/spline/spline.h"
#include "test/testing/scenario.h"

namespace plumbline {
namespace {

// The final problem of a mapped scenario, at its solution.
class CovarianceTest : public MappingTest {
 protected:
  void MapScenario(const std::vector<ScenarioScanner>& scanners, double length_m = 1.5) {
    Scenario scenario;
    scenario.building = PillarRoom();
    scenario.scanners = scanners;
    scenario.path = PillarWalk(length_m, 1.0);
    WriteRecording(Simulate(scenario));
    rig_ = ReadRig(Path("rig.yaml"));
    RecordingReader recording(Path("recording.bag"), rig_);
    result_ =
        std::make_unique<MapResult>(std::move(MapRecording(
                                                  rig_, options_, [](double) {}, &recording)
                                                  .front()));
    MapState& state = result_->state;
    problem_ = std::make_unique<EstimationProblem>(
        rig_, result_->planar, &state.trajectory, &state.landmarks);
    problem_->AddTrajectoryTerms(
        options_.trajectory,
        MotionProfile::Uniform(MotionNoise::Of(options_.trajectory), state.trajectory),
        state.origin_time_ns);
    std::vector<const Observation*> associated;
    for (const Observation& observation : state.observations) {
      if (observation.landmark_id >= 0) associated.push_back(&observation);
    }
    problem_->AddSegments(associated, 0.0);
  }

  // The inverse of the free unknowns' part; zero elsewhere.
  static Eigen::MatrixXd InverseOf(const NormalEquations& equations) {
    std::vector<int> rows;
    for (int i = 0; i < equations.size(); ++i) {
      if (equations.hessian(i, i) > 0.0) rows.push_back(i);
    }
    const Eigen::MatrixXd free = equations.hessian(rows, rows).inverse();
    Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(equations.size(), equations.size());
    inverse(rows, rows) = free;
    return inverse;
  }
  // The position's covariance from that of all unknowns: it is linear in the control points,
  // p = sum b_j p_j.
  Eigen::Matrix3d PositionAt(int64_t time_ns,
                             const NormalEquations& equations,
                             const Eigen::MatrixXd& covariance) const {
    const Trajectory::Location at = result_->state.trajectory.Locate(time_ns);
    const std::array<double, 4> basis = SplineBasis(at.u);
    const auto row_of = [&](int control_point) {
      for (size_t b = 0; b < equations.blocks.size(); ++b) {
        if (equations.blocks[b] == PositionBlock(control_point)) return equations.offsets[b];
      }
      return -1;
    };
    Eigen::Matrix3d position = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        position += basis[static_cast<size_t>(i)] * basis[static_cast<size_t>(j)] *
                    covariance.block<3, 3>(row_of(at.first + i), row_of(at.first + j));
      }
    }
    return position;
  }

  NormalEquations Linearise() const { return LineariseDense(*problem_, problem_->Layout()); }

  // What the blocks hold, one after the other.
  std::vector<double> Values() const {
    std::vector<double> values;
    for (const BlockId& block : problem_->Layout().blocks) {
      const double* data = problem_->unknowns().Data(block);
      values.insert(values.end(), data, data + problem_->unknowns().AmbientSize(block));
    }
    return values;
  }
  // Moves control points and planes by some millimetres, the same way every time.
  void MoveAway(const std::vector<double>& solution) {
    size_t next = 0;
    for (const BlockId& block : problem_->Layout().blocks) {
      double* data = problem_->unknowns().Data(block);
      for (int i = 0; i < problem_->unknowns().AmbientSize(block); ++i, ++next)
        data[i] = solution[next];
      if (block.kind == BlockId::Kind::kPosition) data[0] += 0.003 * (block.index % 3 - 1);
      if (block.kind == BlockId::Kind::kLandmark) {
        data[problem_->unknowns().AmbientSize(block) - 1] += 0.002 * (block.index % 3 - 1);
      }
    }
  }

  static double LargestDifference(const std::vector<double>& a, const std::vector<double>& b) {
    double largest = 0.0;
    for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
    return largest;
  }

  Rig rig_;
  MapperOptions options_;
  std::unique_ptr<MapResult> result_;
  std::unique_ptr<EstimationProblem> problem_;
};

// The window's way to a solution, and the batch's. Ceres evaluates each segment anew; groups
// keep a linearisation that leaves out less than 0.01 mm (LinearisedGroup::kFine).
TEST_F(CovarianceTest, NormalEquationsHaveTheSolutionOfCeres) {
  std::vector<ScenarioScanner> horizontal = TiltedRig();
  for (ScenarioScanner& scanner : horizontal) scanner.rotation_deg = "0, 0, 20";
  for (const auto& scanners : {TiltedRig(), horizontal}) {
    MapScenario(scanners);
    const std::vector<double> mapped = Values();
    MoveAway(mapped);
    CeresSolver<NormalEquations>({50, 1e-14, 0.0}, CeresProblem::Segments::kOneByOne)
        .Solve(problem_.get());
    const std::vector<double> by_ceres = Values();
    MoveAway(mapped);
    // In groups it ends where shortened steps, too, would raise the cost by what the groups'
    // linearisations leave out.
    CeresSolver<NormalEquations>({50, 1e-14, 0.0}).Solve(problem_.get());
    EXPECT_LT(LargestDifference(Values(), by_ceres), 1e-4);
    MoveAway(mapped);
    const NormalEquations equations =
        GaussNewtonSolver<NormalEquations>({50, 1e-14, 0.0}).Solve(problem_.get());
    EXPECT_LT(LargestDifference(Values(), by_ceres), 1e-5);
    EXPECT_LT((equations.hessian - Linearise().hessian).norm(),
              1e-6 * equations.hessian.norm());
    MoveAway(mapped);
    EXPECT_GT(Linearise().cost, 1.1 * equations.cost);
    const ArrowheadEquations arrowhead =
        GaussNewtonSolver<ArrowheadEquations>({50, 1e-14, 0.0}).Solve(problem_.get());
    EXPECT_LT(LargestDifference(Values(), by_ceres), 1e-5);
    EXPECT_NEAR(arrowhead.cost, equations.cost, 1e-9 * equations.cost);
  }
}

// With the default options the tracker's estimate of every scan but the first one, the
// window's and the batch's final one are each a ceres::Solve.
TEST_F(CovarianceTest, CeresSolvesByDefault) {
  const int64_t before = NumCeresSolves();
  MapScenario(TiltedRig());
  const auto num_scans = static_cast<int64_t>(result_->scan_times_ns.size());
  const int64_t num_solves = NumCeresSolves() - before;
  EXPECT_GT(num_solves, num_scans);
  options_.window.solver = SolverKind::kGaussNewton;
  const int64_t before_batch = NumCeresSolves();
  MapScenario(TiltedRig());
  EXPECT_GE(NumCeresSolves() - before_batch, 1);
  EXPECT_LT(NumCeresSolves() - before_batch, 10);
}

// So far that groups are linearised anew, so near that the model tells the cost.
TEST_F(CovarianceTest, EndsWhereAnotherStepWouldFindLittle) {
  MapScenario(TiltedRig());
  const double least = Linearise().cost;
  const std::vector<double> mapped = Values();
  // What is left of the cost after no more than so many steps.
  const auto cost_after = [&](const SolverOptions& options) {
    MoveAway(mapped);
    for (const BlockId& block : problem_->Layout().blocks) {
      if (block.kind == BlockId::Kind::kPosition) problem_->unknowns().Data(block)[2] += 0.05;
    }
    return GaussNewtonSolver<ArrowheadEquations>(options).Solve(problem_.get()).cost;
  };
  const double after_one_step = cost_after({1, 0.0, 0.0});
  EXPECT_EQ(cost_after({50, 0.0, 0.01}), after_one_step) << "the model told the cost";
  EXPECT_LT(after_one_step, least + 0.01);
  EXPECT_LT(cost_after({50, 0.0, 0.0}), after_one_step);
}

// Verified or not: in both cases towards the solution.
TEST_F(CovarianceTest, SingleStepsLowerTheCost) {
  MapScenario(TiltedRig());
  const std::vector<double> mapped = Values();
  const double least = Linearise().cost;
  MoveAway(mapped);
  const double moved_away = Linearise().cost;
  GaussNewtonSolver<ArrowheadEquations>({1, 0.0, 0.0}).Solve(problem_.get());
  const std::vector<double> first_step = Values();
  MoveAway(mapped);
  TakeGaussNewtonStep(problem_.get());
  // Groups that were near enough have kept their linearisations.
  EXPECT_LT(LargestDifference(Values(), first_step), 1e-4);
  EXPECT_LT(Linearise().cost - least, 0.01 * (moved_away - least));

  // So far that the steps are verified.
  MoveAway(mapped);
  for (const BlockId& block : problem_->Layout().blocks) {
    if (block.kind == BlockId::Kind::kPosition) problem_->unknowns().Data(block)[2] += 0.2;
  }
  const double raised = Linearise().cost;
  TakeGaussNewtonStep(problem_.get());
  EXPECT_LT(Linearise().cost - least, 0.01 * (raised - least));
}

TEST_F(CovarianceTest, PlanesAgreeWithCeres) {
  MapScenario(TiltedRig());
  const MapCovariance covariance = MapCovariance::Of(*problem_);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::SPARSE_QR;
  ceres::Covariance oracle(options);
  const CeresProblem ceres_problem(*problem_, CeresProblem::Segments::kOneByOne);
  std::vector<std::pair<const double*, const double*>> pairs;
  std::vector<const double*> blocks;
  for (const int id : covariance.landmark_ids()) {
    blocks.push_back(problem_->unknowns().Data(LandmarkBlock(id)));
  }
  for (const double* a : blocks) {
    for (const double* b : blocks) pairs.emplace_back(a, b);
  }
  ASSERT_TRUE(oracle.Compute(pairs, ceres_problem.get()));
  ASSERT_GE(blocks.size(), 6u);
  for (size_t i = 0; i < blocks.size(); ++i) {
    for (size_t j = 0; j < blocks.size(); ++j) {
      const int rows = covariance.offsets()[i + 1] - covariance.offsets()[i];
      const int cols = covariance.offsets()[j + 1] - covariance.offsets()[j];
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> expected(rows,
                                                                                      cols);
      ASSERT_TRUE(oracle.GetCovarianceBlock(blocks[i], blocks[j], expected.data()));
      const Eigen::MatrixXd found = covariance.landmarks().block(
          covariance.offsets()[i], covariance.offsets()[j], rows, cols);
      EXPECT_LT((found - expected).norm(), 1e-5 * expected.norm() + 1e-14)
          << i << " " << j << "\n"
          << found << "\n"
          << expected;
    }
  }
}

// Against the dense inverse, whose rows are known; planar rigs have four rows a control point.
TEST_F(CovarianceTest, PosesAgreeWithTheDenseInverse) {
  std::vector<ScenarioScanner> horizontal = TiltedRig();
  for (ScenarioScanner& scanner : horizontal) scanner.rotation_deg = "0, 0, 20";
  for (const auto& scanners : {TiltedRig(), horizontal}) {
    MapScenario(scanners);
    const NormalEquations equations = Linearise();
    const MapCovariance covariance = MapCovariance::Of(*problem_);
    const Trajectory& trajectory = result_->state.trajectory;
    const int64_t time_ns = result_->scan_times_ns[result_->scan_times_ns.size() / 2];
    const Matrix6d found = covariance.PoseAt(trajectory, time_ns);
    const Eigen::Matrix3d expected = PositionAt(time_ns, equations, InverseOf(equations));
    EXPECT_LT((found.bottomRightCorner<3, 3>() - expected).norm(), 1e-4 * expected.norm());
    EXPECT_EQ(result_->planar, found(0, 0) == 0.0);
    EXPECT_GT(found(2, 2), 0.0);
  }
}

TEST_F(CovarianceTest, FindsTheSmallestEigenvalue) {
  MapScenario(TiltedRig());
  const NormalEquations equations = Linearise();
  std::vector<int> rows;
  for (int i = 0; i < equations.size(); ++i) {
    if (equations.hessian(i, i) > 0.0) rows.push_back(i);
  }
  Eigen::MatrixXd scaled = equations.hessian(rows, rows);
  const Eigen::VectorXd scale = scaled.diagonal().cwiseSqrt().cwiseInverse();
  scaled = scale.asDiagonal() * scaled * scale.asDiagonal();
  const Eigen::VectorXd expected =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled).eigenvalues();
  const MapCovariance covariance = MapCovariance::Of(*problem_);
  const std::vector<WeakDirection>& weak = covariance.weak_directions();
  ASSERT_EQ(weak.size(), 3u);
  EXPECT_NEAR(weak[0].eigenvalue / expected[0], 1.0, 1e-3);
  EXPECT_LE(weak[0].eigenvalue, weak[1].eigenvalue);
}

TEST_F(CovarianceTest, AFewCombinationsShowTheNoiseOfTheMotion) {
  MapScenario(TiltedRig(), 6.0);
  const MotionProfile assumed =
      MotionProfile::Uniform(MotionNoise::Of(options_.trajectory), result_->state.trajectory);
  const std::vector<MotionEvidence> evidence = FindMotionEvidence(
      assumed,
      *problem_,
      ArrowheadCholesky(LineariseArrowhead(*problem_, problem_->Layout()).hessian,
                        BorderElimination::kNested));
  // G of the heights' accelerations, without the few that random combinations share with other
  // kinds of motion.
  const Eigen::MatrixXd covariance = InverseOf(Linearise());
  std::vector<Eigen::RowVectorXd> rows;
  double residuals2 = 0.0;
  VisitFactors(*problem_,
               problem_->Layout(),
               FactorTerm::Kind::kPositionAcceleration,
               [&](const std::vector<int>& columns,
                   const Eigen::MatrixXd& jacobian,
                   const Eigen::VectorXd& residuals) {
                 rows.emplace_back(Eigen::RowVectorXd::Zero(covariance.cols()));
                 rows.back()(columns) = jacobian.row(2);
                 residuals2 += residuals[2] * residuals[2];
               });
  const auto num_knots = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd jacobian(num_knots, covariance.cols());
  for (Eigen::Index i = 0; i < num_knots; ++i) jacobian.row(i) = rows[static_cast<size_t>(i)];
  const Eigen::MatrixXd g = Eigen::MatrixXd::Identity(num_knots, num_knots) -
                            jacobian * covariance * jacobian.transpose();
  double weight = 0.0, squares = 0.0;
  for (const MotionEvidence& of_knot : evidence) {
    weight += of_knot.weight[kVertical];
    squares += of_knot.squares[kVertical];
  }
  // Eight combinations of n accelerations know their sums to sqrt(n / 4) at worst. Twice that,
  // and what is shared with other kinds.
  const double tolerance = std::sqrt(static_cast<double>(num_knots));
  EXPECT_NEAR(weight, g.squaredNorm(), tolerance);
  const double variance = std::pow(assumed.usual.density[kVertical], 2);
  EXPECT_NEAR(squares / variance, residuals2 - g.trace() + g.squaredNorm(), tolerance);
}

}  // namespace
}  // namespace plumbline

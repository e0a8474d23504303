#include "core/window/marginal_prior.h"

#include <gtest/gtest.h>

#include <random>

#include "core/estimation/block_layout.h"
#include "core/estimation/normal_equations.h"

namespace plumbline {
namespace {

// A wall some 60 m from the origin, first seen at this place along it.
Landmark MakeWall(int id, double angle, double along_m) {
  const Eigen::Vector3d normal(std::cos(angle), std::sin(angle), 0.0);
  const Eigen::Vector3d along(-normal.y(), normal.x(), 0.0);
  Landmark landmark = MakeVerticalLandmark(
      normal, 50.0 * normal + Eigen::Vector3d(0.3, 0.2, 0.0) + along_m * along);
  landmark.id = id;
  return landmark;
}

Eigen::Vector2d Parameters(const Landmark& landmark) {
  return {landmark.parameters[0], landmark.parameters[1]};
}

class MarginalPriorTest : public testing::Test {
 protected:
  Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd values(rows, columns);
    for (double& value : values.reshaped()) value = normal_(random_);
    return values;
  }

  // A position and the landmarks, about the values they have.
  MarginalPrior MakePrior() {
    std::map<BlockId, int> sizes = {{PositionBlock(0), 3}};
    for (const Landmark& landmark : landmarks_) {
      sizes[LandmarkBlock(landmark.id)] = landmark.num_parameters();
    }
    MarginalPrior prior;
    prior.equations = ZeroSystem(sizes);
    prior.at.push_back(Eigen::Vector3d::Zero());
    for (const Landmark& landmark : landmarks_) {
      prior.at.push_back(AnchoredParameters(landmark));
    }
    const Eigen::Index size = prior.equations.size();
    const Eigen::MatrixXd jacobian = Random(2 * size, size);
    prior.equations.hessian = jacobian.transpose() * jacobian;
    prior.equations.gradient = jacobian.transpose() * Random(2 * size, 1);
    return prior;
  }

  // The marginal prior's cost of a position and of the landmarks as they are, up to a
  // constant.
  static double Cost(const MarginalPrior& prior,
                     const Eigen::Vector3d& position,
                     const std::deque<Landmark>& landmarks) {
    Eigen::VectorXd moved(prior.equations.size());
    for (size_t i = 0; i < prior.at.size(); ++i) {
      const BlockId& block = prior.equations.blocks[i];
      const Eigen::VectorXd now =
          IsLandmark(block) ? AnchoredParameters(landmarks[static_cast<size_t>(block.index)])
                            : Eigen::VectorXd(position);
      moved.segment(prior.equations.offsets[i], now.size()) = now - prior.at[i];
    }
    return prior.equations.gradient.dot(moved) +
           0.5 * moved.dot(prior.equations.hessian * moved);
  }

  std::mt19937_64 random_{3};
  std::normal_distribution<double> normal_;
  std::deque<Landmark> landmarks_;
};

TEST_F(MarginalPriorTest, AnchoredParametersAndBack) {
  for (Landmark landmark :
       {MakeWall(0, 0.7, 3.0), MakeHorizontalLandmark(-1.0, {1.0, 2.0, 3.0})}) {
    const std::array<double, 3> parameters = landmark.parameters;
    const Eigen::VectorXd anchored = AnchoredParameters(landmark);
    landmark.parameters = {};
    SetFromAnchored(anchored, &landmark);
    for (size_t k = 0; k < 2; ++k) EXPECT_NEAR(landmark.parameters[k], parameters[k], 1e-12);
  }
  EXPECT_NEAR(AnchoredParameters(MakeWall(0, 0.7, 3.0))[1], 0.0, 1e-12);  // anchored on it
}

TEST_F(MarginalPriorTest, ParametersByAnchoredIsTheirDerivative) {
  const Landmark wall = MakeWall(0, 2.1, -4.0);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 2; ++k) {
    const auto at = [&](double step) {
      Landmark moved = wall;
      SetFromAnchored(AnchoredParameters(wall) + step * Eigen::Vector2d::Unit(k), &moved);
      return Parameters(moved);
    };
    const Eigen::Vector2d column = (at(kStep) - at(-kStep)) / (2.0 * kStep);
    EXPECT_LT((ParametersByAnchored(wall).col(k) - column).norm(), 1e-7);
  }
}

// Equations in both coordinates have the same solution, and covariances follow.
TEST_F(MarginalPriorTest, EquationsAndCovariancesChangeTogether) {
  landmarks_ = {MakeWall(0, 0.7, 3.0),
                MakeHorizontalLandmark(1.0, {0.0, 0.0, 0.0}),
                MakeWall(2, -2.0, 5.0)};
  NormalEquations equations = MakePrior().equations;
  Eigen::MatrixXd covariance = equations.hessian.inverse();
  const Eigen::VectorXd step = -covariance * equations.gradient;
  EquationsToAnchored(landmarks_, &equations);
  CovarianceToAnchored(landmarks_, equations, &covariance);
  EXPECT_LT((covariance * equations.hessian -
             Eigen::MatrixXd::Identity(equations.size(), equations.size()))
                .norm(),
            1e-9);
  const Eigen::VectorXd anchored_step = -covariance * equations.gradient;
  EXPECT_LT((step.head<3>() - anchored_step.head<3>()).norm(), 1e-9);
  const int row = equations.offsets[3];
  const Eigen::Matrix2d by_anchored = ParametersByAnchored(landmarks_[2]);
  EXPECT_LT((step.segment<2>(row) - by_anchored * anchored_step.segment<2>(row)).norm(), 1e-8);
}

// Two copies of a plane, one of them turned by 7 degrees: as one plane they cost what they did
// as two equal ones, wherever it lies near the value that the marginal prior has for it.
TEST_F(MarginalPriorTest, MergedPlanesCostWhatTwoEqualOnesDo) {
  Landmark roof = MakeGeneralLandmark({-0.48, 0.36, -0.8}, {30.0, 40.0, 5.0});
  Landmark turned_roof =
      MakeGeneralLandmark(Eigen::Vector3d(-0.58, 0.36, -0.8).normalized(), {33.0, 41.0, 4.0});
  turned_roof.id = 1;
  const std::deque<Landmark> walls = {MakeWall(0, 0.70, 0.0), MakeWall(1, 0.82, 3.0)};
  for (const std::deque<Landmark>& pair : {walls, {roof, turned_roof}}) {
    for (const bool both_known : {true, false}) {
      landmarks_ = pair;
      if (!both_known) landmarks_.pop_front();  // nothing of the first one yet
      MarginalPrior prior = MakePrior();
      landmarks_ = pair;
      const MarginalPrior before = prior;
      const Landmark& plane = landmarks_[both_known ? 0 : 1];
      const auto cost = [&](const MarginalPrior& of, const Eigen::VectorXd& step) {
        Landmark moved = plane;
        SetFromAnchored(AnchoredParameters(plane) + step, &moved);
        std::deque<Landmark> both = landmarks_;
        for (Landmark& landmark : both) landmark.SetPlane(moved.Normal(), moved.Distance());
        return Cost(of, {0.1, -0.2, 0.3}, both);
      };
      const Reanchoring change = MergePlanes(landmarks_[0], landmarks_[1], &prior);
      EXPECT_EQ(prior.equations.blocks.back(), LandmarkBlock(0));
      EXPECT_EQ(change.shift.isZero(1e-9), !both_known);
      const int size = plane.num_parameters();
      const Eigen::VectorXd unmoved = Eigen::VectorXd::Zero(size);
      const double before_unmoved = cost(before, unmoved);
      const double constant = cost(prior, unmoved) - before_unmoved;
      for (int k = 0; k < size; ++k) {
        const Eigen::VectorXd step = 1e-4 * Eigen::VectorXd::Unit(size, k);
        const double change_before = cost(before, step) - before_unmoved;
        EXPECT_NEAR(cost(prior, step) - constant - before_unmoved,
                    change_before,
                    2e-3 * std::abs(change_before) + 1e-6);
      }
    }
  }
}

// The gauge's wall does not turn: what has turned and become it has no say in its heading.
TEST_F(MarginalPriorTest, HeldHeadingHasNoEquations) {
  landmarks_ = {MakeWall(0, 0.0, 0.0), MakeWall(1, 0.05, 2.0)};
  landmarks_[0].heading_fixed = true;
  MarginalPrior prior = MakePrior();
  MergePlanes(landmarks_[0], landmarks_[1], &prior);
  const int row = prior.equations.offsets[1];
  EXPECT_EQ(prior.equations.hessian.row(row).norm(), 0.0);
  EXPECT_EQ(prior.equations.hessian.col(row).norm(), 0.0);
  EXPECT_EQ(prior.equations.gradient[row], 0.0);
  EXPECT_GT(prior.equations.hessian(row + 1, row + 1), 0.0);
}

}  // namespace
}  // namespace plumbline

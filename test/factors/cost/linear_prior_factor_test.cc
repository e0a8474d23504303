#include "factors/cost/linear_prior_factor.h"

#include <gtest/gtest.h>

#include "factors/manifold/anchored_plane.h"
#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"
#include "test/testing/factor_testing.h"

namespace plumbline {
namespace {

using Kind = LinearPrior::Kind;

// Blocks of kinds that need no anchor; 3 + 1 + 2 = 6 tangents.
LinearPrior MixedPrior(TestRandom* random) {
  LinearPrior prior;
  prior.blocks.push_back({Kind::kRotation, 4, random->Rotation(2.0).coeffs()});
  prior.blocks.push_back({Kind::kYawRotation, 4, random->Rotation(0.5).coeffs()});
  prior.blocks.push_back({Kind::kEuclidean, 2, Eigen::Vector2d(1.0, -4.0)});
  prior.root.resize(5, 6);
  for (double& value : prior.root.reshaped()) value = random->Uniform(-2.0, 2.0);
  prior.offset = Eigen::VectorXd::LinSpaced(5, -1.0, 1.0);
  return prior;
}

// The blocks moved away from where they were linearised.
TestBlocks MovedBlocks(const LinearPrior& prior, const Eigen::VectorXd& tangent) {
  const auto add = [](TestBlocks* blocks,
                      const Eigen::VectorXd& x0,
                      const Eigen::VectorXd& delta,
                      std::unique_ptr<ceres::Manifold> manifold) {
    Eigen::VectorXd x(x0.size());
    manifold->Plus(x0.data(), delta.data(), x.data());
    blocks->Add(x, std::move(manifold));
  };
  TestBlocks blocks;
  add(&blocks, prior.blocks[0].x0, tangent.segment(0, 3), CreateRotationManifold());
  add(&blocks, prior.blocks[1].x0, tangent.segment(3, 1), CreateYawManifold());
  blocks.AddEuclidean(prior.blocks[2].x0 + tangent.segment(4, 2));
  return blocks;
}

TEST(LinearPriorFactor, IsLinearInTheTangent) {
  TestRandom random(1);
  const LinearPrior prior = MixedPrior(&random);
  const auto factor = CreateLinearPriorFactor(prior);
  ASSERT_EQ(factor->num_residuals(), 5);
  Eigen::VectorXd tangent(6);
  tangent << 0.3, -0.5, 0.2, 0.9, 3.0, -2.0;
  for (const double scale : {0.0, 1e-6, 1.0}) {
    const Eigen::VectorXd expected = prior.offset + prior.root * (scale * tangent);
    const TestBlocks blocks = MovedBlocks(prior, scale * tangent);
    EXPECT_LT((blocks.Residuals(*factor) - expected).norm(), 1e-13) << scale;
    blocks.ExpectGradientsCorrect(*factor);
  }
}

TEST(LinearPriorFactor, JacobianAtTheLinearisationPointIsTheRoot) {
  TestRandom random(2);
  const LinearPrior prior = MixedPrior(&random);
  const TestBlocks blocks = MovedBlocks(prior, Eigen::VectorXd::Zero(6));
  EXPECT_LT((blocks.TangentJacobian(*CreateLinearPriorFactor(prior)) - prior.root).norm(),
            1e-13);
}

TEST(LinearPriorFactor, FarRotations) {
  TestRandom random(3);
  const LinearPrior prior = MixedPrior(&random);
  Eigen::VectorXd tangent(6);
  tangent << 1.5, -2.0, 1.2, 3.0, 0.0, 0.0;
  MovedBlocks(prior, tangent).ExpectGradientsCorrect(*CreateLinearPriorFactor(prior));
}

TEST(LinearPriorFactor, SignOfTheQuaternionDoesNotMatter) {
  TestRandom random(4);
  const LinearPrior prior = MixedPrior(&random);
  const auto factor = CreateLinearPriorFactor(prior);
  TestBlocks blocks = MovedBlocks(prior, Eigen::VectorXd::Constant(6, 0.1));
  const Eigen::VectorXd residuals = blocks.Residuals(*factor);
  blocks[0] *= -1.0;
  blocks[1] *= -1.0;
  EXPECT_LT((blocks.Residuals(*factor) - residuals).norm(), 1e-13);
}

// What is known of a wall 60 m away from the origin, of whose direction hardly anything is, is
// where its one segment lies.
TEST(LinearPriorFactor, VerticalPlanesTurnAboutTheirAnchor) {
  const Eigen::Vector2d anchor(30.0, -52.0);
  const Eigen::Vector2d x0(0.4, 0.02);
  LinearPrior prior;
  prior.blocks.push_back({Kind::kVerticalPlane, 2, x0, anchor});
  prior.root = Eigen::Vector2d(0.1, 1000.0).asDiagonal();
  prior.offset = Eigen::Vector2d::Zero();
  const auto factor = CreateLinearPriorFactor(prior);
  for (const double turn : {0.0, 1e-3, 0.3}) {
    TestBlocks blocks;
    blocks.AddEuclidean(
        AnchoredFromPlane(Eigen::Vector2d(x0 + Eigen::Vector2d(turn, 0.001)), -anchor));
    EXPECT_LT((blocks.Residuals(*factor) - Eigen::Vector2d(0.1 * turn, 1.0)).norm(), 1e-9);
    blocks.ExpectGradientsCorrect(*factor);
  }
}

}  // namespace
}  // namespace plumbline

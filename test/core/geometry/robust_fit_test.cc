#include "core/geometry/robust_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace plumbline {
namespace {

using Eigen::Vector2d;

// The derivative of a loss, over the residual, is its weight.
template <typename Loss>
double WeightOf(const Loss& loss, double residual) {
  constexpr double kStep = 1e-6;
  return (loss(residual + kStep) - loss(residual - kStep)) / (2.0 * kStep * residual);
}

TEST(RobustWeights, AreThoseOfTheirLosses) {
  constexpr double kScale = 0.3;
  for (const double residual : {0.01, 0.1, -0.25, 0.29, 0.7}) {
    const double ratio = residual / kScale;
    EXPECT_NEAR(CauchyWeight(residual, kScale),
                WeightOf(
                    [](double r) {
                      return 0.5 * kScale * kScale * std::log1p(r * r / (kScale * kScale));
                    },
                    residual),
                1e-6);
    EXPECT_NEAR(
        GemanMcClureWeight(residual, kScale),
        WeightOf([](double r) { return 0.5 * r * r / (1.0 + r * r / (kScale * kScale)); },
                 residual),
        1e-6);
    EXPECT_NEAR(TukeyWeight(residual, kScale),
                std::abs(ratio) > 1.0
                    ? 0.0
                    : WeightOf(
                          [](double r) {
                            const double left = 1.0 - r * r / (kScale * kScale);
                            return kScale * kScale / 6.0 * (1.0 - left * left * left);
                          },
                          residual),
                1e-6);
  }
}

// Points of a line y = a + b x, and one stray.
TEST(RobustFit, FindsALineInSpiteOfAStray) {
  Vector2d line = Vector2d::Zero();
  for (int step = 0; step < 30; ++step) {
    RobustFit<2> fit;
    for (int x = 0; x < 10; ++x) {
      const double y = x == 4 ? 9.0 : 1.0 + 0.5 * x;
      const double residual = line[0] + line[1] * x - y;
      fit.Add({1.0, x}, residual, TukeyWeight(residual, step < 10 ? 20.0 : 1.0));
    }
    line += fit.Step();
  }
  EXPECT_LT((line - Vector2d(1.0, 0.5)).norm(), 1e-9);
}

TEST(RobustFit, APriorHoldsWhatResidualsLeaveOpen) {
  RobustFit<2> fit;
  fit.Add({1.0, 0.0}, -3.0, 1e9);
  fit.AddPrior(Eigen::Matrix2d::Identity(), Vector2d(0.0, 2.0));
  EXPECT_LT((fit.Step() - Vector2d(3.0, -2.0)).norm(), 1e-6);
  EXPECT_NEAR(fit.hessian()(1, 1), 1.0, 1e-12);
}

}  // namespace
}  // namespace plumbline

#include "test/testing/factor_testing.h"

#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include <utility>

#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"

namespace plumbline {

double TestRandom::Uniform(double min, double max) {
  return std::uniform_real_distribution<double>(min, max)(engine_);
}

Eigen::Vector3d TestRandom::Vector(double max_abs) {
  const double x = Uniform(-max_abs, max_abs);
  const double y = Uniform(-max_abs, max_abs);
  return {x, y, Uniform(-max_abs, max_abs)};
}

Eigen::Quaterniond TestRandom::Rotation(double angle) {
  return Exp(angle * Vector(1.0).normalized());
}

void TestBlocks::AddRotation(const Eigen::Quaterniond& q) {
  Add(q.coeffs(), CreateRotationManifold());
}

void TestBlocks::AddEuclidean(const Eigen::VectorXd& x) { Add(x, nullptr); }

PlaneChart TestRandom::Chart() {
  PlaneChart chart;
  chart.sign = -1.0;
  chart.axes = Rotation(2.0).toRotationMatrix();
  chart.anchor = Vector(3.0);
  return chart;
}

void TestBlocks::Add(const Eigen::VectorXd& x, std::unique_ptr<ceres::Manifold> manifold) {
  values_.push_back(x);
  manifolds_.push_back(std::move(manifold));
}

void TestBlocks::AddSpline(int num_control_points, double step, TestRandom* random) {
  Eigen::Quaterniond q = random->Rotation(2.0);
  for (int j = 0; j < num_control_points; ++j) {
    AddRotation(q);
    q = random->Rotation(step) * q;
  }
  for (int j = 0; j < num_control_points; ++j) AddEuclidean(random->Vector(3.0));
}

std::vector<const double*> TestBlocks::pointers() const {
  std::vector<const double*> pointers;
  for (const Eigen::VectorXd& value : values_) pointers.push_back(value.data());
  return pointers;
}

void TestBlocks::ExpectGradientsCorrect(const ceres::CostFunction& factor,
                                        double tolerance) const {
  std::vector<const ceres::Manifold*> manifolds;
  for (const auto& manifold : manifolds_) manifolds.push_back(manifold.get());
  ceres::NumericDiffOptions options;
  options.ridders_relative_initial_step_size = 1e-3;  // stays on one side of a turn of pi
  const ceres::GradientChecker checker(&factor, &manifolds, options);
  ceres::GradientChecker::ProbeResults results;
  checker.Probe(pointers().data(), 1e-9, &results);
  ASSERT_TRUE(results.return_value) << results.error_log;
  for (size_t i = 0; i < values_.size(); ++i) {
    const Eigen::MatrixXd& exact = results.local_jacobians[i];
    const Eigen::MatrixXd& numeric = results.local_numeric_jacobians[i];
    EXPECT_LE((exact - numeric).cwiseAbs().maxCoeff(),
              tolerance * std::max(1.0, numeric.cwiseAbs().maxCoeff()))
        << "block " << i << "\n"
        << exact << "\nnumeric\n"
        << numeric;
  }
}

Eigen::VectorXd TestBlocks::Residuals(const ceres::CostFunction& factor) const {
  Eigen::VectorXd residuals(factor.num_residuals());
  EXPECT_TRUE(factor.Evaluate(pointers().data(), residuals.data(), nullptr));
  return residuals;
}

Eigen::MatrixXd TestBlocks::TangentJacobian(const ceres::CostFunction& factor,
                                            Eigen::VectorXd* at) const {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const Eigen::Index rows = factor.num_residuals();
  Eigen::VectorXd residuals(rows);
  std::vector<Eigen::VectorXd> storage;
  std::vector<double*> jacobians;
  Eigen::Index columns = 0;
  for (size_t i = 0; i < values_.size(); ++i) {
    storage.emplace_back(Eigen::VectorXd::Zero(rows * values_[i].size()));
    jacobians.push_back(storage.back().data());
    columns += manifolds_[i] ? manifolds_[i]->TangentSize() : values_[i].size();
  }
  EXPECT_TRUE(factor.Evaluate(pointers().data(), residuals.data(), jacobians.data()));
  if (at != nullptr) *at = residuals;
  Eigen::MatrixXd result(rows, columns);
  Eigen::Index column = 0;
  for (size_t i = 0; i < values_.size(); ++i) {
    const Eigen::Index size = values_[i].size();
    const Eigen::Map<const RowMajor> ambient(jacobians[i], rows, size);
    const Eigen::Index tangent = manifolds_[i] ? manifolds_[i]->TangentSize() : size;
    RowMajor plus = RowMajor::Identity(size, tangent);
    if (manifolds_[i]) manifolds_[i]->PlusJacobian(values_[i].data(), plus.data());
    result.middleCols(column, tangent) = ambient * plus;
    column += tangent;
  }
  return result;
}

}  // namespace plumbline

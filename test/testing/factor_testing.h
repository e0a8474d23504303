#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <random>
#include <vector>

#include "factors/manifold/plane_model.h"

namespace plumbline {

// Random numbers that are the same on every run of a test.
class TestRandom {
 public:
  explicit TestRandom(unsigned seed) : engine_(seed) {}

  double Uniform(double min, double max);
  Eigen::Vector3d Vector(double max_abs);  // each component
  // Turned from the identity by max_angle about a random axis.
  Eigen::Quaterniond Rotation(double angle);
  // A ceiling's sign; axes turned by 2 rad and an anchor within 3 m of the origin.
  PlaneChart Chart();

 private:
  std::mt19937 engine_;
};

// The parameter blocks of one factor with the manifolds that Ceres would use for them.
class TestBlocks {
 public:
  void AddRotation(const Eigen::Quaterniond& q);
  void AddEuclidean(const Eigen::VectorXd& x);
  void Add(const Eigen::VectorXd& x, std::unique_ptr<ceres::Manifold> manifold);

  // num_control_points rotations with max_step rad between neighbours, starting anywhere, and
  // as many positions.
  void AddSpline(int num_control_points, double step, TestRandom* random);

  int size() const { return static_cast<int>(values_.size()); }
  Eigen::VectorXd& operator[](int i) { return values_[static_cast<size_t>(i)]; }
  std::vector<const double*> pointers() const;

  // Ceres' GradientChecker finds no difference, relative to the largest entry of a block.
  void ExpectGradientsCorrect(const ceres::CostFunction& factor,
                              double tolerance = 1e-7) const;

  Eigen::VectorXd Residuals(const ceres::CostFunction& factor) const;
  // Derivative by the tangents of all blocks.
  Eigen::MatrixXd TangentJacobian(const ceres::CostFunction& factor,
                                  Eigen::VectorXd* at = nullptr) const;

 private:
  std::vector<Eigen::VectorXd> values_;
  std::vector<std::unique_ptr<ceres::Manifold>> manifolds_;
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "factors/segment/segment_group.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// A group with its last linearisation: an orthogonal transformation of the segments' own
// residuals with the same cost, gradient and Gauss-Newton matrix, in no more rows than the
// group has unknowns, plus one. It stays in use while nothing has moved farther than its
// validity; then the group is linearised anew. Serves one thread at a time.
class LinearisedGroup {
 public:
  // How far rotations and planes may have turned and positions moved. What a linearisation
  // leaves out are products of two such changes: with kFine less than 0.01 mm for every point
  // within 30 m, with kCoarse 0.2 mm.
  struct Validity {
    double turn_rad;
    double shift_m;
  };
  static constexpr Validity kFine = {5e-4, 0.01};
  static constexpr Validity kCoarse = {3e-3, 0.02};

  explicit LinearisedGroup(SegmentGroup group);

  void set_validity(const Validity& validity) { validity_ = validity; }

  const SegmentGroup& group() const { return group_; }
  // How often it has been linearised.
  int num_linearisations() const { return num_linearisations_; }
  // Whether the loss has changed nothing at the last linearisation, so that without it the
  // group would be the same.
  bool is_plain() const { return !has_outliers_; }

  // As ceres::CostFunction's, with group().size() + 1 residuals and the parameters of
  // SegmentGroup::Linearise.
  void Evaluate(double const* const* parameters, double* residuals, double** jacobians);

  // The cost's quadratic model about these parameters (SegmentGroup::Quadratic), for solvers
  // of normal equations. A group keeps either what these ask for or Ceres' rows: asked for the
  // other one, it is linearised anew.
  struct Model {
    double cost;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;  // lower triangle
  };
  Model ModelAt(double const* const* parameters);

 private:
  int BlockSize(int block) const;
  // First of the group's rows that belong to a block.
  int FirstRow(int block) const;
  // Steps from the linearisation, in the group's rows; false where it is none or too far.
  bool Move(double const* const* parameters, Eigen::VectorXd* step) const;
  SegmentGroup::Quadratic Linearise(double const* const* parameters);
  // For ModelAt.
  void KeepModel(const SegmentGroup::Quadratic& quadratic);
  Eigen::MatrixXd Hessian() const;
  // For Ceres' rows.
  void KeepRoot(const SegmentGroup::Quadratic& quadratic);
  Eigen::MatrixXd Root() const;

  SegmentGroup group_;
  Validity validity_ = kFine;
  std::vector<double> at_;
  // Of the model; valid unless packed_hessian_ is empty.
  double cost_ = 0.0;
  Eigen::VectorXd gradient_;
  std::vector<double> packed_hessian_;  // lower triangle, column by column
  // Row i of the root without the zeros in the first i variables of the order, row by row.
  std::vector<double> packed_root_;
  std::vector<int> order_;
  Eigen::VectorXd offset_;
  double rest_ = 0.0;  // the residual that no unknown can lower
  bool has_outliers_ = false;
  int num_linearisations_ = 0;
};

// Ceres' view of a group.
// Blocks: [ q_0 .. q_{m-1} | p_0 .. p_{m-1} | planes ]
std::unique_ptr<ceres::CostFunction> CreateSegmentGroupFactor(
    std::shared_ptr<LinearisedGroup> group);

}  // namespace plumbline

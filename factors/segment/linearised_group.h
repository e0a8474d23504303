#pragma once

#include <Eigen/Core>
#include <vector>

#include "factors/segment/segment_group.h"

namespace plumbline {

// A group with its last linearisation, a quadratic model of its cost. It stays in use while
// nothing has moved farther than its validity; then the group is linearised anew. Serves one
// thread at a time.
class LinearisedGroup {
 public:
  // Validity is the turn of rotations, planes and scanners and the shift of positions and
  // scanners up to which a linearisation is kept. What a linearisation leaves out are products
  // of two such changes: with kFine less than 0.01 mm for every point within 30 m, with
  // kCoarse 0.2 mm. A scanner's delay counts as the turn of a body that turns by 1 rad/s.
  struct Validity {
    double turn_rad;
    double shift_m;
  };
  static constexpr Validity kFine = {5e-4, 0.01};
  static constexpr Validity kCoarse = {3e-3, 0.02};

  // planes_held: planes and scanners are constant, the model is about the control points
  // alone.
  explicit LinearisedGroup(SegmentGroup group, bool planes_held = false);

  void set_validity(const Validity& validity) { validity_ = validity; }

  const SegmentGroup& group() const { return group_; }
  // Number of times that it has been linearised.
  int num_linearisations() const { return num_linearisations_; }
  // Whether the loss has changed nothing at the last linearisation, so that without it the
  // group would be the same.
  bool is_plain() const { return !has_outliers_; }

  // The cost's quadratic model about these parameters (SegmentGroup::Quadratic).
  struct Model {
    double cost;
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;  // lower triangle
  };
  Model ModelAt(double const* const* parameters);

  // The parameter blocks that the model is about, in the group's order, and their rows.
  int NumBlocks() const;
  int BlockSize(int block) const;
  int FirstRow(int block) const;
  bool IsRotation(int block) const { return block < group_.num_control_points(); }
  int NumRows() const {
    return planes_held_ ? 6 * group_.num_control_points() : group_.size();
  }

 private:
  // Steps from the linearisation, in the group's rows; false where it is none or too far.
  bool Move(double const* const* parameters, Eigen::VectorXd* step) const;
  SegmentGroup::Quadratic Linearise(double const* const* parameters);
  void Keep(const SegmentGroup::Quadratic& quadratic);
  Eigen::MatrixXd Hessian() const;

  SegmentGroup group_;
  bool planes_held_;
  Validity validity_ = kFine;
  std::vector<double> at_;
  // The model at these parameters; there is none while packed_hessian_ is empty.
  double cost_ = 0.0;
  Eigen::VectorXd gradient_;
  std::vector<double> packed_hessian_;  // lower triangle, column by column
  bool has_outliers_ = false;
  int num_linearisations_ = 0;
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <vector>

#include "factors/plane_model.h"
#include "factors/segment_factor.h"

namespace ceres {
class CostFunction;
}

namespace plumbline {

// All segments of one stretch of the trajectory as one least squares term. Its cost is the sum
// of the segments' costs (CreateSegmentFactor, with Huber's loss where asked for); what they
// share, the spline's steps above all, is computed once, and whatever their number, a solver
// sees no more rows than the term has unknowns, plus one.
//
// Extrinsics are constant here: to estimate them, use the segments' own factors.
class SegmentGroup {
 public:
  struct Scanner {
    Eigen::Matrix3d body_from_scanner_rotation;
    Eigen::Vector3d body_from_scanner_translation;
  };
  struct Plane {
    PlaneModel model = PlaneModel::kVertical;
    double sign = 1.0;  // horizontal planes
  };
  struct Segment {
    const SegmentMeasurement* measurement = nullptr;  // outlives the group
    std::array<SplineNode, 3> nodes;
    int scanner = 0;  // position in scanners
    int plane = 0;    // position in planes
    SegmentWeights weights;
  };

  // Quadratic model at some parameters: cost(delta) = cost + gradient.delta + delta^T hessian
  // delta / 2. Rows: [ rotation tangents (3 each) | positions (3 each) | plane parameters ].
  struct Quadratic {
    double cost = 0.0;
    bool has_outliers = false;  // segments beyond Huber's width
    Eigen::VectorXd gradient;
    Eigen::MatrixXd hessian;  // lower triangle
  };

  // huber_width: in standard deviations of the norm of a segment's residuals; 0: plain least
  // squares.
  SegmentGroup(int num_control_points,
               std::vector<Scanner> scanners,
               std::vector<Plane> planes,
               std::vector<Segment> segments,
               double huber_width);

  int num_control_points() const { return num_control_points_; }
  const std::vector<Plane>& planes() const { return planes_; }
  // First row of a plane's parameters; the last element is the number of rows.
  const std::vector<int>& plane_offsets() const { return plane_offsets_; }
  int size() const { return plane_offsets_.back(); }

  // parameters: [ q_0 .. q_{m-1} | p_0 .. p_{m-1} | planes ]. Gauss-Newton, each segment
  // weighted by its loss' first derivative.
  void Linearise(double const* const* parameters, Quadratic* quadratic) const;

 private:
  int num_control_points_;
  std::vector<Scanner> scanners_;
  std::vector<Plane> planes_;
  std::vector<int> plane_offsets_;
  std::vector<Segment> segments_;  // by their first node
  double huber_width_;
};

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

 private:
  int BlockSize(int block) const;
  // Steps from the linearisation, in the group's rows; false where it is none or too far.
  bool Move(double const* const* parameters, Eigen::VectorXd* step) const;
  void Linearise(double const* const* parameters);

  SegmentGroup group_;
  Validity validity_ = kFine;
  std::vector<double> at_;
  Eigen::MatrixXd root_;
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

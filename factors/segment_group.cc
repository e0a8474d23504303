#include "factors/segment_group.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "factors/manifolds.h"
#include "factors/schur.h"
#include "factors/segment_node.h"
#include "factors/spline.h"

namespace plumbline {
namespace {

constexpr int kNumNodes = 3;
constexpr int kMaxControlPoints = 6;
constexpr int kPoseSize = 6;
// A direction of which less than this share of its variables' information is left belongs to
// rounding.
constexpr double kRankTolerance = 1e-13;

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Steps = std::array<RotationStep, kMaxControlPoints - 1>;

// g at the segment's nodes, and its derivatives by [ rotation tangent and position of the
// node's own pose | plane ].
template <int kPlaneSize>
struct NodeDerivatives {
  Eigen::Matrix<double, 9, 1> g;
  Eigen::Matrix<double, 9, kPoseSize + kPlaneSize, Eigen::RowMajor> by_node;
  std::array<SplinePoseJacobian, kNumNodes> splines;
};

template <typename Plane>
void Differentiate(const SegmentGroup::Segment& segment,
                   const SegmentGroup::Scanner& scanner,
                   const Steps& steps,
                   double const* const* q,
                   double const* const* p,
                   const ceres::Jet<double, kPoseSize + Plane::kSize> normal[3],
                   const ceres::Jet<double, kPoseSize + Plane::kSize>& distance,
                   NodeDerivatives<Plane::kSize>* result) {
  using T = ceres::Jet<double, kPoseSize + Plane::kSize>;
  T opposite_tangent[3];
  for (int i = 0; i < 3; ++i) opposite_tangent[i] = -T(0.0, i);
  for (int k = 0; k < segment.measurement->num_nodes; ++k) {
    const SplineNode& node = segment.nodes[static_cast<size_t>(k)];
    const SplinePose pose = EvaluatePose(&steps[static_cast<size_t>(node.first)],
                                         q[node.first],
                                         p + node.first,
                                         node.u,
                                         &result->splines[static_cast<size_t>(k)]);
    T position[3];
    T g[3];
    for (int i = 0; i < 3; ++i) position[i] = T(pose.position[i], 3 + i);
    NodeGeometry<T, double>(pose.world_from_body.toRotationMatrix(),
                            opposite_tangent,
                            position,
                            scanner.body_from_scanner_rotation.col(0).data(),
                            scanner.body_from_scanner_rotation.col(1).data(),
                            scanner.body_from_scanner_translation.data(),
                            normal,
                            distance,
                            g);
    for (int i = 0; i < 3; ++i) {
      result->g[3 * k + i] = g[i].a;
      result->by_node.row(3 * k + i) = g[i].v.transpose();
    }
  }
}

// Writes the segment's whitened Jacobian into rows of the group's, which are zero before.
// Columns: [ rotation tangents | positions | this plane ].
template <int kPlaneSize>
void WriteRows(const SegmentGroup::Segment& segment,
               int num_control_points,
               const NodeDerivatives<kPlaneSize>& derivatives,
               Eigen::Ref<RowMajorMatrix> rows) {
  const auto& root = segment.measurement->root;
  const double scale = segment.weights.scale;
  const Eigen::Index num_rows = root.rows();
  const int positions = 3 * num_control_points;
  for (int k = 0; k < segment.measurement->num_nodes; ++k) {
    const int first = segment.nodes[static_cast<size_t>(k)].first;
    const SplinePoseJacobian& spline = derivatives.splines[static_cast<size_t>(k)];
    // Derivative of the residuals by the node's own pose.
    Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor, 9, kPoseSize> by_pose(
        num_rows, kPoseSize);
    by_pose.noalias() =
        (scale * root.template middleCols<3>(3 * k))
            .lazyProduct(derivatives.by_node.template block<3, kPoseSize>(3 * k, 0));
    for (int j = 0; j < kSplineOrder; ++j) {
      const Eigen::Matrix3d& rotation = spline.rotation_wrt_control[static_cast<size_t>(j)];
      const double weight = spline.position_weights[static_cast<size_t>(j)];
      double* const rotation_at = rows.data() + 3 * (first + j);
      double* const position_at = rows.data() + positions + 3 * (first + j);
      for (Eigen::Index row = 0; row < num_rows; ++row) {
        const double* const pose = by_pose.data() + row * kPoseSize;
        double* const out = rotation_at + row * rows.outerStride();
        double* const shift = position_at + row * rows.outerStride();
        for (int i = 0; i < 3; ++i) {
          out[i] +=
              pose[0] * rotation(0, i) + pose[1] * rotation(1, i) + pose[2] * rotation(2, i);
          shift[i] += weight * pose[3 + i];
        }
      }
    }
  }
  rows.template rightCols<kPlaneSize>() =
      (scale * root).lazyProduct(derivatives.by_node.template rightCols<kPlaneSize>());
}

}  // namespace

SegmentGroup::SegmentGroup(int num_control_points,
                           std::vector<Scanner> scanners,
                           std::vector<Plane> planes,
                           std::vector<Segment> segments,
                           double huber_width)
    : num_control_points_(num_control_points),
      scanners_(std::move(scanners)),
      planes_(std::move(planes)),
      plane_offsets_(1, 6 * num_control_points),
      segments_(std::move(segments)),
      huber_width_(huber_width) {
  CHECK_GE(num_control_points, kSplineOrder);
  CHECK_LE(num_control_points, kMaxControlPoints);
  for (const Plane& plane : planes_) {
    plane_offsets_.push_back(plane_offsets_.back() + PlaneModelSize(plane.model));
  }
  for (const Segment& segment : segments_) {
    CHECK(segment.scanner >= 0 && segment.scanner < static_cast<int>(scanners_.size()));
    CHECK(segment.plane >= 0 && segment.plane < static_cast<int>(planes_.size()));
    for (const SplineNode& node : segment.nodes) {
      CHECK(node.first >= 0 && node.first + kSplineOrder <= num_control_points) << node.first;
    }
  }
  std::stable_sort(segments_.begin(), segments_.end(), [](const auto& a, const auto& b) {
    return a.plane < b.plane;
  });
}

namespace {

// Whitened Jacobian and residuals of the segments begin .. end - 1, which lie on one plane,
// weighted by Huber's loss; returns their cost.
template <typename PlaneType>
double WriteSegments(const PlaneType& plane,
                     const double* plane_parameters,
                     const SegmentGroup::Segment* begin,
                     const SegmentGroup::Segment* end,
                     const std::vector<SegmentGroup::Scanner>& scanners,
                     const Steps& steps,
                     double const* const* q,
                     double const* const* p,
                     int num_control_points,
                     double huber_width,
                     RowMajorMatrix* jacobian,
                     Eigen::VectorXd* residuals) {
  constexpr int kPlaneSize = PlaneType::kSize;
  using T = ceres::Jet<double, kPoseSize + kPlaneSize>;
  T plane_jets[kPlaneSize], normal[3], distance;
  for (int i = 0; i < kPlaneSize; ++i) {
    plane_jets[i] = T(plane_parameters[i], kPoseSize + i);
  }
  plane.Evaluate(plane_jets, normal, &distance);
  NodeDerivatives<kPlaneSize> derivatives;
  double cost = 0.0;
  Eigen::Index at = 0;
  for (const SegmentGroup::Segment* segment = begin; segment != end; ++segment) {
    const SegmentMeasurement& measurement = *segment->measurement;
    const Eigen::Index count = measurement.root.rows();
    derivatives.g.setZero();
    derivatives.by_node.setZero();
    Differentiate<PlaneType>(*segment,
                             scanners[static_cast<size_t>(segment->scanner)],
                             steps,
                             q,
                             p,
                             normal,
                             distance,
                             &derivatives);
    auto rows = jacobian->middleRows(at, count);
    WriteRows(*segment, num_control_points, derivatives, rows);
    auto segment_residuals = residuals->segment(at, count);
    segment_residuals = segment->weights.scale * measurement.root.lazyProduct(derivatives.g);
    if (measurement.offset.size() > 0) {
      segment_residuals += segment->weights.offset * measurement.offset;
    }
    const double squared = segment_residuals.squaredNorm();
    if (huber_width > 0.0 && squared > huber_width * huber_width) {
      const double norm = std::sqrt(squared);
      cost += huber_width * (norm - 0.5 * huber_width);
      const double weight = std::sqrt(huber_width / norm);
      segment_residuals *= weight;
      rows *= weight;
    } else {
      cost += 0.5 * squared;
    }
    at += count;
  }
  return cost;
}

}  // namespace

void SegmentGroup::Linearise(double const* const* parameters, Quadratic* quadratic) const {
  const int num_poses = 6 * num_control_points_;
  double const* const* const q = parameters;
  double const* const* const p = parameters + num_control_points_;
  Steps steps;
  for (int j = 0; j + 1 < num_control_points_; ++j) {
    steps[static_cast<size_t>(j)] = MakeRotationStep(q[j], q[j + 1]);
  }
  quadratic->cost = 0.0;
  quadratic->gradient.setZero(size());
  quadratic->hessian.setZero(size(), size());
  RowMajorMatrix jacobian;
  Eigen::VectorXd residuals;
  for (size_t begin = 0; begin < segments_.size();) {
    const int plane_index = segments_[begin].plane;
    size_t end = begin;
    Eigen::Index num_rows = 0;
    for (; end < segments_.size() && segments_[end].plane == plane_index; ++end) {
      num_rows += segments_[end].measurement->root.rows();
    }
    const Plane& description = planes_[static_cast<size_t>(plane_index)];
    const int plane_size = PlaneModelSize(description.model);
    const int num_columns = num_poses + plane_size;
    jacobian.setZero(num_rows, num_columns);
    residuals.resize(num_rows);
    quadratic->cost +=
        VisitPlaneModel(description.model, description.sign, [&](const auto& plane) {
          return WriteSegments(plane,
                               parameters[2 * num_control_points_ + plane_index],
                               segments_.data() + begin,
                               segments_.data() + end,
                               scanners_,
                               steps,
                               q,
                               p,
                               num_control_points_,
                               huber_width_,
                               &jacobian,
                               &residuals);
        });
    const int offset = plane_offsets_[static_cast<size_t>(plane_index)];
    Eigen::MatrixXd product = Eigen::MatrixXd::Zero(num_columns, num_columns);
    product.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.transpose());
    const Eigen::VectorXd gradient = jacobian.transpose() * residuals;
    quadratic->hessian.topLeftCorner(num_poses, num_poses) +=
        product.topLeftCorner(num_poses, num_poses);
    quadratic->hessian.block(offset, 0, plane_size, num_poses) +=
        product.bottomLeftCorner(plane_size, num_poses);
    quadratic->hessian.block(offset, offset, plane_size, plane_size) +=
        product.bottomRightCorner(plane_size, plane_size);
    quadratic->gradient.head(num_poses) += gradient.head(num_poses);
    quadratic->gradient.segment(offset, plane_size) += gradient.tail(plane_size);
    begin = end;
  }
}

namespace {

class SegmentGroupCost final : public ceres::CostFunction {
 public:
  explicit SegmentGroupCost(SegmentGroup group) : group_(std::move(group)) {
    std::vector<int>* sizes = mutable_parameter_block_sizes();
    sizes->insert(sizes->end(), static_cast<size_t>(group_.num_control_points()), 4);
    sizes->insert(sizes->end(), static_cast<size_t>(group_.num_control_points()), 3);
    for (const SegmentGroup::Plane& plane : group_.planes()) {
      sizes->push_back(PlaneModelSize(plane.model));
    }
    set_num_residuals(group_.size() + 1);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    if (!IsCurrent(parameters)) Linearise(parameters);
    Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) = residuals_;
    if (jacobians == nullptr) return true;
    const int num_control_points = group_.num_control_points();
    const auto& sizes = parameter_block_sizes();
    int column = 0;
    for (size_t i = 0; i < sizes.size(); ++i) {
      const bool is_rotation = static_cast<int>(i) < num_control_points;
      const int tangent_size = is_rotation ? 3 : sizes[i];
      if (jacobians[i] != nullptr) {
        Eigen::Map<RowMajorMatrix> jacobian(jacobians[i], num_residuals(), sizes[i]);
        jacobian.bottomRows<1>().setZero();
        auto upper = jacobian.topRows(group_.size());
        if (is_rotation) {
          upper =
              root_.middleCols<3>(column).lazyProduct(RotationMinusJacobian(parameters[i]));
        } else {
          upper = root_.middleCols(column, tangent_size);
        }
      }
      column += tangent_size;
    }
    return true;
  }

 private:
  bool IsCurrent(double const* const* parameters) const {
    if (values_.empty()) return false;
    const double* value = values_.data();
    const auto& sizes = parameter_block_sizes();
    for (size_t i = 0; i < sizes.size(); value += sizes[i], ++i) {
      if (!std::equal(value, value + sizes[i], parameters[i])) return false;
    }
    return true;
  }

  // H = root^T root and g = root^T r_upper; the last residual is what no unknown can lower.
  void Linearise(double const* const* parameters) const {
    values_.clear();
    const auto& sizes = parameter_block_sizes();
    for (size_t i = 0; i < sizes.size(); ++i) {
      values_.insert(values_.end(), parameters[i], parameters[i] + sizes[i]);
    }
    SegmentGroup::Quadratic quadratic;
    group_.Linearise(parameters, &quadratic);
    residuals_.setZero(num_residuals());
    const MarginalisedSystem system =
        Marginalise(quadratic.hessian, quadratic.gradient, 0, kRankTolerance);
    root_.setZero(group_.size(), group_.size());
    root_.topRows(system.rank) = system.root;
    residuals_.head(system.rank) = system.offset;
    residuals_[group_.size()] =
        std::sqrt(std::max(0.0, 2.0 * quadratic.cost - system.offset.squaredNorm()));
  }

  SegmentGroup group_;
  // Of the last evaluation.
  mutable std::vector<double> values_;
  mutable RowMajorMatrix root_;
  mutable Eigen::VectorXd residuals_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateSegmentGroupFactor(SegmentGroup group) {
  return std::make_unique<SegmentGroupCost>(std::move(group));
}

}  // namespace plumbline

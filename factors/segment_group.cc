#include "factors/segment_group.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

#include "factors/manifolds.h"
#include "factors/schur.h"
#include "factors/segment_node.h"
#include "factors/so3.h"
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

constexpr int kLineSize = kNumNodes * kPoseSize;
using LineVector = Eigen::Matrix<double, kLineSize, 1>;
using LineMatrix = Eigen::Matrix<double, kLineSize, kLineSize, Eigen::RowMajor>;

// The poses at the nodes of a scan line.
struct NodePoses {
  std::array<Eigen::Matrix3d, kNumNodes> world_from_body;
  std::array<Eigen::Vector3d, kNumNodes> position;
  std::array<SplinePoseJacobian, kNumNodes> splines;
};

// Normal equations of a scan line's segments in the poses at its nodes, [ rotation tangent |
// position ] each, and in the planes' parameters.
struct LineSystem {
  LineMatrix poses;
  LineVector gradient;
  // Columns: planes' parameters.
  Eigen::Matrix<double, kLineSize, Eigen::Dynamic> cross;
  std::vector<bool> sees_plane;
};

// A segment's whitened residuals and their derivatives by [ poses at the nodes | plane ].
template <int kPlaneSize>
struct SegmentRows {
  static constexpr int kColumns = kLineSize + kPlaneSize;
  Eigen::Matrix<double, Eigen::Dynamic, kColumns, Eigen::RowMajor, 9, kColumns> jacobian;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 9, 1> residuals;
};

// A plane's normal and distance, differentiated by the parameters behind those of a pose.
template <typename Plane>
struct PlaneJets {
  using T = ceres::Jet<double, kPoseSize + Plane::kSize>;
  T normal[3];
  T distance;

  PlaneJets(const Plane& plane, const double* parameters) {
    T jets[Plane::kSize];
    for (int i = 0; i < Plane::kSize; ++i) jets[i] = T(parameters[i], kPoseSize + i);
    plane.Evaluate(jets, normal, &distance);
  }
};

template <typename Plane>
void Differentiate(const SegmentGroup::Segment& segment,
                   const SegmentGroup::Scanner& scanner,
                   const NodePoses& poses,
                   const PlaneJets<Plane>& plane,
                   SegmentRows<Plane::kSize>* rows) {
  using T = typename PlaneJets<Plane>::T;
  const SegmentMeasurement& measurement = *segment.measurement;
  const auto& root = measurement.root;
  rows->jacobian.setZero(root.rows(), SegmentRows<Plane::kSize>::kColumns);
  rows->residuals.setZero(root.rows());
  T opposite_tangent[3];
  for (int i = 0; i < 3; ++i) opposite_tangent[i] = -T(0.0, i);
  for (int k = 0; k < measurement.num_nodes; ++k) {
    const auto node = static_cast<size_t>(k);
    T position[3];
    T g[3];
    for (int i = 0; i < 3; ++i) position[i] = T(poses.position[node][i], 3 + i);
    NodeGeometry<T, double>(poses.world_from_body[node],
                            opposite_tangent,
                            position,
                            scanner.body_from_scanner_rotation.col(0).data(),
                            scanner.body_from_scanner_rotation.col(1).data(),
                            scanner.body_from_scanner_translation.data(),
                            plane.normal,
                            plane.distance,
                            g);
    for (Eigen::Index row = 0; row < root.rows(); ++row) {
      for (int i = 0; i < 3; ++i) {
        const double weight = segment.weights.scale * root(row, 3 * k + i);
        rows->residuals[row] += weight * g[i].a;
        rows->jacobian.template block<1, kPoseSize>(row, kPoseSize * k) +=
            weight * g[i].v.template head<kPoseSize>().transpose();
        rows->jacobian.template block<1, Plane::kSize>(row, kLineSize) +=
            weight * g[i].v.template tail<Plane::kSize>().transpose();
      }
    }
  }
  if (measurement.offset.size() > 0) {
    rows->residuals += segment.weights.offset * measurement.offset;
  }
}

// Weighs the rows by Huber's loss of their norm; returns the cost.
template <int kPlaneSize>
double Weigh(double huber_width, SegmentRows<kPlaneSize>* rows, bool* is_outlier) {
  const double squared = rows->residuals.squaredNorm();
  if (huber_width <= 0.0 || squared <= huber_width * huber_width) return 0.5 * squared;
  *is_outlier = true;
  const double norm = std::sqrt(squared);
  const double weight = std::sqrt(huber_width / norm);
  rows->residuals *= weight;
  rows->jacobian *= weight;
  return huber_width * (norm - 0.5 * huber_width);
}

// Adds a segment to the line's system and, for the plane alone, to the group's.
template <int kPlaneSize>
void AddRows(const SegmentRows<kPlaneSize>& rows,
             int plane_column,
             int plane_row,
             LineSystem* line,
             SegmentGroup::Quadratic* quadratic) {
  using PlaneMatrix = Eigen::Matrix<double, kPlaneSize, kPlaneSize>;
  PlaneMatrix plane = PlaneMatrix::Zero();
  for (Eigen::Index row = 0; row < rows.jacobian.rows(); ++row) {
    const Eigen::Matrix<double, 1, kLineSize> pose =
        rows.jacobian.template block<1, kLineSize>(row, 0);
    const Eigen::Matrix<double, 1, kPlaneSize> by_plane =
        rows.jacobian.template block<1, kPlaneSize>(row, kLineSize);
    const double residual = rows.residuals[row];
    for (int i = 0; i < kLineSize; ++i) line->poses.row(i) += pose[i] * pose;
    for (int i = 0; i < kPlaneSize; ++i) {
      line->cross.col(plane_column + i) += by_plane[i] * pose.transpose();
    }
    line->gradient += residual * pose.transpose();
    plane += by_plane.transpose() * by_plane;
    quadratic->gradient.template segment<kPlaneSize>(plane_row) +=
        residual * by_plane.transpose();
  }
  quadratic->hessian.template block<kPlaneSize, kPlaneSize>(plane_row, plane_row) += plane;
}

// The chain rule through the spline, from the nodes' poses to the control points: adds a
// line's system to the group's.
class Spread {
 public:
  // first: of the control points that each node uses.
  Spread(const std::array<int, kNumNodes>& first, const NodePoses& poses, int num_nodes)
      : first_(first), poses_(poses), num_nodes_(num_nodes) {}

  void Add(const LineSystem& line,
           const std::vector<int>& plane_offsets,
           int num_control_points,
           SegmentGroup::Quadratic* quadratic) const {
    const int positions = 3 * num_control_points;
    for (int k = 0; k < num_nodes_; ++k) {
      AddGradient(k, line, positions, quadratic);
      for (int l = 0; l < num_nodes_; ++l) AddPair(k, l, line, positions, quadratic);
    }
    for (size_t i = 0; i < line.sees_plane.size(); ++i) {
      if (!line.sees_plane[i]) continue;
      for (int row = plane_offsets[i]; row < plane_offsets[i + 1]; ++row) {
        AddCross(line.cross.col(row - plane_offsets[0]), row, positions, quadratic);
      }
    }
  }

 private:
  const Eigen::Matrix3d& Rotation(int node, int j) const {
    return poses_.splines[static_cast<size_t>(node)]
        .rotation_wrt_control[static_cast<size_t>(j)];
  }
  double Weight(int node, int j) const {
    return poses_.splines[static_cast<size_t>(node)].position_weights[static_cast<size_t>(j)];
  }
  int First(int node) const { return first_[static_cast<size_t>(node)]; }

  void AddGradient(int k,
                   const LineSystem& line,
                   int positions,
                   SegmentGroup::Quadratic* quadratic) const {
    for (int j = 0; j < kSplineOrder; ++j) {
      const int at = 3 * (First(k) + j);
      quadratic->gradient.segment<3>(at) +=
          Rotation(k, j).transpose() * line.gradient.segment<3>(kPoseSize * k);
      quadratic->gradient.segment<3>(positions + at) +=
          Weight(k, j) * line.gradient.segment<3>(kPoseSize * k + 3);
    }
  }

  // Lower triangle only.
  void AddPair(int k,
               int l,
               const LineSystem& line,
               int positions,
               SegmentGroup::Quadratic* quadratic) const {
    const Eigen::Matrix3d rotations = line.poses.block<3, 3>(kPoseSize * k, kPoseSize * l);
    const Eigen::Matrix3d mixed = line.poses.block<3, 3>(kPoseSize * k + 3, kPoseSize * l);
    const Eigen::Matrix3d both = line.poses.block<3, 3>(kPoseSize * k + 3, kPoseSize * l + 3);
    Eigen::MatrixXd& hessian = quadratic->hessian;
    for (int j = 0; j < kSplineOrder; ++j) {
      const int column = 3 * (First(l) + j);
      const Eigen::Matrix3d turned = rotations * Rotation(l, j);
      const Eigen::Matrix3d shifted = mixed * Rotation(l, j);
      for (int i = 0; i < kSplineOrder; ++i) {
        const int row = 3 * (First(k) + i);
        const double weight = Weight(k, i);
        hessian.block<3, 3>(positions + row, column) += weight * shifted;
        if (row < column) continue;
        hessian.block<3, 3>(row, column).noalias() += Rotation(k, i).transpose() * turned;
        hessian.block<3, 3>(positions + row, positions + column) +=
            weight * Weight(l, j) * both;
      }
    }
  }

  void AddCross(const LineVector& cross,
                int row,
                int positions,
                SegmentGroup::Quadratic* quadratic) const {
    for (int k = 0; k < num_nodes_; ++k) {
      for (int j = 0; j < kSplineOrder; ++j) {
        const int at = 3 * (First(k) + j);
        quadratic->hessian.block<1, 3>(row, at) +=
            cross.segment<3>(kPoseSize * k).transpose() * Rotation(k, j);
        quadratic->hessian.block<1, 3>(row, positions + at) +=
            Weight(k, j) * cross.segment<3>(kPoseSize * k + 3).transpose();
      }
    }
  }

  const std::array<int, kNumNodes> first_;
  const NodePoses& poses_;
  int num_nodes_;
};

bool SameNodes(const SegmentGroup::Segment& a, const SegmentGroup::Segment& b) {
  for (size_t k = 0; k < kNumNodes; ++k) {
    if (a.nodes[k].first != b.nodes[k].first || a.nodes[k].u != b.nodes[k].u) return false;
  }
  return a.measurement->num_nodes == b.measurement->num_nodes;
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
  // Those with the same nodes one after the other.
  std::stable_sort(segments_.begin(), segments_.end(), [](const auto& a, const auto& b) {
    return std::tie(a.nodes[0].first, a.nodes[0].u) < std::tie(b.nodes[0].first, b.nodes[0].u);
  });
}

void SegmentGroup::Linearise(double const* const* parameters, Quadratic* quadratic) const {
  double const* const* const q = parameters;
  double const* const* const p = parameters + num_control_points_;
  double const* const* const plane_parameters = parameters + 2 * num_control_points_;
  Steps steps;
  for (int j = 0; j + 1 < num_control_points_; ++j) {
    steps[static_cast<size_t>(j)] = MakeRotationStep(q[j], q[j + 1]);
  }
  quadratic->cost = 0.0;
  quadratic->has_outliers = false;
  quadratic->gradient.setZero(size());
  quadratic->hessian.setZero(size(), size());
  LineSystem line;
  NodePoses poses;
  for (size_t begin = 0; begin < segments_.size();) {
    const Segment& head = segments_[begin];
    std::array<int, kNumNodes> first;
    for (size_t k = 0; k < kNumNodes; ++k) {
      const SplineNode& node = head.nodes[k];
      const SplinePose pose = EvaluatePose(&steps[static_cast<size_t>(node.first)],
                                           q[node.first],
                                           p + node.first,
                                           node.u,
                                           &poses.splines[k]);
      poses.world_from_body[k] = pose.world_from_body.toRotationMatrix();
      poses.position[k] = pose.position;
      first[k] = node.first;
    }
    line.poses.setZero();
    line.gradient.setZero();
    line.cross.setZero(kLineSize, size() - plane_offsets_.front());
    line.sees_plane.assign(planes_.size(), false);
    size_t end = begin;
    for (; end < segments_.size() && SameNodes(head, segments_[end]); ++end) {
      const Segment& segment = segments_[end];
      const auto plane = static_cast<size_t>(segment.plane);
      line.sees_plane[plane] = true;
      VisitPlaneModel(planes_[plane].model, planes_[plane].sign, [&](const auto& model) {
        using Model = std::decay_t<decltype(model)>;
        SegmentRows<Model::kSize> rows;
        Differentiate(segment,
                      scanners_[static_cast<size_t>(segment.scanner)],
                      poses,
                      PlaneJets<Model>(model, plane_parameters[plane]),
                      &rows);
        quadratic->cost += Weigh(huber_width_, &rows, &quadratic->has_outliers);
        AddRows(rows,
                plane_offsets_[plane] - plane_offsets_.front(),
                plane_offsets_[plane],
                &line,
                quadratic);
      });
    }
    Spread(first, poses, head.measurement->num_nodes)
        .Add(line, plane_offsets_, num_control_points_, quadratic);
    begin = end;
  }
}

LinearisedGroup::LinearisedGroup(SegmentGroup group) : group_(std::move(group)) {}

int LinearisedGroup::BlockSize(int block) const {
  const int num_control_points = group_.num_control_points();
  if (block < num_control_points) return 4;
  if (block < 2 * num_control_points) return 3;
  return PlaneModelSize(
      group_.planes()[static_cast<size_t>(block - 2 * num_control_points)].model);
}

bool LinearisedGroup::Move(double const* const* parameters, Eigen::VectorXd* step) const {
  if (at_.empty()) return false;
  using Quaternion = Eigen::Map<const Eigen::Quaterniond>;
  step->resize(group_.size());
  const int num_control_points = group_.num_control_points();
  const int num_blocks = 2 * num_control_points + static_cast<int>(group_.planes().size());
  const double* at = at_.data();
  Eigen::Index row = 0;
  for (int i = 0; i < num_blocks; ++i) {
    const int size = BlockSize(i);
    if (i < num_control_points) {
      const Eigen::Vector3d turn = Log(Quaternion(parameters[i]) * Quaternion(at).conjugate());
      if (turn.squaredNorm() > validity_.turn_rad * validity_.turn_rad) return false;
      step->segment<3>(row) = turn;
      row += 3;
    } else {
      for (int k = 0; k < size; ++k) (*step)[row + k] = parameters[i][k] - at[k];
      // A plane's distance may move freely: the residuals are linear in it.
      const bool is_position = i < 2 * num_control_points;
      const double limit = is_position ? validity_.shift_m : validity_.turn_rad;
      const int num_limited = is_position ? size : size - 1;
      for (int k = 0; k < num_limited; ++k) {
        if (std::abs((*step)[row + k]) > limit) return false;
      }
      row += size;
    }
    at += size;
  }
  return true;
}

// H = root^T root and g = root^T offset.
void LinearisedGroup::Linearise(double const* const* parameters) {
  at_.clear();
  const int num_blocks =
      2 * group_.num_control_points() + static_cast<int>(group_.planes().size());
  for (int i = 0; i < num_blocks; ++i) {
    at_.insert(at_.end(), parameters[i], parameters[i] + BlockSize(i));
  }
  ++num_linearisations_;
  SegmentGroup::Quadratic quadratic;
  group_.Linearise(parameters, &quadratic);
  has_outliers_ = quadratic.has_outliers;
  MarginalisedSystem system =
      Marginalise(quadratic.hessian, quadratic.gradient, 0, kRankTolerance);
  rest_ = std::sqrt(std::max(0.0, 2.0 * quadratic.cost - system.offset.squaredNorm()));
  root_ = std::move(system.root);
  offset_ = std::move(system.offset);
}

void LinearisedGroup::Evaluate(double const* const* parameters,
                               double* residuals,
                               double** jacobians) {
  Eigen::VectorXd step;
  const bool is_near = Move(parameters, &step);
  if (!is_near) Linearise(parameters);
  const int num_residuals = group_.size() + 1;
  const Eigen::Index rank = root_.rows();
  Eigen::Map<Eigen::VectorXd> all(residuals, num_residuals);
  all.setZero();
  all.head(rank) = offset_;
  if (is_near) all.head(rank).noalias() += root_ * step;
  all[num_residuals - 1] = rest_;
  if (jacobians == nullptr) return;
  const int num_control_points = group_.num_control_points();
  const int num_blocks = 2 * num_control_points + static_cast<int>(group_.planes().size());
  Eigen::Index column = 0;
  for (int i = 0; i < num_blocks; ++i) {
    const int size = BlockSize(i);
    const bool is_rotation = i < num_control_points;
    const int tangent_size = is_rotation ? 3 : size;
    if (jacobians[i] != nullptr) {
      Eigen::Map<RowMajorMatrix> jacobian(jacobians[i], num_residuals, size);
      jacobian.bottomRows(num_residuals - rank).setZero();
      if (is_rotation) {
        jacobian.topRows(rank) =
            root_.middleCols<3>(column).lazyProduct(RotationMinusJacobian(parameters[i]));
      } else {
        jacobian.topRows(rank) = root_.middleCols(column, size);
      }
    }
    column += tangent_size;
  }
}

namespace {

class SegmentGroupCost final : public ceres::CostFunction {
 public:
  explicit SegmentGroupCost(std::shared_ptr<LinearisedGroup> group)
      : group_(std::move(group)) {
    const SegmentGroup& segments = group_->group();
    std::vector<int>* sizes = mutable_parameter_block_sizes();
    sizes->insert(sizes->end(), static_cast<size_t>(segments.num_control_points()), 4);
    sizes->insert(sizes->end(), static_cast<size_t>(segments.num_control_points()), 3);
    for (const SegmentGroup::Plane& plane : segments.planes()) {
      sizes->push_back(PlaneModelSize(plane.model));
    }
    set_num_residuals(segments.size() + 1);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    group_->Evaluate(parameters, residuals, jacobians);
    return true;
  }

 private:
  std::shared_ptr<LinearisedGroup> group_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateSegmentGroupFactor(
    std::shared_ptr<LinearisedGroup> group) {
  return std::make_unique<SegmentGroupCost>(std::move(group));
}

}  // namespace plumbline

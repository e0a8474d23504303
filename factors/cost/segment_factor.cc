#include "factors/cost/segment_factor.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <glog/logging.h>

#include <algorithm>
#include <type_traits>

#include "factors/manifold/manifolds.h"
#include "factors/segment/segment_measurement.h"
#include "factors/segment/segment_node.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

constexpr int kNumNodes = 3;
constexpr int kMaxControlPoints = 6;
constexpr int kMaxResiduals = 9;

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;
template <int kRows, int kCols>
using RowMajor = Eigen::Matrix<double, kRows, kCols, Eigen::RowMajor>;

template <typename Plane>
class SegmentCost final : public ceres::CostFunction {
 public:
  SegmentCost(const SegmentMeasurement& measurement,
              const std::array<SplineNode, kNumNodes>& nodes,
              int num_control_points,
              const Plane& plane,
              const SegmentWeights& weights)
      : root_(weights.scale * measurement.root()),
        offset_(weights.offset * measurement.offset()),
        centroid_(measurement.centroid),
        tangent_(measurement.tangent),
        nodes_(nodes),
        num_nodes_(measurement.num_nodes),
        num_control_points_(num_control_points),
        plane_(plane) {
    CHECK_GE(num_control_points, kSplineOrder);
    CHECK_LE(num_control_points, kMaxControlPoints);
    CHECK(num_nodes_ == 1 || num_nodes_ == kNumNodes) << num_nodes_;
    for (const SplineNode& node : nodes) {
      CHECK(node.first >= 0 && node.first + kSplineOrder <= num_control_points) << node.first;
    }
    std::vector<int>* sizes = mutable_parameter_block_sizes();
    sizes->insert(sizes->end(), num_control_points, 4);
    sizes->insert(sizes->end(), num_control_points, 3);
    sizes->insert(sizes->end(), {4, 3, Plane::kSize});
    distance_root_.resize(root_.rows(), kNumNodes);
    for (int k = 0; k < kNumNodes; ++k) distance_root_.col(k) = root_.col(3 * k + 2);
    bend_.resize(root_.rows() + 1);
    bend_ << measurement.bend(), measurement.bend_rest;
    bend_ *= weights.scale;
    rest_offset_ = weights.offset * measurement.bend_offset;
    set_num_residuals(static_cast<int>(root_.rows()) + (Plane::kIsCurved ? 1 : 0));
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const Blocks blocks(parameters, num_control_points_);
    if (jacobians == nullptr) {
      EvaluateResiduals(blocks, residuals);
    } else if (jacobians[blocks.extrinsics] || jacobians[blocks.extrinsics + 1]) {
      Linearise<true>(blocks, residuals, jacobians);
    } else {
      Linearise<false>(blocks, residuals, jacobians);
    }
    return true;
  }

 private:
  struct Blocks {
    Blocks(double const* const* parameters, int num_control_points)
        : q(parameters),
          p(parameters + num_control_points),
          extrinsics(2 * num_control_points),
          extrinsics_q(parameters[extrinsics]),
          extrinsics_t(parameters[extrinsics + 1]),
          plane(parameters[extrinsics + 2]),
          body_from_scanner(ConstQuaternion(extrinsics_q).toRotationMatrix()) {
      for (int j = 0; j + 1 < num_control_points; ++j) {
        steps[j] = MakeRotationStep(q[j], q[j + 1]);
      }
    }

    double const* const* q;
    double const* const* p;
    int extrinsics;  // position of the extrinsics' first block
    const double* extrinsics_q;
    const double* extrinsics_t;
    const double* plane;
    Eigen::Matrix3d body_from_scanner;
    std::array<RotationStep, kMaxControlPoints - 1> steps;
  };

  SplinePose Pose(const Blocks& blocks, int k, SplinePoseJacobian* jacobian) const {
    const SplineNode& node = nodes_[k];
    return EvaluatePose(&blocks.steps[node.first],
                        blocks.q[node.first],
                        blocks.p + node.first,
                        node.u,
                        jacobian);
  }

  void EvaluateResiduals(const Blocks& blocks, double* residuals) const {
    double normal[3], distance, point[3];
    if constexpr (!Plane::kIsCurved) plane_.Evaluate(blocks.plane, normal, &distance);
    const double no_tangent[3] = {0.0, 0.0, 0.0};
    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
    for (int k = 0; k < num_nodes_; ++k) {
      const SplinePose pose = Pose(blocks, k, nullptr);
      const Eigen::Matrix3d world_from_body = pose.world_from_body.toRotationMatrix();
      if constexpr (Plane::kIsCurved) {
        double axes[3][3];
        ScannerAxes(blocks, axes);
        Centroid<double, double>(
            world_from_body, no_tangent, pose.position.data(), axes, point);
        plane_.EvaluateAt(blocks.plane, point, normal, &distance);
      }
      NodeGeometry<double, double>(world_from_body,
                                   no_tangent,
                                   pose.position.data(),
                                   blocks.body_from_scanner.col(0).data(),
                                   blocks.body_from_scanner.col(1).data(),
                                   blocks.extrinsics_t,
                                   normal,
                                   distance,
                                   &g[3 * k]);
    }
    WriteResiduals(g, residuals);
    AddBow(blocks, residuals, nullptr);
  }

  // Derivatives of g with respect to [ rotation tangent and position of the node's own pose |
  // plane | extrinsics' rotation tangent and translation (kExtrinsics only) ].
  static constexpr int kPoseSize = 6;
  static constexpr int kExtrinsicsAt = kPoseSize + Plane::kSize;

  template <bool kExtrinsics>
  void Linearise(const Blocks& blocks, double* residuals, double** jacobians) const {
    constexpr int kSize = kExtrinsicsAt + (kExtrinsics ? 6 : 0);
    using T = ceres::Jet<double, kSize>;
    using E = std::conditional_t<kExtrinsics, T, double>;
    T plane_params[Plane::kSize], normal[3], distance, opposite_tangent[3], tangent[3],
        position[3], point[3], g_jet[3];
    for (int i = 0; i < Plane::kSize; ++i) {
      plane_params[i] = T(blocks.plane[i], kPoseSize + i);
    }
    for (int i = 0; i < 3; ++i) {
      tangent[i] = T(0.0, i);
      opposite_tangent[i] = -tangent[i];
    }
    if constexpr (!Plane::kIsCurved) plane_.Evaluate(plane_params, normal, &distance);
    E axes[3][3];  // x, y axis and origin of the scanner
    ScannerAxes(blocks, axes);

    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
    RowMajor<9, kSize> g_derivative;
    g_derivative.setZero();
    std::array<SplinePoseJacobian, kNumNodes> splines;
    for (int k = 0; k < num_nodes_; ++k) {
      const SplinePose pose = Pose(blocks, k, &splines[k]);
      const Eigen::Matrix3d world_from_body = pose.world_from_body.toRotationMatrix();
      for (int i = 0; i < 3; ++i) position[i] = T(pose.position[i], 3 + i);
      if constexpr (Plane::kIsCurved) {
        Centroid<T, E>(world_from_body, tangent, position, axes, point);
        plane_.EvaluateAt(plane_params, point, normal, &distance);
      }
      NodeGeometry<T, E>(world_from_body,
                         opposite_tangent,
                         position,
                         axes[0],
                         axes[1],
                         axes[2],
                         normal,
                         distance,
                         g_jet);
      for (int i = 0; i < 3; ++i) {
        g[3 * k + i] = g_jet[i].a;
        g_derivative.row(3 * k + i) = g_jet[i].v.transpose();
      }
    }

    WriteResiduals(g, residuals);
    WriteControlPoints(blocks, g_derivative, splines, jacobians);
    const int first = blocks.extrinsics;
    if constexpr (kExtrinsics) {
      const RowMajor<9, 4> rotation =
          g_derivative.template middleCols<3>(kExtrinsicsAt)
              .lazyProduct(RotationMinusJacobian(blocks.extrinsics_q));
      WriteJacobian<4>(root_, rotation, jacobians[first]);
      WriteJacobian<3>(
          root_, g_derivative.template middleCols<3>(kExtrinsicsAt + 3), jacobians[first + 1]);
    }
    WriteJacobian<Plane::kSize>(root_,
                                g_derivative.template middleCols<Plane::kSize>(kPoseSize),
                                jacobians[first + 2]);
    AddBow(blocks, residuals, jacobians[first + 2]);
  }

  // The segment's centroid in the world. tangent: turns the body.
  template <typename T, typename E>
  void Centroid(const Eigen::Matrix3d& world_from_body,
                const T tangent[3],
                const T position[3],
                const E axes[3][3],
                T point[3]) const {
    E in_body[3], from_body[3];
    for (int i = 0; i < 3; ++i) {
      in_body[i] = centroid_.x() * axes[0][i] + centroid_.y() * axes[1][i] + axes[2][i];
    }
    for (int i = 0; i < 3; ++i) from_body[i] = Dot(in_body, world_from_body.row(i));
    TurnSlightly(tangent, from_body, point);
    for (int i = 0; i < 3; ++i) point[i] += position[i];
  }

  // The bow of the segment itself, where the surface bends (SegmentMeasurement). That it
  // becomes flatter as the rig tilts is of second order.
  void AddBow(const Blocks& blocks, double* residuals, double* plane_jacobian) const {
    if constexpr (Plane::kIsCurved) {
      const SplinePose pose = Pose(blocks, num_nodes_ == 1 ? 0 : 1, nullptr);
      const Eigen::Vector3d along =
          pose.world_from_body * (blocks.body_from_scanner.template leftCols<2>() * tangent_);
      const double level2 = along.head<2>().squaredNorm();
      residuals[bend_.size() - 1] = rest_offset_;
      for (Eigen::Index row = 0; row < bend_.size(); ++row) {
        const double bow = level2 * bend_[row];
        residuals[row] += blocks.plane[Plane::kCurvatureAt] * bow;
        if (plane_jacobian == nullptr) continue;
        plane_jacobian[row * Plane::kSize + Plane::kCurvatureAt] += bow;
      }
    }
  }

  static void ScannerAxes(const Blocks& blocks, double axes[3][3]) {
    for (int i = 0; i < 3; ++i) {
      axes[0][i] = blocks.body_from_scanner(i, 0);
      axes[1][i] = blocks.body_from_scanner(i, 1);
      axes[2][i] = blocks.extrinsics_t[i];
    }
  }

  template <typename T>
  static void ScannerAxes(const Blocks& blocks, T axes[3][3]) {
    T tangent[3];
    for (int i = 0; i < 3; ++i) {
      tangent[i] = T(0.0, kExtrinsicsAt + i);
      axes[2][i] = T(blocks.extrinsics_t[i], kExtrinsicsAt + 3 + i);
    }
    TurnSlightly(tangent, blocks.body_from_scanner.col(0), axes[0]);
    TurnSlightly(tangent, blocks.body_from_scanner.col(1), axes[1]);
  }

  // The chain rule through the spline, to the control points' ambient coordinates.
  template <typename Derivative>
  void WriteControlPoints(const Blocks& blocks,
                          const Derivative& g_derivative,
                          const std::array<SplinePoseJacobian, kNumNodes>& splines,
                          double** jacobians) const {
    for (int j = 0; j < num_control_points_; ++j) {
      double* const rotation_jacobian = jacobians[j];
      double* const position_jacobian = jacobians[num_control_points_ + j];
      if (rotation_jacobian == nullptr && position_jacobian == nullptr) continue;
      RowMajor<9, 3> rotation = RowMajor<9, 3>::Zero();
      // Of a plane the distances alone depend on the position.
      constexpr int kPerNode = Plane::kIsCurved ? 3 : 1;
      using ByPosition = RowMajor<kNumNodes * kPerNode, 3>;
      ByPosition position = ByPosition::Zero();
      for (int k = 0; k < num_nodes_; ++k) {
        const int index = j - nodes_[k].first;
        if (index < 0 || index >= kSplineOrder) continue;
        rotation.middleRows<3>(3 * k) =
            g_derivative.template block<3, 3>(3 * k, 0).lazyProduct(
                splines[k].rotation_wrt_control[index]);
        position.template middleRows<kPerNode>(kPerNode * k) =
            g_derivative.template block<kPerNode, 3>(3 * k + 3 - kPerNode, 3) *
            splines[k].position_weights[index];
      }
      if (rotation_jacobian != nullptr) {
        const RowMajor<9, 4> ambient =
            rotation.lazyProduct(RotationMinusJacobian(blocks.q[j]));
        WriteJacobian<4>(root_, ambient, rotation_jacobian);
      }
      if constexpr (Plane::kIsCurved) {
        WriteJacobian<3>(root_, position, position_jacobian);
      } else {
        WriteJacobian<3>(distance_root_, position, position_jacobian);
      }
    }
  }

  void WriteResiduals(const Eigen::Matrix<double, 9, 1>& g, double* residuals) const {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxResiduals, 1>>(
        residuals, root_.rows()) = root_.lazyProduct(g) + offset_;
  }

  // root times derivative, where Ceres asks for it.
  template <int kCols, typename Root, typename Derivative>
  static void WriteJacobian(const Root& root, const Derivative& derivative, double* jacobian) {
    if (jacobian == nullptr) return;
    for (Eigen::Index row = 0; row < root.rows(); ++row, jacobian += kCols) {
      std::array<double, kCols> sum{};
      for (int k = 0; k < Root::ColsAtCompileTime; ++k) {
        for (int col = 0; col < kCols; ++col) sum[col] += root(row, k) * derivative(k, col);
      }
      for (int col = 0; col < kCols; ++col) jacobian[col] = sum[col];
    }
    if constexpr (Plane::kIsCurved) std::fill_n(jacobian, kCols, 0.0);  // the bow's rest
  }

  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor, kMaxResiduals, 9> root_;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxResiduals, 1> offset_;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxResiduals + 1, 1> bend_;  // the rest last
  double rest_offset_ = 0.0;
  Eigen::Vector2d centroid_;
  Eigen::Vector2d tangent_;
  // The columns of root_ for the distances g_k(2).
  Eigen::Matrix<double, Eigen::Dynamic, kNumNodes, Eigen::RowMajor, kMaxResiduals, kNumNodes>
      distance_root_;
  std::array<SplineNode, kNumNodes> nodes_;
  int num_nodes_;
  int num_control_points_;
  Plane plane_;
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateSegmentFactor(
    const SegmentMeasurement& measurement,
    const std::array<SplineNode, 3>& nodes,
    int num_control_points,
    PlaneModel model,
    const PlaneChart& chart,
    const SegmentWeights& weights) {
  return VisitPlaneModel(
      model, chart, [&](const auto& plane) -> std::unique_ptr<ceres::CostFunction> {
        return std::make_unique<SegmentCost<std::decay_t<decltype(plane)>>>(
            measurement, nodes, num_control_points, plane, weights);
      });
}

Eigen::Matrix<double, 9, 1> SegmentGeometry(
    const std::array<SplinePose, 3>& poses,
    const Eigen::Quaterniond& body_from_scanner_rotation,
    const Eigen::Vector3d& body_from_scanner_translation,
    const Eigen::Vector3d& normal_world,
    double distance) {
  const Eigen::Matrix3d body_from_scanner = body_from_scanner_rotation.toRotationMatrix();
  const double no_tangent[3] = {0.0, 0.0, 0.0};
  Eigen::Matrix<double, 9, 1> g;
  for (int k = 0; k < kNumNodes; ++k) {
    NodeGeometry<double, double>(poses[k].world_from_body.toRotationMatrix(),
                                 no_tangent,
                                 poses[k].position.data(),
                                 body_from_scanner.col(0).data(),
                                 body_from_scanner.col(1).data(),
                                 body_from_scanner_translation.data(),
                                 normal_world.data(),
                                 distance,
                                 &g[3 * k]);
  }
  return g;
}

}  // namespace plumbline

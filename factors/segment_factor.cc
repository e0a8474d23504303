#include "factors/segment_factor.h"

#include <ceres/cost_function.h>
#include <ceres/jet.h>
#include <glog/logging.h>

#include <Eigen/QR>
#include <type_traits>

#include "factors/manifolds.h"

namespace plumbline {
namespace {

constexpr int kNumNodes = 3;
constexpr int kMaxControlPoints = 6;
constexpr int kMaxResiduals = 9;

// Limits of the motion and geometry that CompressSegment's accuracy holds for; see the header.
constexpr double kMaxPlaneDistance = 100.0;
constexpr double kMaxRotationRate = 10.0;
constexpr double kMaxSpeed = 10.0;
constexpr double kMaxAcceleration = 100.0;  // rad/s^2 and m/s^2
constexpr double kMaxLoss = 1e-3;           // standard deviations of one range

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;
using ConstVector = Eigen::Map<const Eigen::Vector3d>;

template <typename A, typename B>
auto Dot(const A& a, const B& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// a turned by the small rotation vector: a + tangent x a, exact in value and first derivative
// at tangent = 0.
template <typename T, typename A>
void TurnSlightly(const T tangent[3], const A& a, T turned[3]) {
  turned[0] = a[0] + tangent[1] * a[2] - tangent[2] * a[1];
  turned[1] = a[1] + tangent[2] * a[0] - tangent[0] * a[2];
  turned[2] = a[2] + tangent[0] * a[1] - tangent[1] * a[0];
}

// g of one node. x_axis, y_axis, origin: of the scanner, in the body frame (E: double or T).
// Turning the body by Exp(tangent) on the left is seen as turning the normal by -tangent.
template <typename T, typename E>
void NodeGeometry(const Eigen::Matrix3d& world_from_body,
                  const T opposite_tangent[3],
                  const T position[3],
                  const E x_axis[3],
                  const E y_axis[3],
                  const E origin[3],
                  const T normal[3],
                  const T& distance,
                  T g[3]) {
  T turned[3];
  TurnSlightly(opposite_tangent, normal, turned);
  E world[3];
  const E* const vectors_body[3] = {x_axis, y_axis, origin};
  for (int i = 0; i < 3; ++i) {
    for (int row = 0; row < 3; ++row) {
      world[row] = Dot(vectors_body[i], world_from_body.row(row));
    }
    g[i] = Dot(turned, world);
  }
  g[2] += Dot(normal, position) - distance;
}

template <typename Plane>
class SegmentCost final : public ceres::CostFunction {
 public:
  SegmentCost(const SegmentMeasurement& measurement,
              const std::array<SplineNode, kNumNodes>& nodes,
              int num_control_points,
              const Plane& plane,
              double weight_scale)
      : root_(weight_scale * measurement.root),
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
    set_num_residuals(static_cast<int>(root_.rows()));
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
    double normal[3], distance;
    plane_.Evaluate(blocks.plane, normal, &distance);
    const double no_tangent[3] = {0.0, 0.0, 0.0};
    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
    for (int k = 0; k < num_nodes_; ++k) {
      const SplinePose pose = Pose(blocks, k, nullptr);
      NodeGeometry<double, double>(pose.world_from_body.toRotationMatrix(),
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
    T plane_params[Plane::kSize], normal[3], distance, opposite_tangent[3], position[3],
        g_jet[3];
    for (int i = 0; i < Plane::kSize; ++i) {
      plane_params[i] = T(blocks.plane[i], kPoseSize + i);
    }
    plane_.Evaluate(plane_params, normal, &distance);
    for (int i = 0; i < 3; ++i) opposite_tangent[i] = -T(0.0, i);
    E axes[3][3];  // x, y axis and origin of the scanner
    ScannerAxes(blocks, axes);

    Eigen::Matrix<double, 9, 1> g = Eigen::Matrix<double, 9, 1>::Zero();
    Eigen::Matrix<double, 9, kSize, Eigen::RowMajor> g_derivative;
    g_derivative.setZero();
    std::array<SplinePoseJacobian, kNumNodes> splines;
    for (int k = 0; k < num_nodes_; ++k) {
      const SplinePose pose = Pose(blocks, k, &splines[k]);
      for (int i = 0; i < 3; ++i) position[i] = T(pose.position[i], 3 + i);
      NodeGeometry<T, E>(pose.world_from_body.toRotationMatrix(),
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
      const Eigen::Matrix<double, 9, 4> rotation =
          g_derivative.template middleCols<3>(kExtrinsicsAt) *
          RotationMinusJacobian(blocks.extrinsics_q);
      WriteJacobian<4>(rotation, jacobians[first]);
      WriteJacobian<3>(g_derivative.template middleCols<3>(kExtrinsicsAt + 3),
                       jacobians[first + 1]);
    }
    WriteJacobian<Plane::kSize>(g_derivative.template middleCols<Plane::kSize>(kPoseSize),
                                jacobians[first + 2]);
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
      Eigen::Matrix<double, 9, 3> rotation = Eigen::Matrix<double, 9, 3>::Zero();
      Eigen::Matrix<double, 9, 3> position = Eigen::Matrix<double, 9, 3>::Zero();
      for (int k = 0; k < num_nodes_; ++k) {
        const int index = j - nodes_[k].first;
        if (index < 0 || index >= kSplineOrder) continue;
        rotation.middleRows<3>(3 * k).noalias() = g_derivative.template block<3, 3>(3 * k, 0) *
                                                  splines[k].rotation_wrt_control[index];
        position.middleRows<3>(3 * k) =
            g_derivative.template block<3, 3>(3 * k, 3) * splines[k].position_weights[index];
      }
      if (rotation_jacobian != nullptr) {
        const Eigen::Matrix<double, 9, 4> ambient =
            rotation * RotationMinusJacobian(blocks.q[j]);
        WriteJacobian<4>(ambient, rotation_jacobian);
      }
      WriteJacobian<3>(position, position_jacobian);
    }
  }

  void WriteResiduals(const Eigen::Matrix<double, 9, 1>& g, double* residuals) const {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxResiduals, 1>>(
        residuals, root_.rows()) = root_.lazyProduct(g);
  }

  // U times the derivative of g, where Ceres asks for it.
  template <int kCols, typename Derivative>
  void WriteJacobian(const Derivative& g_derivative, double* jacobian) const {
    if (jacobian == nullptr) return;
    constexpr int kOrder = kCols == 1 ? Eigen::ColMajor : Eigen::RowMajor;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, kCols, kOrder, kMaxResiduals, kCols>>(
        jacobian, root_.rows(), kCols) = root_.lazyProduct(g_derivative);
  }

  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor, kMaxResiduals, 9> root_;
  std::array<SplineNode, kNumNodes> nodes_;
  int num_nodes_;
  int num_control_points_;
  Plane plane_;
};

// Number of leading rows of the triangular matrix that may matter: the entries of the vector
// that it multiplies are at most one.
Eigen::Index NumSignificantRows(const Eigen::MatrixXd& triangular) {
  const double bound = std::sqrt(static_cast<double>(triangular.cols()));
  Eigen::Index rows = triangular.rows();
  double rest2 = 0.0;
  while (rows > 1) {
    rest2 += triangular.row(rows - 1).squaredNorm();
    if (bound * std::sqrt(rest2) > kMaxLoss) break;
    --rows;
  }
  return rows;
}

}  // namespace

SegmentMeasurement CompressSegment(const Eigen::Matrix2Xd& points_scanner,
                                   const std::vector<int64_t>& times_ns,
                                   const Eigen::VectorXd& whitening) {
  const Eigen::Index num_points = points_scanner.cols();
  CHECK_GE(num_points, 1);
  CHECK_EQ(num_points, static_cast<Eigen::Index>(times_ns.size()));
  CHECK_EQ(num_points, whitening.size());
  CHECK_LE(times_ns.front(), times_ns.back());

  SegmentMeasurement measurement;
  measurement.num_points = static_cast<int>(num_points);
  const int64_t half_span_ns = (times_ns.back() - times_ns.front()) / 2;
  const int64_t middle_ns = times_ns.front() + half_span_ns;
  measurement.node_times_ns = {times_ns.front(), middle_ns, middle_ns + half_span_ns};
  measurement.num_nodes = half_span_ns == 0 ? 1 : kNumNodes;

  // With g(tau) = h_0 + tau h_1 + tau^2 h_2, tau = -1, 0, 1 at the nodes, the matrix of h is
  // [ m, tau m, tau^2 m ], m = w (x, y, 1). Its columns are scaled by the largest plausible h.
  const double half_span_s = static_cast<double>(half_span_ns) * 1e-9;
  const double rate = kMaxRotationRate * half_span_s;
  const double speed = kMaxSpeed * half_span_s;
  const double bend = 0.5 * kMaxAcceleration * half_span_s * half_span_s;
  Eigen::VectorXd scale(9);
  scale << 1.0, 1.0, kMaxPlaneDistance, rate, rate, speed, bend, bend, bend;
  const Eigen::Index num_columns = 3 * measurement.num_nodes;
  Eigen::MatrixXd matrix(num_points, num_columns);
  for (Eigen::Index i = 0; i < num_points; ++i) {
    const Eigen::RowVector3d row =
        whitening[i] * Eigen::RowVector3d(points_scanner(0, i), points_scanner(1, i), 1.0);
    matrix.block<1, 3>(i, 0) = row;
    if (measurement.num_nodes == 1) continue;
    const double tau = static_cast<double>(times_ns[static_cast<size_t>(i)] - middle_ns) /
                       static_cast<double>(half_span_ns);
    matrix.block<1, 3>(i, 3) = tau * row;
    matrix.block<1, 3>(i, 6) = tau * tau * row;
  }
  matrix *= scale.head(num_columns).asDiagonal();

  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);
  const Eigen::Index size = std::min(num_points, num_columns);
  const Eigen::MatrixXd triangular =
      qr.matrixQR().topRows(size).triangularView<Eigen::Upper>();
  const Eigen::Index num_rows = NumSignificantRows(triangular);
  const Eigen::MatrixXd rows = triangular.topRows(num_rows) *
                               qr.colsPermutation().transpose() *
                               scale.head(num_columns).cwiseInverse().asDiagonal();
  measurement.root.setZero(num_rows, 9);
  if (measurement.num_nodes == 1) {
    measurement.root.leftCols<3>() = rows;
  } else {
    // h_0 = g_1,  h_1 = (g_2 - g_0) / 2,  h_2 = (g_0 - 2 g_1 + g_2) / 2.
    measurement.root.leftCols<3>() = 0.5 * (rows.rightCols<3>() - rows.middleCols<3>(3));
    measurement.root.middleCols<3>(3) = rows.leftCols<3>() - rows.rightCols<3>();
    measurement.root.rightCols<3>() = 0.5 * (rows.rightCols<3>() + rows.middleCols<3>(3));
  }
  return measurement;
}

std::unique_ptr<ceres::CostFunction> CreateSegmentFactor(
    const SegmentMeasurement& measurement,
    const std::array<SplineNode, 3>& nodes,
    int num_control_points,
    PlaneModel model,
    double sign,
    double weight_scale) {
  return VisitPlaneModel(
      model, sign, [&](const auto& plane) -> std::unique_ptr<ceres::CostFunction> {
        return std::make_unique<SegmentCost<std::decay_t<decltype(plane)>>>(
            measurement, nodes, num_control_points, plane, weight_scale);
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

#include "factors/cost/segment_factor.h"

#include <ceres/dynamic_autodiff_cost_function.h>
#include <glog/logging.h>

#include <algorithm>
#include <type_traits>

#include "factors/manifold/manifolds.h"

namespace plumbline {
namespace {

double ValueOf(double x) { return x; }
template <typename Jet>
double ValueOf(const Jet& x) {
  return x.a;
}

// How each row of a segment, and the bow's rest, changes with the surface's curvature,
// whitened; the rest is a row of its own. A plane has no curvature.
template <typename Plane>
Eigen::VectorXd BendOf(const Plane&, const SegmentMeasurement&, double) {
  return {};
}
Eigen::VectorXd BendOf(const Cylinder&, const SegmentMeasurement& measurement, double scale) {
  Eigen::VectorXd bend(measurement.rows.rows() + 1);
  bend << measurement.bend(), measurement.bend_rest;
  return scale * bend;
}

template <typename Plane>
struct SegmentFunctor {
  Eigen::MatrixXd root;    // rows x 9, whitened
  Eigen::VectorXd offset;  // of each row, whitened
  Eigen::VectorXd bend;    // see BendOf
  double rest_offset;
  Eigen::Vector2d centroid;
  Eigen::Vector2d tangent;
  std::array<SplineNode, 3> nodes;
  int num_nodes;
  int num_control_points;
  Plane plane;

  template <typename T>
  bool operator()(T const* const* parameters, T* residuals) const {
    using Vector = Eigen::Matrix<T, 3, 1>;
    using Quaternion = Eigen::Quaternion<T>;
    const int m = num_control_points;
    const Eigen::Map<const Quaternion> body_from_scanner(parameters[2 * m]);
    const Eigen::Map<const Vector> origin_body(parameters[2 * m + 1]);
    const T* const surface = parameters[2 * m + 2];
    Eigen::Matrix<T, 9, 1> g;
    g.fill(T(0.0));
    double level2 = 0.0;  // share of the segment's direction
    for (int k = 0; k < num_nodes; ++k) {
      const SplineNode& node = nodes[static_cast<size_t>(k)];
      Quaternion world_from_body;
      Vector position;
      EvaluateRotation(parameters + node.first, node.u, world_from_body.coeffs().data());
      EvaluatePosition(parameters + m + node.first, node.u, position.data());
      const Eigen::Matrix<T, 3, 3> axes =
          (world_from_body * Quaternion(body_from_scanner)).toRotationMatrix();
      const Vector origin = world_from_body * Vector(origin_body) + position;
      const Vector middle =
          T(centroid.x()) * axes.col(0) + T(centroid.y()) * axes.col(1) + origin;
      Vector normal;
      T distance;
      EvaluateNear(plane, surface, middle.data(), normal.data(), &distance);
      g[3 * k] = axes.col(0).dot(normal);
      g[3 * k + 1] = axes.col(1).dot(normal);
      g[3 * k + 2] = origin.dot(normal) - distance;
      if (k != num_nodes / 2) continue;  // the middle one
      const Vector along = T(tangent.x()) * axes.col(0) + T(tangent.y()) * axes.col(1);
      level2 = ValueOf(along.template head<2>().squaredNorm());
    }
    for (Eigen::Index row = 0; row < root.rows(); ++row) {
      residuals[row] = T(offset[row]);
      for (int i = 0; i < 3 * num_nodes; ++i) residuals[row] += root(row, i) * g[i];
    }
    if (bend.size() > 0) residuals[root.rows()] = T(rest_offset);
    for (Eigen::Index row = 0; row < bend.size(); ++row) {
      residuals[row] += level2 * bend[row] * CurvatureOf(plane, surface);
    }
    return true;
  }
};

}  // namespace

std::unique_ptr<ceres::CostFunction> CreateSegmentFactor(
    const SegmentMeasurement& measurement,
    const std::array<SplineNode, 3>& nodes,
    int num_control_points,
    PlaneModel model,
    const PlaneChart& chart,
    const SegmentWeights& weights) {
  CHECK_GE(num_control_points, kSplineOrder);
  for (const SplineNode& node : nodes) {
    CHECK(node.first >= 0 && node.first + kSplineOrder <= num_control_points) << node.first;
  }
  return VisitPlaneModel(
      model, chart, [&](const auto& plane) -> std::unique_ptr<ceres::CostFunction> {
        using Plane = std::decay_t<decltype(plane)>;
        using Functor = SegmentFunctor<Plane>;
        const Eigen::VectorXd bend = BendOf(plane, measurement, weights.scale);
        const Eigen::Index num_rows = std::max(measurement.rows.rows(), bend.size());
        auto cost = std::make_unique<ceres::DynamicAutoDiffCostFunction<Functor, 8>>(
            new Functor{weights.scale * measurement.root(),
                        weights.offset * measurement.offset(),
                        bend,
                        weights.offset * measurement.bend_offset,
                        measurement.centroid,
                        measurement.tangent,
                        nodes,
                        measurement.num_nodes,
                        num_control_points,
                        plane});
        for (int j = 0; j < num_control_points; ++j) cost->AddParameterBlock(4);
        for (int j = 0; j < num_control_points; ++j) cost->AddParameterBlock(3);
        for (const int size : {4, 3, Plane::kSize}) cost->AddParameterBlock(size);
        cost->SetNumResiduals(static_cast<int>(num_rows));
        return cost;
      });
}

}  // namespace plumbline

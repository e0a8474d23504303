#include "core/registration/pose_graph.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <array>
#include <cmath>

namespace plumbline {
namespace {

// Standard deviations up to which an edge that may be wrong counts in full.
constexpr double kLossWidth = 2.0;

// [R(from)^T (p_to - p_from) - t; heading_to - heading_from - turn], of poses (x, y, heading).
template <typename T>
Eigen::Matrix<T, 3, 1> ErrorOf(const PlanarPose& stated, const T* from, const T* to) {
  const T cosine = cos(from[2]);
  const T sine = sin(from[2]);
  const T x = to[0] - from[0];
  const T y = to[1] - from[1];
  return {cosine * x + sine * y - stated.position.x(),
          cosine * y - sine * x - stated.position.y(),
          to[2] - from[2] - stated.heading};
}

// r = U error, U^T U = information.
struct EdgeFunctor {
  PlanarPose stated;
  Eigen::Matrix3d root;

  template <typename T>
  bool operator()(const T* from, const T* to, T* residuals) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Vector3 error = ErrorOf(stated, from, to);
    Eigen::Map<Vector3>(residuals, 3) = root.cast<T>() * error;
    return true;
  }
};

std::array<double, 3> BlockOf(const PlanarPose& pose) {
  return {pose.position.x(), pose.position.y(), pose.heading};
}

}  // namespace

void SolvePoseGraph(const std::vector<PoseGraphEdge>& edges, std::vector<PlanarPose>* poses) {
  if (poses->empty()) return;
  std::vector<std::array<double, 3>> blocks;
  for (const PlanarPose& pose : *poses) blocks.push_back(BlockOf(pose));
  ceres::Problem problem;
  for (const PoseGraphEdge& edge : edges) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<EdgeFunctor, 3, 3, 3>(
            new EdgeFunctor{edge.from_from_to, edge.information.llt().matrixU()}),
        edge.may_be_wrong ? new ceres::CauchyLoss(kLossWidth) : nullptr,
        blocks[edge.from].data(),
        blocks[edge.to].data());
  }
  problem.AddParameterBlock(blocks[0].data(), 3);
  problem.SetParameterBlockConstant(blocks[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 50;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    LOG(WARNING) << "poses of visits: " << summary.message;
    return;
  }
  for (size_t i = 0; i < blocks.size(); ++i) {
    (*poses)[i] = {blocks[i][2], {blocks[i][0], blocks[i][1]}};
  }
}

double SquaredDeviation(const PoseGraphEdge& edge, const std::vector<PlanarPose>& poses) {
  Eigen::Vector3d error = ErrorOf(
      edge.from_from_to, BlockOf(poses[edge.from]).data(), BlockOf(poses[edge.to]).data());
  error[2] = std::remainder(error[2], 2.0 * M_PI);
  return error.dot(edge.information * error);
}

}  // namespace plumbline

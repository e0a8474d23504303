#include "core/map_covariance.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <utility>

#include "factors/spline.h"

namespace plumbline {
namespace {

constexpr int kNumWeakDirections = 3;
constexpr int kMaxControlPointsOfResidual = 6;

// Inverse iteration on a small subspace: the smallest eigenvalues of the scaled matrix and
// their vectors.
std::vector<WeakDirection> FindWeakDirections(const ArrowFactor& factor,
                                              const Eigen::VectorXd& diagonal,
                                              const FullJacobian& jacobian) {
  constexpr int kSubspace = kNumWeakDirections + 3;
  constexpr int kIterations = 8;
  const Eigen::Index size = diagonal.size();
  const Eigen::VectorXd root = diagonal.cwiseSqrt();
  const Eigen::Index dimension = std::min<Eigen::Index>(kSubspace, size);
  // A start that no structure of the problem is orthogonal to; always the same.
  Eigen::MatrixXd basis(size, dimension);
  uint64_t state = 1;
  for (double& value : basis.reshaped()) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    value = static_cast<double>(state >> 40) / static_cast<double>(1 << 24) - 0.5;
  }
  Eigen::MatrixXd projected(dimension, dimension);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(basis);
    const Eigen::MatrixXd orthonormal =
        qr.householderQ() * Eigen::MatrixXd::Identity(size, dimension);
    for (Eigen::Index j = 0; j < dimension; ++j) {
      basis.col(j) = root.cwiseProduct(factor.Solve(root.cwiseProduct(orthonormal.col(j))));
    }
    projected = orthonormal.transpose() * basis;
    if (iteration + 1 == kIterations) basis = orthonormal;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      0.5 * (projected + projected.transpose()));
  std::vector<WeakDirection> weak;
  for (int i = 0; i < std::min<int>(kNumWeakDirections, static_cast<int>(dimension)); ++i) {
    const Eigen::Index column = dimension - 1 - i;  // of the inverse the largest
    const Eigen::VectorXd direction = basis * solver.eigenvectors().col(column);
    WeakDirection found;
    found.eigenvalue = 1.0 / solver.eigenvalues()[column];
    for (size_t b = 0; b < jacobian.blocks.size(); ++b) {
      const int offset = jacobian.offsets[b];
      const double share =
          direction.segment(offset, jacobian.offsets[b + 1] - offset).squaredNorm();
      if (share <= found.share) continue;
      found.share = share;
      found.block = jacobian.blocks[b];
    }
    weak.push_back(found);
  }
  return weak;
}

}  // namespace

MapCovariance MapCovariance::Of(EstimationProblem* problem) {
  const FullJacobian jacobian = problem->Jacobian();
  MapCovariance result;
  result.planar_ = problem->planar();
  int num_band = 0;
  result.offsets_.push_back(0);
  for (size_t i = 0; i < jacobian.blocks.size(); ++i) {
    if (jacobian.blocks[i].kind != BlockId::Kind::kLandmark) {
      num_band = jacobian.offsets[i + 1];
    } else {
      result.landmark_ids_.push_back(jacobian.blocks[i].index);
      result.offsets_.push_back(jacobian.offsets[i + 1] - num_band);
    }
  }
  const int size = jacobian.offsets.back();
  const int bandwidth = kMaxControlPointsOfResidual * (result.planar_ ? 4 : 6) - 1;
  ArrowMatrix matrix(num_band, bandwidth, size - num_band);
  // Directions that are held get a unit diagonal and are taken out again at the end.
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(size);
  std::vector<bool> is_free(static_cast<size_t>(size), false);
  for (const int column : jacobian.full_column) is_free[static_cast<size_t>(column)] = true;
  for (int i = 0; i < size; ++i) {
    if (is_free[static_cast<size_t>(i)]) continue;
    matrix.Add(i, i, 1.0);
    diagonal[i] = 1.0;
  }
  jacobian.ForEachResidualBlock(
      [&](size_t, const std::vector<int>& columns, const Eigen::MatrixXd& block) {
        const Eigen::MatrixXd product = block.transpose() * block;
        matrix.AddBlock(columns, product);
        for (size_t i = 0; i < columns.size(); ++i) {
          const auto at = static_cast<Eigen::Index>(i);
          diagonal[columns[i]] += product(at, at);
        }
      });
  const ArrowFactor factor(std::move(matrix));
  result.inverse_ = factor.Inverse();
  for (int i = 0; i < size; ++i) {
    if (is_free[static_cast<size_t>(i)]) continue;
    if (i < num_band) {
      result.inverse_.band(0, i) = 0.0;  // its other entries are zero
    } else {
      result.inverse_.border.row(i - num_band).setZero();
      result.inverse_.border.col(i - num_band).setZero();
    }
  }
  result.weak_directions_ = FindWeakDirections(factor, diagonal, jacobian);
  return result;
}

Matrix6d MapCovariance::PoseAt(const Trajectory& trajectory, int64_t time_ns) const {
  const Trajectory::Location at = trajectory.Locate(time_ns);
  const SplinePoseJacobian spline = trajectory.PoseJacobian(at);
  const int rotation_size = planar_ ? 1 : 3;
  const int block_size = rotation_size + 3;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, kSplineOrder * block_size);
  for (int j = 0; j < kSplineOrder; ++j) {
    const auto index = static_cast<size_t>(j);
    jacobian.block(0, j * block_size, 3, rotation_size) =
        spline.rotation_wrt_control[index].rightCols(rotation_size);
    jacobian.block<3, 3>(3, j * block_size + rotation_size)
        .diagonal()
        .setConstant(spline.position_weights[index]);
  }
  return jacobian * inverse_.BandBlock(at.first * block_size, kSplineOrder * block_size) *
         jacobian.transpose();
}

}  // namespace plumbline

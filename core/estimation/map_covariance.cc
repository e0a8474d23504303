#include "core/estimation/map_covariance.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "core/estimation/arrowhead_equations.h"
#include "core/estimation/block_layout.h"
#include "core/estimation/linearisation.h"
#include "core/geometry/matrix_types.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

constexpr int kNumWeakDirections = 3;

// Inverse iteration on a small subspace: the smallest eigenvalues of the scaled matrix and
// their vectors.
std::vector<WeakDirection> FindWeakDirections(const ArrowheadCholesky& factor,
                                              const Eigen::VectorXd& diagonal,
                                              const BlockLayout& layout) {
  constexpr int kIterations = 8;
  const Eigen::Index size = diagonal.size();
  const Eigen::VectorXd root = diagonal.cwiseSqrt();
  const Eigen::Index dimension = std::min<Eigen::Index>(2 * kNumWeakDirections, size);
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
    basis = root.asDiagonal() * factor.Solve(root.asDiagonal() * orthonormal);
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
    for (size_t b = 0; b < layout.blocks.size(); ++b) {
      const int offset = layout.offsets[b];
      const double share =
          direction.segment(offset, layout.offsets[b + 1] - offset).squaredNorm();
      if (share <= found.share) continue;
      found.share = share;
      found.block = layout.blocks[b];
    }
    weak.push_back(found);
  }
  return weak;
}

}  // namespace

MapCovariance MapCovariance::Of(const EstimationProblem& problem) {
  return Of(problem, LineariseArrowhead(problem, problem.Layout()));
}

MapCovariance MapCovariance::Of(const EstimationProblem& problem,
                                ArrowheadEquations equations) {
  return Of(problem, std::move(equations), nullptr);
}

MapCovariance MapCovariance::Of(const EstimationProblem& problem,
                                ArrowheadEquations equations,
                                const CorrelatedErrorsOf& correlated) {
  const BlockLayout layout = problem.Layout();
  MapCovariance result;
  result.planar_ = problem.planar();
  result.layout_ = layout;
  const int num_band = layout.NumBandColumns();
  result.offsets_.push_back(0);
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    if (layout.blocks[i].kind != BlockId::Kind::kLandmark) continue;
    result.landmark_ids_.push_back(layout.blocks[i].index);
    result.offsets_.push_back(layout.offsets[i + 1] - num_band);
  }
  ArrowheadCholesky factor(std::move(equations.hessian), BorderElimination::kLast);
  result.weak_directions_ = FindWeakDirections(factor, equations.diagonal, layout);
  CorrelatedErrors errors;
  if (correlated) errors = correlated(factor);
  result.RelateToHeading(factor, equations.diagonal, errors.shift, num_band);
  result.inverse_ = factor.TakeInverse();
  for (int i = 0; i < layout.size(); ++i) {
    if (!layout.is_free[static_cast<size_t>(i)]) result.inverse_.Clear(i);
  }
  Eigen::MatrixXd border = result.inverse_.border();
  if (errors.shift.size() > 0) {
    border += errors.landmarks;
    result.shift_ = std::move(errors.shift);
  }
  const int num_landmark_rows = result.offsets_.back();
  const Eigen::Index num_scanner_rows = border.rows() - num_landmark_rows;
  result.landmarks_ = border.topLeftCorner(num_landmark_rows, num_landmark_rows);
  result.scanners_ = border.bottomRightCorner(num_scanner_rows, num_scanner_rows);
  return result;
}

MapCovariance MapCovariance::OfPoses(const EstimationProblem& problem) {
  const BlockLayout layout = problem.Layout();
  MapCovariance result;
  result.planar_ = problem.planar();
  result.inverse_ = ArrowheadCholesky(LineariseArrowhead(problem, layout).hessian.Band(),
                                      BorderElimination::kLast)
                        .TakeInverse();
  result.layout_ = layout;
  for (int i = 0; i < layout.NumBandColumns(); ++i) {
    if (!layout.is_free[static_cast<size_t>(i)]) result.inverse_.Clear(i);
  }
  return result;
}

Eigen::MatrixXd MapCovariance::OfBand(int first, int size) const {
  Eigen::MatrixXd covariance = inverse_.BandBlock(first, size);
  if (shift_.size() == 0) return covariance;
  const auto rows = shift_.middleRows(first, size);
  covariance.noalias() += rows * rows.transpose();
  return covariance;
}

void MapCovariance::RelateToHeading(const ArrowheadCholesky& factor,
                                    const Eigen::VectorXd& information,
                                    const Eigen::MatrixXd& shift,
                                    int num_band) {
  Eigen::VectorXd by_unknowns = Eigen::VectorXd::Zero(factor.size());
  for (size_t i = 0; i < layout_.blocks.size(); ++i) {
    if (layout_.blocks[i].kind != BlockId::Kind::kRotation) continue;
    const int heading = layout_.offsets[i] + NumRotations() - 1;
    by_unknowns[heading] = information[heading];
  }
  if (by_unknowns.sum() > 0.0) by_unknowns /= by_unknowns.sum();
  with_heading_ = factor.Solve(by_unknowns).topRows(num_band);
  if (shift.size() > 0) {
    const auto rows = shift.topRows(num_band);
    with_heading_ += rows * (rows.transpose() * by_unknowns.head(num_band));
  }
  heading_variance_ = with_heading_.dot(by_unknowns.head(num_band));
}

Eigen::Matrix3d MapCovariance::PositionInTurnedMap(const Trajectory& trajectory,
                                                   int64_t time_ns) const {
  const Trajectory::Location at = trajectory.Locate(time_ns);
  const SplinePoseJacobian spline = trajectory.PoseJacobian(at);
  Eigen::Vector3d with_heading = Eigen::Vector3d::Zero();
  for (int j = 0; j < kSplineOrder; ++j) {
    const int position = layout_.ColumnOf(PositionBlock(at.first + j));
    with_heading +=
        spline.position_weights[static_cast<size_t>(j)] * with_heading_.segment<3>(position);
  }
  const Eigen::Vector3d by_heading =
      Eigen::Vector3d::UnitZ().cross(trajectory.WorldFromBody(time_ns).translation);
  const Eigen::Matrix3d crossed = by_heading * with_heading.transpose();
  return PoseAt(trajectory, time_ns).bottomRightCorner<3, 3>() - crossed -
         crossed.transpose() + heading_variance_ * by_heading * by_heading.transpose();
}

Matrix6d MapCovariance::PoseAt(const Trajectory& trajectory, int64_t time_ns) const {
  const Trajectory::Location at = trajectory.Locate(time_ns);
  const SplinePoseJacobian spline = trajectory.PoseJacobian(at);
  const int rotation_size = NumRotations();
  const int first = layout_.ColumnOf(RotationBlock(at.first));
  const int end = layout_.ColumnOf(PositionBlock(at.first + kSplineOrder - 1)) + 3;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, end - first);
  for (int j = 0; j < kSplineOrder; ++j) {
    const auto index = static_cast<size_t>(j);
    const int column = layout_.ColumnOf(RotationBlock(at.first + j)) - first;
    jacobian.block(0, column, 3, rotation_size) =
        spline.rotation_wrt_control[index].rightCols(rotation_size);
    jacobian.block<3, 3>(3, column + rotation_size)
        .diagonal()
        .setConstant(spline.position_weights[index]);
  }
  return jacobian * OfBand(first, end - first) * jacobian.transpose();
}

}  // namespace plumbline

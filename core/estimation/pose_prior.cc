#include "core/estimation/pose_prior.h"

#include <ceres/cost_function.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/estimation/imu_terms.h"
#include "core/util/error.h"
#include "factors/cost/motion_factor.h"

namespace plumbline {
std::vector<int> RowsInPoses(const NormalEquations& equations, int first) {
  std::vector<int> rows;
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    const BlockId& block = equations.blocks[i];
    if (!IsControlPoint(block) || block.index < first) continue;
    const int size = BlockSize(equations, i);
    const int first_row = kPoseSize * (block.index - first) +
                          (block.kind == BlockId::Kind::kPosition ? 3 : 3 - size);
    for (int k = 0; k < size; ++k) rows.push_back(first_row + k);
  }
  return rows;
}

PoseGaussian PosesFrom(const NormalEquations& equations,
                       const Eigen::MatrixXd& information,
                       const Trajectory& trajectory,
                       int first) {
  PoseGaussian gaussian;
  gaussian.first = first;
  for (int i = first; i < trajectory.num_control_points(); ++i) {
    gaussian.mean.push_back(trajectory.control_point(i));
  }
  const std::vector<int> rows = RowsInPoses(equations, first);
  const auto size = static_cast<Eigen::Index>(kPoseSize * gaussian.mean.size());
  gaussian.information.setZero(size, size);
  gaussian.information(rows, rows) = information;
  return gaussian;
}

Prior PosePrior(const PoseGaussian& gaussian, bool planar) {
  Prior prior;
  std::vector<int> rows;     // of the information that are not zero
  std::vector<int> columns;  // of the blocks' tangents, parallel to rows
  int tangent_size = 0;
  for (size_t i = 0; i < gaussian.mean.size(); ++i) {
    const int control_point = gaussian.first + static_cast<int>(i);
    const ControlPoint& mean = gaussian.mean[i];
    prior.blocks.push_back(RotationBlock(control_point));
    prior.linear.blocks.push_back(
        {planar ? LinearPrior::Kind::kYawRotation : LinearPrior::Kind::kRotation,
         4,
         Eigen::Map<const Eigen::VectorXd>(mean.rotation.data(), 4)});
    prior.blocks.push_back(PositionBlock(control_point));
    prior.linear.blocks.push_back(
        {LinearPrior::Kind::kEuclidean,
         3,
         Eigen::Map<const Eigen::VectorXd>(mean.position.data(), 3)});
    for (int k = planar ? 2 : 0; k < kPoseSize; ++k, ++tangent_size) {
      if (planar && k + 1 == kPoseSize) continue;  // the height is held
      rows.push_back(kPoseSize * static_cast<int>(i) + k);
      columns.push_back(tangent_size);
    }
  }
  // H = L L^T, so that |L^T x|^2 is the Gaussian's cost.
  const Eigen::LLT<Eigen::MatrixXd> cholesky(
      Eigen::MatrixXd(gaussian.information(rows, rows)));
  if (cholesky.info() != Eigen::Success) {
    throw Error("the scans do not determine the poses");
  }
  const auto num_rows = static_cast<Eigen::Index>(rows.size());
  prior.linear.root.setZero(num_rows, tangent_size);
  prior.linear.root(Eigen::all, columns) = Eigen::MatrixXd(cholesky.matrixU());
  prior.linear.offset.setZero(num_rows);
  return prior;
}

void AddGravityStart(const GravityStart& start,
                     const Trajectory& trajectory,
                     EstimationProblem* problem) {
  PoseConstraint attitude;
  attitude.time_ns = start.time_ns;
  attitude.measurement.world_from_body = start.world_from_body;
  attitude.measurement.root.diagonal().head<3>() << 1.0 / start.tilt_stddev_rad,
      1.0 / start.tilt_stddev_rad, 1.0 / start.heading_stddev_rad;
  problem->AddPoseConstraint(attitude);
  problem->AddFactor(
      CreatePositionVelocityFactor(start.speed_stddev_m_s, trajectory.knot_interval_s()),
      {PositionBlock(0), PositionBlock(1)});
}

void AddScannerPriors(const RigCalibration& calibration, EstimationProblem* problem) {
  for (size_t i = 0; i < calibration.scanners.size(); ++i) {
    if (!calibration.scanners[i].IsEstimated()) continue;
    const int size = calibration.scanners[i].BlockSize();
    Prior prior;
    prior.blocks.push_back(ScannerBlockId(static_cast<int>(i)));
    prior.linear.blocks.push_back(
        {LinearPrior::Kind::kEuclidean, size, Eigen::VectorXd::Zero(size)});
    prior.linear.root.setZero(size, size);
    prior.linear.offset.setZero(size);
    for (int row = 0; row < size; ++row) {
      const double sigma = calibration.scanners[i].prior_sigma[static_cast<size_t>(row)];
      if (sigma > 0.0) prior.linear.root(row, row) = 1.0 / sigma;
    }
    problem->AddPrior(prior);
  }
}

void SetCalibrationCovariance(const EstimationProblem& problem,
                              const MapCovariance& covariance,
                              RigCalibration* calibration) {
  const BlockLayout layout = problem.Layout();
  Eigen::Index row = 0;
  for (const BlockId& block : layout.blocks) {
    if (IsLandmark(block) || IsControlPoint(block)) continue;
    if (IsBias(block)) {
      SetImuCovariance(block,
                       covariance.OfBand(layout.ColumnOf(block), kImuBiasSize),
                       0,
                       &*calibration->imu);
      continue;
    }
    if (IsScanner(block)) {
      calibration->scanners[static_cast<size_t>(block.index)].SetCovariance(
          covariance.scanners(), row);
    } else {
      SetImuCovariance(block, covariance.scanners(), row, &*calibration->imu);
    }
    row += problem.unknowns().TangentSize(block);
  }
}

}  // namespace plumbline

#include "core/association/plane_through_lines.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/association/association.h"

namespace plumbline {
namespace {

// A weight below which a direction counts as unknown: by more than a half turn.
constexpr double kLeastInformation = 0.1;  // 1/rad^2
constexpr double kBump = 0.5;              // m, as far as a surface's unevenness is alike

}  // namespace

MeasuredLine MeasureLine(const Observation& observation,
                         const ObservationPoses& poses,
                         const Matrix6d& pose_covariance,
                         double flatness_m) {
  const Eigen::Matrix2d flatness = FlatnessCovariance(observation.length_m(), flatness_m);
  MeasuredLine line;
  line.centroid_world = poses.motion.nodes()[1] * observation.centroid().homogeneous();
  line.direction_world =
      (poses.motion.nodes()[1].leftCols<2>() * observation.tangent()).normalized();
  // The worst direction of the pose counts.
  const Eigen::Vector3d arm = line.centroid_world - poses.world_from_body.translation;
  const double turn = pose_covariance.topLeftCorner<3, 3>().trace();
  const double shift =
      pose_covariance.bottomRightCorner<3, 3>().trace() + turn * arm.squaredNorm();
  line.sigma_offset_m = std::sqrt(observation.sigma_offset_m * observation.sigma_offset_m +
                                  flatness(0, 0) + shift);
  line.sigma_direction_rad =
      std::sqrt(observation.sigma_direction_rad * observation.sigma_direction_rad +
                flatness(1, 1) + turn);
  line.flatness_m = flatness_m;
  return line;
}

void PlaneThroughLines::Add(const MeasuredLine& line) {
  if (num_lines_ == 0) origin_ = line.centroid_world;
  flatness_m_ = std::max(flatness_m_, line.flatness_m);
  ++num_lines_;
  const double half_weight = 0.5 / (line.sigma_offset_m * line.sigma_offset_m);
  const double arm = line.sigma_offset_m / line.sigma_direction_rad;
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Vector3d p =
        line.centroid_world - origin_ + side * arm * line.direction_world;
    weight_ += half_weight;
    first_moments_ += half_weight * p;
    second_moments_ += half_weight * p * p.transpose();
  }
}

PlaneThroughLines::Fit PlaneThroughLines::Solve() const {
  CHECK_GT(num_lines_, 0);
  const Eigen::Vector3d mean = first_moments_ / weight_;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(second_moments_ - weight_ * mean * mean.transpose());
  Fit fit;
  fit.centre_world = origin_ + mean;
  fit.normal = solver.eigenvectors().col(0);
  fit.chi2 = std::max(0.0, solver.eigenvalues()[0]);
  fit.centre_variance = 1.0 / weight_;
  fit.normal_covariance.setZero();
  for (const int k : {1, 2}) {
    // Noise spreads the points in all directions: what it adds tells nothing of this one.
    const double information = std::max(solver.eigenvalues()[k] - fit.chi2, kLeastInformation);
    const Eigen::Vector3d towards = solver.eigenvectors().col(k);
    // Bumps stay where they are, however often they are measured.
    const double spread = information / weight_;
    const double num_bumps = std::max(1.0, std::sqrt(12.0 * spread) / kBump);
    const double variance =
        1.0 / information + flatness_m_ * flatness_m_ / (spread * num_bumps);
    fit.normal_covariance += variance * towards * towards.transpose();
  }
  return fit;
}

}  // namespace plumbline

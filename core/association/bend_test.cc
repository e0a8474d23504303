#include "core/association/bend_test.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/association/association.h"
#include "core/association/line_deviation.h"
#include "core/association/surface_levels.h"

namespace plumbline {
namespace {

// The least bow of what was seen: more than unevenness, or two walls that nearly meet in line,
// have.
constexpr double kMinBow = 0.02;        // m
constexpr double kMinFlatnesses = 4.0;  // in multiples of the unevenness
// The ends of a stair's riser take up beams of the walls beside it, and bow by the noise.
constexpr double kMinNoises = 1.5;  // in multiples of a range's noise
// Below this, 1/m, rounding decides (a segment of a few beams has no bow).
constexpr double kLeastInformation = 1e-6;

}  // namespace

void CylinderEquations::Add(const Observation& observation,
                            const ObservationPoses& poses,
                            const LandmarkView& cylinder,
                            const Eigen::Matrix2d& of_pose,
                            double flatness_m) {
  const BowedDeviation bowed = BowedDeviationFrom(observation, poses, cylinder);
  Eigen::Matrix3d covariance =
      (bowed.information + kLeastInformation * Eigen::Matrix3d::Identity()).inverse();
  const Eigen::Vector3d value = covariance * bowed.right_side;
  const double length_m = std::max(observation.length_m(), flatness_m);
  covariance.topLeftCorner<2, 2>() += FlatnessCovariance(length_m, flatness_m) + of_pose;
  const double bow = 8.0 * flatness_m / (length_m * length_m);
  covariance(2, 2) += bow * bow;
  const double by_curvature = bowed.by_surface(2, Cylinder::kCurvatureAt);
  bow_information_ += by_curvature * by_curvature / covariance(2, 2);
  bow_right_side_ += by_curvature * value[2] / covariance(2, 2);
  const Eigen::Matrix3d weight = covariance.inverse();
  information_ += bowed.by_surface.transpose() * weight * bowed.by_surface;
  right_side_ += bowed.by_surface.transpose() * (weight * value);
  square_ += value.dot(weight * value);
  ++num_segments_;
}

std::optional<CylinderEquations::Solution> CylinderEquations::Solve() const {
  const Eigen::FullPivLU<Eigen::Matrix3d> solver(information_);
  if (num_segments_ == 0 || !solver.isInvertible()) return std::nullopt;
  Solution solution;
  solution.covariance = solver.inverse();
  solution.step = -(solution.covariance * right_side_);
  solution.mean_chi2 =
      (square_ + right_side_.dot(solution.step)) / std::max(1, 3 * num_segments_ - 3);
  solution.curvature_by_bows = -bow_right_side_ / bow_information_;
  solution.variance_by_bows = 1.0 / bow_information_;
  return solution;
}

bool MayBend(const Landmark& landmark) {
  constexpr double kMaxTurn = 0.5;  // rad
  return TraitsOf(landmark).may_bend && !landmark.heading_fixed &&
         std::abs(landmark.Curvature()) * landmark.Width() < kMaxTurn;
}

BendTest::BendTest(const Landmark& wall, double flatness_m, double range_noise_m)
    : reference_(MakeCylinderLandmark(
          wall.NormalNear(wall.extent.axes().anchor), 0.0, wall.extent.axes().anchor)),
      flatness_m_(flatness_m),
      range_noise_m_(range_noise_m) {}

void BendTest::Add(const Observation& observation,
                   const ObservationPoses& poses,
                   const Matrix6d& pose_covariance) {
  if (!reference_) return;
  const LandmarkView view(*reference_);
  const LineDeviation deviation = DeviationFromPlane(observation, poses, view);
  equations_.Add(observation,
                 poses,
                 view,
                 deviation.by_pose * pose_covariance * deviation.by_pose.transpose(),
                 flatness_m_);
  const ScanPlacement& placement = poses.motion.nodes()[1];
  const Eigen::Vector3d centroid = placement * observation.centroid().homogeneous();
  const double along = reference_->extent.axes().u.dot(centroid - reference_->chart.anchor);
  const Eigen::Vector3d piece =
      placement.leftCols<2>() * (observation.end() - observation.start());
  num_points_ += observation.num_points;
  along_ += observation.num_points * along;
  along2_ += observation.num_points * (along * along + piece.head<2>().squaredNorm() / 12.0);
}

double BendTest::Width() const {
  const double mean = along_ / num_points_;
  return std::sqrt(12.0 * std::max(0.0, along2_ / num_points_ - mean * mean));
}

std::optional<Landmark> BendTest::Solve() const {
  const std::optional<CylinderEquations::Solution> solution = equations_.Solve();
  if (!solution) return std::nullopt;
  const double step = solution->step[Cylinder::kCurvatureAt];
  const double curvature = std::abs(step);
  if (solution->mean_chi2 > kMaxMeanChi2) return std::nullopt;
  // Negative where single segments bow the other way.
  const double by_bows = solution->curvature_by_bows * (step < 0.0 ? -1.0 : 1.0);
  if (!(by_bows > kCurvatureSigmas * std::sqrt(solution->variance_by_bows))) {
    return std::nullopt;
  }
  const double width_m = Width();
  if (width_m < kShowingWidth) return std::nullopt;
  const double bow_m = curvature * width_m * width_m / 8.0;
  if (bow_m < std::max({kMinBow, kMinFlatnesses * flatness_m_, kMinNoises * range_noise_m_})) {
    return std::nullopt;
  }
  if (curvature * kMinRadius > 1.0 || curvature * kMaxRadius < 1.0) return std::nullopt;
  const double angle = reference_->parameters[0] + solution->step[0];
  Landmark cylinder = MakeCylinderLandmark(
      {std::cos(angle), std::sin(angle), 0.0}, step, reference_->chart.anchor);
  cylinder.parameters[2] = solution->step[2];
  cylinder.covariance = solution->covariance;
  return cylinder;
}

}  // namespace plumbline

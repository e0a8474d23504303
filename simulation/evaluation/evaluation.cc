#include "simulation/evaluation/evaluation.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/geometry/angles.h"
#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

double Yaw(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d x = rotation * Eigen::Vector3d::UnitX();
  return std::atan2(x.y(), x.x());
}

Eigen::Quaterniond RotationFromYaw(double yaw) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
}

// The part of a pose that a planar rig can observe.
Rigid3d Flatten(const Rigid3d& pose) {
  return {RotationFromYaw(Yaw(pose.rotation)),
          Eigen::Vector3d(pose.translation.x(), pose.translation.y(), 0.0)};
}

Eigen::Vector3d RotationVector(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd angle_axis(rotation);
  return angle_axis.angle() * angle_axis.axis();
}

Eigen::Quaterniond RotationFromVector(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, vector / angle));
}

// A pose of the result and the truth at the same instant, both in the model frame.
struct PosePair {
  Rigid3d estimate;
  Rigid3d truth;
};

PoseErrors ComputePoseErrors(const std::vector<PosePair>& pairs) {
  std::vector<double> positions;
  std::vector<double> rotations;
  for (const PosePair& pair : pairs) {
    positions.push_back((pair.estimate.translation - pair.truth.translation).norm());
    const Eigen::Quaterniond error = pair.truth.rotation.conjugate() * pair.estimate.rotation;
    rotations.push_back(RotationVector(error).norm() * kDegreesPerRadian);
  }
  return {ComputeStatistics(std::move(positions)), ComputeStatistics(std::move(rotations))};
}

// The rigid motion that moves the result's positions onto the truth with least squares
// (Umeyama 1991, without scale). about_z: heading and translation only.
Rigid3d Align(const std::vector<PosePair>& pairs, bool about_z) {
  const Eigen::Index n = static_cast<Eigen::Index>(pairs.size());
  Eigen::Matrix3Xd estimate(3, n);
  Eigen::Matrix3Xd truth(3, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    estimate.col(i) = pairs[static_cast<size_t>(i)].estimate.translation;
    truth.col(i) = pairs[static_cast<size_t>(i)].truth.translation;
  }
  const Eigen::Vector3d estimate_mean = estimate.rowwise().mean();
  const Eigen::Vector3d truth_mean = truth.rowwise().mean();
  const Eigen::Matrix3d moments = (truth.colwise() - truth_mean) *
                                  (estimate.colwise() - estimate_mean).transpose() /
                                  static_cast<double>(n);
  const Eigen::Vector3d spread =
      Eigen::JacobiSVD<Eigen::Matrix3d>(moments).singularValues().cwiseSqrt();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  // Positions on one line leave the rotation around it open, and those of a rig that stands
  // still leave every rotation open.
  constexpr double kMinSpread = 0.01;  // m; less is noise
  if (spread(0) >= kMinSpread && (about_z || spread(1) < kMinSpread)) {
    rotation = RotationFromYaw(
        std::atan2(moments(1, 0) - moments(0, 1), moments(0, 0) + moments(1, 1)));
  } else if (spread(0) >= kMinSpread) {
    const Eigen::Matrix4d motion = Eigen::umeyama(estimate, truth, false);
    rotation = Eigen::Quaterniond(Eigen::Matrix3d(motion.topLeftCorner<3, 3>()));
  }
  return {rotation, truth_mean - rotation * estimate_mean};
}

// Errors of the motion between poses that lie one metre of the true path apart.
PoseErrors ComputeRelativeErrors(const std::vector<PosePair>& pairs,
                                 const std::vector<double>& path_length) {
  constexpr double kStep = 1.0;  // m, as PoseErrors relative_1m says
  std::vector<PosePair> motions;
  size_t j = 0;
  for (size_t i = 0; i < pairs.size(); ++i) {
    while (j < pairs.size() && path_length[j] - path_length[i] < kStep) ++j;
    if (j == pairs.size()) break;
    motions.push_back({pairs[i].estimate.Inverse() * pairs[j].estimate,
                       pairs[i].truth.Inverse() * pairs[j].truth});
  }
  return ComputePoseErrors(motions);
}

TrajectoryEvaluation EvaluateTrajectory(const EvaluationInput& input,
                                        const InterpolatedTrajectory& truth,
                                        const Rigid3d& model_from_truth) {
  const bool planar = input.figures.motion == "planar";
  TrajectoryEvaluation evaluation;
  std::vector<PosePair> pairs;
  std::vector<double> path_length;
  for (const StampedPose& pose : input.trajectory) {
    if (!truth.Covers(pose.time_ns)) {
      ++evaluation.num_poses_uncovered;
      continue;
    }
    PosePair pair{pose.world_from_body, model_from_truth * truth.Pose(pose.time_ns)};
    if (planar) pair = {Flatten(pair.estimate), Flatten(pair.truth)};
    if (!pairs.empty()) {
      evaluation.path_length_m +=
          (pair.truth.translation - pairs.back().truth.translation).norm();
    }
    path_length.push_back(evaluation.path_length_m);
    pairs.push_back(pair);
  }
  evaluation.num_poses = static_cast<int>(pairs.size());
  evaluation.unaligned = ComputePoseErrors(pairs);
  evaluation.relative_1m = ComputeRelativeErrors(pairs, path_length);
  evaluation.alignment = Align(pairs, planar);
  for (PosePair& pair : pairs) pair.estimate = evaluation.alignment * pair.estimate;
  evaluation.aligned = ComputePoseErrors(pairs);
  return evaluation;
}

std::vector<PlanePatch> TransformPatches(const Rigid3d& b_from_a,
                                         const std::vector<PlanePatch>& patches_a) {
  std::vector<PlanePatch> patches_b;
  for (const PlanePatch& patch : patches_a)
    patches_b.push_back(TransformPatch(b_from_a, patch));
  return patches_b;
}

}  // namespace

ErrorStatistics ComputeStatistics(std::vector<double> errors) {
  ErrorStatistics statistics;
  if (errors.empty()) return statistics;
  std::sort(errors.begin(), errors.end());
  const size_t n = errors.size();
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double error : errors) {
    sum += error;
    sum_of_squares += error * error;
  }
  statistics.mean = sum / static_cast<double>(n);
  statistics.rmse = std::sqrt(sum_of_squares / static_cast<double>(n));
  statistics.median = 0.5 * (errors[(n - 1) / 2] + errors[n / 2]);
  statistics.max = errors.back();
  double spread = 0.0;
  for (const double error : errors) spread += std::pow(error - statistics.mean, 2);
  statistics.stddev = std::sqrt(spread / static_cast<double>(n));
  return statistics;
}

InterpolatedTrajectory::InterpolatedTrajectory(const std::vector<StampedPose>& poses) {
  if (poses.size() < 2) throw Error("the true trajectory has fewer than two poses");
  for (size_t i = 1; i < poses.size(); ++i) {
    if (poses[i].time_ns <= poses[i - 1].time_ns) {
      throw Error("the true trajectory's instants do not increase at pose " +
                  std::to_string(i + 1));
    }
  }
  // Between samples that almost coincide, a polynomial only magnifies their rounding.
  const int64_t mean_step =
      (poses.back().time_ns - poses.front().time_ns) / static_cast<int64_t>(poses.size() - 1);
  for (size_t i = 0; i < poses.size(); ++i) {
    const bool is_end = i == 0 || i + 1 == poses.size();
    if (is_end || poses[i + 1].time_ns - poses[i].time_ns > mean_step / 10) {
      poses_.push_back(poses[i]);
    }
  }
}

bool InterpolatedTrajectory::Covers(int64_t time_ns) const {
  return time_ns >= poses_.front().time_ns && time_ns <= poses_.back().time_ns;
}

Rigid3d InterpolatedTrajectory::Pose(int64_t time_ns) const {
  if (!Covers(time_ns)) {
    throw Error("the true trajectory does not cover the instant " + std::to_string(time_ns) +
                " ns");
  }
  const auto later = std::upper_bound(
      poses_.begin(), poses_.end(), time_ns, [](int64_t time, const StampedPose& pose) {
        return time < pose.time_ns;
      });
  // Two samples on either side where the trajectory has them.
  const size_t num_used = std::min<size_t>(4, poses_.size());
  const size_t position = static_cast<size_t>(later - poses_.begin());
  const size_t first = std::min(position < 2 ? 0 : position - 2, poses_.size() - num_used);
  std::array<double, 4> times{};
  for (size_t i = 0; i < num_used; ++i) {
    times[i] = SecondsBetween(time_ns, poses_[first + i].time_ns);
  }
  const Rigid3d& reference = poses_[first + num_used / 2].world_from_body;
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < num_used; ++i) {
    double weight = 1.0;  // Lagrange's polynomial at time zero
    for (size_t j = 0; j < num_used; ++j) {
      if (j != i) weight *= times[j] / (times[j] - times[i]);
    }
    const Rigid3d& sample = poses_[first + i].world_from_body;
    translation += weight * sample.translation;
    rotation += weight * RotationVector(reference.rotation.conjugate() * sample.rotation);
  }
  return {(reference.rotation * RotationFromVector(rotation)).normalized(), translation};
}

ModelFrameOfTruth FindModelFrame(const EvaluationInput& input,
                                 const InterpolatedTrajectory& truth,
                                 const PlaneMatchingOptions& options) {
  // A scanner whose clock is early may have seen before the truth begins.
  const StampedPose& first = *std::find_if(
      input.trajectory.begin(), input.trajectory.end(), [&truth](const StampedPose& pose) {
        return truth.Covers(pose.time_ns);
      });
  const Rigid3d true_start = truth.Pose(first.time_ns);
  ModelFrameOfTruth frame;
  frame.model_from_truth.rotation =
      RotationFromYaw(Yaw(first.world_from_body.rotation) - Yaw(true_start.rotation));
  frame.model_from_truth.translation =
      first.world_from_body.translation -
      frame.model_from_truth.rotation * true_start.translation;
  const auto reference = std::find_if(
      input.planes.begin(), input.planes.end(), [&input](const PlanePatch& plane) {
        return plane.id == input.figures.reference_plane_id;
      });
  if (reference == input.planes.end()) return frame;
  // The heading of a single pose is less certain than a wall's, hence the wider bounds.
  PlaneMatchingOptions wide = options;
  wide.max_angle_deg *= 2.0;
  wide.max_distance_m *= 2.0;
  const int face = FindBestFace(*reference,
                                TransformPatches(frame.model_from_truth, input.truth_planes),
                                input.figures.motion == "planar",
                                wide);
  if (face < 0) return frame;
  const PlanePatch& true_wall = input.truth_planes[static_cast<size_t>(face)];
  frame.reference_face_id = true_wall.id;
  frame.model_from_truth.rotation =
      RotationFromYaw(-std::atan2(true_wall.normal.y(), true_wall.normal.x()));
  // The map's first position is its origin.
  frame.model_from_truth.translation =
      first.world_from_body.translation -
      input.trajectory.front().world_from_body.translation -
      frame.model_from_truth.rotation * true_start.translation;
  return frame;
}

Evaluation Evaluate(const EvaluationInput& input, const PlaneMatchingOptions& options) {
  if (input.trajectory.empty()) throw Error("the result's trajectory has no poses");
  const InterpolatedTrajectory truth(input.truth_trajectory);
  const bool is_covered = std::any_of(
      input.trajectory.begin(), input.trajectory.end(), [&truth](const StampedPose& pose) {
        return truth.Covers(pose.time_ns);
      });
  if (!is_covered) {
    throw Error("the result's poses, the first at " +
                std::to_string(input.trajectory.front().time_ns) +
                " ns, lie outside the time span of the truth");
  }
  Evaluation evaluation;
  evaluation.figures = input.figures;
  evaluation.frame = FindModelFrame(input, truth, options);
  const Rigid3d& model_from_truth = evaluation.frame.model_from_truth;
  evaluation.trajectory = EvaluateTrajectory(input, truth, model_from_truth);
  const bool planar = input.figures.motion == "planar";
  const std::vector<PlanePatch> truth_planes =
      TransformPatches(model_from_truth, input.truth_planes);
  evaluation.planes = MatchPlanes(input.planes, truth_planes, planar, options);
  evaluation.planes_aligned =
      MatchPlanes(TransformPatches(evaluation.trajectory.alignment, input.planes),
                  truth_planes,
                  planar,
                  options);
  return evaluation;
}

}  // namespace plumbline

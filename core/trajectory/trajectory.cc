#include "core/trajectory/trajectory.h"

#include <glog/logging.h>

#include <string>

#include "core/util/error.h"
#include "core/util/time.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

ControlPoint ControlPointAt(const Eigen::Quaterniond& rotation,
                            const Eigen::Vector3d& position) {
  ControlPoint control_point;
  Eigen::Map<Eigen::Quaterniond>(control_point.rotation.data()) = rotation.normalized();
  Eigen::Map<Eigen::Vector3d>(control_point.position.data()) = position;
  return control_point;
}

}  // namespace

Trajectory::Trajectory(int64_t start_ns,
                       int64_t knot_interval_ns,
                       const Rigid3d& world_from_body)
    : start_ns_(start_ns),
      knot_interval_ns_(knot_interval_ns),
      control_points_(kSplineOrder,
                      ControlPointAt(world_from_body.rotation, world_from_body.translation)) {
  CHECK_GT(knot_interval_ns, 0);
}

int64_t Trajectory::end_ns() const {
  return start_ns_ + (num_control_points() - (kSplineOrder - 1)) * knot_interval_ns_;
}

Trajectory::Location Trajectory::Locate(int64_t time_ns) const {
  if (time_ns < start_ns_ || time_ns >= end_ns()) {
    throw Error("instant " + std::to_string(SecondsBetween(start_ns_, time_ns)) +
                " s lies outside the trajectory, which spans 0 to " +
                std::to_string(SecondsBetween(start_ns_, end_ns())) + " s");
  }
  const int64_t since_start = time_ns - start_ns_;
  const int64_t interval = since_start / knot_interval_ns_;
  const int64_t since_knot = since_start - interval * knot_interval_ns_;
  return {static_cast<int>(interval),
          static_cast<double>(since_knot) / static_cast<double>(knot_interval_ns_)};
}

namespace {

struct Support {
  const double* rotations[kSplineOrder];
  const double* positions[kSplineOrder];
};

Support SupportAt(const Trajectory& trajectory, int first) {
  Support support;
  for (int j = 0; j < kSplineOrder; ++j) {
    const ControlPoint& control_point = trajectory.control_point(first + j);
    support.rotations[j] = control_point.rotation.data();
    support.positions[j] = control_point.position.data();
  }
  return support;
}

}  // namespace

Rigid3d Trajectory::WorldFromBody(int64_t time_ns) const {
  const Location at = Locate(time_ns);
  const Support support = SupportAt(*this, at.first);
  const SplinePose pose = EvaluatePose(support.rotations, support.positions, at.u, nullptr);
  return {pose.world_from_body, pose.position};
}

Rigid3d PoseSampler::WorldFromBody(int64_t time_ns, double delay_s) {
  Trajectory::Location at = trajectory_.Locate(time_ns);
  at.u += delay_s / trajectory_.knot_interval_s();
  const Support support = SupportAt(trajectory_, at.first);
  if (at.first != first_) {
    for (size_t j = 0; j < steps_.size(); ++j) {
      steps_[j] = MakeRotationStep(support.rotations[j], support.rotations[j + 1]);
    }
    first_ = at.first;
  }
  const SplinePose pose =
      EvaluatePose(steps_.data(), support.rotations[0], support.positions, at.u, nullptr);
  return {pose.world_from_body, pose.position};
}

SplinePoseJacobian Trajectory::PoseJacobian(const Location& at) const {
  const Support support = SupportAt(*this, at.first);
  SplinePoseJacobian jacobian;
  EvaluatePose(support.rotations, support.positions, at.u, &jacobian);
  return jacobian;
}

void Trajectory::Velocity(int64_t time_ns,
                          Eigen::Vector3d* angular_world,
                          Eigen::Vector3d* linear_world) const {
  const Location at = Locate(time_ns);
  const Support support = SupportAt(*this, at.first);
  EvaluateVelocity(support.rotations,
                   support.positions,
                   at.u,
                   knot_interval_s(),
                   angular_world,
                   linear_world);
}

void Trajectory::ExtendTo(int64_t time_ns) {
  while (time_ns >= end_ns()) {
    const ControlPoint& last = control_points_[control_points_.size() - 1];
    const ControlPoint& previous = control_points_[control_points_.size() - 2];
    const Eigen::Map<const Eigen::Quaterniond> last_rotation(last.rotation.data());
    const Eigen::Map<const Eigen::Quaterniond> previous_rotation(previous.rotation.data());
    const Eigen::Map<const Eigen::Vector3d> last_position(last.position.data());
    const Eigen::Map<const Eigen::Vector3d> previous_position(previous.position.data());
    control_points_.push_back(
        ControlPointAt(last_rotation * (previous_rotation.conjugate() * last_rotation),
                       2.0 * last_position - previous_position));
  }
}

void Trajectory::Move(const Rigid3d& to_from) {
  for (ControlPoint& control_point : control_points_) {
    const Rigid3d from_body(Eigen::Quaterniond(control_point.rotation.data()),
                            Eigen::Vector3d(control_point.position.data()));
    const Rigid3d to_body = to_from * from_body;
    control_point = ControlPointAt(to_body.rotation, to_body.translation);
  }
}

void Trajectory::Append(const Trajectory& later) {
  CHECK_EQ(later.knot_interval_ns_, knot_interval_ns_);
  CHECK_GT(later.start_ns_, start_ns_);
  CHECK_EQ((later.start_ns_ - start_ns_) % knot_interval_ns_, 0);
  const auto first = static_cast<size_t>((later.start_ns_ - start_ns_) / knot_interval_ns_);
  if (control_points_.size() > first) control_points_.resize(first);
  const size_t last = control_points_.size() - 1;
  const Eigen::Quaterniond from_rotation(control_points_[last].rotation.data());
  const Eigen::Quaterniond to_rotation(later.control_points_[0].rotation.data());
  const Eigen::Vector3d from_position(control_points_[last].position.data());
  const Eigen::Vector3d to_position(later.control_points_[0].position.data());
  for (size_t i = last + 1; i < first; ++i) {
    const double share = static_cast<double>(i - last) / static_cast<double>(first - last);
    control_points_.push_back(
        ControlPointAt(from_rotation.slerp(share, to_rotation),
                       from_position + share * (to_position - from_position)));
  }
  control_points_.insert(
      control_points_.end(), later.control_points_.begin(), later.control_points_.end());
}

void Trajectory::ShrinkTo(int64_t time_ns) {
  control_points_.resize(static_cast<size_t>(Locate(time_ns).first + kSplineOrder));
}

}  // namespace plumbline

#include "core/sensor/odometry_repair.h"

#include <algorithm>
#include <cmath>

#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

// How one pose follows another.
struct Step {
  Step(const OdometrySample& from, const OdometrySample& to)
      : way(to.position - from.position) {
    const double turn = std::remainder(to.heading - from.heading, 2.0 * M_PI);
    const double heading = from.heading + 0.5 * turn;
    seconds = SecondsBetween(from.time_ns, to.time_ns);
    ahead = way.dot(Eigen::Vector2d(std::cos(heading), std::sin(heading)));
    turn_rate = turn / seconds;
  }
  // In m/s: of the body, and by how much wheels half a metre apart differ from it in a turn.
  Eigen::Vector3d Velocity() const {
    return {way.x() / seconds, way.y() / seconds, 0.25 * turn_rate};
  }
  Eigen::Vector2d way;  // m, in the frame of the poses
  double ahead = 0.0;   // m
  double turn_rate = 0.0;  // rad/s
  double seconds = 0.0;
};

void Order(std::vector<CountedPose>* poses) {
  const auto is_not_finite = [](const CountedPose& pose) {
    return !pose.sample.position.allFinite() || !std::isfinite(pose.sample.heading);
  };
  poses->erase(std::remove_if(poses->begin(), poses->end(), is_not_finite), poses->end());
  std::stable_sort(poses->begin(), poses->end(), [](const auto& a, const auto& b) {
    return a.sample.time_ns < b.sample.time_ns;
  });
  const auto is_same_instant = [](const auto& a, const auto& b) {
    return a.sample.time_ns == b.sample.time_ns;
  };
  poses->erase(std::unique(poses->begin(), poses->end(), is_same_instant), poses->end());
}

bool IsSamePose(const OdometrySample& a, const OdometrySample& b) {
  return a.position == b.position && a.heading == b.heading;
}

// Leaves out poses that are sent again while the rig moves on; returns how many. A rig that
// stands for one step between two of a steady speed moves four times as smoothly, by the
// squared changes of its velocity, if it is taken to have moved on. None starts and stops so
// sharply: a rig for which the ratio is larger moved on.
int DropStale(std::vector<CountedPose>* poses) {
  std::vector<size_t> firsts;  // samples whose pose is another than that before
  for (size_t i = 0; i < poses->size(); ++i) {
    if (i == 0 || !IsSamePose((*poses)[i].sample, (*poses)[i - 1].sample)) firsts.push_back(i);
  }
  const auto velocity = [&](size_t from, size_t to) {
    return Step((*poses)[from].sample, (*poses)[to].sample).Velocity();
  };
  std::vector<bool> is_stale(poses->size(), false);
  for (size_t k = 1; k + 2 < firsts.size(); ++k) {
    const size_t next = firsts[k + 1];
    if (next == firsts[k] + 1) continue;
    const Eigen::Vector3d before = velocity(firsts[k - 1], firsts[k]);
    const Eigen::Vector3d after = velocity(next, firsts[k + 2]);
    const Eigen::Vector3d as_sent = velocity(next - 1, next);
    const Eigen::Vector3d throughout = velocity(firsts[k], next);
    const double changes_as_sent =
        before.squaredNorm() + as_sent.squaredNorm() + (after - as_sent).squaredNorm();
    const double changes_moving_on =
        (throughout - before).squaredNorm() + (after - throughout).squaredNorm();
    if (changes_as_sent <= 4.0 * changes_moving_on) continue;
    for (size_t i = firsts[k] + 1; i < next; ++i) is_stale[i] = true;
  }
  size_t num_kept = 0;
  for (size_t i = 0; i < poses->size(); ++i) {
    if (!is_stale[i]) (*poses)[num_kept++] = (*poses)[i];
  }
  const size_t num_dropped = poses->size() - num_kept;
  poses->resize(num_kept);
  return static_cast<int>(num_dropped);
}

// Whether the pose goes forward in a step that its velocity calls backward.
bool IsTurnedRound(const Step& step, const CountedPose& to) {
  return to.velocity.x() < 0.0 && step.ahead > 0.0;
}

// How many of the steps that their velocity calls backward go forward, where nearly all do and
// the velocity is the body's; else 0.
int CountTurnedRound(const std::vector<CountedPose>& poses) {
  int num_forward = 0;
  int num_backward = 0;
  double off_body = 0.0;   // how far the velocities are off the steps, up to their sign,
  double off_frame = 0.0;  // and as if they were in the frame of the poses
  for (size_t i = 1; i < poses.size(); ++i) {
    const Step step(poses[i - 1].sample, poses[i].sample);
    const Eigen::Vector2d& velocity = poses[i].velocity;
    off_body += std::abs(std::abs(step.ahead / step.seconds) - std::abs(velocity.x()));
    off_frame += (step.way / step.seconds - velocity).norm();
    // Those that hardly move may have either sign.
    if (std::abs(step.ahead) < 0.5 * std::abs(velocity.x()) * step.seconds) continue;
    if (velocity.x() >= 0.0) continue;
    ++(step.ahead > 0.0 ? num_forward : num_backward);
  }
  const double chance = std::sqrt(static_cast<double>(num_forward + num_backward));
  const bool is_unsigned =
      off_body < off_frame && num_forward - num_backward > kSignificantStddevs * chance;
  return is_unsigned ? num_forward : 0;
}

void TurnBackwardSteps(std::vector<CountedPose>* poses) {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  OdometrySample previous = poses->front().sample;
  for (CountedPose& pose : *poses) {
    const OdometrySample counted = pose.sample;
    if (counted.time_ns > previous.time_ns) {
      const Step step(previous, counted);
      if (IsTurnedRound(step, pose)) shift -= 2.0 * step.way;
    }
    pose.sample.position += shift;
    previous = counted;
  }
}

}  // namespace

std::vector<OdometrySample> RepairOdometry(std::vector<CountedPose> poses,
                                           std::vector<std::string>* sentences) {
  Order(&poses);
  const int num_stale = DropStale(&poses);
  if (num_stale > 0) {
    sentences->push_back(std::to_string(num_stale) +
                         (num_stale == 1 ? " pose was sent again" : " poses were sent again") +
                         " while the rig moved on, and left out");
  }
  const int num_turned = CountTurnedRound(poses);
  if (num_turned > 0) {
    TurnBackwardSteps(&poses);
    sentences->push_back(
        "the pose goes forward in " + std::to_string(num_turned) +
        " steps whose own velocity is backward: the wheels count without a sign, and these "
        "steps were turned round");
  }
  std::vector<OdometrySample> samples;
  for (const CountedPose& pose : poses) samples.push_back(pose.sample);
  return samples;
}

}  // namespace plumbline

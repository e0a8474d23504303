#include "core/trajectory/motion_prior.h"

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

// The options count as much as innovations of kInitialTime; what the scans have shown is
// forgotten by exp(-1) in kMemory.
constexpr double kInitialTime = 0.5;  // s
constexpr double kMemory = 5.0;       // s

}  // namespace

MotionPrior::MotionPrior(const TrajectoryOptions& options)
    : usual_(MotionNoise::Of(options)),
      bridging_density_(options.bridging_acceleration_density_m_s2),
      learns_(options.estimate_densities),
      initial_(usual_) {}

MotionNoise MotionPrior::At(int first) const {
  MotionNoise noise = usual_;
  if (bridged_.count(first) > 0) {
    noise.density[kHorizontal] = std::min(usual_.density[kHorizontal], bridging_density_);
  }
  return noise;
}

void MotionPrior::FollowHeight(const Trajectory& trajectory, int last) {
  usual_.vertical_velocity_m_s =
      MeanVerticalVelocity(trajectory, last - KnotsOfMean(trajectory), last);
}

void MotionPrior::Learn(const Trajectory& trajectory,
                        int first,
                        const Eigen::Vector3d& linear_variance,
                        const Eigen::Vector3d& angular_variance) {
  if (!learns_ || bridged_.count(first + 1) > 0) return;
  const double interval_s = trajectory.knot_interval_s();
  const ByMotionKind to_density = usual_.DensityPerInnovation2(interval_s);
  const KnotAcceleration e = usual_.InnovationAt(trajectory, first);
  const ByMotionKind squares =
      SumByKind(e.linear_world.cwiseAbs2(), e.angular_world.cwiseAbs2());
  const ByMotionKind variances = SumByKind(linear_variance, angular_variance);
  const double kept = std::exp(-interval_s / kMemory);
  for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
    const double usual2 = usual_.density[kind] * usual_.density[kind];
    const double initial2 = initial_.density[kind] * initial_.density[kind];
    squares_[kind] = kept * squares_[kind] + squares[kind] * to_density[kind] / initial2;
    determined_[kind] =
        kept * determined_[kind] +
        std::max(0.0, kNumAxes[kind] - variances[kind] * to_density[kind] / usual2);
    const double n0 = kInitialTime / interval_s * kNumAxes[kind];
    usual_.density[kind] =
        std::sqrt(initial2 * (n0 + squares_[kind]) / (n0 + determined_[kind]));
  }
}

void MotionPrior::Forget() {
  usual_ = initial_;
  squares_ = {};
  determined_ = {};
}

void MotionPrior::Bridge(int first, int end) {
  for (int i = first; i < end; ++i) bridged_.insert(i);
}

}  // namespace plumbline

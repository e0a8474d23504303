#include "core/trajectory/motion_noise.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/angles.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

// Number of innovations that the noise before a step counts as much as.
constexpr double kWeightBefore = 1.0;
// A step lowers a density to a tenth at most: what it finds for one that is far too large may
// be anything near zero.
constexpr double kLargestDecrease = 10.0;
// Number of innovations that the usual noise counts as much as in a stretch of the motion.
constexpr double kUsualWeight = 4.0;
constexpr double kHalfStretch = 0.25;  // s

// Time over which a vertical velocity is a mean, of some steps: two stretches of the motion.
constexpr double MeanTime() { return 4.0 * kHalfStretch; }  // s

void Add(const MotionEvidence& evidence, MotionEvidence* sum) {
  for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
    sum->squares[kind] += evidence.squares[kind];
    sum->weight[kind] += evidence.weight[kind];
  }
  sum->by_prior += evidence.by_prior;
  sum->prior_cost += evidence.prior_cost;
}

MotionNoise Likeliest(const MotionEvidence& evidence,
                      const MotionNoise& beforehand,
                      double weight) {
  MotionNoise noise = beforehand;
  for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
    const double variance = beforehand.density[kind] * beforehand.density[kind];
    noise.density[kind] =
        std::sqrt((weight * variance + std::max(0.0, evidence.squares[kind])) /
                  (weight + std::max(0.0, evidence.weight[kind])));
  }
  return noise;
}

Eigen::Vector3d Linear(const ByMotionKind& density) {
  return {density[kHorizontal], density[kHorizontal], density[kVertical]};
}

Eigen::Vector3d Angular(const ByMotionKind& density) {
  return {density[kTilt], density[kTilt], density[kYaw]};
}

}  // namespace

KnotAcceleration KnotAcceleration::At(const Trajectory& trajectory,
                                      int first,
                                      const MotionPersistence& persistence) {
  std::array<Eigen::Vector3d, 3> p;
  std::array<Eigen::Quaterniond, 3> q;
  for (int i = 0; i < 3; ++i) {
    const ControlPoint& control_point = trajectory.control_point(first + i);
    p[static_cast<size_t>(i)] = Eigen::Vector3d(control_point.position.data());
    q[static_cast<size_t>(i)] = Eigen::Quaterniond(control_point.rotation.data());
  }
  const double per_s2 = 1.0 / (trajectory.knot_interval_s() * trajectory.knot_interval_s());
  const Eigen::Vector3d turn = Log(q[2] * q[1].conjugate()) - Log(q[1] * q[0].conjugate());
  const Eigen::Vector3d mean = trajectory.knot_interval_s() * persistence.mean_velocity;
  const Eigen::Vector3d driven =
      (p[2] - p[1] - mean) - persistence.velocity.cwiseProduct(p[1] - p[0] - mean);
  return {per_s2 * driven, per_s2 * turn};
}

ByMotionKind SumByKind(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) {
  return {linear.head<2>().sum(), linear.z(), angular.head<2>().sum(), angular.z()};
}

int KnotsOfMean(const Trajectory& trajectory) {
  return std::max(1, static_cast<int>(std::lround(MeanTime() / trajectory.knot_interval_s())));
}

double MeanVerticalVelocity(const Trajectory& trajectory, int first, int last) {
  const int end = trajectory.num_control_points() - 1;
  first = std::clamp(first, 0, end);
  last = std::clamp(last, first, end);
  const double rise_m =
      trajectory.control_point(last).position[2] - trajectory.control_point(first).position[2];
  return rise_m / std::max((last - first) * trajectory.knot_interval_s(), MeanTime());
}

MotionNoise MotionNoise::Of(const TrajectoryOptions& options) {
  MotionNoise noise;
  noise.density[kHorizontal] = options.acceleration_density_m_s2;
  noise.density[kVertical] = options.acceleration_density_m_s2;
  noise.density[kTilt] = kRadiansPerDegree * options.angular_acceleration_density_deg_s2;
  noise.density[kYaw] = kRadiansPerDegree * options.angular_acceleration_density_deg_s2;
  noise.correlation_s = options.acceleration_correlation_s;
  noise.vertical_velocity_correlation_s = options.vertical_velocity_correlation_s;
  return noise;
}

double MotionNoise::Persistence(double knot_interval_s) const {
  return correlation_s > 0.0 ? std::exp(-knot_interval_s / correlation_s) : 0.0;
}

MotionPersistence MotionNoise::LinearPersistence(double knot_interval_s) const {
  const double rho = Persistence(knot_interval_s);
  return {{1.0, 1.0, std::exp(-knot_interval_s / vertical_velocity_correlation_s)},
          {rho, rho, 0.0},
          {0.0, 0.0, vertical_velocity_m_s}};
}

Eigen::Vector3d MotionNoise::LinearStddev(double knot_interval_s) const {
  const Eigen::Array3d rho = LinearPersistence(knot_interval_s).acceleration;
  return ((1.0 - rho) / (1.0 + rho) / knot_interval_s).sqrt() * Linear(density).array();
}

Eigen::Vector3d MotionNoise::AngularStddev(double knot_interval_s) const {
  const double rho = Persistence(knot_interval_s);
  return std::sqrt((1.0 - rho) / (1.0 + rho) / knot_interval_s) * Angular(density);
}

Eigen::Vector3d MotionNoise::LinearInnovationStddev(double knot_interval_s) const {
  const Eigen::Array3d rho = LinearPersistence(knot_interval_s).acceleration;
  return (1.0 - rho) / std::sqrt(knot_interval_s) * Linear(density).array();
}

Eigen::Vector3d MotionNoise::AngularInnovationStddev(double knot_interval_s) const {
  return (1.0 - Persistence(knot_interval_s)) / std::sqrt(knot_interval_s) * Angular(density);
}

ByMotionKind MotionNoise::DensityPerInnovation2(double knot_interval_s) const {
  const double innovation = 1.0 - Persistence(knot_interval_s);
  ByMotionKind factors;
  factors.fill(knot_interval_s / (innovation * innovation));
  factors[kVertical] = knot_interval_s;  // of white noise
  return factors;
}

KnotAcceleration MotionNoise::InnovationAt(const Trajectory& trajectory, int first) const {
  const double rho = Persistence(trajectory.knot_interval_s());
  const MotionPersistence linear = LinearPersistence(trajectory.knot_interval_s());
  const KnotAcceleration before = KnotAcceleration::At(trajectory, first, linear);
  const KnotAcceleration after = KnotAcceleration::At(trajectory, first + 1, linear);
  return {after.linear_world - linear.acceleration.cwiseProduct(before.linear_world),
          after.angular_world - rho * before.angular_world};
}

void MotionProfile::FollowHeight(const Trajectory& trajectory) {
  const int num_knots = KnotsOfMean(trajectory);
  for (int i = 0; i < static_cast<int>(at.size()); ++i) {
    const int first = i + 1 - num_knots / 2;
    at[static_cast<size_t>(i)].vertical_velocity_m_s =
        MeanVerticalVelocity(trajectory, first, first + num_knots);
  }
}

MotionProfile MotionProfile::Uniform(const MotionNoise& noise, const Trajectory& trajectory) {
  MotionProfile profile = {
      noise,
      std::vector<MotionNoise>(static_cast<size_t>(trajectory.num_control_points() - 2),
                               noise)};
  profile.FollowHeight(trajectory);
  return profile;
}

MotionEvidence SumOf(const std::vector<MotionEvidence>& evidence) {
  MotionEvidence sum;
  for (const MotionEvidence& of_knot : evidence) Add(of_knot, &sum);
  return sum;
}

MotionProfile MotionProfile::From(const std::vector<MotionEvidence>& evidence,
                                  const MotionNoise& before,
                                  double knot_interval_s) {
  MotionProfile profile;
  profile.usual = Likeliest(SumOf(evidence), before, kWeightBefore);
  for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
    profile.usual.density[kind] =
        std::max(profile.usual.density[kind], before.density[kind] / kLargestDecrease);
  }
  const auto num_knots = static_cast<int>(evidence.size());
  const auto reach =
      std::max(1, static_cast<int>(std::lround(kHalfStretch / knot_interval_s)));
  for (int i = 0; i < num_knots; ++i) {
    MotionEvidence near;
    for (int j = std::max(0, i - reach); j <= std::min(num_knots - 1, i + reach); ++j) {
      Add(evidence[static_cast<size_t>(j)], &near);
    }
    profile.at.push_back(Likeliest(near, profile.usual, kUsualWeight));
  }
  return profile;
}

MotionProfile MotionProfile::Of(const Trajectory& known, const MotionNoise& initial) {
  MotionProfile profile = Uniform(initial, known);
  const ByMotionKind to_density = initial.DensityPerInnovation2(known.knot_interval_s());
  std::vector<MotionEvidence> evidence(1);  // the first acceleration has none before it
  for (int i = 0; i + 3 < known.num_control_points(); ++i) {
    const KnotAcceleration e = profile.at[static_cast<size_t>(i) + 1].InnovationAt(known, i);
    MotionEvidence of_knot;
    of_knot.squares = SumByKind(e.linear_world.cwiseAbs2(), e.angular_world.cwiseAbs2());
    for (size_t kind = 0; kind < kNumMotionKinds; ++kind) {
      of_knot.squares[kind] *= to_density[kind];
    }
    of_knot.weight = kNumAxes;
    evidence.push_back(of_knot);
  }
  constexpr int kNumSteps = 4;  // each lowers a density to a tenth at most
  for (int step = 0; step < kNumSteps; ++step) {
    profile = From(evidence, profile.usual, known.knot_interval_s());
  }
  profile.FollowHeight(known);
  return profile;
}

}  // namespace plumbline

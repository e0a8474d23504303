#include "simulation/sensing/wheels.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/geometry/angles.h"
#include "core/util/time.h"
#include "simulation/world/random.h"

namespace plumbline {
namespace {

constexpr uint64_t kKey = 0x77686c73;  // of the wheels' random numbers, apart from all others

double HeadingOf(const Rigid3d& pose) {
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

// Sends poses again in place of those that follow them.
void MakeStale(const WheelOptions& options,
               uint64_t seed,
               std::vector<OdometrySample>* samples) {
  Random random({seed, kKey, 1});
  int64_t until_ns = samples->front().time_ns;
  for (size_t i = 1; i < samples->size(); ++i) {
    OdometrySample& sample = (*samples)[i];
    const OdometrySample& before = (*samples)[i - 1];
    if (sample.time_ns < until_ns) {
      sample.position = before.position;
      sample.heading = before.heading;
    } else if (random.Uniform() < options.stale_per_s / options.rate_hz) {
      until_ns = sample.time_ns + NanosecondsFromSeconds(options.stale_s);
    }
  }
}

}  // namespace

WheelOptions ReadWheels(const YamlNode& node) {
  WheelOptions options;
  node.Optional("topic", &options.topic);
  node.Optional("rate_hz", &options.rate_hz, 0.5, 1000.0);
  node.Optional("length_scale", &options.length_scale, -10.0, 10.0);
  node.Optional("turn_scale", &options.turn_scale, -10.0, 10.0);
  node.Optional("length_noise_m", &options.length_noise_m, 0.0, 1.0);
  double turn_noise_deg = 0.0;
  node.Optional("turn_noise_deg", &turn_noise_deg, 0.0, 90.0);
  options.turn_noise_rad = turn_noise_deg * kRadiansPerDegree;
  if (node.Has("slips")) {
    const YamlNode slips = node["slips"];
    options.slips_per_m = slips["per_m"].AsDouble(0.0, 10.0);
    slips.Optional("share", &options.slip_share, -10.0, 10.0);
    slips.Optional("duration_s", &options.slip_s, 0.0, 60.0);
    slips.RejectUnreadKeys();
  }
  node.Optional("clock_late_s", &options.clock_late_s, -10.0, 10.0);
  if (node.Has("stale")) {
    const YamlNode stale = node["stale"];
    options.stale_per_s = stale["per_s"].AsDouble(0.0, 10.0);
    stale.Optional("duration_s", &options.stale_s, 0.0, 60.0);
    stale.RejectUnreadKeys();
  }
  node.RejectUnreadKeys();
  return options;
}

std::vector<OdometrySample> WheelSamples(const Path& path,
                                         const WheelOptions& options,
                                         uint64_t seed) {
  Random random({seed, kKey});
  const int64_t late_ns = NanosecondsFromSeconds(options.clock_late_s);
  const int64_t period_ns = NanosecondsFromSeconds(1.0 / options.rate_hz);
  std::vector<OdometrySample> samples = {{path.start_ns() + late_ns}};
  Rigid3d before = path.PoseAt(path.start_ns());
  double slips_for_s = 0.0;
  for (int64_t time_ns = path.start_ns() + period_ns; time_ns <= path.end_ns();
       time_ns += period_ns) {
    const Rigid3d pose = path.PoseAt(time_ns);
    const double heading = HeadingOf(before);
    const Eigen::Vector2d step =
        Eigen::Rotation2Dd(-heading) * (pose.translation - before.translation).head<2>();
    const double turn = std::remainder(HeadingOf(pose) - heading, 2.0 * M_PI);
    const double length = step.norm();
    slips_for_s -= SecondsBetween(time_ns - period_ns, time_ns);
    if (random.Uniform() < options.slips_per_m * length) slips_for_s = options.slip_s;
    const double share =
        options.length_scale * (slips_for_s > 0.0 ? 1.0 + options.slip_share : 1.0);
    const double noise_m = options.length_noise_m * std::sqrt(length) * random.Gaussian();
    const double noise_rad = options.turn_noise_rad * std::sqrt(length) * random.Gaussian();
    // Noise is along the way, where there is one.
    const Eigen::Vector2d counted =
        length > 0.0 ? Eigen::Vector2d((share + noise_m / length) * step) : step;
    const OdometrySample& last = samples.back();
    samples.push_back({time_ns + late_ns,
                       last.position + Eigen::Rotation2Dd(last.heading) * counted,
                       last.heading + options.turn_scale * turn + noise_rad});
    before = pose;
  }
  if (options.stale_per_s > 0.0) MakeStale(options, seed, &samples);
  return samples;
}

}  // namespace plumbline

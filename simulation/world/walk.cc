#include "simulation/world/walk.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/util/error.h"

namespace plumbline {
namespace {

using Sample = Eigen::Matrix<double, 5, 1>;

constexpr double kLengthStep = 0.02;     // m, along the curve
constexpr double kTimeStep = 0.01;       // s, between control points
constexpr double kHalfSmoothing = 0.25;  // s, half width of the smoothing over time
constexpr double kAcceleration = 1.0;    // m/s^2
constexpr double kMinSpeed = 0.05;       // m/s, while it does not stand
constexpr double kTurnsBack = 100.0 * M_PI / 180.0;  // at a point: stands and turns

double Wrapped(double angle) { return std::remainder(angle, 2 * M_PI); }

// Weights of a raised cosine over 2 n + 1 steps, of sum 1.
std::vector<double> RaisedCosine(int n) {
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = -n; i <= n; ++i) {
    weights.push_back(1.0 + std::cos(M_PI * i / (n + 1)));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

double Heading(const Eigen::Vector3d& step) { return std::atan2(step.y(), step.x()); }

// Points between two places where the walk turns back, and the length up to each.
struct Section {
  std::vector<Eigen::Vector3d> points;
  std::vector<double> lengths = {0.0};

  void Add(const Eigen::Vector3d& point) {
    if (!points.empty()) lengths.push_back(length() + (point - points.back()).norm());
    points.push_back(point);
  }
  double length() const { return lengths.back(); }
  // Goes straight on beyond the ends.
  Eigen::Vector3d At(double s) const {
    const auto after = std::upper_bound(lengths.begin() + 1, lengths.end() - 1, s);
    const auto i = static_cast<size_t>(after - lengths.begin());
    const double share = (s - lengths[i - 1]) / (lengths[i] - lengths[i - 1]);
    return points[i - 1] + share * (points[i] - points[i - 1]);
  }
};

std::vector<Section> SectionsOf(const WalkOptions& options) {
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& point : options.points) {
    if (points.empty() || (point - points.back()).norm() > 1e-6) points.push_back(point);
  }
  if (points.size() < 2) {
    throw Error(options.location + ": a path needs at least two way points");
  }
  std::vector<Section> sections(1);
  for (size_t i = 0; i < points.size(); ++i) {
    sections.back().Add(points[i]);
    if (i == 0 || i + 1 == points.size()) continue;
    const double turn =
        Wrapped(Heading(points[i + 1] - points[i]) - Heading(points[i] - points[i - 1]));
    if (std::abs(turn) > kTurnsBack) sections.emplace_back().Add(points[i]);
  }
  return sections;
}

// One section as samples at equal steps of the length.
std::vector<Sample> Smoothed(const Section& section, double begin_m, double smooth_m) {
  const int num_steps =
      std::max(2, static_cast<int>(std::ceil(section.length() / kLengthStep)));
  const double step = section.length() / num_steps;
  const int half = std::max(1, static_cast<int>(std::lround(smooth_m / step)));
  const std::vector<double> weights = RaisedCosine(half);
  std::vector<Sample> samples(static_cast<size_t>(num_steps) + 1);
  double last_heading = 0.0;
  for (int i = 0; i <= num_steps; ++i) {
    Eigen::Vector3d place = Eigen::Vector3d::Zero();
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
    for (int j = -half; j <= half; ++j) {
      const double weight = weights[static_cast<size_t>(j + half)];
      const double s = (i + j) * step;
      place += weight * section.At(s);
      tangent += weight * (section.At(s + step / 2) - section.At(s - step / 2));
    }
    const double heading =
        i == 0 ? Heading(tangent) : last_heading + Wrapped(Heading(tangent) - last_heading);
    last_heading = heading;
    samples[static_cast<size_t>(i)] << place, heading, begin_m + i * step;
  }
  return samples;
}

// Speeds at the samples: none above what the turn allows, standing at both ends and at stops.
std::vector<double> PlanSpeed(const std::vector<Sample>& samples,
                              const std::vector<bool>& stands,
                              const WalkOptions& options) {
  const size_t n = samples.size();
  const double step = samples[1](4) - samples[0](4);
  std::vector<double> speeds(n, options.speed_m_s);
  for (size_t i = 0; i < n; ++i) {
    const size_t before = i == 0 ? 0 : i - 1;
    const size_t after = std::min(i + 1, n - 1);
    const double curvature = std::abs(samples[after](3) - samples[before](3)) /
                             (step * static_cast<double>(after - before));
    speeds[i] = std::min(speeds[i], options.max_turn_rate_rad_s / std::max(curvature, 1e-9));
    speeds[i] = stands[i] ? 0.0 : std::max(speeds[i], kMinSpeed);
  }
  const auto reachable = [&](double speed) {
    return std::sqrt(speed * speed + 2 * kAcceleration * step);
  };
  for (size_t i = 1; i < n; ++i) speeds[i] = std::min(speeds[i], reachable(speeds[i - 1]));
  for (size_t i = n - 1; i-- > 0;) speeds[i] = std::min(speeds[i], reachable(speeds[i + 1]));
  return speeds;
}

// The plan: samples at increasing times, straight in between.
class Plan {
 public:
  explicit Plan(const WalkOptions& options) : options_(options) {}

  // At the full rate, which the smoothing over time begins and ends gently.
  void Turn(double angle) {
    Sample sample = samples.back();
    sample(3) += angle;
    Add(times.back() + std::abs(angle) / options_.max_turn_rate_rad_s, sample);
  }

  void Stand(double duration) { Add(times.back() + duration, samples.back()); }

  void Go(std::vector<Sample> section) {
    if (!samples.empty()) {
      const double turn = Wrapped(section.front()(3) - samples.back()(3));
      const double offset = samples.back()(3) + turn - section.front()(3);
      Turn(turn);
      for (Sample& sample : section) sample(3) += offset;
    }
    std::vector<bool> stands(section.size(), false);
    std::vector<double> durations(section.size(), 0.0);
    stands.front() = stands.back() = true;
    const double step = section[1](4) - section[0](4);
    for (const WalkOptions::Stop& stop : options_.stops) {
      const double index = std::round((stop.at_m - section.front()(4)) / step);
      if (index < 0.0 || index >= static_cast<double>(section.size())) continue;
      stands[static_cast<size_t>(index)] = true;
      durations[static_cast<size_t>(index)] = stop.duration_s;
    }
    const std::vector<double> speeds = PlanSpeed(section, stands, options_);
    if (samples.empty()) Add(0.0, section.front());
    for (size_t i = 1; i < section.size(); ++i) {
      const double mean = std::max((speeds[i - 1] + speeds[i]) / 2, kMinSpeed);
      Add(times.back() + step / mean, section[i]);
      if (durations[i] > 0.0) Stand(durations[i]);
    }
  }

  std::vector<double> times;
  std::vector<Sample> samples;

 private:
  void Add(double time, const Sample& sample) {
    times.push_back(time);
    samples.push_back(sample);
  }

  const WalkOptions& options_;
};

}  // namespace

Walk::Walk(const WalkOptions& options) {
  Plan plan(options);
  for (const Section& section : SectionsOf(options)) {
    plan.Go(Smoothed(section, length_m_, options.smooth_m));
    length_m_ += section.length();
  }
  duration_s_ = plan.times.back();
  SampleOver(plan.times, plan.samples);
}

void Walk::SampleOver(const std::vector<double>& times, const std::vector<Sample>& samples) {
  const int half = static_cast<int>(std::lround(kHalfSmoothing / kTimeStep));
  const std::vector<double> weights = RaisedCosine(half);
  const int num_steps = static_cast<int>(std::ceil(duration_s_ / kTimeStep));
  std::vector<Sample> even;  // at every step, before smoothing
  size_t after = 1;
  for (int i = 0; i <= num_steps; ++i) {
    const double time = std::min(i * kTimeStep, duration_s_);
    while (after + 1 < times.size() && times[after] <= time) ++after;
    const double span = times[after] - times[after - 1];
    const double share = span > 0.0 ? (time - times[after - 1]) / span : 1.0;
    even.push_back(samples[after - 1] + share * (samples[after] - samples[after - 1]));
  }
  for (int i = 0; i <= num_steps; ++i) {
    Sample& sum = control_.emplace_back(Sample::Zero());
    for (int j = -half; j <= half; ++j) {
      const int index = std::clamp(i + j, 0, num_steps);
      sum += weights[static_cast<size_t>(j + half)] * even[static_cast<size_t>(index)];
    }
  }
}

WalkState Walk::At(double time_s) const {
  const double position = std::clamp(time_s, 0.0, duration_s_) / kTimeStep;
  const double index = std::floor(position);
  const double u = position - index;
  const double weights[4] = {(1 - u) * (1 - u) * (1 - u) / 6,
                             (3 * u * u * u - 6 * u * u + 4) / 6,
                             (-3 * u * u * u + 3 * u * u + 3 * u + 1) / 6,
                             u * u * u / 6};
  Sample sample = Sample::Zero();
  for (int i = 0; i < 4; ++i) {
    const auto last = static_cast<int>(control_.size()) - 1;
    const int at = std::clamp(static_cast<int>(index) + i - 1, 0, last);
    sample += weights[i] * control_[static_cast<size_t>(at)];
  }
  return {sample.head<3>(), sample(3), sample(4)};
}

}  // namespace plumbline

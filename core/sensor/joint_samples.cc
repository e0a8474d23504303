#include "core/sensor/joint_samples.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/util/quantiles.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

using Terms = Eigen::Matrix<double, 6, 1>;  // of a polynomial

bool IsEarlier(const JointSample& a, const JointSample& b) { return a.time_ns < b.time_ns; }

struct SmoothAngles {
  std::vector<double> angles_rad;
  double squares = 0.0;  // sum over the samples of what the others leave of each
};

// Fits the samples within so much time to either side of each.
SmoothAngles FitWithin(const std::vector<JointSample>& samples, int64_t reach_ns) {
  SmoothAngles smooth;
  const double reach_s = SecondsBetween(0, reach_ns);
  auto begin = samples.begin();
  auto end = samples.begin();
  for (const JointSample& sample : samples) {
    while (begin->time_ns < sample.time_ns - reach_ns) ++begin;
    while (end != samples.end() && end->time_ns <= sample.time_ns + reach_ns) ++end;
    smooth.angles_rad.push_back(sample.angle_rad);
    if (end - begin <= Terms::SizeAtCompileTime) continue;
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Terms right = Terms::Zero();
    for (auto other = begin; other != end; ++other) {
      const double t = SecondsBetween(sample.time_ns, other->time_ns) / reach_s;
      const double t2 = t * t;
      const Terms powers = (Terms() << 1.0, t, t2, t * t2, t2 * t2, t * t2 * t2).finished();
      normal += powers * powers.transpose();
      right += powers * (other->angle_rad - sample.angle_rad);
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factor(normal);
    const double change = factor.solve(right)[0];
    const double own_share = factor.solve(Terms::Unit(0))[0];  // of its fitted angle
    smooth.angles_rad.back() += change;
    smooth.squares += std::pow(change / std::max(1.0 - own_share, 1e-9), 2);
  }
  return smooth;
}

}  // namespace

void SortAndUnwrap(std::vector<JointSample>* samples) {
  const auto is_not_finite = [](const JointSample& sample) {
    return !std::isfinite(sample.angle_rad);
  };
  const auto is_same_instant = [](const JointSample& a, const JointSample& b) {
    return a.time_ns == b.time_ns;
  };
  samples->erase(std::remove_if(samples->begin(), samples->end(), is_not_finite),
                 samples->end());
  std::stable_sort(samples->begin(), samples->end(), IsEarlier);
  samples->erase(std::unique(samples->begin(), samples->end(), is_same_instant),
                 samples->end());
  for (size_t i = 1; i < samples->size(); ++i) {
    const double before = (*samples)[i - 1].angle_rad;
    (*samples)[i].angle_rad =
        before + std::remainder((*samples)[i].angle_rad - before, 2.0 * M_PI);
  }
}

void Smooth(std::vector<JointSample>* samples) {
  if (samples->size() <= Terms::SizeAtCompileTime) return;
  std::vector<double> steps_s;
  for (size_t i = 1; i < samples->size(); ++i) {
    steps_s.push_back(SecondsBetween((*samples)[i - 1].time_ns, (*samples)[i].time_ns));
  }
  // A reach of three and a half steps has one sample more than the polynomial has terms.
  double reach_s = 3.5 * Median(std::move(steps_s));
  const double whole_s = SecondsBetween(samples->front().time_ns, samples->back().time_ns);
  SmoothAngles best;
  best.squares = std::numeric_limits<double>::infinity();
  for (; reach_s < whole_s; reach_s *= M_SQRT2) {
    SmoothAngles smooth = FitWithin(*samples, NanosecondsFromSeconds(reach_s));
    if (!(smooth.squares < best.squares)) break;
    best = std::move(smooth);
  }
  for (size_t i = 0; i < best.angles_rad.size(); ++i) {
    (*samples)[i].angle_rad = best.angles_rad[i];
  }
}

}  // namespace plumbline

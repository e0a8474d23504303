#include "core/association/joint_association.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/association/association.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Observations whose hypotheses are tried as starts: that all of these are clutter is
// unlikely.
constexpr size_t kMaxStartObservations = 6;

// Small products below are lazy: general ones cost more than they compute.

// Estimated error of the prediction after some hypotheses, and how likely these are.
class Chain {
 public:
  explicit Chain(const MotionCovariance& covariance) : covariance_(covariance) {}

  // -2 ln of the hypothesis's density, infinite beyond the gate.
  double Cost(const JointHypothesis& hypothesis, double gate) const {
    const Eigen::Vector2d value = hypothesis.value + hypothesis.by_motion.lazyProduct(error_);
    const Eigen::Matrix2d total = Total(hypothesis);
    const double distance2 = value.dot(total.inverse() * value);
    if (!(distance2 < gate)) return std::numeric_limits<double>::infinity();
    return distance2 + std::log(total.determinant()) + 2.0 * std::log(2.0 * M_PI);
  }

  void Add(const JointHypothesis& hypothesis, size_t index, double cost) {
    const Eigen::Matrix<double, 12, 2> cross =
        covariance_.lazyProduct(hypothesis.by_motion.transpose());
    const Eigen::Matrix2d total = hypothesis.noise + hypothesis.by_motion.lazyProduct(cross);
    const Eigen::Matrix<double, 12, 2> gain = cross.lazyProduct(total.inverse());
    const Eigen::Vector2d value = hypothesis.value + hypothesis.by_motion.lazyProduct(error_);
    error_ -= gain.lazyProduct(value);
    covariance_ -= gain.lazyProduct(cross.transpose());
    chosen_.push_back(index);
    cost_ += cost;
  }

  void AddCost(double cost) { cost_ += cost; }
  double cost() const { return cost_; }
  const std::vector<size_t>& chosen() const { return chosen_; }

 private:
  Eigen::Matrix2d Total(const JointHypothesis& hypothesis) const {
    const Eigen::Matrix<double, 2, 12> product = hypothesis.by_motion.lazyProduct(covariance_);
    return hypothesis.noise + product.lazyProduct(hypothesis.by_motion.transpose());
  }

  MotionError error_ = MotionError::Zero();
  MotionCovariance covariance_;
  std::vector<size_t> chosen_;
  double cost_ = 0.0;
};

}  // namespace

Eigen::Matrix<double, 6, 12> PoseByMotion(double share) {
  Eigen::Matrix<double, 6, 12> by_motion = Eigen::Matrix<double, 6, 12>::Zero();
  by_motion.leftCols<6>().diagonal().setConstant(1.0 - share);
  by_motion.rightCols<6>().diagonal().setConstant(share);
  return by_motion;
}

Eigen::Matrix<double, 6, 6> PoseCovariance(const MotionCovariance& covariance, double share) {
  const double before = 1.0 - share;
  return before * before * covariance.topLeftCorner<6, 6>() +
         before * share *
             (covariance.topRightCorner<6, 6>() + covariance.bottomLeftCorner<6, 6>()) +
         share * share * covariance.bottomRightCorner<6, 6>();
}

double ClutterCost(const AssociationOptions& options) {
  return 2.0 * std::log(2.0 * options.max_gap_m * M_PI);
}

JointChoice ChooseJointly(const std::vector<JointHypothesis>& hypotheses,
                          const MotionCovariance& covariance,
                          const AssociationOptions& options) {
  const double gate = TwoDegreesQuantile(options.significance);
  const double clutter_cost = ClutterCost(options);
  std::vector<std::pair<size_t, size_t>> groups;  // begin, end; one for each observation
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    if (i == 0 || hypotheses[i].observation_index != hypotheses[i - 1].observation_index) {
      groups.emplace_back(i, i);
    }
    ++groups.back().second;
  }
  const auto continue_chain = [&](size_t start_group, Chain* chain) {
    for (size_t g = 0; g < groups.size(); ++g) {
      if (g == start_group) continue;
      double best_cost = clutter_cost;
      size_t best = groups[g].second;
      for (size_t i = groups[g].first; i < groups[g].second; ++i) {
        const double cost = chain->Cost(hypotheses[i], gate);
        if (cost >= best_cost) continue;
        best_cost = cost;
        best = i;
      }
      if (best < groups[g].second) {
        chain->Add(hypotheses[best], best, best_cost);
      } else {
        chain->AddCost(clutter_cost);
      }
    }
  };
  Chain best(covariance);
  double best_cost = clutter_cost * static_cast<double>(groups.size());
  for (size_t g = 0; g < std::min(groups.size(), kMaxStartObservations); ++g) {
    for (size_t i = groups[g].first; i < groups[g].second; ++i) {
      // From a hypothesis of the best chain so far one would come to the same chain again.
      const std::vector<size_t>& known = best.chosen();
      if (std::find(known.begin(), known.end(), i) != known.end()) continue;
      Chain chain(covariance);
      const double cost = chain.Cost(hypotheses[i], gate);
      if (cost >= clutter_cost) continue;
      chain.Add(hypotheses[i], i, cost);
      continue_chain(g, &chain);
      if (chain.cost() >= best_cost) continue;
      best_cost = chain.cost();
      best = std::move(chain);
    }
  }
  return {best.chosen(), best_cost};
}

}  // namespace plumbline

#include "core/estimation/aitken_extrapolation.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

double AitkenRelaxation(const Eigen::VectorXd& step,
                        const Eigen::VectorXd& last_step,
                        double last_lengthening,
                        const Eigen::VectorXd& weights) {
  constexpr double kMinRatio = 0.5;  // of the two steps
  constexpr double kMinCosine = 0.9;
  constexpr double kMaxLengthening = 20.0;
  const double product = step.dot(weights.cwiseProduct(last_step));
  const double square = step.dot(weights.cwiseProduct(step));
  const double last_square = last_step.dot(weights.cwiseProduct(last_step));
  if (!(product > kMinRatio * last_square)) return 1.0;
  if (!(product > kMinCosine * std::sqrt(square * last_square))) return 1.0;
  const double share = (1.0 - product / last_square) / last_lengthening;  // of the way
  if (!(share * kMaxLengthening > 1.0)) return kMaxLengthening;
  return std::max(1.0, 1.0 / share);
}

}  // namespace plumbline

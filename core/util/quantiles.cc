#include "core/util/quantiles.h"

#include <algorithm>
#include <cmath>

namespace plumbline {

// Newton's steps on log P(|z| > x), which is almost a parabola and concave: they arrive from
// above, with all digits after a few of them.
double TwoSidedNormalQuantile(double probability) {
  constexpr double kLargest = 37.0;  // its probability is the smallest that a double holds
  if (probability >= 1.0) return 0.0;
  if (!(probability > std::erfc(kLargest * M_SQRT1_2))) return kLargest;
  const double logarithm = std::log(probability);
  double x = std::sqrt(-2.0 * logarithm);
  for (int iteration = 0; iteration < 20; ++iteration) {
    const double tail = std::erfc(x * M_SQRT1_2);
    const double density = std::sqrt(2.0 / M_PI) * std::exp(-0.5 * x * x);
    const double step = tail / density * (std::log(tail) - logarithm);
    x = std::max(0.0, x + step);
    if (std::abs(step) < 1e-9) break;
  }
  return x;
}

double Chi2Quantile(int degrees, double normal_quantile) {
  const double a = 2.0 / (9.0 * degrees);
  const double root = 1.0 - a + normal_quantile * std::sqrt(a);
  return degrees * root * root * root;
}

double TwoDegreesQuantile(double significance) { return -2.0 * std::log(significance); }

}  // namespace plumbline

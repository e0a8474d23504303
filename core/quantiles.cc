#include "core/quantiles.h"

#include <cmath>

namespace plumbline {

double TwoSidedNormalQuantile(double probability) {
  double low = 0.0;
  double high = 40.0;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle * M_SQRT1_2) > probability ? low : high) = middle;
  }
  return high;
}

double Chi2Quantile(int degrees, double normal_quantile) {
  const double a = 2.0 / (9.0 * degrees);
  const double root = 1.0 - a + normal_quantile * std::sqrt(a);
  return degrees * root * root * root;
}

}  // namespace plumbline

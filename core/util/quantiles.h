#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace plumbline {

// Standard deviations beyond which a difference is not taken for chance.
inline constexpr double kSignificantStddevs = 3.0;

// x with P(|z| > x) = probability for a standard normal z.
double TwoSidedNormalQuantile(double probability);

// Upper quantile of the chi square distribution by Wilson and Hilferty's approximation, for
// the normal quantile of the same probability.
double Chi2Quantile(int degrees, double normal_quantile);

// -2 ln(significance): the quantile of a chi-square variable of two degrees of freedom.
double TwoDegreesQuantile(double significance);

// The value of a sample below which a share of the others lies; 0 of none.
template <typename T>
T SampleQuantile(std::vector<T> values, double share) {
  if (values.empty()) return T();
  const auto at = values.begin() +
                  static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// The median of a sample, of an even number of values the larger one of the two in the middle;
// 0 of none.
template <typename T>
T Median(std::vector<T> values) {
  if (values.empty()) return T();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace plumbline

#pragma once

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

}  // namespace plumbline

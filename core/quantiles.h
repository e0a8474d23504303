#pragma once

namespace plumbline {

// x with P(|z| > x) = probability for a standard normal z.
double TwoSidedNormalQuantile(double probability);

// Upper quantile of the chi square distribution by Wilson and Hilferty's approximation, for
// the normal quantile of the same probability.
double Chi2Quantile(int degrees, double normal_quantile);

}  // namespace plumbline

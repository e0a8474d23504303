#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/estimation/arrowhead_cholesky.h"

namespace plumbline {

class ErrorPatterns;

// CorrelatedErrors is what the residuals of a recording say of errors that repeat from scan to
// scan, and what these add to the covariance of an estimate that takes all errors as
// independent. Covariance of the estimate: H^-1 + sum over the patterns of variance times the
// square of what a pattern does to the estimate.
struct CorrelatedErrors {
  double unevenness_m = 0.0;  // standard deviation of a surface from its plane
  double range_bias_m = 0.0;  // standard deviations of what is wrong with a scanner
  double rotation_rad = 0.0;
  double translation_m = 0.0;
  // Empty where there are none.
  // The covariance to be added is that of shift * x, x of unit covariance. Rows: the layout's
  // columns.
  Eigen::MatrixXd shift;
  // The same of the landmarks' parameters alone, without the probes' own scatter.
  Eigen::MatrixXd landmarks;
};

// Whether the patterns are in the residuals beyond what the independent noise does. They may
// have been summed up from some of the segments only.
bool ShowCorrelatedErrors(const ErrorPatterns& patterns, const ArrowheadCholesky& factor);

// Estimates the patterns' variances from the residuals, and their effect. What the
// independent noise explains is not counted: where the recording shows no more, all is zero.
// factor: of the normal matrix that the patterns were summed up with. rescore: calls
// patterns->RescoreCells() for all segments.
CorrelatedErrors EstimateCorrelatedErrors(const ArrowheadCholesky& factor,
                                          const std::function<void()>& rescore,
                                          ErrorPatterns* patterns);

}  // namespace plumbline

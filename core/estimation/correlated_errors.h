#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/estimation/arrowhead_cholesky.h"
#include "core/map/observation.h"

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

// Calls a function for segments.
using VisitSegments = std::function<void(const std::function<void(const Observation&)>&)>;

// What the residuals say each surface deviates by from its plane, m, by landmark: the same for
// all, but for those whose scores exceed what that explains. A plane that stands for balusters
// or drawers deviates by several times as much as a wall. Empty where no surface deviates;
// nothing where no pattern is in the residuals beyond what the independent noise does.
// `patterns` may have been summed up from some of the segments only; for_each: calls a
// function for these.
std::optional<std::vector<double>> EstimateDeviations(const ArrowheadCholesky& factor,
                                                      const VisitSegments& for_each,
                                                      ErrorPatterns* patterns);

// Estimates the patterns' variances from the residuals, and their effect. What the
// independent noise explains is not counted: where the recording shows no more, all is zero.
// factor: of the normal matrix that the patterns were summed up with. for_each: calls a
// function for all segments.
CorrelatedErrors EstimateCorrelatedErrors(const ArrowheadCholesky& factor,
                                          const VisitSegments& for_each,
                                          ErrorPatterns* patterns);

}  // namespace plumbline

#include "core/estimation/correlated_errors.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "core/estimation/error_patterns.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {

// Kinds of a scanner's errors.
enum Kind { kRange, kRotation, kTranslation, kNumKinds };
// Size of a scanner's errors, m and rad, where the iteration for their variances starts.
constexpr double kScale = 0.01;
constexpr int kIterations = 300;
// Share of the largest eigenvalue of the information below which a direction is open: what the
// linearisation leaves out would be taken for errors there.
constexpr double kMinInformation = 1e-4;
// Root mean square of what bilinear interpolation leaves of independent nodes: 2/3 in each
// direction, of the variance.
constexpr double kInterpolated = 2.0 / 3.0;
constexpr double kMinVariance = 1e-10;  // relative to the scale's square

Kind KindOf(int pattern) {
  const int part = pattern % ErrorPatterns::kPerScanner;
  return part == 0 ? kRange : part < 4 ? kRotation : kTranslation;
}

// Products of all patterns V, V^T Q V, where Q takes away what the estimate adapts to. They
// are the scores' covariance by noise, and what the scores are of an error of 1.
Eigen::MatrixXd AdaptedProducts(const ErrorPatterns& patterns,
                                const Eigen::MatrixXd& loads,
                                const Eigen::MatrixXd& shifts) {
  const Eigen::Index size = patterns.products().cols();
  return patterns.products() - loads.leftCols(size).transpose() * shifts.leftCols(size);
}

// The variance of the cells' deviation by the method of moments: with the scores q = F^T r and
// A = F^T Q F, E q q^T = A + variance A^2. The traces are estimated from the probes' products.
double CellVariance(const std::vector<double>& scores, const Eigen::MatrixXd& products) {
  const auto probes = products.bottomRightCorner(ErrorPatterns::kNumTraceProbes,
                                                 ErrorPatterns::kNumTraceProbes);
  const double trace = probes.trace() / ErrorPatterns::kNumTraceProbes;
  const double trace_of_square =
      (probes.squaredNorm() - probes.diagonal().squaredNorm()) /
      (ErrorPatterns::kNumTraceProbes * (ErrorPatterns::kNumTraceProbes - 1));
  const double sum = std::inner_product(scores.begin(), scores.end(), scores.begin(), 0.0);
  VLOG(1) << scores.size() << " cells: sum of squares " << sum << ", by noise " << trace
          << " +- " << std::sqrt(2.0 * trace_of_square);
  const double excess = sum - trace;
  if (!(excess > kSignificantStddevs * std::sqrt(2.0 * trace_of_square))) return 0.0;
  return excess / trace_of_square;
}

// The scanners' errors, scaled to numbers of the size of one, in a basis of those directions
// that the residuals show.
struct KnownErrors {
  Eigen::VectorXd information;  // of each direction
  Eigen::MatrixXd basis;        // scaled errors x directions
};

KnownErrors FindKnownErrors(const ErrorPatterns& patterns, const Eigen::MatrixXd& products) {
  const int size = patterns.num_scanner_patterns();
  if (size == 0) return {};
  // What moves all scanners together only moves the body's frame. All scales are the same.
  const Eigen::MatrixXd common = patterns.CommonScannerPatterns();
  const Eigen::MatrixXd apart =
      Eigen::MatrixXd::Identity(size, size) - common * common.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::MatrixXd(kScale * kScale * apart * products.topLeftCorner(size, size) * apart));
  const Eigen::VectorXd& eigenvalues = solver.eigenvalues();
  const Eigen::Index count =
      (eigenvalues.array() > kMinInformation * eigenvalues.maxCoeff()).count();
  return {eigenvalues.tail(count), solver.eigenvectors().rightCols(count)};
}

struct ScannerErrors {
  Eigen::VectorXd mean;
  std::array<double, kNumKinds> variances = {};
  Eigen::MatrixXd root;  // root root^T: expected square of the errors
};

// Empirical Bayes: the errors of each kind have a variance of their own, which is found by
// expectation maximisation. noise: covariance of the patterns' scores.
ScannerErrors EstimateScannerErrors(const KnownErrors& known,
                                    const Eigen::MatrixXd& noise,
                                    const Eigen::VectorXd& scores) {
  const Eigen::Index size = scores.size();
  const Eigen::MatrixXd to_basis = kScale * known.basis.transpose();
  const Eigen::LDLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(to_basis * noise * to_basis.transpose()));
  const Eigen::MatrixXd by_error = known.information.asDiagonal() * known.basis.transpose();
  const Eigen::MatrixXd weight = by_error.transpose() * factor.solve(by_error);
  const Eigen::VectorXd weighted = by_error.transpose() * factor.solve(to_basis * scores);
  std::array<double, kNumKinds> variances;
  variances.fill(1.0);
  Eigen::MatrixXd posterior;
  Eigen::VectorXd mean;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::MatrixXd prior = weight;
    for (int i = 0; i < size; ++i) prior(i, i) += 1.0 / variances[KindOf(i)];
    posterior = prior.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
    mean = posterior * weighted;
    std::array<double, kNumKinds> sums = {};
    std::array<int, kNumKinds> counts = {};
    for (int i = 0; i < size; ++i) {
      const Kind kind = KindOf(i);
      sums[kind] += mean[i] * mean[i] + posterior(i, i);
      ++counts[kind];
    }
    for (size_t kind = 0; kind < kNumKinds; ++kind) {
      variances[kind] = std::max(kMinVariance, sums[kind] / counts[kind]);
    }
  }
  ScannerErrors errors;
  for (size_t kind = 0; kind < kNumKinds; ++kind) {
    errors.variances[kind] = variances[kind] * kScale * kScale;
  }
  const Eigen::VectorXd found = kScale * mean;
  VLOG(1) << "scanner errors " << found.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(found * found.transpose() +
                                                              kScale * kScale * posterior);
  errors.mean = found;
  errors.root =
      solver.eigenvectors() * solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return errors;
}

struct ErrorVariances {
  double cells = 0.0;
  ScannerErrors scanners;
};

// loads, shifts: of the estimate by the patterns. What a scanner's errors do to a cell is no
// unevenness: they are taken away first, as far as the two can be told apart.
ErrorVariances EstimateVariances(const Eigen::MatrixXd& loads,
                                 const Eigen::MatrixXd& shifts,
                                 const VisitSegments& for_each,
                                 ErrorPatterns* patterns) {
  const int num_scanner = patterns->num_scanner_patterns();
  const Eigen::MatrixXd products = AdaptedProducts(*patterns, loads, shifts);
  const KnownErrors known = FindKnownErrors(*patterns, products);
  const Eigen::MatrixXd crossed =
      products.topRightCorner(num_scanner, ErrorPatterns::kNumTraceProbes);
  const auto find_scanners = [&](double cells) {
    if (num_scanner == 0) return ScannerErrors();  // the estimate has them
    return EstimateScannerErrors(
        known,
        products.topLeftCorner(num_scanner, num_scanner) +
            cells / ErrorPatterns::kNumTraceProbes * crossed * crossed.transpose(),
        patterns->scanner_scores());
  };
  ErrorVariances found;
  found.cells = CellVariance(patterns->cell_scores(), products);
  found.scanners = find_scanners(found.cells);
  if (found.cells == 0.0) return found;
  patterns->Explain(found.scanners.mean, shifts.leftCols(num_scanner) * found.scanners.mean);
  for_each([&](const Observation& observation) { patterns->RescoreCells(observation); });
  found.cells = CellVariance(patterns->cell_scores(), products);
  found.scanners = find_scanners(found.cells);
  return found;
}

// Whether the patterns are in the residuals beyond what the independent noise does. shifts: of
// the estimate by their loads.
bool AreInResiduals(const ErrorPatterns& patterns, const Eigen::MatrixXd& shifts) {
  const Eigen::MatrixXd products = AdaptedProducts(patterns, patterns.loads(), shifts);
  if (CellVariance(patterns.cell_scores(), products) > 0.0) return true;
  const KnownErrors known = FindKnownErrors(patterns, products);
  const Eigen::VectorXd scores = kScale * known.basis.transpose() * patterns.scanner_scores();
  const double sum = scores.cwiseAbs2().cwiseQuotient(known.information).sum();
  const auto freedom = static_cast<double>(scores.size());
  VLOG(1) << "scanners: sum of squares " << sum << " of " << freedom;
  return freedom > 0.0 && sum > freedom + kSignificantStddevs * std::sqrt(2.0 * freedom);
}

}  // namespace

std::optional<std::vector<double>> EstimateDeviations(const ArrowheadCholesky& factor,
                                                      const VisitSegments& for_each,
                                                      ErrorPatterns* patterns) {
  const Eigen::MatrixXd shifts = factor.Solve(patterns->loads());
  if (!AreInResiduals(*patterns, shifts)) return std::nullopt;
  const ErrorVariances found =
      EstimateVariances(patterns->loads(), shifts, for_each, patterns);
  if (found.cells == 0.0) return std::vector<double>();
  const Eigen::MatrixXd by_probes =
      shifts.middleCols<ErrorPatterns::kNumTraceProbes>(patterns->num_scanner_patterns());
  for_each(
      [&](const Observation& observation) { patterns->ScoreProbes(observation, by_probes); });
  std::vector<double> deviations;
  for (const ErrorPatterns::SurfaceScores& surface : patterns->ScoresBySurface()) {
    const double own = surface.squares - surface.by_noise;
    const double largest_of_all =
        found.cells * (surface.by_deviation + kSignificantStddevs * surface.stddev);
    deviations.push_back(
        std::sqrt(own > largest_of_all ? own / surface.by_deviation : found.cells));
  }
  return deviations;
}

CorrelatedErrors EstimateCorrelatedErrors(const ArrowheadCholesky& factor,
                                          const VisitSegments& for_each,
                                          ErrorPatterns* patterns) {
  const int num_scanner = patterns->num_scanner_patterns();
  const Eigen::MatrixXd loads = patterns->loads().leftCols(patterns->products().cols());
  Eigen::MatrixXd shifts = factor.Solve(patterns->TakeLoads());
  const ErrorVariances found = EstimateVariances(loads, shifts, for_each, patterns);

  CorrelatedErrors errors;
  errors.unevenness_m =
      kInterpolated * std::sqrt(found.cells * patterns->MeanSquareDeviation());
  errors.range_bias_m = std::sqrt(found.scanners.variances[kRange]);
  errors.rotation_rad = std::sqrt(found.scanners.variances[kRotation]);
  errors.translation_m = std::sqrt(found.scanners.variances[kTranslation]);
  shifts.leftCols(num_scanner) *= found.scanners.root;
  shifts.rightCols(ErrorPatterns::kNumProbes) *=
      std::sqrt(found.cells / ErrorPatterns::kNumProbes);
  errors.shift = std::move(shifts);
  const Eigen::MatrixXd effects = patterns->TakeCellEffectsOnLandmarks();
  const auto by_scanners = errors.shift.leftCols(num_scanner).bottomRows(effects.rows());
  errors.landmarks = by_scanners * by_scanners.transpose();
  errors.landmarks.selfadjointView<Eigen::Lower>().rankUpdate(effects, found.cells);
  errors.landmarks.triangularView<Eigen::StrictlyUpper>() = errors.landmarks.transpose();
  return errors;
}

}  // namespace plumbline

#include "core/estimation/correlated_errors.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace plumbline {
namespace {

constexpr int kNumProbes = ErrorPatterns::kNumProbes;
constexpr int kNumTraceProbes = ErrorPatterns::kNumTraceProbes;
// Unevenness is believed where it is so many standard deviations beyond what noise does.
constexpr double kSignificance = 3.0;

// Kinds of a scanner's errors, and the size of each that is unlikely to be exceeded: where the
// iteration starts.
enum Kind { kRange, kRotation, kTranslation, kNumKinds };
constexpr std::array<double, kNumKinds> kScale = {0.01, 0.01, 0.01};
constexpr int kIterations = 300;
// Share of the largest eigenvalue of the information below which a direction is open: what the
// linearisation leaves out would be taken for errors there.
constexpr double kMinInformation = 1e-4;
constexpr double kMinVariance = 1e-10;  // relative to the scale's square

Kind KindOf(int pattern) {
  const int part = pattern % ErrorPatterns::kPerScanner;
  return part == 0 ? kRange : part < 4 ? kRotation : kTranslation;
}

// The variance of the cells' deviation by the method of moments: with the scores
// q = F^T r and A = F^T Q F, where Q takes away what the estimate adapts to,
// E q q^T = A + variance A^2. The traces are estimated from the probes.
double CellVariance(const std::vector<double>& scores, const Eigen::MatrixXd& probes) {
  const double trace = probes.trace() / kNumTraceProbes;
  const Eigen::MatrixXd off =
      probes - Eigen::MatrixXd(probes.diagonal().asDiagonal());
  const double trace_of_square =
      off.squaredNorm() / (kNumTraceProbes * (kNumTraceProbes - 1));
  const double sum =
      std::inner_product(scores.begin(), scores.end(), scores.begin(), 0.0);
  const double excess = sum - trace;
  VLOG(1) << "cells " << scores.size() << ", sum " << sum << ", trace " << trace << ", of square "
          << trace_of_square;
  if (!(excess > kSignificance * std::sqrt(2.0 * trace_of_square))) return 0.0;
  return excess / trace_of_square;
}

struct ScannerErrors {
  Eigen::VectorXd mean;
  std::array<double, kNumKinds> variances = {};
  Eigen::MatrixXd root;  // root root^T: expected square of the errors
};

// Empirical Bayes: the errors of each kind have a variance of their own, which is found by
// expectation maximisation. scores = information * errors + noise of this covariance.
ScannerErrors EstimateScannerErrors(const Eigen::MatrixXd& information,
                                    const Eigen::MatrixXd& noise,
                                    const Eigen::VectorXd& scores) {
  const Eigen::Index size = scores.size();
  Eigen::VectorXd scale(size);
  for (int i = 0; i < size; ++i) scale[i] = kScale[KindOf(i)];
  // What moves all scanners together only moves the body's frame: the residuals say nothing.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> known(
      Eigen::MatrixXd(scale.asDiagonal() * information * scale.asDiagonal()));
  const Eigen::VectorXd& eigenvalues = known.eigenvalues();
  const Eigen::Index num_known =
      (eigenvalues.array() > kMinInformation * eigenvalues.maxCoeff()).count();
  const Eigen::MatrixXd basis = known.eigenvectors().rightCols(num_known);
  const Eigen::MatrixXd to_basis = basis.transpose() * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> factor(
      Eigen::MatrixXd(to_basis * noise * to_basis.transpose()));
  const Eigen::MatrixXd by_error =
      eigenvalues.tail(num_known).asDiagonal() * basis.transpose();
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
      sums[KindOf(i)] += mean[i] * mean[i] + posterior(i, i);
      ++counts[KindOf(i)];
    }
    for (size_t kind = 0; kind < kNumKinds; ++kind) {
      variances[kind] = std::max(kMinVariance, sums[kind] / counts[kind]);
    }
  }
  ScannerErrors errors;
  for (size_t kind = 0; kind < kNumKinds; ++kind) {
    errors.variances[kind] = variances[kind] * kScale[kind] * kScale[kind];
  }
  const Eigen::VectorXd found = scale.cwiseProduct(mean);
  VLOG(1) << "scanner errors " << found.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      found * found.transpose() + scale.asDiagonal() * posterior * scale.asDiagonal());
  errors.mean = found;
  errors.root = solver.eigenvectors() *
                solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  return errors;
}

}  // namespace

CorrelatedErrors EstimateCorrelatedErrors(const ArrowheadCholesky& factor,
                                          const std::function<void()>& rescore,
                                          ErrorPatterns* patterns) {
  const int num_scanner = patterns->num_scanner_patterns();
  const Eigen::Index num_products = patterns->products().cols();
  const Eigen::MatrixXd shifts = factor.Solve(patterns->loads());
  // V^T Q V of the scanners' patterns and some probes.
  Eigen::MatrixXd products = patterns->products();
  products.noalias() -=
      patterns->loads().leftCols(num_products).transpose() * shifts.leftCols(num_products);
  const Eigen::MatrixXd information = products.topLeftCorner(num_scanner, num_scanner);
  const Eigen::MatrixXd crossed = products.topRightCorner(num_scanner, kNumTraceProbes);
  const Eigen::MatrixXd of_probes =
      products.bottomRightCorner(kNumTraceProbes, kNumTraceProbes);
  const auto scanners_beside = [&](double cells) {
    return EstimateScannerErrors(
        information,
        information + cells / kNumTraceProbes * crossed * crossed.transpose(),
        patterns->scanner_scores());
  };
  // What a scanner's errors do to a cell is no unevenness: they are taken away first, as far
  // as the two can be told apart.
  double cells = CellVariance(patterns->cell_scores(), of_probes);
  ScannerErrors scanners = scanners_beside(cells);
  if (cells > 0.0) {
    patterns->Explain(scanners.mean, shifts.leftCols(num_scanner) * scanners.mean);
    rescore();
    cells = CellVariance(patterns->cell_scores(), of_probes);
    scanners = scanners_beside(cells);
  }

  CorrelatedErrors errors;
  errors.unevenness_m = std::sqrt(cells);
  errors.range_bias_m = std::sqrt(scanners.variances[kRange]);
  errors.rotation_rad = std::sqrt(scanners.variances[kRotation]);
  errors.translation_m = std::sqrt(scanners.variances[kTranslation]);
  errors.shift.resize(shifts.rows(), shifts.cols());
  errors.shift.leftCols(num_scanner) = shifts.leftCols(num_scanner) * scanners.root;
  errors.shift.rightCols(kNumProbes) =
      std::sqrt(cells / kNumProbes) * shifts.rightCols(kNumProbes);
  const Eigen::MatrixXd effects = patterns->CellEffectsOnLandmarks();
  const Eigen::MatrixXd by_scanners =
      errors.shift.leftCols(num_scanner).bottomRows(effects.rows());
  errors.landmarks = by_scanners * by_scanners.transpose();
  errors.landmarks += cells * effects * effects.transpose();
  return errors;
}

}  // namespace plumbline

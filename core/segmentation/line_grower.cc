#include "core/segmentation/line_grower.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

namespace plumbline {

LineGrower::LineGrower(const BeamModel& model, const Thresholds& thresholds)
    : beams_(model), thresholds_(thresholds) {
  const size_t num_beams = static_cast<size_t>(model.num_beams());
  point_beams_.reset(new int[num_beams]);
  sums_.reset(new LineEquations[num_beams + 1]);
  chi2_.reset(new double[num_beams + 1]);
  sums_[0] = {};
  chi2_[0] = 0.0;
}

void LineGrower::Clear() { num_points_ = 0; }

void LineGrower::TakeUpAll(int first, int last, const Eigen::Vector2d& q) {
  line_ = {q.x(), q.y(), 1.0};
  for (int i = first; i <= last; ++i) {
    BeamModel::LineIntersection at;
    if (beams_.Intersect(i, line_, &at) && beams_.IsOnLine(at)) TakeUp(i, at);
  }
}

void LineGrower::Truncate(int num_points) {
  num_points_ = static_cast<size_t>(num_points);
  if (sums_[num_points_].IsSolvable()) line_ = sums_[num_points_].SolveScaled();
}

// Linearised at line_: an observation of q itself, not of its change.
void LineGrower::TakeUp(int beam, const BeamModel::LineIntersection& at) {
  const double weight = 1.0 / at.variance;
  const double value = at.slope * (line_.scale - at.excess);
  LineEquations sum = sums_[num_points_];
  sum.Add(line_.scale * at.point, value, weight);
  point_beams_[num_points_] = beam;
  sums_[++num_points_] = sum;
  chi2_[num_points_] = sum.Chi2();
}

bool LineGrower::Seed(int first) {
  Clear();
  seed_beams_.clear();
  // The measured ranges give a first line, and that the weights and the linearisation.
  LineEquations measured{};
  int gap = 0;
  for (int i = first; i < beams_.num_beams() && gap < thresholds_.min_points; ++i, ++gap) {
    if (!beams_.HasReturn(i)) continue;
    const BeamModel::Beam beam = beams_.beam(i);
    gap = -1;
    measured.Add(beam.origin + beam.range * beam.direction,
                 1.0,
                 beam.range * beam.range / beams_.RangeVariance(beam.range));
    seed_beams_.push_back(i);
    if (static_cast<int>(seed_beams_.size()) == thresholds_.min_points) break;
  }
  if (static_cast<int>(seed_beams_.size()) < thresholds_.min_points) return false;
  if (!measured.IsSolvable()) return false;
  line_ = measured.SolveScaled();
  for (const int i : seed_beams_) {
    BeamModel::LineIntersection at;
    if (!beams_.Intersect(i, line_, &at)) return false;
    TakeUp(i, at);
  }
  if (!sums_[num_points_].IsSolvable()) return false;
  line_ = sums_[num_points_].SolveScaled();
  return chi2_[num_points_] <= thresholds_.seed;
}

// Each step waits for the line that the step before leaves. Hence the scaled line, and the
// sums outside the array.
void LineGrower::Grow(int begin, int end, int step, int num_kept) {
  CHECK_GE(step * (end - begin), 0);  // else it would leave the beams
  const double inverse_outlier_threshold = 1.0 / beams_.outlier_threshold();
  LineEquations sum = sums_[num_points_];
  ScaledLine line = line_;
  int gap = 0;
  for (int i = begin; i != end && gap < thresholds_.min_points; i += step, ++gap) {
    BeamModel::LineIntersection at;
    if (!beams_.HasReturn(i) || !beams_.Intersect(i, line, &at)) continue;
    const Eigen::Vector2d row = line.scale * at.point;
    // The variance of the line so far matters only to beams that it can let in.
    const double residual = at.slope * at.excess;
    const double square = residual * residual * inverse_outlier_threshold;
    if (square > at.variance && square > at.variance + sum.VarianceOf(row)) continue;
    sum.Add(row, at.slope * (line.scale - at.excess), 1.0 / at.variance);
    line = sum.SolveScaled();
    point_beams_[num_points_] = i;
    sums_[++num_points_] = sum;
    chi2_[num_points_] = sum.square - (sum.x * line.x + sum.y * line.y) / line.scale;
    gap = -1;
    if (num_points_ % 2 == 0 && EndAtChange(static_cast<size_t>(num_kept))) return;
  }
  line_ = line;
}

// Tests the last 4, 8, 16, ... points against those before, a run of length 2 h whenever h
// more have come in: one test per point on average, and no run is missed for long. The
// statistic is the generalised likelihood ratio of two lines against one.
bool LineGrower::EndAtChange(size_t num_kept) {
  const size_t n = num_points_;
  for (size_t half = 2; n % half == 0 && 2 * half + 3 <= n; half *= 2) {
    const size_t before = n - 2 * half;
    if (before < num_kept) break;
    const double two_lines = chi2_[before] + (sums_[num_points_] - sums_[before]).Chi2();
    if (chi2_[num_points_] - two_lines <= thresholds_.run) continue;
    // The most likely place of the change.
    const size_t reach = 8 * half;
    size_t best = before;
    double best_chi2 = two_lines;
    for (size_t k = std::max(num_kept, n > reach ? n - reach : 0); k < n; ++k) {
      const double chi2 = chi2_[k] + (sums_[num_points_] - sums_[k]).Chi2();
      if (chi2 < best_chi2) {
        best = k;
        best_chi2 = chi2;
      }
    }
    Truncate(static_cast<int>(best));
    return true;
  }
  return false;
}

// Sum of squares when the points from `begin` to before `end` lie on a line of their own and
// all others on another: in the usual case with one division for both.
double LineGrower::SplitChi2(size_t begin, size_t end) const {
  const LineEquations run = sums_[end] - sums_[begin];
  const LineEquations rest = sums_[num_points_] - run;
  if (!run.IsSolvable() || !rest.IsSolvable()) return run.Chi2() + rest.Chi2();
  const double a = run.Determinant();
  const double b = rest.Determinant();
  return sums_[num_points_].square - (run.ScaledGain() * b + rest.ScaledGain() * a) / (a * b);
}

bool LineGrower::FindForeignRun(int* begin, int* end) const {
  constexpr size_t kShortest = 8;  // the growing line sees shorter runs as well as this would
  const size_t n = num_points_;
  const double limit = chi2_[num_points_] - thresholds_.run;
  bool is_found = false;
  size_t best_begin = 0;
  size_t best_end = n;
  double best = chi2_[num_points_];  // of the runs with points on both sides
  for (size_t length = kShortest; length + 3 <= n; length *= 2) {
    for (size_t k = 0; k + length <= n; k += length / 2) {
      const double chi2 = SplitChi2(k, k + length);
      is_found = is_found || chi2 < limit;
      if (chi2 >= best || k == 0 || k + length == n) continue;
      best = chi2;
      best_begin = k;
      best_end = k + length;
    }
  }
  if (!is_found) return false;
  // Moves one end of the run after the other to its most likely place.
  const size_t reach = best_end - best_begin;
  for (int sweep = 0; sweep < 2; ++sweep) {
    const size_t old_begin = best_begin;
    const size_t old_end = best_end;
    for (size_t k = old_begin > reach ? old_begin - reach : 1; k + 3 < old_end; ++k) {
      const double chi2 = SplitChi2(k, old_end);
      if (chi2 >= best) continue;
      best = chi2;
      best_begin = k;
    }
    for (size_t k = best_begin + 3; k < std::min(n, old_end + reach); ++k) {
      const double chi2 = SplitChi2(best_begin, k);
      if (chi2 >= best) continue;
      best = chi2;
      best_end = k;
    }
  }
  // A single change has one end less to choose freely. Prefer it unless the run explains more
  // than that freedom does in one of a hundred lines that change once (union bound).
  constexpr double kWrongChoice = 0.01;
  double single = best - 2.0 * std::log(kWrongChoice / static_cast<double>(n));
  for (size_t k = 2; k + 2 <= n; ++k) {
    const double chi2 = SplitChi2(k, n);
    if (chi2 >= single) continue;
    single = chi2;
    best_begin = k;
    best_end = n;
  }
  *begin = static_cast<int>(best_begin);
  *end = static_cast<int>(best_end);
  return true;
}

}  // namespace plumbline

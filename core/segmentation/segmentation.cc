#include "core/segmentation/segmentation.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "core/segmentation/beam_model.h"
#include "core/segmentation/line_grower.h"
#include "core/segmentation/line_piece.h"
#include "core/sensor/scanner_motion.h"
#include "core/util/quantiles.h"

namespace plumbline {
namespace {
struct Limits {
  Limits(const SegmentationOptions& options, int num_beams) {
    // Union bounds: there are fewer than two tests of runs for each beam (one while growing,
    // half a test when looking for foreign runs). The statistic of a run is chi square with
    // two degrees of freedom, P(T > x) = exp(-x / 2).
    const double per_beam = options.significance / std::max(1, num_beams);
    const double point = TwoSidedNormalQuantile(per_beam);
    outlier = point * point;
    run = -2.0 * std::log(per_beam / 2.0);
    sum_quantile = TwoSidedNormalQuantile(2.0 * options.significance);
  }

  double outlier = 0.0;       // of one squared whitened residual
  double run = 0.0;           // of the statistic of a run
  double sum_quantile = 0.0;  // normal quantile for the chi square of a whole segment
};

class Segmenter {
 public:
  Segmenter(const ScanLine& scan_line,
            const Scanner& scanner,
            const ScannerMotion& motion,
            const SegmentationOptions& options)
      : scanner_(scanner),
        options_(options),
        limits_(options, scan_line.num_beams()),
        beams_(scan_line, scanner, motion, limits_.outlier),
        grower_(beams_,
                {options.min_points,
                 limits_.run,
                 Chi2Quantile(options.min_points - 2, limits_.sum_quantile)}) {}

  std::vector<Segment> Run() {
    GrowAll();
    OptimiseSplitsAndMerge();
    SeparateWeakRuns();
    OptimiseSplitsAndMerge();  // with the lines that merged and separated
    LeaveOutDoubtfulBeams();
    return MakeSegments();
  }

 private:
  void GrowAll();
  void AddGrownPiece(bool starts_at_change);
  bool Fit(int max_iterations, LinePiece* piece) const;
  bool AreAdjacent(const LinePiece& a, const LinePiece& b) const;
  std::pair<int, double> BestSplit(const Eigen::Vector2d& a,
                                   const Eigen::Vector2d& b,
                                   int first,
                                   int last,
                                   int split) const;
  void OptimiseSplit(LinePiece* a, LinePiece* b) const;
  bool Merge(const LinePiece& a, const LinePiece& b, LinePiece* merged) const;
  bool IsNeeded(const LinePiece& a, const LinePiece& b, const LinePiece& c) const;
  void OptimiseSplitsAndMerge();
  void SeparateWeakRuns();
  int PassDoubtful(
      int i, int end, int step, double limit, const LinePiece& a, const LinePiece& b) const;
  void LeaveOutBetween(LinePiece* a, LinePiece* b) const;
  bool IsNearLimit(int i, const LinePiece& piece) const;
  void LeaveOutDoubtfulBeams();
  bool MakeSegment(const LinePiece& piece, Segment* segment) const;
  std::vector<Segment> MakeSegments() const;

  const Scanner& scanner_;
  const SegmentationOptions& options_;
  const Limits limits_;
  const BeamModel beams_;
  LineGrower grower_;
  std::vector<LinePiece> pieces_;
};

// --- Growing

void Segmenter::GrowAll() {
  const int num_beams = beams_.num_beams();
  int next = 0;
  int end = num_beams;  // where the next line has to end, if known
  bool starts_at_change = false;
  while (next < num_beams) {
    if (next >= end) {
      end = num_beams;
      starts_at_change = true;
    }
    if (!beams_.HasReturn(next) || !grower_.Seed(next)) {
      ++next;
      continue;
    }
    const int begin = grower_.PointBeam(grower_.num_points() - 1) + 1;
    // A seed that reaches beyond the end has passed the change.
    grower_.Grow(begin, begin > end ? num_beams : end, 1, 2);
    bool next_starts_at_change = false;
    int run_begin = 0;
    int run_end = 0;
    while (grower_.FindForeignRun(&run_begin, &run_end)) {
      next_starts_at_change = run_begin > 0;
      if (run_begin > 0 && run_end < grower_.num_points()) end = grower_.PointBeam(run_end);
      grower_.Truncate(run_begin > 0 ? run_begin : run_end);
    }
    next = grower_.PointBeam(grower_.num_points() - 1) + 1;
    if (grower_.num_points() >= options_.min_points) AddGrownPiece(starts_at_change);
    starts_at_change = next_starts_at_change;
  }
}

void Segmenter::AddGrownPiece(bool starts_at_change) {
  LinePiece piece;
  piece.first = grower_.PointBeam(0);
  piece.last = grower_.PointBeam(grower_.num_points() - 1);
  piece.starts_at_change = starts_at_change;
  if (!starts_at_change) {
    // Backwards over beams at which no line could start, for example beside an outlier.
    const int before = pieces_.empty() ? -1 : pieces_.back().last;
    const int num_forward = grower_.num_points();
    grower_.Grow(piece.first - 1, std::min(before, piece.first - 1), -1, num_forward);
    if (grower_.num_points() > num_forward) {
      piece.first = grower_.PointBeam(grower_.num_points() - 1);
    }
  }
  piece.q = grower_.q();
  piece.information = grower_.equations();
  pieces_.push_back(piece);
}

// --- Fitting

// Maximum likelihood line through the beams of the piece, without outliers: least squares of
// the whitened range residuals. The residual of range is that of distance divided by n . u, so
// this is the weighted fit of the distances n . p - d with one difference that matters: the
// lever arm of a point comes from where its beam meets the line, not from its measured range.
// A measured lever arm shares the noise of its residual, which turns every line that is not
// seen symmetrically (by 0.5 of its sigma for a wall that passes 0.6 m from the scanner, 1080
// beams, sigma 3 cm). Shortens the piece to beams on the line. False if fewer than min_points
// remain.
bool Segmenter::Fit(int max_iterations, LinePiece* piece) const {
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    int num_points = 0;
    const LineEquations sum =
        beams_.SumOnLine(piece->first, piece->last, piece->q, &num_points);
    if (num_points < options_.min_points || !sum.IsSolvable()) return false;
    const Eigen::Vector2d change = sum.Solve();
    piece->q += change;
    piece->information = sum;
    piece->num_points = num_points;
    const double gain = change.dot(Eigen::Vector2d(sum.x, sum.y));
    piece->chi2 = sum.square - gain;
    // Length of the step in standard deviations; the error left is of its square.
    if (gain < 1e-4) break;
  }
  beams_.TrimToLine(piece->q, &piece->first, &piece->last);
  return true;
}

// --- Neighbours

bool Segmenter::AreAdjacent(const LinePiece& a, const LinePiece& b) const {
  return b.first - a.last <= options_.min_points;
}

// Most likely last beam of line a if b follows, within first - 1 .. last, searched from
// `split` on both sides. Second: the change of chi square with respect to `split`.
std::pair<int, double> Segmenter::BestSplit(
    const Eigen::Vector2d& a, const Eigen::Vector2d& b, int first, int last, int split) const {
  constexpr int kBlock = BeamModel::kBlock;
  Eigen::Array4d in_a, in_b;
  std::pair<int, double> best(split, 0.0);
  double cost = 0.0;
  for (int i = split + 1; i <= last && cost < best.second + limits_.run; ++i) {
    const int k = (i - split - 1) % kBlock;
    if (k == 0) {
      in_a = beams_.Deviations(i, a);
      in_b = beams_.Deviations(i, b);
    }
    cost += in_a[k] - in_b[k];
    if (cost < best.second) best = {i, cost};
  }
  cost = 0.0;
  int block = split + 1;  // first of the block before
  for (int i = split; i >= first && cost < best.second + limits_.run; --i) {
    if (i < block) {
      block = std::max(0, block - kBlock);
      in_a = beams_.Deviations(block, a);
      in_b = beams_.Deviations(block, b);
    }
    const int k = i - block;
    cost += in_b[k] - in_a[k];
    if (cost < best.second) best = {i - 1, cost};
  }
  return best;
}

// Moves the end points between two adjacent pieces to the most likely place.
void Segmenter::OptimiseSplit(LinePiece* a, LinePiece* b) const {
  for (int iteration = 0; iteration < 4; ++iteration) {
    const int split = BestSplit(a->q, b->q, a->first + 1, b->last - 1, a->last).first;
    LinePiece new_a = *a;
    LinePiece new_b = *b;
    new_a.last = split;
    new_b.first = split + 1;
    if (new_a.last == a->last && new_b.first == b->first) return;
    if (!Fit(1, &new_a) || !Fit(1, &new_b)) return;
    const bool is_same = new_a.last == a->last && new_b.first == b->first;
    *a = new_a;
    *b = new_b;
    if (is_same) return;
  }
}

bool Segmenter::Merge(const LinePiece& a, const LinePiece& b, LinePiece* merged) const {
  if (b.starts_at_change || Difference(a, b) > limits_.run) return false;
  *merged = a.last - a.first > b.last - b.first ? a : b;
  merged->first = a.first;
  merged->last = b.last;
  merged->starts_at_change = a.starts_at_change;
  return Fit(2, merged);
}

// Is the piece b between a and c needed, or do the lines a and c explain its beams?
bool Segmenter::IsNeeded(const LinePiece& a, const LinePiece& b, const LinePiece& c) const {
  Eigen::Array4d in_a, in_b, in_c;
  double cost = 0.0;
  for (int i = b.first; i <= b.last; ++i) {
    const int k = (i - b.first) % BeamModel::kBlock;
    if (k == 0) in_b = beams_.Deviations(i, b.q);
    cost -= in_b[k];
  }
  // No split is better than the better line for each beam: that decides after a few of them.
  double cost_of_better = cost;
  for (int i = b.first; i <= b.last; ++i) {
    const int k = (i - b.first) % BeamModel::kBlock;
    if (k == 0) in_a = beams_.Deviations(i, a.q);
    if (k == 0) in_c = beams_.Deviations(i, c.q);
    cost_of_better += std::min(in_a[k], in_c[k]);
    if (cost_of_better > limits_.run) return true;
    cost += in_c[k];
  }
  return cost + BestSplit(a.q, c.q, b.first, b.last, b.first - 1).second > limits_.run;
}

void Segmenter::OptimiseSplitsAndMerge() {
  std::vector<LinePiece> done;
  done.reserve(pieces_.size());
  for (LinePiece piece : pieces_) {
    while (!done.empty() && AreAdjacent(done.back(), piece)) {
      OptimiseSplit(&done.back(), &piece);
      LinePiece merged;
      if (Merge(done.back(), piece, &merged)) {
        piece = merged;
        done.pop_back();
        continue;
      }
      const size_t n = done.size();
      if (n < 2 || !AreAdjacent(done[n - 2], done[n - 1]) ||
          IsNeeded(done[n - 2], done[n - 1], piece)) {
        break;
      }
      done.pop_back();
      piece.first = done.back().last + 1;
    }
    done.push_back(piece);
  }
  pieces_ = std::move(done);
}

// A weak run in the middle of a wall may have merged with the wall on one side of it: wall and
// run against wall. Looks again at neighbours that differ little, with the points of both.
void Segmenter::SeparateWeakRuns() {
  constexpr double kLittle = 10.0;  // stronger runs do not merge; saves time only
  for (size_t k = 0; k + 1 < pieces_.size(); ++k) {
    const LinePiece a = pieces_[k];
    const LinePiece b = pieces_[k + 1];
    if (!AreAdjacent(a, b) || Difference(a, b) > kLittle * limits_.run) continue;
    grower_.Clear();
    grower_.TakeUpAll(a.first, a.last, a.q);
    grower_.TakeUpAll(b.first, b.last, b.q);
    int begin = 0;
    int end = 0;
    if (!grower_.FindForeignRun(&begin, &end)) continue;
    if (begin < options_.min_points || end > grower_.num_points() - options_.min_points)
      continue;
    LinePiece wall = a;
    LinePiece run = a;
    LinePiece rest = b;
    wall.last = grower_.PointBeam(begin - 1);
    run.first = grower_.PointBeam(begin);
    run.last = grower_.PointBeam(end - 1);
    rest.first = grower_.PointBeam(end);
    run.starts_at_change = rest.starts_at_change = true;
    if (!Fit(2, &wall) || !Fit(2, &run) || !Fit(2, &rest)) continue;
    pieces_[k] = wall;
    pieces_[k + 1] = run;
    pieces_.insert(pieces_.begin() + static_cast<std::ptrdiff_t>(k) + 2, rest);
    k += 2;
  }
}

// --- Doubtful beams. All decisions follow from the fitted lines. These are independent of
// their points' residuals, so that leaving points out does not bias what the others say.

// First beam from i on that belongs to one of the lines without doubt: either alone, separated
// by `limit`, or because the beams passed over, all taken together, would: a run with the sum
// S of squared separations goes to the wrong line with the probability of a normal variable >
// sqrt(S) / 2.
int Segmenter::PassDoubtful(
    int i, int end, int step, double limit, const LinePiece& a, const LinePiece& b) const {
  const double max_sum = 4.0 * options_.ambiguity_sigmas * options_.ambiguity_sigmas;
  double sum = 0.0;
  for (; i != end && sum < max_sum; i += step) {
    const double square = beams_.Separate(i, a.q, b.q).square;
    if (square >= limit * limit) break;
    sum += square;
  }
  return i;
}

void Segmenter::LeaveOutBetween(LinePiece* a, LinePiece* b) const {
  int last_of_a = a->last;
  int first_of_b = b->first;
  // If the lines intersect where the split may be as well, it is at the intersection.
  const double any = std::numeric_limits<double>::infinity();
  const int low = PassDoubtful(a->last, a->first, -1, any, *a, *b);
  const int high = PassDoubtful(b->first, b->last, 1, any, *a, *b);
  bool is_above = beams_.Separate(low, a->q, b->q).is_above;
  for (int i = low; i < high; ++i) {
    const bool is_next_above = beams_.Separate(i + 1, a->q, b->q).is_above;
    if (is_next_above != is_above) {
      last_of_a = i;
      first_of_b = i + 1;
      break;
    }
    is_above = is_next_above;
  }
  const double limit = options_.ambiguity_sigmas;
  a->last = PassDoubtful(last_of_a, a->first, -1, limit, *a, *b);
  b->first = PassDoubtful(first_of_b, b->last, 1, limit, *a, *b);
}

// Near the limits of the scanner only noise of one sign gives a valid range.
bool Segmenter::IsNearLimit(int i, const LinePiece& piece) const {
  BeamModel::Prediction prediction;
  if (!beams_.Predict(i, piece.q, &prediction)) return true;
  const double margin = options_.ambiguity_sigmas * std::sqrt(prediction.variance);
  return prediction.range > scanner_.max_range_m - margin ||
         prediction.range < scanner_.min_range_m + margin;
}

void Segmenter::LeaveOutDoubtfulBeams() {
  constexpr int kMaxIterations = 5;
  const std::vector<LinePiece> whole = pieces_;
  for (int round = 0; round < 3; ++round) {
    std::vector<LinePiece> shorter = pieces_;
    for (size_t k = 0; k < whole.size(); ++k) {
      shorter[k].first = whole[k].first;
      shorter[k].last = whole[k].last;
    }
    for (size_t k = 0; k + 1 < whole.size(); ++k) {
      if (AreAdjacent(whole[k], whole[k + 1])) LeaveOutBetween(&shorter[k], &shorter[k + 1]);
    }
    bool is_changed = false;
    for (size_t k = 0; k < whole.size(); ++k) {
      LinePiece& piece = shorter[k];
      while (piece.first < piece.last && IsNearLimit(piece.first, piece)) ++piece.first;
      while (piece.first < piece.last && IsNearLimit(piece.last, piece)) --piece.last;
      const bool has_moved = piece.first != pieces_[k].first || piece.last != pieces_[k].last;
      is_changed = is_changed || has_moved;
      if (round > 1 && !has_moved) continue;
      if (!Fit(round == 0 ? 1 : kMaxIterations, &piece)) piece.num_points = 0;
      pieces_[k] = piece;
    }
    if (round > 0 && !is_changed) return;
  }
}

// --- Result

// A change of the rules above must not let a segment contradict itself: who uses it counts
// its beams again.
void CheckConsistent(const Segment& segment, int min_points) {
  const std::vector<int>& excluded = segment.excluded_beams;
  CHECK_GE(segment.num_points, min_points);
  CHECK_EQ(segment.num_points,
           segment.last_beam - segment.first_beam + 1 - static_cast<int>(excluded.size()));
  CHECK(std::is_sorted(excluded.begin(), excluded.end(), std::less_equal<int>()));
  if (!excluded.empty()) {
    CHECK_GT(excluded.front(), segment.first_beam);
    CHECK_LT(excluded.back(), segment.last_beam);
  }
  CHECK(std::isfinite(segment.chi2) && std::isfinite(segment.sigma_offset_m) &&
        std::isfinite(segment.sigma_direction_rad) && segment.start.allFinite() &&
        segment.end.allFinite() && segment.centroid.allFinite())
      << "beams " << segment.first_beam << " to " << segment.last_beam;
}

// Decides, once, which of the piece's beams count; the last step of the fit takes these, and
// all numbers follow from them. False if fewer than min_points do or they do not determine a
// line.
//
// The line's statistics follow from the information of q, since n . p = d for the points it is
// made of: |q|^2 information = sum w p p^T, w = 1 / variance of a point along the normal.
bool Segmenter::MakeSegment(const LinePiece& piece, Segment* segment) const {
  int first = piece.first;
  int last = piece.last;
  beams_.TrimToLine(piece.q, &first, &last);
  const LineEquations sum = beams_.SumOnLine(first, last, piece.q, &segment->num_points);
  if (segment->num_points < options_.min_points || !sum.IsSolvable()) return false;
  segment->first_beam = first;
  segment->last_beam = last;
  if (segment->num_points < last - first + 1) {
    for (int i = first; i <= last; ++i) {
      if (!beams_.IsOnLine(i, piece.q)) segment->excluded_beams.push_back(i);
    }
    segment->num_points = last - first + 1 - static_cast<int>(segment->excluded_beams.size());
  }
  const Eigen::Vector2d change = sum.Solve();
  const Eigen::Vector2d q = piece.q + change;
  BeamModel::Prediction at_end;
  if (!beams_.Predict(segment->first_beam, q, &at_end)) return false;
  if (!beams_.Predict(segment->last_beam, q, &at_end)) return false;
  segment->start = beams_.PointOnLine(segment->first_beam, q);
  segment->end = beams_.PointOnLine(segment->last_beam, q);
  segment->chi2 = sum.square - change.dot(Eigen::Vector2d(sum.x, sum.y));
  const double norm = q.norm();
  const Eigen::Vector2d normal = -q / norm;
  const Eigen::Vector2d tangent(-normal.y(), normal.x());
  segment->normal = normal;
  segment->distance = -1.0 / norm;
  Eigen::Matrix2d moments;
  moments << sum.xx, sum.xy, sum.xy, sum.yy;
  moments *= norm * norm;
  const double weight = normal.dot(moments * normal) * norm * norm;
  const double along = tangent.dot(moments * normal) / (segment->distance * weight);
  segment->centroid = segment->distance * normal + along * tangent;
  // det(moments) = (weight distance spread)^2
  segment->spread_m = norm * norm * norm * std::sqrt(sum.Determinant()) / weight;
  segment->sigma_offset_m = 1.0 / std::sqrt(weight);
  segment->sigma_direction_rad = segment->sigma_offset_m / segment->spread_m;
  CheckConsistent(*segment, options_.min_points);
  return true;
}

// Leaves out what is too short or not straight. A variance factor above one that the segments
// of the scan line share (median over the points) says that range_noise_m is understated, not
// that all lines are bent.
std::vector<Segment> Segmenter::MakeSegments() const {
  std::vector<Segment> segments;
  segments.reserve(pieces_.size());
  std::vector<std::pair<double, int>> factors;
  factors.reserve(pieces_.size());
  int num_points = 0;
  for (const LinePiece& piece : pieces_) {
    if (piece.num_points < options_.min_points) continue;
    Segment segment;
    if (!MakeSegment(piece, &segment)) continue;
    factors.emplace_back(segment.chi2 / (segment.num_points - 2), segment.num_points);
    num_points += segment.num_points;
    segments.push_back(std::move(segment));
  }
  std::sort(factors.begin(), factors.end());
  double factor = 1.0;
  int num_below = 0;
  for (const auto& [value, count] : factors) {
    if (2 * num_below < num_points) factor = std::max(1.0, value);
    num_below += count;
  }
  const auto is_bent = [&](const Segment& segment) {
    return segment.chi2 > factor * Chi2Quantile(segment.num_points - 2, limits_.sum_quantile);
  };
  segments.erase(std::remove_if(segments.begin(), segments.end(), is_bent), segments.end());
  return segments;
}

}  // namespace

std::vector<Segment> SegmentScanLine(const ScanLine& scan_line,
                                     const Scanner& scanner,
                                     const ScannerMotion& motion,
                                     const SegmentationOptions& options) {
  return Segmenter(scan_line, scanner, motion, options).Run();
}

}  // namespace plumbline

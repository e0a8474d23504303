#include "core/segmentation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

// A line is kept as q = n / d with q . p = 1 for its points, n pointing away from the scanner.
// Beam i starts at o_i and points along u_i (both in the scanner frame at the middle time), so
// its range to the line is (1 - q . o_i) / (q . u_i). A fit minimises the sum of squared range
// residuals, each divided by its variance: the maximum likelihood estimate. This is the
// weighted fit of the distances n . p_i - d, because (n . p_i - d) / (n . u_i) is the range
// residual, with one difference that matters: the lever arms come from the points predicted on
// the line, not from the measured ones. Measured lever arms share the noise of the residuals,
// which biases the direction of every wall that is not seen symmetrically (by 0.1 sigma and
// more for a wall that starts in front of the scanner and runs away from it).

namespace plumbline {
namespace {

struct Beam {
  Eigen::Vector2d origin;
  Eigen::Vector2d direction;
  double range;
  bool is_valid;
};

// What the line q predicts for one beam. Row: minus the derivative of the range by q.
struct Prediction {
  double range;
  double variance;
  Eigen::Vector2d row;
};

// Normal equations sum w row row^T, sum w row value, sum w value^2 of row . q = value.
struct NormalEquations {
  double xx = 0.0, xy = 0.0, yy = 0.0;
  double x = 0.0, y = 0.0;
  double square = 0.0;

  void Add(const Eigen::Vector2d& row, double value, double weight) {
    const double wx = weight * row.x(), wy = weight * row.y();
    xx += wx * row.x();
    xy += wx * row.y();
    yy += wy * row.y();
    x += wx * value;
    y += wy * value;
    square += weight * value * value;
  }

  NormalEquations operator-(const NormalEquations& other) const {
    return {xx - other.xx,
            xy - other.xy,
            yy - other.yy,
            x - other.x,
            y - other.y,
            square - other.square};
  }

  double Determinant() const { return xx * yy - xy * xy; }

  Eigen::Vector2d Solve() const {
    const double scale = 1.0 / Determinant();
    return {scale * (yy * x - xy * y), scale * (xx * y - xy * x)};
  }

  // row^T (sum w row row^T)^-1 row
  double PredictionVariance(const Eigen::Vector2d& row) const {
    return (yy * row.x() * row.x() - 2.0 * xy * row.x() * row.y() + xx * row.y() * row.y()) /
           Determinant();
  }

  double Chi2(const Eigen::Vector2d& q) const { return square - x * q.x() - y * q.y(); }

  bool IsSolvable() const { return Determinant() > 1e-12 * xx * yy; }
};

// A segment in the making.
struct Piece {
  int first = 0;
  int last = 0;         // inclusive
  int split_first = 0;  // the same before the doubtful beams were left out
  int split_last = 0;
  Eigen::Vector2d q = Eigen::Vector2d::Zero();
  NormalEquations information;  // of the last fit
};

// x with P(|z| > x) = probability for a standard normal z.
double TwoSidedNormalQuantile(double probability) {
  double low = 0.0, high = 40.0;
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle * M_SQRT1_2) > probability ? low : high) = middle;
  }
  return high;
}

// Upper quantile of the chi square distribution by Wilson and Hilferty's approximation.
double Chi2Quantile(int degrees, double normal_quantile) {
  const double a = 2.0 / (9.0 * degrees);
  const double root = 1.0 - a + normal_quantile * std::sqrt(a);
  return degrees * root * root * root;
}

class Segmenter {
 public:
  Segmenter(const ScanLine& scan_line,
            const Scanner& scanner,
            const ScannerMotion& motion,
            const SegmentationOptions& options)
      : scanner_(scanner),
        options_(options),
        num_beams_(scan_line.num_beams()),
        range_variance_(scanner.range_noise_m * scanner.range_noise_m) {
    // Union bounds over the beams: a scan line without any change is cut with at most this
    // probability. A run's statistic has two degrees of freedom, P(T > x) = exp(-x / 2).
    const double per_beam = options.significance / std::max(1, num_beams_);
    const double point_limit = TwoSidedNormalQuantile(per_beam);
    point_threshold_ = point_limit * point_limit;
    run_threshold_ = -2.0 * std::log(per_beam);
    sum_quantile_ = TwoSidedNormalQuantile(2.0 * options.significance);
    PrepareBeams(scan_line, motion);
  }

  std::vector<Segment> Run() {
    GrowAll();
    for (int round = 0; round < 2; ++round) OptimiseSplitsAndMerge();
    LeaveOutDoubtfulBeams();
    std::vector<Segment> segments;
    segments.reserve(pieces_.size());
    for (const Piece& piece : pieces_) {
      Segment segment = MakeSegment(piece);
      const int degrees = segment.num_points - 2;
      if (segment.num_points < options_.min_points) continue;
      if (segment.chi2 > Chi2Quantile(degrees, sum_quantile_)) continue;
      segments.push_back(std::move(segment));
    }
    return segments;
  }

 private:
  // Moves all beams to the scanner frame at the middle time. With a constant twist (v, w) the
  // frame at time t is turned by w t and lies at t (sin(wt)/(wt) v + (1-cos(wt))/(wt) v_perp).
  void PrepareBeams(const ScanLine& scan_line, const ScannerMotion& motion) {
    beams_.resize(static_cast<size_t>(num_beams_));
    const double middle = 0.5 * (num_beams_ - 1);
    const double turn = motion.yaw_rate_rad_s * scan_line.time_increment_s;
    const double start = scan_line.angle_min - middle * turn;
    const double increment = scan_line.angle_increment + turn;
    const Eigen::Vector2d step(std::cos(increment), std::sin(increment));
    const Eigen::Vector2d& v = motion.velocity_m_s;
    Eigen::Vector2d direction(std::cos(start), std::sin(start));
    for (int i = 0; i < num_beams_; ++i) {
      Beam& beam = beams_[static_cast<size_t>(i)];
      const double t = (i - middle) * scan_line.time_increment_s;
      const double x = motion.yaw_rate_rad_s * t;
      const double along = t * (1.0 - x * x / 6.0 * (1.0 - x * x / 20.0));
      const double across = 0.5 * t * x * (1.0 - x * x / 12.0 * (1.0 - x * x / 30.0));
      beam.origin = {along * v.x() - across * v.y(), along * v.y() + across * v.x()};
      beam.direction = direction;
      beam.range = scan_line.ranges[static_cast<size_t>(i)];
      beam.is_valid = scanner_.IsValidRange(beam.range);
      direction = {direction.x() * step.x() - direction.y() * step.y(),
                   direction.x() * step.y() + direction.y() * step.x()};
    }
  }

  const Beam& beam(int i) const { return beams_[static_cast<size_t>(i)]; }

  // False when the beam does not meet the line within the scanner's range.
  bool Predict(const Beam& beam, const Eigen::Vector2d& q, Prediction* prediction) const {
    const double slope = q.dot(beam.direction);
    const double numerator = 1.0 - q.dot(beam.origin);
    if (!(numerator > 0.0 && slope * 2.0 * scanner_.max_range_m > numerator)) return false;
    const double inverse = 1.0 / slope;
    const double range = numerator * inverse;
    const double cross = q.y() * beam.direction.x() - q.x() * beam.direction.y();
    const double by_angle = scanner_.angle_noise_rad * range * cross * inverse;
    prediction->range = range;
    prediction->variance = range_variance_ + by_angle * by_angle;
    prediction->row = inverse * (beam.origin + range * beam.direction);
    return true;
  }

  // Squared whitened range residual, at most the outlier threshold; 0 without a return.
  double Deviation(int i, const Eigen::Vector2d& q) const {
    if (!beam(i).is_valid) return 0.0;
    Prediction prediction;
    if (!Predict(beam(i), q, &prediction)) return point_threshold_;
    const double residual = beam(i).range - prediction.range;
    return std::min(point_threshold_, residual * residual / prediction.variance);
  }

  bool IsOnLine(int i, const Eigen::Vector2d& q) const {
    return beam(i).is_valid && Deviation(i, q) < point_threshold_;
  }

  // --- Growing. Points 0..n-1 of the line that grows; equations_[k] and chi2_[k] are the sums
  // of the first k of them, point_beams_[k] their beams.

  void Clear() {
    point_beams_.clear();
    equations_.assign(1, NormalEquations());
    chi2_.assign(1, 0.0);
  }

  void Append(int i, const Prediction& prediction, const Eigen::Vector2d& q) {
    NormalEquations sum = equations_.back();
    const double value = prediction.row.dot(q) - (beam(i).range - prediction.range);
    sum.Add(prediction.row, value, 1.0 / prediction.variance);
    point_beams_.push_back(i);
    equations_.push_back(sum);
  }

  // Starts a line with the first min_points returns from beam `first` on. Linearised at the
  // measured ranges, then at the line. False when they do not lie on one line.
  bool Seed(int first) {
    seed_beams_.clear();
    int gap = 0;
    for (int i = first; i < num_beams_ && gap < options_.min_points; ++i) {
      gap = beam(i).is_valid ? 0 : gap + 1;
      if (beam(i).is_valid) seed_beams_.push_back(i);
      if (static_cast<int>(seed_beams_.size()) == options_.min_points) break;
    }
    if (static_cast<int>(seed_beams_.size()) < options_.min_points) return false;
    NormalEquations sum;
    for (const int i : seed_beams_) {
      const double range = beam(i).range;
      sum.Add(
          beam(i).origin + range * beam(i).direction, 1.0, range * range / range_variance_);
    }
    for (int iteration = 0; iteration < 2; ++iteration) {
      if (!sum.IsSolvable()) return false;
      q_ = sum.Solve();
      Clear();
      for (const int i : seed_beams_) {
        Prediction prediction;
        if (!Predict(beam(i), q_, &prediction)) return false;
        Append(i, prediction, q_);
        chi2_.push_back(0.0);
        const NormalEquations& part = equations_.back();
        if (part.IsSolvable()) chi2_.back() = part.Chi2(part.Solve());
      }
      sum = equations_.back();
    }
    if (!sum.IsSolvable()) return false;
    q_ = sum.Solve();
    return sum.Chi2(q_) <= Chi2Quantile(options_.min_points - 2, sum_quantile_);
  }

  // Lets the line grow over the beams from `begin` to before `end`. Single beams that deviate
  // are passed over, fewer than min_points in a row. Returns true if a run of beams proved
  // that the line has ended earlier; the points after the change are then taken away again.
  bool Grow(int begin, int end, int step) {
    int gap = 0;
    for (int i = begin; i != end && gap < options_.min_points; i += step, ++gap) {
      Prediction prediction;
      if (!beam(i).is_valid || !Predict(beam(i), q_, &prediction)) continue;
      const double residual = beam(i).range - prediction.range;
      const double variance =
          prediction.variance + equations_.back().PredictionVariance(prediction.row);
      if (residual * residual > point_threshold_ * variance) continue;
      Append(i, prediction, q_);
      q_ = equations_.back().Solve();
      chi2_.push_back(equations_.back().Chi2(q_));
      gap = -1;
      if (HasChanged()) return true;
    }
    return false;
  }

  // Generalised likelihood ratio of two lines, the first `head` points and the rest, against
  // one line: chi square with two degrees of freedom while the line goes on.
  double RunStatistic(size_t head) const {
    return chi2_.back() - chi2_[head] - RestChi2(head);
  }

  double RestChi2(size_t head) const {
    const NormalEquations rest = equations_.back() - equations_[head];
    return rest.IsSolvable() ? std::max(0.0, rest.Chi2(rest.Solve())) : 0.0;
  }

  // Tests the last 2, 4, 8, ... points against those before, a run of length 2 h whenever h
  // more have come in: two tests per beam on average, and no run is missed for long.
  bool HasChanged() {
    const size_t n = point_beams_.size();
    for (size_t half = 1; n % half == 0 && 2 * half + 3 <= n; half *= 2) {
      if (RunStatistic(n - 2 * half) <= run_threshold_) continue;
      // The change: the most likely one.
      const size_t reach = 8 * half;
      size_t best = n - 2 * half;
      double best_chi2 = std::numeric_limits<double>::infinity();
      for (size_t head = n > reach + 2 ? n - reach : 2; head + 1 <= n; ++head) {
        const double chi2 = chi2_[head] + RestChi2(head);
        if (chi2 < best_chi2) best = head, best_chi2 = chi2;
      }
      point_beams_.resize(best);
      equations_.resize(best + 1);
      chi2_.resize(best + 1);
      if (equations_.back().IsSolvable()) q_ = equations_.back().Solve();
      return true;
    }
    return false;
  }

  void GrowAll() {
    int next = 0;
    while (next < num_beams_) {
      if (!beam(next).is_valid || !Seed(next)) {
        ++next;
        continue;
      }
      const int first = point_beams_.front();
      Grow(point_beams_.back() + 1, num_beams_, 1);
      next = point_beams_.back() + 1;
      if (static_cast<int>(point_beams_.size()) < options_.min_points) continue;
      Piece piece;
      piece.first = first;
      piece.last = point_beams_.back();
      // Backwards over beams at which no line could start, for example beside an outlier.
      const int limit = pieces_.empty() ? 0 : pieces_.back().last + 1;
      const size_t num_forward = point_beams_.size();
      Grow(first - 1, std::min(limit, first) - 1, -1);
      if (point_beams_.size() > num_forward) piece.first = point_beams_.back();
      piece.q = q_;
      if (Fit(&piece)) pieces_.push_back(piece);
    }
  }

  // --- Fitting

  // Maximum likelihood line through the beams of the piece, without outliers. Shortens the
  // piece to beams on the line. False if fewer than min_points remain.
  bool Fit(Piece* piece) const {
    for (int iteration = 0; iteration < 8; ++iteration) {
      NormalEquations sum;
      int num_points = 0;
      for (int i = piece->first; i <= piece->last; ++i) {
        Prediction prediction;
        if (!beam(i).is_valid || !Predict(beam(i), piece->q, &prediction)) continue;
        const double residual = beam(i).range - prediction.range;
        if (residual * residual >= point_threshold_ * prediction.variance) continue;
        sum.Add(prediction.row, -residual, 1.0 / prediction.variance);
        ++num_points;
      }
      if (num_points < options_.min_points || !sum.IsSolvable()) return false;
      const Eigen::Vector2d change = sum.Solve();
      piece->q += change;
      piece->information = sum;
      // Squared length of the step in standard deviations.
      if (change.dot(Eigen::Vector2d(sum.x, sum.y)) < 1e-6) break;
    }
    while (piece->first < piece->last && !IsOnLine(piece->first, piece->q)) ++piece->first;
    while (piece->first < piece->last && !IsOnLine(piece->last, piece->q)) --piece->last;
    return true;
  }

  // --- Neighbours

  bool AreAdjacent(const Piece& a, const Piece& b) const {
    return b.first - a.last <= options_.min_points;
  }

  // Most likely last beam of line a if b follows, within first - 1 .. last, searched from
  // `split` on both sides. Second: the change of chi2 with respect to `split`.
  std::pair<int, double> BestSplit(const Eigen::Vector2d& a,
                                   const Eigen::Vector2d& b,
                                   int first,
                                   int last,
                                   int split) const {
    std::pair<int, double> best(split, 0.0);
    double cost = 0.0;
    for (int i = split + 1; i <= last && cost < best.second + run_threshold_; ++i) {
      cost += Deviation(i, a) - Deviation(i, b);
      if (cost < best.second) best = {i, cost};
    }
    cost = 0.0;
    for (int i = split; i >= first && cost < best.second + run_threshold_; --i) {
      cost += Deviation(i, b) - Deviation(i, a);
      if (cost < best.second) best = {i - 1, cost};
    }
    return best;
  }

  // Moves the end points between two adjacent pieces to the most likely place.
  void OptimiseSplit(Piece* a, Piece* b) const {
    for (int iteration = 0; iteration < 4; ++iteration) {
      const int split = BestSplit(a->q, b->q, a->first + 1, b->last - 1, a->last).first;
      if (split == a->last && split + 1 == b->first) return;
      Piece new_a = *a, new_b = *b;
      new_a.last = split;
      new_b.first = split + 1;
      if (!Fit(&new_a) || !Fit(&new_b)) return;
      const bool is_same = new_a.last == a->last && new_b.first == b->first;
      *a = new_a;
      *b = new_b;
      if (is_same) return;
    }
  }

  // (q_a - q_b)^T (P_a + P_b)^-1 (q_a - q_b): chi square with two degrees if it is one line.
  static double Difference(const Piece& a, const Piece& b) {
    const NormalEquations& m = a.information;
    const NormalEquations& n = b.information;
    const double scale_m = 1.0 / m.Determinant(), scale_n = 1.0 / n.Determinant();
    const double xx = scale_m * m.yy + scale_n * n.yy;
    const double xy = -scale_m * m.xy - scale_n * n.xy;
    const double yy = scale_m * m.xx + scale_n * n.xx;
    const Eigen::Vector2d d = a.q - b.q;
    return (yy * d.x() * d.x() - 2.0 * xy * d.x() * d.y() + xx * d.y() * d.y()) /
           (xx * yy - xy * xy);
  }

  bool Merge(const Piece& a, const Piece& b, Piece* merged) const {
    if (Difference(a, b) > run_threshold_) return false;
    *merged = a.last - a.first > b.last - b.first ? a : b;
    merged->first = a.first;
    merged->last = b.last;
    return Fit(merged);
  }

  // Is the piece b between a and c needed, or do the lines a and c explain its beams?
  bool IsNeeded(const Piece& a, const Piece& b, const Piece& c) const {
    double cost = 0.0;
    for (int i = b.first; i <= b.last; ++i) {
      cost += Deviation(i, c.q) - Deviation(i, b.q);
    }
    return cost + BestSplit(a.q, c.q, b.first, b.last, b.first - 1).second > run_threshold_;
  }

  void OptimiseSplitsAndMerge() {
    std::vector<Piece> done;
    done.reserve(pieces_.size());
    for (Piece piece : pieces_) {
      while (!done.empty() && AreAdjacent(done.back(), piece)) {
        OptimiseSplit(&done.back(), &piece);
        Piece merged;
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

  // --- Doubtful beams. All decisions follow from the fitted lines, which are independent of
  // their points' residuals, so that leaving beams out does not bias the lines.

  // Difference of the ranges that two lines predict in standard deviations of a range.
  double Separation(int i, const Piece& a, const Piece& b) const {
    Prediction in_a, in_b;
    if (!Predict(beam(i), a.q, &in_a) || !Predict(beam(i), b.q, &in_b)) {
      return std::numeric_limits<double>::infinity();
    }
    return (in_a.range - in_b.range) / std::sqrt(0.5 * (in_a.variance + in_b.variance));
  }

  // First beam from i on that belongs to one of the lines without doubt. Either it does so
  // alone, or the beams passed over, all taken together, would: a run with the sum S of
  // squared separations goes to the wrong line with the probability of a normal variable >
  // sqrt(S) / 2.
  int PassDoubtful(int i, int end, int step, const Piece& a, const Piece& b) const {
    const double limit = options_.ambiguity_sigmas;
    double sum = 0.0;
    for (; i != end && sum < 4.0 * limit * limit; i += step) {
      const double separation = Separation(i, a, b);
      if (std::abs(separation) >= limit) break;
      sum += separation * separation;
    }
    return i;
  }

  // Beam before the intersection of two adjacent lines, if it may be the true end of a.
  bool FindIntersection(const Piece& a, const Piece& b, int* last_of_a) const {
    const int low = PassDoubtful(a.split_last, a.split_first, -1, a, b);
    const int high = PassDoubtful(b.split_first, b.split_last, 1, a, b);
    for (int i = low; i < high; ++i) {
      if ((Separation(i, a, b) > 0.0) == (Separation(i + 1, a, b) > 0.0)) continue;
      *last_of_a = i;
      return true;
    }
    return false;
  }

  void LeaveOutBetween(Piece* a, Piece* b) const {
    int last_of_a = a->split_last;
    int first_of_b = b->split_first;
    if (FindIntersection(*a, *b, &last_of_a)) first_of_b = last_of_a + 1;
    a->last = PassDoubtful(last_of_a, a->first, -1, *a, *b);
    b->first = PassDoubtful(first_of_b, b->last, 1, *a, *b);
  }

  // Near the limits of the scanner only noise of one sign gives a valid range.
  bool IsNearLimit(int i, const Piece& piece) const {
    Prediction prediction;
    if (!Predict(beam(i), piece.q, &prediction)) return true;
    const double margin = options_.ambiguity_sigmas * std::sqrt(prediction.variance);
    return prediction.range > scanner_.max_range_m - margin ||
           prediction.range < scanner_.min_range_m + margin;
  }

  void LeaveOutDoubtfulBeams() {
    for (Piece& piece : pieces_) {
      piece.split_first = piece.first;
      piece.split_last = piece.last;
    }
    const std::vector<Piece> whole = pieces_;
    for (int round = 0; round < 3; ++round) {
      for (Piece& piece : pieces_) {
        piece.first = piece.split_first;
        piece.last = piece.split_last;
      }
      for (size_t k = 0; k + 1 < pieces_.size(); ++k) {
        if (AreAdjacent(whole[k], whole[k + 1])) LeaveOutBetween(&pieces_[k], &pieces_[k + 1]);
      }
      bool is_changed = false;
      for (Piece& piece : pieces_) {
        while (piece.first < piece.last && IsNearLimit(piece.first, piece)) ++piece.first;
        while (piece.first < piece.last && IsNearLimit(piece.last, piece)) --piece.last;
        const Piece before = piece;
        if (!Fit(&piece)) piece = before;
        is_changed = is_changed || (piece.q - before.q).norm() > 1e-3 * piece.q.norm();
      }
      if (!is_changed) return;
    }
  }

  // All statistics follow from the information of q, since n . p = d for the points it is made
  // of: |q|^2 information = sum w p p^T with w = 1 / variance of a point along the normal.
  Segment MakeSegment(const Piece& piece) const {
    Segment segment;
    segment.first_beam = piece.first;
    segment.last_beam = piece.last;
    for (int i = piece.first; i <= piece.last; ++i) {
      if (IsOnLine(i, piece.q)) {
        ++segment.num_points;
        segment.chi2 += Deviation(i, piece.q);
      } else {
        segment.excluded_beams.push_back(i);
      }
    }
    const double norm = piece.q.norm();
    segment.normal = -piece.q / norm;
    segment.distance = -1.0 / norm;
    const Eigen::Vector2d& n = segment.normal;
    const Eigen::Vector2d tangent(-n.y(), n.x());
    const NormalEquations& m = piece.information;
    Eigen::Matrix2d moments;
    moments << m.xx, m.xy, m.xy, m.yy;
    moments *= norm * norm;
    const double weight = n.dot(moments * n) * norm * norm;
    const double along = tangent.dot(moments * n) / segment.distance / weight;
    const double square = tangent.dot(moments * tangent) / weight - along * along;
    segment.centroid = segment.distance * n + along * tangent;
    segment.spread_m = std::sqrt(std::max(0.0, square));
    segment.sigma_offset_m = 1.0 / std::sqrt(weight);
    segment.sigma_direction_rad = segment.sigma_offset_m / segment.spread_m;
    segment.start = PointOnLine(piece.first, piece.q);
    segment.end = PointOnLine(piece.last, piece.q);
    return segment;
  }

  Eigen::Vector2d PointOnLine(int i, const Eigen::Vector2d& q) const {
    const Beam& b = beam(i);
    return b.origin + (1.0 - q.dot(b.origin)) / q.dot(b.direction) * b.direction;
  }

  const Scanner& scanner_;
  const SegmentationOptions& options_;
  const int num_beams_;
  const double range_variance_;
  double point_threshold_ = 0.0;  // of one squared whitened residual
  double run_threshold_ = 0.0;    // of a run's statistic
  double sum_quantile_ = 0.0;     // normal quantile for the test of a whole segment
  std::vector<Beam> beams_;
  std::vector<Piece> pieces_;

  // The line that grows.
  Eigen::Vector2d q_ = Eigen::Vector2d::Zero();
  std::vector<int> seed_beams_;
  std::vector<int> point_beams_;
  std::vector<NormalEquations> equations_;
  std::vector<double> chi2_;
};

}  // namespace

std::vector<Segment> SegmentScanLine(const ScanLine& scan_line,
                                     const Scanner& scanner,
                                     const ScannerMotion& motion,
                                     const SegmentationOptions& options) {
  return Segmenter(scan_line, scanner, motion, options).Run();
}

}  // namespace plumbline

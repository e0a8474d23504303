#include "core/beam_fan.h"

#include <cstring>
#include <limits>

namespace plumbline {
namespace {

// Two beams at a time: all x86-64 and ARM64 processors compute so.
using Pair = double __attribute__((vector_size(16)));

Pair Load(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof(pair));
  return pair;
}

void Store(const Pair& pair, double* to) { std::memcpy(to, &pair, sizeof(pair)); }

double Sum(const Pair& pair) { return pair[0] + pair[1]; }

// NaN where b is.
Pair Smaller(const Pair& a, const Pair& b) { return a < b ? a : b; }

}  // namespace

// See the comment of the class.
struct BeamFan::PairMeeting {
  Pair point_x, point_y;  // p
  Pair f;
  Pair variance;  // V
  Pair is_met;    // positive if f and V make sense
};

inline BeamFan::PairMeeting BeamFan::MeetPair(int i, const Eigen::Vector2d& q) const {
  const double qx = q.x();
  const double qy = q.y();
  const Pair ux = Load(direction_x_ + i);
  const Pair uy = Load(direction_y_ + i);
  const Pair ox = Load(origin_x_ + i);
  const Pair oy = Load(origin_y_ + i);
  const Pair slope = qx * ux + qy * uy;
  const Pair numerator = 1.0 - (qx * ox + qy * oy);
  const Pair by_angle = angle_noise_ * numerator * (qy * ux - qx * uy);
  const Pair slope2 = slope * slope;
  return {slope * ox + numerator * ux,
          slope * oy + numerator * uy,
          slope * (Load(range_ + i) * slope - numerator),
          range_variance_ * (slope2 * slope2) + by_angle * by_angle,
          Smaller(numerator, slope * (2.0 * max_range_) - numerator)};
}

// With a constant twist (v, w) the scanner at time t is turned by w t and lies at
// t (sin(wt)/(wt) v + (1 - cos(wt))/(wt) v_perp); both factors as series, good to 1e-9 for a
// turn of 0.2 rad.
BeamFan::BeamFan(const ScanLine& scan_line,
                 const Scanner& scanner,
                 const ScannerMotion& motion,
                 double outlier_threshold)
    : num_beams_(scan_line.num_beams()),
      range_variance_(scanner.range_noise_m * scanner.range_noise_m),
      angle_noise_(scanner.angle_noise_rad),
      max_range_(scanner.max_range_m),
      outlier_threshold_(outlier_threshold) {
  const int length = num_beams_ + kBlock;
  columns_.reset(new double[5 * static_cast<size_t>(length)]);
  origin_x_ = columns_.get();
  origin_y_ = origin_x_ + length;
  direction_x_ = origin_y_ + length;
  direction_y_ = direction_x_ + length;
  range_ = direction_y_ + length;

  const double middle = 0.5 * (num_beams_ - 1);
  const double turn = motion.yaw_rate_rad_s * scan_line.time_increment_s;
  const double start = scan_line.angle_min - middle * turn;
  const double increment = scan_line.angle_increment + turn;
  const double step_x = std::cos(2.0 * increment);
  const double step_y = std::sin(2.0 * increment);
  const double vx = motion.velocity_m_s.x();
  const double vy = motion.velocity_m_s.y();
  Pair x = {std::cos(start), std::cos(start + increment)};
  Pair y = {std::sin(start), std::sin(start + increment)};
  for (int i = 0; i + 1 < length; i += 2) {
    const Pair time = (Pair{i - middle, i + 1 - middle}) * scan_line.time_increment_s;
    const Pair angle = motion.yaw_rate_rad_s * time;
    const Pair angle2 = angle * angle;
    const Pair along = time * (1.0 - angle2 * (1.0 / 6.0) * (1.0 - angle2 * (1.0 / 20.0)));
    const Pair across =
        0.5 * time * angle * (1.0 - angle2 * (1.0 / 12.0) * (1.0 - angle2 * (1.0 / 30.0)));
    Store(along * vx - across * vy, origin_x_ + i);
    Store(along * vy + across * vx, origin_y_ + i);
    Store(x, direction_x_ + i);
    Store(y, direction_y_ + i);
    const Pair next_x = x * step_x - y * step_y;
    y = x * step_y + y * step_x;
    x = next_x;
  }
  constexpr double kNoReturn = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < num_beams_; ++i) {
    const double range = scan_line.ranges[static_cast<size_t>(i)];
    range_[i] = scanner.IsValidRange(range) ? range : kNoReturn;
  }
  for (int i = num_beams_; i < length; ++i) {
    origin_x_[i] = origin_y_[i] = direction_x_[i] = direction_y_[i] = 0.0;
    range_[i] = kNoReturn;
  }
}

LineEquations BeamFan::SumOnLine(int first,
                                 int last,
                                 const Eigen::Vector2d& q,
                                 int* num_points) const {
  Pair count{}, xx{}, xy{}, yy{}, x{}, y{}, square{};
  for (int i = first; i <= last; i += 2) {
    const Pair one = {1.0, i < last ? 1.0 : 0.0};
    const PairMeeting at = MeetPair(i, q);
    // One number decides about all conditions: masks that are combined get taken apart.
    const Pair counts = Smaller(at.is_met, outlier_threshold_ * at.variance - at.f * at.f);
    const Pair weight = counts > 0.0 ? one / at.variance : Pair{};
    const Pair f = counts > 0.0 ? at.f : Pair{};  // NaN without a return
    const Pair weighted_x = weight * at.point_x;
    const Pair weighted_y = weight * at.point_y;
    xx += weighted_x * at.point_x;
    xy += weighted_x * at.point_y;
    yy += weighted_y * at.point_y;
    x -= weighted_x * f;
    y -= weighted_y * f;
    square += weight * (f * f);
    count += counts > 0.0 ? one : Pair{};
  }
  *num_points = static_cast<int>(Sum(count));
  return {Sum(xx), Sum(xy), Sum(yy), Sum(x), Sum(y), Sum(square)};
}

std::array<double, BeamFan::kBlock> BeamFan::Deviations(int first,
                                                        const Eigen::Vector2d& q) const {
  const Pair largest = {outlier_threshold_, outlier_threshold_};
  std::array<double, kBlock> deviations;
  for (int k = 0; k < kBlock; k += 2) {
    const Pair range = Load(range_ + first + k);
    const PairMeeting at = MeetPair(first + k, q);
    const Pair deviation =
        at.is_met > 0.0 ? Smaller(at.f * at.f / at.variance, largest) : largest;
    Store(range == range ? deviation : Pair{}, &deviations[static_cast<size_t>(k)]);
  }
  return deviations;
}

// The end that TrimToLine leaves, looking towards the other one.
int BeamFan::TrimmedEnd(int end, int other_end, const Eigen::Vector2d& q) const {
  constexpr int kMaxTail = 4;  // beams; as many as this are the line's
  const int step = other_end < end ? -1 : 1;
  while (end != other_end) {
    while (end != other_end && !IsOnLine(end, q)) end += step;
    int next = end;
    int tail = 0;
    for (; next != other_end && tail < kMaxTail && IsOnLine(next, q); next += step) ++tail;
    int num_off = 0;
    for (; next != other_end && !IsOnLine(next, q); next += step) {
      if (HasReturn(next)) ++num_off;
    }
    if (num_off <= tail) break;
    end = next;
  }
  return end;
}

}  // namespace plumbline

#include "core/segmentation/beam_model.h"

#include <limits>

#include "core/sensor/scanner_motion.h"
#include "factors/util/simd.h"

namespace plumbline {

static_assert(BeamFan::kBlock % kLanes == 0);

// See the comment of the class.
struct BeamFan::LanesMeeting {
  Lanes point_x, point_y;  // p
  Lanes f;
  Lanes variance;  // V
  Lanes is_met;    // positive if f and V make sense
};

inline BeamFan::LanesMeeting BeamFan::MeetLanes(int i, const Eigen::Vector2d& q) const {
  const double qx = q.x();
  const double qy = q.y();
  const Lanes ux = LoadLanes(direction_x_ + i);
  const Lanes uy = LoadLanes(direction_y_ + i);
  const Lanes ox = LoadLanes(origin_x_ + i);
  const Lanes oy = LoadLanes(origin_y_ + i);
  const Lanes slope = qx * ux + qy * uy;
  const Lanes numerator = 1.0 - (qx * ox + qy * oy);
  const Lanes by_angle = angle_noise_ * numerator * (qy * ux - qx * uy);
  const Lanes slope2 = slope * slope;
  return {slope * ox + numerator * ux,
          slope * oy + numerator * uy,
          slope * (LoadLanes(range_ + i) * slope - numerator),
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
  // In whole lanes.
  const int length = (num_beams_ + kBlock + kLanes - 1) / kLanes * kLanes;
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
  const double step_x = std::cos(kLanes * increment);
  const double step_y = std::sin(kLanes * increment);
  const double vx = motion.velocity_m_s.x();
  const double vy = motion.velocity_m_s.y();
  Lanes x = MakeLanes([&](int k) { return std::cos(start + k * increment); });
  Lanes y = MakeLanes([&](int k) { return std::sin(start + k * increment); });
  const Lanes index = MakeLanes([](int k) { return k; });
  for (int i = 0; i < length; i += kLanes) {
    const Lanes time = (index + (i - middle)) * scan_line.time_increment_s;
    const Lanes angle = motion.yaw_rate_rad_s * time;
    const Lanes angle2 = angle * angle;
    const Lanes along = time * (1.0 - angle2 * (1.0 / 6.0) * (1.0 - angle2 * (1.0 / 20.0)));
    const Lanes across =
        0.5 * time * angle * (1.0 - angle2 * (1.0 / 12.0) * (1.0 - angle2 * (1.0 / 30.0)));
    StoreLanes(along * vx - across * vy, origin_x_ + i);
    StoreLanes(along * vy + across * vx, origin_y_ + i);
    StoreLanes(x, direction_x_ + i);
    StoreLanes(y, direction_y_ + i);
    const Lanes next_x = x * step_x - y * step_y;
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
  Lanes count{}, xx{}, xy{}, yy{}, x{}, y{}, square{};
  const Lanes index = MakeLanes([](int k) { return k; });
  for (int i = first; i <= last; i += kLanes) {
    const Lanes one = index <= static_cast<double>(last - i) ? Lanes{} + 1.0 : Lanes{};
    const LanesMeeting at = MeetLanes(i, q);
    // One number decides about all conditions: masks that are combined get taken apart.
    const Lanes counts = Smaller(at.is_met, outlier_threshold_ * at.variance - at.f * at.f);
    const Lanes weight = counts > 0.0 ? one / at.variance : Lanes{};
    const Lanes f = counts > 0.0 ? at.f : Lanes{};  // NaN without a return
    const Lanes weighted_x = weight * at.point_x;
    const Lanes weighted_y = weight * at.point_y;
    xx += weighted_x * at.point_x;
    xy += weighted_x * at.point_y;
    yy += weighted_y * at.point_y;
    x -= weighted_x * f;
    y -= weighted_y * f;
    square += weight * (f * f);
    count += counts > 0.0 ? one : Lanes{};
  }
  *num_points = static_cast<int>(SumOf(count));
  return {SumOf(xx), SumOf(xy), SumOf(yy), SumOf(x), SumOf(y), SumOf(square)};
}

std::array<double, BeamFan::kBlock> BeamFan::Deviations(int first,
                                                        const Eigen::Vector2d& q) const {
  const Lanes largest = Lanes{} + outlier_threshold_;
  std::array<double, kBlock> deviations;
  for (int k = 0; k < kBlock; k += kLanes) {
    const Lanes range = LoadLanes(range_ + first + k);
    const LanesMeeting at = MeetLanes(first + k, q);
    const Lanes deviation =
        at.is_met > 0.0 ? Smaller(at.f * at.f / at.variance, largest) : largest;
    StoreLanes(range == range ? deviation : Lanes{}, &deviations[static_cast<size_t>(k)]);
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

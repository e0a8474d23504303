#include "core/segmentation/beam_model.h"

#include <limits>

#include "core/sensor/scanner_motion.h"

namespace plumbline {

// Four beams' intersections with a line; see the comment of the class.
struct BeamModel::FourIntersections {
  Eigen::Array4d point_x, point_y;  // p
  Eigen::Array4d f;                 // NaN without a return
  Eigen::Array4d variance;          // V
  Eigen::Array4d is_met;            // positive if f and V make sense
};

EIGEN_ALWAYS_INLINE BeamModel::FourIntersections BeamModel::IntersectFour(
    int i, const Eigen::Vector2d& q) const {
  using Four = Eigen::Map<const Eigen::Array4d>;
  const Four ux(direction_x_ + i), uy(direction_y_ + i);
  const Four ox(origin_x_ + i), oy(origin_y_ + i);
  const Eigen::Array4d slope = q.x() * ux + q.y() * uy;
  const Eigen::Array4d numerator = 1.0 - (q.x() * ox + q.y() * oy);
  const Eigen::Array4d by_angle = angle_noise_ * numerator * (q.y() * ux - q.x() * uy);
  FourIntersections at;
  at.point_x = slope * ox + numerator * ux;
  at.point_y = slope * oy + numerator * uy;
  at.f = slope * (Four(range_ + i) * slope - numerator);
  at.variance = range_variance_ * slope.square().square() +
                noise_growth_ * numerator.square().square() + by_angle.square();
  at.is_met = numerator.min(slope * (2.0 * max_range_) - numerator);
  return at;
}

// With a constant twist (v, w) the scanner at time t is turned by w t and lies at
// t (sin(wt)/(wt) v + (1 - cos(wt))/(wt) v_perp); both factors as series, good to 1e-9 for a
// turn of 0.2 rad.
BeamModel::BeamModel(const ScanLine& scan_line,
                     const Scanner& scanner,
                     const ScannerMotion& motion,
                     double outlier_threshold)
    : num_beams_(scan_line.num_beams()),
      range_variance_(scanner.range_noise_m * scanner.range_noise_m),
      noise_growth_(scanner.range_noise_per_m2 * scanner.range_noise_per_m2),
      angle_noise_(scanner.angle_noise_rad),
      max_range_(scanner.max_range_m),
      outlier_threshold_(outlier_threshold) {
  const int length = (num_beams_ + 2 * kBlock - 1) / kBlock * kBlock;
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
  const double step_x = std::cos(kBlock * increment);
  const double step_y = std::sin(kBlock * increment);
  const double vx = motion.velocity_m_s.x();
  const double vy = motion.velocity_m_s.y();
  const Eigen::Array4d index(0.0, 1.0, 2.0, 3.0);
  Eigen::Array4d x = (start + increment * index).cos();
  Eigen::Array4d y = (start + increment * index).sin();
  for (int i = 0; i < length; i += kBlock) {
    const Eigen::Array4d time = (index + (i - middle)) * scan_line.time_increment_s;
    const Eigen::Array4d angle = motion.yaw_rate_rad_s * time;
    const Eigen::Array4d angle2 = angle.square();
    const Eigen::Array4d along =
        time * (1.0 - angle2 * (1.0 / 6.0) * (1.0 - angle2 * (1.0 / 20.0)));
    const Eigen::Array4d across =
        0.5 * time * angle * (1.0 - angle2 * (1.0 / 12.0) * (1.0 - angle2 * (1.0 / 30.0)));
    Eigen::Map<Eigen::Array4d>(origin_x_ + i) = along * vx - across * vy;
    Eigen::Map<Eigen::Array4d>(origin_y_ + i) = along * vy + across * vx;
    Eigen::Map<Eigen::Array4d>(direction_x_ + i) = x;
    Eigen::Map<Eigen::Array4d>(direction_y_ + i) = y;
    const Eigen::Array4d next_x = x * step_x - y * step_y;
    y = x * step_y + y * step_x;
    x = next_x;
  }
  if (scan_line.angles != nullptr) TakeAngles(*scan_line.angles, turn);
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

// turn: of the scanner from beam to beam.
void BeamModel::TakeAngles(const std::vector<double>& angles, double turn) {
  const double middle = 0.5 * (num_beams_ - 1);
  for (int i = 0; i < num_beams_; ++i) {
    const double angle = angles[static_cast<size_t>(i)] + (i - middle) * turn;
    direction_x_[i] = std::cos(angle);
    direction_y_[i] = std::sin(angle);
  }
}

LineEquations BeamModel::SumOnLine(int first,
                                   int last,
                                   const Eigen::Vector2d& q,
                                   int* num_points) const {
  const Eigen::Array4d zero = Eigen::Array4d::Zero();
  Eigen::Array4d xx = zero, xy = zero, yy = zero, x = zero, y = zero, square = zero;
  *num_points = 0;
  for (int i = first; i <= last; i += kBlock) {
    const FourIntersections at = IntersectFour(i, q);
    Eigen::Array4d weight = at.variance.inverse();
    Eigen::Array4d f = at.f;
    const Eigen::Array4d margin = outlier_threshold_ * at.variance - f.square();
    for (int k = 0; k < kBlock; ++k) {
      const bool counts = i + k <= last && at.is_met[k] > 0.0 && margin[k] > 0.0;
      if (!counts) weight[k] = f[k] = 0.0;
      *num_points += counts ? 1 : 0;
    }
    const Eigen::Array4d weighted_x = weight * at.point_x;
    const Eigen::Array4d weighted_y = weight * at.point_y;
    xx += weighted_x * at.point_x;
    xy += weighted_x * at.point_y;
    yy += weighted_y * at.point_y;
    x -= weighted_x * f;
    y -= weighted_y * f;
    square += weight * f.square();
  }
  return {xx.sum(), xy.sum(), yy.sum(), x.sum(), y.sum(), square.sum()};
}

Eigen::Array4d BeamModel::Deviations(int first, const Eigen::Vector2d& q) const {
  const FourIntersections at = IntersectFour(first, q);
  Eigen::Array4d deviations = (at.f.square() / at.variance).min(outlier_threshold_);
  for (int k = 0; k < kBlock; ++k) {
    if (!(at.is_met[k] > 0.0)) deviations[k] = outlier_threshold_;
    if (!HasReturn(first + k)) deviations[k] = 0.0;
  }
  return deviations;
}

// The end that TrimToLine leaves, looking towards the other one.
int BeamModel::TrimmedEnd(int end, int other_end, const Eigen::Vector2d& q) const {
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

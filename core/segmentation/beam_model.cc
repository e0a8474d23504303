#include "core/segmentation/beam_model.h"

#include <limits>

#include "core/sensor/scanner_motion.h"
#include "factors/util/simd.h"

namespace plumbline {

static_assert(BeamModel::kBlock % kSimdWidth == 0);

// See the comment of the class.
struct BeamModel::SimdIntersection {
  Simd point_x, point_y;  // p
  Simd f;
  Simd variance;  // V
  Simd is_met;    // positive if f and V make sense
};

inline BeamModel::SimdIntersection BeamModel::IntersectSimd(int i,
                                                            const Eigen::Vector2d& q) const {
  const double qx = q.x();
  const double qy = q.y();
  const Simd ux = LoadSimd(direction_x_ + i);
  const Simd uy = LoadSimd(direction_y_ + i);
  const Simd ox = LoadSimd(origin_x_ + i);
  const Simd oy = LoadSimd(origin_y_ + i);
  const Simd slope = qx * ux + qy * uy;
  const Simd numerator = 1.0 - (qx * ox + qy * oy);
  const Simd by_angle = angle_noise_ * numerator * (qy * ux - qx * uy);
  const Simd slope2 = slope * slope;
  return {slope * ox + numerator * ux,
          slope * oy + numerator * uy,
          slope * (LoadSimd(range_ + i) * slope - numerator),
          range_variance_ * (slope2 * slope2) + by_angle * by_angle,
          Smaller(numerator, slope * (2.0 * max_range_) - numerator)};
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
      angle_noise_(scanner.angle_noise_rad),
      max_range_(scanner.max_range_m),
      outlier_threshold_(outlier_threshold) {
  // In whole lanes.
  const int length = (num_beams_ + kBlock + kSimdWidth - 1) / kSimdWidth * kSimdWidth;
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
  const double step_x = std::cos(kSimdWidth * increment);
  const double step_y = std::sin(kSimdWidth * increment);
  const double vx = motion.velocity_m_s.x();
  const double vy = motion.velocity_m_s.y();
  Simd x = MakeSimd([&](int k) { return std::cos(start + k * increment); });
  Simd y = MakeSimd([&](int k) { return std::sin(start + k * increment); });
  const Simd index = MakeSimd([](int k) { return k; });
  for (int i = 0; i < length; i += kSimdWidth) {
    const Simd time = (index + (i - middle)) * scan_line.time_increment_s;
    const Simd angle = motion.yaw_rate_rad_s * time;
    const Simd angle2 = angle * angle;
    const Simd along = time * (1.0 - angle2 * (1.0 / 6.0) * (1.0 - angle2 * (1.0 / 20.0)));
    const Simd across =
        0.5 * time * angle * (1.0 - angle2 * (1.0 / 12.0) * (1.0 - angle2 * (1.0 / 30.0)));
    StoreSimd(along * vx - across * vy, origin_x_ + i);
    StoreSimd(along * vy + across * vx, origin_y_ + i);
    StoreSimd(x, direction_x_ + i);
    StoreSimd(y, direction_y_ + i);
    const Simd next_x = x * step_x - y * step_y;
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

LineEquations BeamModel::SumOnLine(int first,
                                   int last,
                                   const Eigen::Vector2d& q,
                                   int* num_points) const {
  Simd count{}, xx{}, xy{}, yy{}, x{}, y{}, square{};
  const Simd index = MakeSimd([](int k) { return k; });
  for (int i = first; i <= last; i += kSimdWidth) {
    const Simd one = index <= static_cast<double>(last - i) ? Simd{} + 1.0 : Simd{};
    const SimdIntersection at = IntersectSimd(i, q);
    // One number decides about all conditions: masks that are combined get taken apart.
    const Simd counts = Smaller(at.is_met, outlier_threshold_ * at.variance - at.f * at.f);
    const Simd weight = counts > 0.0 ? one / at.variance : Simd{};
    const Simd f = counts > 0.0 ? at.f : Simd{};  // NaN without a return
    const Simd weighted_x = weight * at.point_x;
    const Simd weighted_y = weight * at.point_y;
    xx += weighted_x * at.point_x;
    xy += weighted_x * at.point_y;
    yy += weighted_y * at.point_y;
    x -= weighted_x * f;
    y -= weighted_y * f;
    square += weight * (f * f);
    count += counts > 0.0 ? one : Simd{};
  }
  *num_points = static_cast<int>(SumOf(count));
  return {SumOf(xx), SumOf(xy), SumOf(yy), SumOf(x), SumOf(y), SumOf(square)};
}

std::array<double, BeamModel::kBlock> BeamModel::Deviations(int first,
                                                            const Eigen::Vector2d& q) const {
  const Simd largest = Simd{} + outlier_threshold_;
  std::array<double, kBlock> deviations;
  for (int k = 0; k < kBlock; k += kSimdWidth) {
    const Simd range = LoadSimd(range_ + first + k);
    const SimdIntersection at = IntersectSimd(first + k, q);
    const Simd deviation =
        at.is_met > 0.0 ? Smaller(at.f * at.f / at.variance, largest) : largest;
    StoreSimd(range == range ? deviation : Simd{}, &deviations[static_cast<size_t>(k)]);
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

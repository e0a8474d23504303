#include "core/beam_fan.h"

#include <cmath>

namespace plumbline {

// With a constant twist (v, w) the scanner at time t is turned by w t and lies at
// t (sin(wt)/(wt) v + (1 - cos(wt))/(wt) v_perp); both factors as series, good to 1e-9 for a
// turn of 0.2 rad.
BeamFan::BeamFan(const ScanLine& scan_line,
                 const Scanner& scanner,
                 const ScannerMotion& motion,
                 double outlier_threshold)
    : range_variance_(scanner.range_noise_m * scanner.range_noise_m),
      angle_noise_(scanner.angle_noise_rad),
      max_range_(scanner.max_range_m),
      outlier_threshold_(outlier_threshold),
      beams_(scan_line.ranges.size()) {
  const double middle = 0.5 * (scan_line.num_beams() - 1);
  const double turn = motion.yaw_rate_rad_s * scan_line.time_increment_s;
  const double start = scan_line.angle_min - middle * turn;
  const double increment = scan_line.angle_increment + turn;
  const Eigen::Vector2d step(std::cos(increment), std::sin(increment));
  const Eigen::Vector2d& v = motion.velocity_m_s;
  Eigen::Vector2d direction(std::cos(start), std::sin(start));
  for (size_t i = 0; i < beams_.size(); ++i) {
    Beam& beam = beams_[i];
    const double time = (static_cast<double>(i) - middle) * scan_line.time_increment_s;
    const double x = motion.yaw_rate_rad_s * time;
    const double along = time * (1.0 - x * x / 6.0 * (1.0 - x * x / 20.0));
    const double across = 0.5 * time * x * (1.0 - x * x / 12.0 * (1.0 - x * x / 30.0));
    beam.origin = {along * v.x() - across * v.y(), along * v.y() + across * v.x()};
    beam.direction = direction;
    beam.range = scan_line.ranges[i];
    beam.is_valid = scanner.IsValidRange(beam.range);
    direction = {direction.x() * step.x() - direction.y() * step.y(),
                 direction.x() * step.y() + direction.y() * step.x()};
  }
}

}  // namespace plumbline

// Scanners whose beams are not evenly spread, or of which points alone are recorded.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/segmentation/segmentation.h"

namespace plumbline {
namespace {

constexpr double kWall = 2.0;  // m ahead, across the x axis

// A wall seen by a scanner that turns and moves while its beams go round.
ScanLine SeeWall(const std::vector<double>& angles, const ScannerMotion& motion) {
  ScanLine scan_line;
  scan_line.angle_min = angles.front();
  const auto num_steps = static_cast<double>(angles.size() - 1);
  scan_line.angle_increment = (angles.back() - angles.front()) / num_steps;
  scan_line.time_increment_s = 1e-4;
  scan_line.angles = std::make_shared<std::vector<double>>(angles);
  for (size_t i = 0; i < angles.size(); ++i) {
    const double time = (static_cast<double>(i) - 0.5 * num_steps) * 1e-4;
    const double angle = angles[i] + motion.yaw_rate_rad_s * time;
    const double x = motion.velocity_m_s.x() * time;
    scan_line.ranges.push_back(static_cast<float>((kWall - x) / std::cos(angle)));
  }
  return scan_line;
}

TEST(IrregularBeamsTest, WallIsOneSegmentWhereItIs) {
  ScannerMotion motion;
  motion.velocity_m_s = {1.0, 0.0};
  motion.yaw_rate_rad_s = 0.5;
  std::vector<double> angles;
  for (int i = 0; i < 200; ++i) {
    angles.push_back(-0.8 + 0.008 * i + 0.02 * std::sin(0.11 * i));
  }
  ScanLine scan_line = SeeWall(angles, motion);
  Scanner scanner;
  scanner.range_noise_m = 0.005;
  const std::vector<Segment> segments = SegmentScanLine(scan_line, scanner, motion, {});
  ASSERT_EQ(segments.size(), 1u);
  EXPECT_EQ(segments[0].num_points, 200);
  EXPECT_NEAR(segments[0].normal.x(), -1.0, 1e-6);
  EXPECT_NEAR(segments[0].distance, -kWall, 1e-4);
  // As a fan of regular beams, it is no wall at all.
  scan_line.angles = nullptr;
  EXPECT_GT(SegmentScanLine(scan_line, scanner, motion, {}).size(), 1u);
}

}  // namespace
}  // namespace plumbline

#include "core/sensor/scan_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace plumbline {
namespace {

ScanLine MakeRegular(double increment) {
  ScanLine scan_line;
  scan_line.angle_min = -1.0;
  scan_line.angle_increment = increment;
  scan_line.ranges.assign(9, 2.0f);
  return scan_line;
}

ScanLine MakeIrregular(const std::vector<double>& angles) {
  ScanLine scan_line;
  scan_line.angle_min = angles.front();
  scan_line.angle_increment =
      (angles.back() - angles.front()) / static_cast<double>(angles.size() - 1);
  scan_line.angles = std::make_shared<std::vector<double>>(angles);
  scan_line.ranges.assign(angles.size(), 2.0f);
  return scan_line;
}

TEST(ScanLineTest, BeamsToADirectionAreCountedFromTheBeam) {
  for (const double increment : {0.25, -0.25}) {
    const ScanLine scan_line = MakeRegular(increment);
    for (int from = 0; from < 9; ++from) {
      for (double beam = -3.0; beam < 12.0; beam += 0.5) {
        const double angle = -1.0 + beam * increment;
        EXPECT_NEAR(scan_line.BeamsTo(angle, from), beam - from, 1e-12);
        EXPECT_NEAR(scan_line.BeamsTo(angle + 2.0 * M_PI, from), beam - from, 1e-12);
      }
    }
  }
}

TEST(ScanLineTest, RegularAnglesGivenOneByOneAreTheSame) {
  for (const double increment : {0.25, -0.25}) {
    const ScanLine regular = MakeRegular(increment);
    std::vector<double> angles;
    for (int beam = 0; beam < 9; ++beam) angles.push_back(regular.BeamAngle(beam));
    const ScanLine irregular = MakeIrregular(angles);
    for (int beam = -2; beam < 12; ++beam) {
      EXPECT_NEAR(irregular.BeamAngle(beam), regular.BeamAngle(beam), 1e-12);
      for (double angle = -4.0; angle < 4.0; angle += 0.1) {
        EXPECT_NEAR(irregular.BeamsTo(angle, beam), regular.BeamsTo(angle, beam), 1e-9);
      }
    }
  }
}

TEST(ScanLineTest, IrregularBeamsKeepTheirAngles) {
  const std::vector<double> angles = {0.0, 0.1, 0.3, 0.6, 1.0};
  const ScanLine scan_line = MakeIrregular(angles);
  for (int beam = 0; beam < 5; ++beam) {
    const double angle = angles[static_cast<size_t>(beam)];
    EXPECT_EQ(scan_line.BeamAngle(beam), angle);
    EXPECT_EQ(scan_line.BeamDirection(beam),
              Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  EXPECT_NEAR(scan_line.BeamsTo(0.2, 0), 1.5, 1e-12);
  EXPECT_NEAR(scan_line.BeamsTo(0.2, 4), -2.5, 1e-12);
  EXPECT_NEAR(scan_line.BeamsTo(0.75, 2), 1.375, 1e-12);
  // Beyond the ends, the mean increment of 0.25 counts.
  EXPECT_NEAR(scan_line.BeamsTo(1.5, 3), 3.0, 1e-12);
  EXPECT_NEAR(scan_line.BeamsTo(-0.5, 1), -3.0, 1e-12);
  EXPECT_NEAR(scan_line.BeamAngle(6), 1.5, 1e-12);
}

}  // namespace
}  // namespace plumbline

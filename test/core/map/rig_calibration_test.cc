#include "core/map/rig_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

Rig RigOf(const std::vector<ScannerUncertainty>& uncertainties) {
  Rig rig;
  for (const ScannerUncertainty& uncertainty : uncertainties) {
    Scanner scanner;
    scanner.body_from_scanner.translation = {0.1, 0.2, 0.3};
    scanner.time_offset_s = 0.5;
    scanner.range_bias_m = 0.02;
    scanner.uncertainty = uncertainty;
    rig.scanners.push_back(scanner);
  }
  return rig;
}

constexpr ScannerUncertainty kByHand = {0.02, 0.01, 0.002, 0.01};
constexpr ScannerUncertainty kExact = {};

TEST(RigCalibration, OfAnExactRigIsEmpty) {
  EXPECT_TRUE(RigCalibration(RigOf({kExact, kExact}), false).scanners.empty());
}

TEST(RigCalibration, FirstScannerIsTheBodysButForItsRanges) {
  const RigCalibration calibration(RigOf({kByHand, kByHand}), false);
  ASSERT_EQ(calibration.scanners.size(), 2u);
  EXPECT_TRUE(calibration.scanners[0].is_body);
  EXPECT_EQ(calibration.scanners[0].prior_sigma, (ScannerBlock{0, 0, 0, 0, 0, 0, 0, 0.01}));
  EXPECT_EQ(calibration.scanners[1].prior_sigma,
            (ScannerBlock{0.02, 0.02, 0.02, 0.01, 0.01, 0.01, 0.002, 0.01}));
  EXPECT_DOUBLE_EQ(calibration.scanners[1].covariance(0, 0), 4e-4);
}

TEST(RigCalibration, ScannerThatIsKnownExactlyIsTheBodys) {
  const RigCalibration calibration(RigOf({kByHand, kExact}), false);
  EXPECT_FALSE(calibration.scanners[0].is_body);
  EXPECT_TRUE(calibration.scanners[1].is_body);
  EXPECT_TRUE(calibration.IsEstimated(0));
  EXPECT_FALSE(calibration.IsEstimated(1));
}

TEST(RigCalibration, MotionInThePlaneShowsNoHeightsAndTilts) {
  const RigCalibration calibration(RigOf({kByHand, kByHand}), true);
  EXPECT_EQ(calibration.scanners[1].prior_sigma,
            (ScannerBlock{0, 0, 0.02, 0.01, 0.01, 0, 0.002, 0.01}));
}

TEST(RigCalibration, CalibratedRigHasPosesClocksAndRanges) {
  const Rig rig = RigOf({kByHand, kByHand});
  RigCalibration calibration(rig, false);
  calibration.scanners[1].block = {0, 0, M_PI / 2, 0.01, 0, 0, 0.003, 0.004, 0.01};
  const Rig posed = calibration.Posed(rig);
  EXPECT_EQ(posed.scanners[1].time_offset_s, 0.5);
  EXPECT_EQ(posed.scanners[1].delay_s, 0.003);
  EXPECT_EQ(posed.scanners[1].range_excess_m, 0.004);
  const Rig calibrated = calibration.Calibrated(rig);
  const Scanner& scanner = calibrated.scanners[1];
  EXPECT_DOUBLE_EQ(scanner.time_offset_s, 0.503);
  EXPECT_DOUBLE_EQ(scanner.range_bias_m, 0.024);
  EXPECT_DOUBLE_EQ(scanner.range_scale, 0.99);
  EXPECT_DOUBLE_EQ((5.0 - scanner.range_bias_m) * scanner.range_scale,
                   posed.scanners[1].TrueRange(5.0 - 0.02));
  EXPECT_EQ(scanner.delay_s, 0.0);
  EXPECT_EQ(scanner.range_excess_m, 0.0);
  EXPECT_NEAR(scanner.body_from_scanner.translation.x(), 0.11, 1e-12);
  // It turns about itself.
  const Eigen::Vector3d ahead = scanner.body_from_scanner.rotation * Eigen::Vector3d::UnitX();
  EXPECT_LT((ahead - Eigen::Vector3d::UnitY()).norm(), 1e-12);
}

}  // namespace
}  // namespace plumbline

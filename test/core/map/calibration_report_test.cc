#include "core/map/calibration_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geometry/angles.h"
#include "core/result/calibration_text.h"

namespace plumbline {
namespace {

class CalibrationReportTest : public testing::Test {
 protected:
  CalibrationReportTest() {
    for (const char* name : {"top", "left"}) {
      Scanner scanner;
      scanner.name = name;
      scanner.uncertainty = {0.02, 0.01, 0.002, 0.01};
      rig_.scanners.push_back(scanner);
    }
  }

  // Of both scanners' blocks: as the rig file states them, the left one's clock apart.
  Eigen::MatrixXd Covariance(const RigCalibration& calibration, double clock_sigma_s) const {
    Eigen::MatrixXd covariance =
        Eigen::MatrixXd::Zero(2 * kScannerBlockSize, 2 * kScannerBlockSize);
    for (int i = 0; i < 2; ++i) {
      covariance.block<kScannerBlockSize, kScannerBlockSize>(kScannerBlockSize * i,
                                                             kScannerBlockSize * i) =
          calibration.scanners[static_cast<size_t>(i)]
              .covariance.topLeftCorner<kScannerBlockSize, kScannerBlockSize>();
    }
    const int clock = kScannerBlockSize + kScannerDelayAt;
    covariance(clock, clock) = clock_sigma_s * clock_sigma_s;
    return covariance;
  }

  Rig rig_;
};

TEST_F(CalibrationReportTest, SaysWhatIsOffTheRigFileAndWhatIsShown) {
  RigCalibration calibration(rig_, false);
  calibration.scanners[1].block[kScannerDelayAt] = 0.0015;
  const Calibration found =
      DescribeCalibration(rig_, rig_, calibration, Covariance(calibration, 1e-4));
  ASSERT_EQ(found.scanners.size(), 2u);
  const CalibratedParameter& clock = found.scanners[1].parameters[CalibratedScanner::kTime];
  EXPECT_NEAR(clock.value, 0.0015, 1e-12);
  EXPECT_NEAR(clock.sigma, 1e-4, 1e-12);
  const CalibratedParameter& roll = found.scanners[1].parameters[0];
  EXPECT_EQ(roll.name, "roll_deg");
  EXPECT_NEAR(roll.sigma, 0.02 * kDegreesPerRadian, 1e-9);
  const std::vector<bool> observed = ObservedParameters(found)[1];
  EXPECT_TRUE(observed[CalibratedScanner::kTime]);
  EXPECT_FALSE(observed[CalibratedScanner::kTurn]);
  // The first scanner is the body's, but for its ranges.
  EXPECT_TRUE(found.scanners[0].parameters[0].IsHeld());
  EXPECT_FALSE(found.scanners[0].parameters[CalibratedScanner::kRange].IsHeld());
  EXPECT_EQ(found.covariance.rows(), kScannerBlockSize) << "scales are not asked for";
}

TEST_F(CalibrationReportTest, MetreIsThatOfTheBodysScanner) {
  for (Scanner& scanner : rig_.scanners) scanner.uncertainty.range_scale = 0.01;
  RigCalibration calibration(rig_, false);
  calibration.scanners[1].block[kScannerScaleAt] = 0.003;
  const Calibration found =
      DescribeCalibration(rig_, rig_, calibration, Covariance(calibration, 1e-4));
  const CalibratedParameter& scale = found.scanners[1].parameters[CalibratedScanner::kScale];
  EXPECT_EQ(scale.name, "range_scale");
  EXPECT_NEAR(scale.value, 0.003, 1e-12);
  EXPECT_EQ(scale.prior_sigma, 0.01);
  EXPECT_TRUE(found.scanners[0].parameters[CalibratedScanner::kScale].IsHeld());
  const Rig calibrated = CalibratedRig(rig_, calibration);
  EXPECT_DOUBLE_EQ(calibrated.scanners[1].range_scale, 0.997);
  EXPECT_EQ(calibrated.scanners[0].uncertainty.range_scale, 0.0);
  EXPECT_EQ(calibrated.scanners[0].uncertainty.range_m, rig_.scanners[0].uncertainty.range_m);
}

// The turn about the axis of a mount is the zero of its angle.
TEST_F(CalibrationReportTest, DescribesAMount) {
  Mount mount;
  mount.axis = Eigen::Vector3d(0.1, 1.0, 0.0).normalized();
  mount.rate_rad_s = 2.0;
  mount.uncertainty = {0.02, 0.002, 0.001, 0.01, 0.003};
  rig_.scanners[1].mount = mount;
  RigCalibration calibration(rig_, false);
  ScannerEstimate& scanner = calibration.scanners[1];
  EXPECT_EQ(scanner.prior_sigma[kScannerTurnAt + 1], 0.0);
  EXPECT_EQ(scanner.prior_sigma[kScannerTurnAt], 0.02);
  scanner.block[kMountZeroAt] = 0.01;
  scanner.block[kMountDelayAt] = 0.001;
  scanner.block[kMountRateAt] = 0.0005;
  scanner.block[kMountTiltAt] = 0.02;
  scanner.block[kMountShiftAt + 1] = -0.002;
  const int size = kScannerBlockSize + kMountedBlockSize;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(size, size) * 1e-8;
  const Calibration found = DescribeCalibration(rig_, rig_, calibration, covariance);
  ASSERT_EQ(found.scanners[1].parameters.size(), static_cast<size_t>(kMountedBlockSize));
  for (int k = 0; k < kMountedBlockSize; ++k) {
    const CalibratedParameter& parameter =
        found.scanners[1].parameters[static_cast<size_t>(k)];
    const double unit =
        parameter.name.find("_deg") == std::string::npos ? 1.0 : kRadiansPerDegree;
    EXPECT_NEAR(parameter.value * unit, scanner.block[static_cast<size_t>(k)], 1e-9)
        << parameter.name;
  }
  EXPECT_EQ(found.scanners[1].parameters[kMountZeroAt].name, "mount_zero_deg");
  EXPECT_TRUE(found.scanners[1].parameters[1].IsHeld());
  // A rig as it is found is what the next map starts from.
  scanner.SetCovariance(covariance.bottomRightCorner(kMountedBlockSize, kMountedBlockSize), 0);
  const Mount calibrated = *CalibratedRig(rig_, calibration).scanners[1].mount;
  EXPECT_NEAR(calibrated.zero_rad, 0.01, 1e-12);
  EXPECT_NEAR(calibrated.time_offset_s, 0.001, 1e-12);
  EXPECT_NEAR(calibrated.rate_rad_s, 2.001, 1e-12);
  EXPECT_NEAR(calibrated.uncertainty.zero_rad, 1e-4, 1e-12);
}

// A rig that started elsewhere is held against what the file says.
TEST_F(CalibrationReportTest, CountsFromTheRigFileAlsoWhereTheMapStartedElsewhere) {
  Rig near = rig_;
  near.scanners[1].time_offset_s = 0.02;
  near.scanners[1].body_from_scanner.translation.x() = 0.05;
  RigCalibration calibration(near, false);
  calibration.scanners[1].block[kScannerDelayAt] = 0.001;
  const Calibration found =
      DescribeCalibration(rig_, near, calibration, Covariance(calibration, 1e-4));
  EXPECT_NEAR(found.scanners[1].parameters[CalibratedScanner::kTime].value, 0.021, 1e-12);
  EXPECT_NEAR(found.scanners[1].parameters[CalibratedScanner::kShift].value, 0.05, 1e-12);
  EXPECT_NEAR(found.scanners[1].parameters[CalibratedScanner::kTime].prior_value, 0.02, 1e-12);
}

TEST_F(CalibrationReportTest, CalibratedRigStatesWhatIsStillUncertain) {
  RigCalibration calibration(rig_, false);
  ScannerEstimate& left = calibration.scanners[1];
  left.covariance.setZero();
  left.covariance.diagonal() << 1e-6, 4e-6, 1e-6, 1e-6, 1e-6, 9e-6, 1e-8, 1e-8;
  const Rig calibrated = CalibratedRig(rig_, calibration);
  EXPECT_EQ(calibrated.scanners[0].uncertainty.rotation_rad, 0.0);
  EXPECT_EQ(calibrated.scanners[0].uncertainty.range_m, 0.01);
  EXPECT_NEAR(calibrated.scanners[1].uncertainty.rotation_rad, 2e-3, 1e-12);
  EXPECT_NEAR(calibrated.scanners[1].uncertainty.translation_m, 3e-3, 1e-12);
  EXPECT_NEAR(calibrated.scanners[1].uncertainty.time_s, 1e-4, 1e-12);
}

}  // namespace
}  // namespace plumbline

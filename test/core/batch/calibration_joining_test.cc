#include "core/batch/calibration_joining.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/map/calibration_report.h"
#include "core/map/rig_calibration.h"
#include "core/result/calibration_text.h"
#include "core/util/error.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

class CalibrationJoiningTest : public TemporaryDirectoryTest {
 protected:
  CalibrationJoiningTest() {
    for (const char* name : {"top", "left"}) {
      Scanner scanner;
      scanner.name = name;
      scanner.uncertainty = {0.02, 0.01, 0.002, 0.01};
      rig_.scanners.push_back(scanner);
    }
  }

  // A walk that has found the left scanner's clock off by this, so well.
  Calibration Found(double time_s, double sigma_s) const {
    return FoundFrom(rig_, time_s, sigma_s);
  }

  // The same from a map that began with this rig.
  Calibration FoundFrom(const Rig& start, double time_s, double sigma_s) const {
    RigCalibration estimate(start, false);
    estimate.scanners[1].block[kScannerDelayAt] = time_s - start.scanners[1].time_offset_s;
    Eigen::MatrixXd covariance =
        Eigen::MatrixXd::Zero(2 * kScannerBlockSize, 2 * kScannerBlockSize);
    for (int i = 0; i < 2; ++i) {
      for (int k = 0; k < kScannerBlockSize; ++k) {
        const double sigma =
            estimate.scanners[static_cast<size_t>(i)].prior_sigma[static_cast<size_t>(k)];
        covariance(kScannerBlockSize * i + k, kScannerBlockSize * i + k) = sigma * sigma;
      }
    }
    const int at = kScannerBlockSize + kScannerDelayAt;
    covariance(at, at) = sigma_s * sigma_s;
    return DescribeCalibration(rig_, start, estimate, covariance);
  }

  Rig rig_;
};

TEST_F(CalibrationJoiningTest, OneRecordingSaysWhatItSays) {
  const Calibration joined = JoinCalibrations({Found(0.001, 0.0001)}, {"a"});
  const CalibratedParameter& time = joined.scanners[1].parameters[CalibratedScanner::kTime];
  EXPECT_NEAR(time.value, 0.001, 1e-12);
  EXPECT_NEAR(time.sigma, 0.0001, 1e-12);
}

TEST_F(CalibrationJoiningTest, TheRigFileCountsOnce) {
  const Calibration joined =
      JoinCalibrations({Found(0.0010, 0.0001), Found(0.0012, 0.0002)}, {"a", "b"});
  // Information of the walks alone, and of the prior of 2 ms about 0.
  const double prior = 1.0 / (0.002 * 0.002);
  const double a = 1.0 / (0.0001 * 0.0001);
  const double b = 1.0 / (0.0002 * 0.0002);
  const double information = a + b - prior;
  const CalibratedParameter& time = joined.scanners[1].parameters[CalibratedScanner::kTime];
  EXPECT_NEAR(time.value, (a * 0.0010 + b * 0.0012) / information, 1e-12);
  EXPECT_NEAR(time.sigma, 1.0 / std::sqrt(information), 1e-12);
  EXPECT_NEAR(joined.scanners[1].parameters[0].sigma,
              joined.scanners[1].parameters[0].prior_sigma,
              1e-9)
      << "which no walk has shown";
}

TEST_F(CalibrationJoiningTest, MapsThatStartedElsewhereAreJoined) {
  Rig start = rig_;
  start.scanners[1].time_offset_s = 0.02;
  start.scanners[1].uncertainty.time_s = 0.02;
  const Calibration joined =
      JoinCalibrations({Found(0.0190, 0.0001), FoundFrom(start, 0.0202, 0.0001)}, {"a", "b"});
  const CalibratedParameter& time = joined.scanners[1].parameters[CalibratedScanner::kTime];
  // The first walk's prior of 2 ms about 0 is taken back and counts as one of 20 ms.
  const double walk = 1.0 / (0.0001 * 0.0001);
  const double narrow = 1.0 / (0.002 * 0.002);
  const double wide = 1.0 / (0.02 * 0.02);
  const double weighted = walk * 0.0190 + walk * 0.0202 - wide * 0.02;
  EXPECT_NEAR(time.value, weighted / (2.0 * walk - narrow), 1e-9);
  EXPECT_NEAR(time.sigma, 1.0 / std::sqrt(2.0 * walk - narrow), 1e-9);
  EXPECT_EQ(time.prior_sigma, 0.02);
  EXPECT_EQ(time.prior_value, 0.0);
}

TEST_F(CalibrationJoiningTest, RigGetsWhatWasFound) {
  const Rig calibrated = WithCalibration(rig_, Found(0.001, 0.0001));
  EXPECT_NEAR(calibrated.scanners[1].time_offset_s, 0.001, 1e-12);
  EXPECT_NEAR(calibrated.scanners[1].uncertainty.time_s, 0.0001, 1e-9);
  EXPECT_NEAR(calibrated.scanners[1].uncertainty.rotation_rad, 0.02, 1e-9);
  EXPECT_EQ(calibrated.scanners[0].uncertainty.rotation_rad, 0.0);
}

TEST_F(CalibrationJoiningTest, FileIsReadAsItWasWritten) {
  const Calibration found = Found(0.001, 0.0001);
  const std::string path = (directory_ / "calibration.json").string();
  std::ofstream(path) << FormatCalibration(found);
  const Calibration read = ReadCalibration(path);
  ASSERT_EQ(read.scanners.size(), 2u);
  EXPECT_EQ(read.scanners[1].parameters[CalibratedScanner::kTime].value, 0.001);
  EXPECT_EQ(read.covariance, found.covariance);
  EXPECT_EQ(CalibrationLine(read), CalibrationLine(found));
}

TEST_F(CalibrationJoiningTest, OtherRigFilesAreRefused) {
  const Calibration found = Found(0.001, 0.0001);
  rig_.scanners[1].uncertainty.time_s = 0.005;
  EXPECT_THROW(JoinCalibrations({found, Found(0.001, 0.0001)}, {"a", "b"}), Error);
  rig_.scanners[1].name = "right";
  EXPECT_THROW(WithCalibration(rig_, found), Error);
}

TEST_F(CalibrationJoiningTest, DamagedFileIsNamed) {
  const std::string path = (directory_ / "calibration.json").string();
  std::ofstream(path) << R"({"scanners": [{"name": "left"}], "covariance": []})";
  try {
    ReadCalibration(path);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).rfind(path, 0), 0u) << error.what();
  }
}

}  // namespace
}  // namespace plumbline

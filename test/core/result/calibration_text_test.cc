#include "core/result/calibration_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace plumbline {
namespace {

Calibration LeftScanner() {
  CalibratedScanner left;
  left.name = "left";
  left.parameters = {{"roll_deg", "roll", 0.3, 0.01, 1.0},
                     {"pitch_deg", "pitch", 0.4, 0.01, 1.0},
                     {"yaw_deg", "yaw", 0.0, 0.01, 1.0},
                     {"x_m", "position along x", 0.003, 0.001, 0.01},
                     {"y_m", "position along y", 0.0, 0.001, 0.01},
                     {"z_m", "height", 0.004, 0.0099, 0.01},
                     {"time_s", "clock", 0.0015, 0.00002, 0.002},
                     {"range_m", "range bias", -0.005, 0.009, 0.01}};
  Calibration calibration;
  calibration.scanners = {left};
  Eigen::VectorXd variances(8);
  for (Eigen::Index i = 0; i < 8; ++i) {
    variances[i] = std::pow(left.parameters[static_cast<size_t>(i)].sigma, 2);
  }
  calibration.covariance = variances.asDiagonal();
  return calibration;
}

// Scanners of which a walk shows to 0.1 mm how they lie to each other, and nothing of what
// they have in common, of which the rig file says 10 mm for each.
Calibration WithCommonHeight(int num_scanners) {
  Calibration calibration;
  const double common = 1e-4 / num_scanners;
  calibration.covariance = Eigen::MatrixXd::Constant(num_scanners, num_scanners, common) +
                           1e-8 * Eigen::MatrixXd::Identity(num_scanners, num_scanners);
  for (int i = 0; i < num_scanners; ++i) {
    CalibratedScanner scanner;
    scanner.name = std::to_string(i);
    scanner.parameters = {{"z_m", "height", 0.0, std::sqrt(common + 1e-8), 0.01}};
    calibration.scanners.push_back(scanner);
  }
  return calibration;
}

TEST(CalibrationText, NamesWhatIsNotShown) {
  EXPECT_THAT(UnobservedInWords(LeftScanner()),
              testing::ElementsAre("height, range bias of scanner left"));
}

// Each of three is known to 0.58 of what the rig file says, because it says three heights.
TEST(CalibrationText, NamesWhatScannersHaveInCommonAndNothingShows) {
  for (const int num_scanners : {2, 3}) {
    EXPECT_EQ(UnobservedInWords(WithCommonHeight(num_scanners)).size(),
              static_cast<size_t>(num_scanners));
  }
}

// A shift that the open height leaks into is still shown.
TEST(CalibrationText, SmallShareInWhatIsOpenIsNotNamed) {
  Calibration calibration = WithCommonHeight(1);
  calibration.scanners[0].parameters.push_back({"x_m", "position along x", 0.0, 1e-3, 0.01});
  calibration.covariance = Eigen::Vector2d(1e-4, 1e-6).asDiagonal();
  calibration.covariance(0, 1) = calibration.covariance(1, 0) = 0.99e-5;
  EXPECT_THAT(UnobservedInWords(calibration), testing::ElementsAre("height of scanner 0"));
  EXPECT_THAT(ObservedParameters(calibration),
              testing::ElementsAre(testing::ElementsAre(false, true)));
}

TEST(CalibrationText, OfNothingNothingIsNamed) {
  EXPECT_TRUE(UnobservedInWords(Calibration()).empty());
}

TEST(CalibrationText, LineHasTheSizesOfTheCorrections) {
  EXPECT_EQ(CalibrationLine(LeftScanner()),
            "Scanners off the rig file by left: 0.50 deg, 5.0 mm, 1.50 ms, ranges -5.0 mm; "
            "this recording does not show height, range bias of scanner left");
}

TEST(CalibrationText, WhatIsTheBodysIsKnown) {
  Calibration calibration = LeftScanner();
  calibration.scanners[0].parameters[5].prior_sigma = 0.0;
  const std::vector<int> free = {0, 1, 2, 3, 4, 6, 7};
  calibration.covariance = Eigen::MatrixXd(calibration.covariance(free, free));
  EXPECT_THAT(UnobservedInWords(calibration),
              testing::ElementsAre("range bias of scanner left"));
  const auto json = nlohmann::json::parse(FormatCalibration(calibration));
  EXPECT_EQ(json["scanners"][0]["parameters"].size(), 8u);
  EXPECT_EQ(json["scanners"][0]["parameters"][5]["prior_sigma"], 0.0);
}

TEST(CalibrationText, JsonHasValuesAndCovariance) {
  const auto json = nlohmann::json::parse(FormatCalibration(LeftScanner()));
  const auto& parameter = json["scanners"][0]["parameters"][6];
  EXPECT_EQ(parameter["name"], "time_s");
  EXPECT_EQ(parameter["value"], 0.0015);
  EXPECT_EQ(parameter["sigma"], 0.00002);
  EXPECT_EQ(parameter["prior_sigma"], 0.002);
  EXPECT_TRUE(parameter["observed"]);
  EXPECT_EQ(json["covariance"].size(), 8u);
  EXPECT_EQ(json["unobserved"].size(), 1u);
}

}  // namespace
}  // namespace plumbline

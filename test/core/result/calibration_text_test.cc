#include "core/result/calibration_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
  calibration.covariance = Eigen::MatrixXd::Identity(8, 8);
  return calibration;
}

TEST(CalibrationText, NamesWhatIsNotShown) {
  EXPECT_THAT(UnobservedInWords(LeftScanner()),
              testing::ElementsAre("height, range bias of scanner left"));
}

TEST(CalibrationText, LineHasTheSizesOfTheCorrections) {
  EXPECT_EQ(CalibrationLine(LeftScanner()),
            "Scanners off the rig file by left: 0.50 deg, 5.0 mm, 1.50 ms, ranges -5.0 mm; "
            "this recording does not show height, range bias of scanner left");
}

TEST(CalibrationText, WhatIsTheBodysIsKnown) {
  Calibration calibration = LeftScanner();
  calibration.scanners[0].parameters[5].prior_sigma = 0.0;
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

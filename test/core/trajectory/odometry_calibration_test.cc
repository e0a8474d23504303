#include "core/trajectory/odometry_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace plumbline {
namespace {

class OdometryCalibrationTest : public testing::Test {
 protected:
  // A motion of a knot interval as wheels state it, drawn at random.
  PlanarMotion Stated() {
    std::uniform_real_distribution<double> length(0.05, 0.2);
    std::uniform_real_distribution<double> turn(-0.2, 0.2);
    return {{length(random_), 0.0}, turn(random_)};
  }

  // Takes in motions of which the wheels' scale and noise, as a share, are known. How a motion
  // is made of its share is asked of the calibration itself, whose noise is 1 for that.
  void TakeIn(int count, double length_scale, double turn_scale, double share) {
    OdometryOptions options;
    options.length_noise = options.turn_noise = 1.0;
    const OdometryCalibration unit(options);
    std::normal_distribution<double> noise;
    for (int i = 0; i < count; ++i) {
      const PlanarMotion stated = Stated();
      const OdometryMeasurement amount = unit.Measure(stated);
      PlanarMotion estimated;
      for (int axis = 0; axis < 2; ++axis) {
        estimated.translation[axis] = length_scale * stated.translation[axis] +
                                      share * amount.translation_stddev * noise(random_);
      }
      estimated.turn = turn_scale * stated.turn + share * amount.turn_stddev * noise(random_);
      calibration_.Add(stated, estimated);
    }
  }

  std::mt19937_64 random_{5};
  OdometryCalibration calibration_{OdometryOptions()};
};

TEST_F(OdometryCalibrationTest, BeginsWithWhatTheOptionsSay) {
  EXPECT_EQ(calibration_.length_scale(), 1.0);
  EXPECT_EQ(calibration_.turn_scale(), 1.0);
  EXPECT_NEAR(calibration_.length_noise(), OdometryOptions().length_noise, 1e-12);
  EXPECT_NEAR(calibration_.turn_noise(), OdometryOptions().turn_noise, 1e-12);
  PlanarMotion stated;
  stated.translation.x() = 0.18;
  const OdometryMeasurement measurement = calibration_.Measure(stated);
  EXPECT_EQ(measurement.translation.x(), 0.18);
  EXPECT_NEAR(measurement.translation_stddev, 0.1 * 0.2, 1e-12);
}

TEST_F(OdometryCalibrationTest, FindsScalesAndNoise) {
  TakeIn(2000, 1.04, 0.93, 0.05);
  EXPECT_NEAR(calibration_.length_scale(), 1.04, 0.005);
  EXPECT_NEAR(calibration_.turn_scale(), 0.93, 0.01);
  // 30 motions of 0.1 count beforehand: sqrt((30 * 0.01 + 2000 * 0.0025) / 2030) = 0.051.
  EXPECT_NEAR(calibration_.length_noise(), 0.051, 0.004);
  EXPECT_NEAR(calibration_.turn_noise(), 0.051, 0.004);
}

TEST_F(OdometryCalibrationTest, ARigThatStandsTeachesNothing) {
  for (int i = 0; i < 1000; ++i) calibration_.Add({}, {});
  EXPECT_EQ(calibration_.num_motions(), 0);
  EXPECT_NEAR(calibration_.turn_noise(), OdometryOptions().turn_noise, 1e-12);
}

TEST_F(OdometryCalibrationTest, SlippingWheelsDoNotMakeTheScale) {
  TakeIn(500, 1.0, 1.0, 0.05);
  for (int i = 0; i < 25; ++i) {
    PlanarMotion stated = Stated();
    PlanarMotion estimated = stated;
    estimated.translation *= 0.1;  // the wheels turned, the rig stood
    calibration_.Add(stated, estimated);
  }
  EXPECT_GT(calibration_.length_scale(), 0.98);
}

// Where the scans have slipped, it is not the wheels that have the noise.
TEST_F(OdometryCalibrationTest, TheNoiseIsThatOfMostMotions) {
  for (int i = 0; i < 200; ++i) {
    TakeIn(8, 1.0, 1.0, 0.05);
    TakeIn(2, 1.0, 1.0, 1.0);
  }
  EXPECT_LT(calibration_.turn_noise(), 0.1);
  EXPECT_LT(calibration_.length_noise(), 0.1);
}

TEST_F(OdometryCalibrationTest, TheScalesStandardDeviationIsThatOfItsError) {
  // Errors of the scale over what is stated, of 200 wheels: RMS 1 to 5 %, three sigmas.
  double squares = 0.0;
  constexpr int kWheels = 200;
  for (int i = 0; i < kWheels; ++i) {
    calibration_ = OdometryCalibration(OdometryOptions());
    TakeIn(300, 1.02, 1.0, 0.1);
    const double error = calibration_.length_scale() - 1.02;
    squares += error * error / std::pow(calibration_.length_scale_stddev(), 2);
  }
  EXPECT_NEAR(std::sqrt(squares / kWheels), 1.0, 0.15);
}

}  // namespace
}  // namespace plumbline

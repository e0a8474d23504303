#include "core/segmentation/beam_model.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A wall 3 m ahead, seen by beams from straight ahead to 40 degrees, the last 1 cm too long.
class BeamModelTest : public testing::Test {
 protected:
  BeamModelTest() {
    scanner_.range_noise_m = 0.003;
    scanner_.range_noise_per_m2 = 0.002;
    scanner_.angle_noise_rad = 0.001;
    line_.angle_increment = 0.1;
    for (int beam = 0; beam < 8; ++beam) {
      line_.ranges.push_back(static_cast<float>(RangeOf(beam) + (beam == 7 ? 0.01 : 0.0)));
    }
  }
  static double RangeOf(int beam) { return 3.0 / std::cos(0.1 * beam); }
  // Noise of the range, and what a turn of the beam does to it.
  static double VarianceOf(int beam) {
    const double range = RangeOf(beam);
    return std::pow(0.003, 2) + std::pow(0.002 * range * range, 2) +
           std::pow(0.001 * range * std::tan(0.1 * beam), 2);
  }

  Scanner scanner_;
  ScanLine line_;
  const Eigen::Vector2d wall_{1.0 / 3.0, 0.0};
};

TEST_F(BeamModelTest, VarianceGrowsWithTheFourthPowerOfTheRange) {
  const BeamModel model(line_, scanner_, {}, 9.0);
  for (int beam = 0; beam < 8; ++beam) {
    BeamModel::Prediction prediction;
    ASSERT_TRUE(model.Predict(beam, wall_, &prediction));
    EXPECT_NEAR(prediction.range, RangeOf(beam), 1e-9);
    EXPECT_NEAR(prediction.variance, VarianceOf(beam), 1e-9 * VarianceOf(beam));
    // A line as a fraction has the same variance, times the fourth power of its slope.
    BeamModel::LineIntersection at;
    ASSERT_TRUE(model.Intersect(beam, {2.0 / 3.0, 0.0, 2.0}, &at));
    EXPECT_NEAR(
        at.variance / std::pow(at.slope, 4), VarianceOf(beam), 1e-9 * VarianceOf(beam));
  }
}

TEST_F(BeamModelTest, FourBeamsAtOnceHaveTheVariancesOfSingleOnes) {
  const BeamModel model(line_, scanner_, {}, 9.0);
  const Eigen::Array4d deviations = model.Deviations(4, wall_);
  EXPECT_NEAR(deviations[3], 1e-4 / VarianceOf(7), 1e-2 * 1e-4 / VarianceOf(7));
  int num_points = 0;
  const LineEquations sum = model.SumOnLine(0, 7, wall_, &num_points);
  EXPECT_EQ(num_points, 8);
  EXPECT_NEAR(sum.square, 1e-4 / VarianceOf(7), 1e-2 * 1e-4 / VarianceOf(7));
}

}  // namespace
}  // namespace plumbline

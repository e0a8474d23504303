#include "core/trajectory/motion_prior.h"

#include <gtest/gtest.h>

namespace plumbline {
namespace {

TEST(MotionPrior, IsNarrowWhereTheMotionBridges) {
  TrajectoryOptions options;
  MotionPrior prior(options);
  prior.Bridge(5, 7);
  for (const int usual : {4, 7}) {
    EXPECT_EQ(prior.At(usual).horizontal_m_s2, options.acceleration_stddev_m_s2);
  }
  for (const int bridged : {5, 6}) {
    EXPECT_EQ(prior.At(bridged).horizontal_m_s2, options.bridging_acceleration_stddev_m_s2);
    EXPECT_EQ(prior.At(bridged).vertical_m_s2, options.vertical_acceleration_stddev_m_s2);
    EXPECT_EQ(prior.At(bridged).angular_rad_s2, prior.At(4).angular_rad_s2);
  }
}

TEST(MotionPrior, IsNeverWiderThanUsual) {
  TrajectoryOptions options;
  options.acceleration_stddev_m_s2 = 0.2;
  MotionPrior prior(options);
  prior.Bridge(0, 1);
  EXPECT_EQ(prior.At(0).horizontal_m_s2, 0.2);
}

}  // namespace
}  // namespace plumbline

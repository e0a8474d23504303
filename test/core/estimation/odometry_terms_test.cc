#include "core/estimation/odometry_terms.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/estimation/estimation_problem.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/normal_equations.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

constexpr int64_t kStart = 1'000'000'000;
constexpr int64_t kKnot = 100'000'000;
constexpr int kNumIntervals = 60;

// A rig whose turns begin and end within a knot interval, and wheels that count what it does.
class OdometryTermsTest : public testing::Test {
 protected:
  OdometryTermsTest() : state_{Trajectory(kStart, kKnot, Rigid3d()), {}, {}, kStart} {
    state_.trajectory.ExtendTo(kStart + kNumIntervals * kKnot - 1);
    for (int i = 0; i < state_.trajectory.num_control_points(); ++i) {
      ControlPoint& point = state_.trajectory.control_point(i);
      Eigen::Map<Eigen::Quaterniond>(point.rotation.data()) =
          Exp(Eigen::Vector3d(0.0, 0.0, i / 5 % 2 == 0 ? 0.0 : 0.6));
      point.position = {0.05 * i, 0.01 * (i % 3), 0.0};
    }
    rig_.scanners.resize(1);
  }

  void Count(int64_t period_ns) {
    std::vector<OdometrySample> samples;
    for (int64_t time_ns = kStart; time_ns < state_.trajectory.end_ns(); time_ns += period_ns) {
      const Rigid3d pose = state_.trajectory.WorldFromBody(time_ns);
      samples.push_back({time_ns, pose.translation.head<2>(), Log(pose.rotation).z()});
    }
    state_.odometry = std::make_shared<const Odometry>(samples);
  }

  EstimationProblem Problem() {
    return {rig_, true, &state_.trajectory, &state_.landmarks, &state_.calibration};
  }

  size_t NumTerms(int first, int end) {
    EstimationProblem problem = Problem();
    AddOdometry(state_, first, end, &problem);
    return problem.factor_terms().size();
  }

  double Cost(int end) {
    EstimationProblem problem = Problem();
    AddOdometry(state_, 0, end, &problem);
    return LineariseDense(problem, problem.Layout()).cost;
  }

  Rig rig_;
  MapState state_;
};

// Slower than the knots, faster, and as fast but in between.
TEST_F(OdometryTermsTest, PerfectWheelsOfAnyRateCostNothing) {
  for (const int64_t period_ns : {230'000'000, 37'000'000, 101'000'000}) {
    Count(period_ns);
    EXPECT_LT(Cost(kNumIntervals - 6), 1e-9) << period_ns;  // the rest ends between samples
  }
}

TEST_F(OdometryTermsTest, StretchesAreAsLongAsAKnotIntervalOrAsTheSamplesAreApart) {
  Count(10'000'000);
  EXPECT_EQ(NumTerms(0, kNumIntervals), 59U);  // up to the last sample
  Count(300'000'000);
  EXPECT_EQ(NumTerms(0, kNumIntervals), 19U);  // up to the last sample
}

TEST_F(OdometryTermsTest, SamplesThatAreFarApartCountFromKnotToKnot) {
  Count(1'000'000'000);
  EXPECT_EQ(NumTerms(0, kNumIntervals), 50U);  // up to the last sample
}

// What a window gives up and what it keeps is all that the wheels say.
TEST_F(OdometryTermsTest, EachStretchBelongsToTheIntervalWhereItBegins) {
  for (const int64_t period_ns : {37'000'000, 230'000'000, 1'000'000'000}) {
    Count(period_ns);
    for (const int border : {10, 11, 12}) {
      EXPECT_EQ(NumTerms(0, border) + NumTerms(border, kNumIntervals),
                NumTerms(0, kNumIntervals));
    }
  }
}

TEST_F(OdometryTermsTest, FromKnotToKnotForAPrediction) {
  Count(37'000'000);
  EstimationProblem problem = Problem();
  AddOdometryByKnots(state_, 3, 8, &problem);
  EXPECT_EQ(problem.factor_terms().size(), 5U);
}

TEST_F(OdometryTermsTest, StretchesOfAMapCalibrateTheWheels) {
  Count(230'000'000);
  OdometryCalibration calibration{OdometryOptions()};
  Calibrate(state_, 0, kNumIntervals, &calibration);
  EXPECT_EQ(calibration.num_motions(), 26);
  EXPECT_NEAR(calibration.turn_scale(), 1.0, 1e-6);
}

}  // namespace
}  // namespace plumbline

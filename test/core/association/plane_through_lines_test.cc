#include "core/association/plane_through_lines.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

namespace plumbline {
namespace {

constexpr double kSigma = 0.005;  // m

class PlaneThroughLinesTest : public testing::Test {
 protected:
  // A line of 2 m on the plane through `on_plane`, measured with noise.
  MeasuredLine Line(const Eigen::Vector3d& centroid, const Eigen::Vector3d& direction) {
    MeasuredLine line;
    line.sigma_offset_m = kSigma;
    line.sigma_direction_rad = kSigma / 0.577;
    line.centroid_world = centroid + kSigma * noise_(random_) * normal_;
    line.direction_world =
        (direction + line.sigma_direction_rad * noise_(random_) * normal_).normalized();
    return line;
  }

  // Lines along the plane in turns of their direction, about a place far from the origin.
  PlaneThroughLines Fit(int num_lines, double turn) {
    PlaneThroughLines fit;
    for (int i = 0; i < num_lines; ++i) {
      const double angle = turn * i;
      fit.Add(Line(place_ + 0.1 * i * u_, std::cos(angle) * u_ + std::sin(angle) * v_));
    }
    return fit;
  }

  const Eigen::Vector3d normal_ = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  const Eigen::Vector3d u_ = normal_.unitOrthogonal();
  const Eigen::Vector3d v_ = normal_.cross(u_);
  const Eigen::Vector3d place_{40.0, -30.0, 3.0};
  std::mt19937_64 random_{3};
  std::normal_distribution<double> noise_;
};

// Over many draws the errors have the covariance that the fit states, and its chi-square its
// degrees of freedom.
TEST_F(PlaneThroughLinesTest, ErrorsAgreeWithTheStatedCovariance) {
  constexpr int kDraws = 2000;
  constexpr int kLines = 6;
  double squared_turn = 0.0;
  double squared_shift = 0.0;
  double chi2 = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const PlaneThroughLines::Fit fit = Fit(kLines, 0.4).Solve();
    const Eigen::Vector3d normal = fit.normal.dot(normal_) > 0.0 ? fit.normal : -fit.normal;
    const Eigen::Vector2d turn(u_.dot(normal), v_.dot(normal));
    Eigen::Matrix<double, 3, 2> tangents;
    tangents << u_, v_;
    const Eigen::Matrix2d covariance = tangents.transpose() * fit.normal_covariance * tangents;
    squared_turn += turn.dot(covariance.inverse() * turn);
    const double shift = normal_.dot(fit.centre_world - place_);
    squared_shift += shift * shift / fit.centre_variance;
    chi2 += fit.chi2;
  }
  // Means of 2000 chi-square variables, four standard deviations.
  EXPECT_NEAR(squared_turn / kDraws, 2.0, 4.0 * std::sqrt(2.0 * 2.0 / kDraws));
  EXPECT_NEAR(squared_shift / kDraws, 1.0, 4.0 * std::sqrt(2.0 / kDraws));
  const double degrees = 2.0 * kLines - 3.0;
  EXPECT_NEAR(chi2 / kDraws, degrees, 4.0 * std::sqrt(2.0 * degrees / kDraws));
}

TEST_F(PlaneThroughLinesTest, OneLineLeavesThePlaneOpenAboutItself) {
  const PlaneThroughLines::Fit fit = Fit(1, 0.0).Solve();
  EXPECT_LT(u_.dot(fit.normal_covariance * u_), 1e-3);
  EXPECT_GT(fit.normal_covariance.trace(), 1.0);
}

}  // namespace
}  // namespace plumbline

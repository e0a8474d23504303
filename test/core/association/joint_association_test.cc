#include "core/association/joint_association.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace plumbline {
namespace {

// Deviations that a heading error alone explains: offsets of segments at some lever arms.
class JointAssociationTest : public testing::Test {
 protected:
  JointAssociationTest() {
    covariance_.setZero();
    covariance_.diagonal().setConstant(1e-8);
    // Heading at the scan's beginning and end: 2 degrees, the same at both.
    const double variance = std::pow(2.0 * M_PI / 180.0, 2);
    covariance_(2, 2) = covariance_(8, 8) = variance + 1e-8;
    covariance_(2, 8) = covariance_(8, 2) = variance;
  }

  // Observation `index` deviates by the given offset and slope from landmark `id`; a heading
  // error of 1 rad would make that lever_m and 1 rad.
  void Add(int index, int id, double lever_m, double offset_m, double slope_rad) {
    JointHypothesis hypothesis;
    hypothesis.observation_index = index;
    hypothesis.landmark_id = id;
    hypothesis.value = {offset_m, slope_rad};
    hypothesis.noise = Eigen::Vector2d(1e-4, 1e-4).asDiagonal();  // 1 cm, 0.6 degrees
    Eigen::Matrix<double, 2, 6> by_pose = Eigen::Matrix<double, 2, 6>::Zero();
    by_pose(0, 2) = lever_m;
    by_pose(1, 2) = 1.0;
    hypothesis.by_motion = by_pose * PoseByMotion(0.5);
    hypotheses_.push_back(hypothesis);
  }

  std::vector<int> Landmarks() {
    std::vector<int> ids;
    for (const size_t i : ChooseJointly(hypotheses_, covariance_, options_).hypotheses) {
      ids.push_back(hypotheses_[i].landmark_id);
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  MotionCovariance covariance_;
  AssociationOptions options_;
  std::vector<JointHypothesis> hypotheses_;
};

TEST(PoseCovarianceTest, IsThatOfTheMotionBetween) {
  const MotionCovariance root = MotionCovariance::Random();
  const MotionCovariance covariance = root * root.transpose();
  for (const double share : {0.0, 0.3, 1.0}) {
    const Eigen::Matrix<double, 6, 12> by_motion = PoseByMotion(share);
    EXPECT_LT(
        (PoseCovariance(covariance, share) - by_motion * covariance * by_motion.transpose())
            .norm(),
        1e-12 * covariance.norm());
  }
}

TEST_F(JointAssociationTest, TakesWhatAgreesWithOneError) {
  // True: everything turned by 2 degrees. Landmarks 11 and 12 would each do alone, at no
  // error.
  const double turn = -2.0 * M_PI / 180.0;
  Add(0, 1, 4.0, -4.0 * turn, -turn);
  Add(1, 2, 3.0, -3.0 * turn, -turn);
  Add(1, 12, 3.0, 0.0, 0.0);
  Add(2, 3, -5.0, 5.0 * turn, -turn);
  Add(3, 4, 2.0, -2.0 * turn, -turn);
  Add(3, 11, 2.0, 0.0, 0.0);
  EXPECT_EQ(Landmarks(), (std::vector<int>{1, 2, 3, 4}));
}

TEST_F(JointAssociationTest, LeavesClutterOut) {
  Add(0, 1, 4.0, 0.0, 0.0);
  Add(1, 2, -4.0, 0.0, 0.0);
  Add(2, 3, 4.0, 0.2, 0.05);  // within its own gate, not with the others' error
  EXPECT_EQ(Landmarks(), (std::vector<int>{1, 2}));
}

TEST_F(JointAssociationTest, AWrongFirstObservationDoesNotDecide) {
  Add(0, 9, 4.0, 0.14, 0.035);  // explains itself by 2 degrees that nobody else has
  for (int i = 1; i < 5; ++i) Add(i, i, i % 2 == 0 ? 4.0 : -4.0, 0.0, 0.0);
  EXPECT_EQ(Landmarks(), (std::vector<int>{1, 2, 3, 4}));
}

TEST_F(JointAssociationTest, NothingFromNothing) {
  const JointChoice choice = ChooseJointly({}, covariance_, options_);
  EXPECT_TRUE(choice.hypotheses.empty());
  EXPECT_EQ(choice.cost, 0.0);
}

}  // namespace
}  // namespace plumbline

#include "core/registration/pose_graph.h"

#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

// A square of four steps of 10 m, each believed to turn by 2 degrees too little.
class PoseGraphTest : public testing::Test {
 protected:
  PoseGraphTest() {
    poses_.push_back({0.3, {5.0, -2.0}});
    for (size_t i = 0; i < 4; ++i) {
      PoseGraphEdge edge;
      edge.from = i;
      edge.to = i + 1;
      edge.from_from_to = {M_PI / 2.0 - kError, {10.0, 0.0}};
      edge.information.diagonal() << 1e2, 1e2, 1e3;
      edges_.push_back(edge);
      poses_.push_back(poses_.back() * edge.from_from_to);
    }
  }

  static PoseGraphEdge Closure(size_t from, size_t to, const PlanarPose& pose) {
    PoseGraphEdge edge{from, to, pose, Eigen::Matrix3d::Identity(), true};
    edge.information.diagonal() << 1e4, 1e4, 1e6;
    return edge;
  }

  static constexpr double kError = 2.0 * M_PI / 180.0;
  std::vector<PlanarPose> poses_;
  std::vector<PoseGraphEdge> edges_;
};

TEST_F(PoseGraphTest, WithoutClosuresNothingMoves) {
  const std::vector<PlanarPose> before = poses_;
  SolvePoseGraph(edges_, &poses_);
  for (size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_LT((poses_[i].position - before[i].position).norm(), 1e-9);
  }
}

TEST_F(PoseGraphTest, AClosureIsSpreadEvenly) {
  // Back at the start, after a whole turn.
  edges_.push_back(Closure(0, 4, {2.0 * M_PI, {0.0, 0.0}}));
  EXPECT_GT(SquaredDeviation(edges_.back(), poses_), 1000.0);
  SolvePoseGraph(edges_, &poses_);
  EXPECT_LT(SquaredDeviation(edges_.back(), poses_), 1.0);
  EXPECT_LT((poses_[4].position - poses_[0].position).norm(), 0.02);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(poses_[i + 1].heading - poses_[i].heading, M_PI / 2.0, 0.25 * kError) << i;
  }
  // The first one stays.
  EXPECT_EQ(poses_[0].heading, 0.3);
  EXPECT_EQ(poses_[0].position, Eigen::Vector2d(5.0, -2.0));
}

TEST_F(PoseGraphTest, AWrongClosureGivesWay) {
  edges_.push_back(Closure(0, 4, {2.0 * M_PI, {0.0, 0.0}}));
  edges_.push_back(Closure(0, 4, {2.0 * M_PI, {0.01, 0.0}}));
  const PoseGraphEdge wrong = Closure(1, 3, {M_PI, {3.0, 6.0}});
  edges_.push_back(wrong);
  SolvePoseGraph(edges_, &poses_);
  EXPECT_GT(SquaredDeviation(wrong, poses_), 100.0);
  EXPECT_LT((poses_[4].position - poses_[0].position).norm(), 0.1);
}

TEST_F(PoseGraphTest, WholeTurnsDoNotDeviate) {
  PoseGraphEdge edge = edges_[0];
  edge.from_from_to.heading -= 2.0 * M_PI;
  EXPECT_LT(SquaredDeviation(edge, poses_), 1e-9);
}

}  // namespace
}  // namespace plumbline

#include "core/estimation/normal_equations.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

NormalEquations System() {
  return ZeroSystem({{RotationBlock(3), 3},
                     {PositionBlock(3), 3},
                     {LandmarkBlock(0), 1},
                     {LandmarkBlock(5), 2}});
}

// A part of blocks of these sizes, with any numbers.
NormalEquations Part(const std::vector<int>& sizes) {
  NormalEquations part;
  part.offsets = {0};
  for (const int size : sizes) {
    part.blocks.push_back(LandmarkBlock(static_cast<int>(part.blocks.size())));
    part.offsets.push_back(part.offsets.back() + size);
  }
  const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(
      part.size(), part.size(), [](Eigen::Index row, Eigen::Index column) {
        return std::sin(0.7 * static_cast<double>((row + 1) * (column * column + 2)));
      });
  part.hessian = root.transpose() * root;
  part.gradient = root.col(0);
  return part;
}

TEST(NormalEquationsTest, EmptySystemHasTheBlocksInOrder) {
  const NormalEquations system = System();
  EXPECT_THAT(system.offsets, ElementsAre(0, 3, 6, 7, 9));
  EXPECT_EQ(system.size(), 9);
  EXPECT_EQ(system.hessian, Eigen::MatrixXd::Zero(9, 9));
  EXPECT_EQ(system.gradient, Eigen::VectorXd::Zero(9));
  EXPECT_EQ(BlockSize(system, 3), 2);
  const NormalEquations nothing = ZeroSystem({});
  EXPECT_EQ(nothing.size(), 0);
  EXPECT_EQ(FindBlock(nothing, ImuBlockId()), 0u);
}

TEST(NormalEquationsTest, BlocksAreFoundOrNot) {
  const NormalEquations system = System();
  EXPECT_EQ(FindBlock(system, RotationBlock(3)), 0u);
  EXPECT_EQ(FindBlock(system, LandmarkBlock(5)), 3u);
  for (const BlockId& missing :
       {RotationBlock(2), PositionBlock(4), LandmarkBlock(3), ScannerBlockId(0)}) {
    EXPECT_EQ(FindBlock(system, missing), 4u);
  }
}

TEST(NormalEquationsTest, RowsAreThoseOfTheBlocksChosen) {
  const NormalEquations system = System();
  EXPECT_THAT(RowsOf(system, {3, 1}), ElementsAre(7, 8, 3, 4, 5));
  EXPECT_THAT(RowsOf(system, IsLandmark), ElementsAre(6, 7, 8));
  EXPECT_THAT(RowsOf(system, IsScanner), IsEmpty());
}

// With the selection T of the part's unknowns among the system's: H += T^T h T, g += T^T g.
TEST(NormalEquationsTest, PartsAreAddedWhereTheirBlocksAre) {
  NormalEquations system = System();
  const NormalEquations first = Part({2, 3});
  const NormalEquations second = Part({3, 1});
  AddTo(first, {LandmarkBlock(5), RotationBlock(3)}, &system);
  AddTo(second, {RotationBlock(3), LandmarkBlock(0)}, &system);
  Eigen::MatrixXd select_first = Eigen::MatrixXd::Zero(5, 9);
  select_first.block<2, 2>(0, 7).setIdentity();
  select_first.block<3, 3>(2, 0).setIdentity();
  Eigen::MatrixXd select_second = Eigen::MatrixXd::Zero(4, 9);
  select_second.block<3, 3>(0, 0).setIdentity();
  select_second(3, 6) = 1.0;
  const Eigen::MatrixXd expected = select_first.transpose() * first.hessian * select_first +
                                   select_second.transpose() * second.hessian * select_second;
  EXPECT_LT((system.hessian - expected).norm(), 1e-12);
  EXPECT_LT((system.gradient - select_first.transpose() * first.gradient -
             select_second.transpose() * second.gradient)
                .norm(),
            1e-12);
}

// Two planes that become one: x appears in both, and the cost is that of (x, x).
TEST(NormalEquationsTest, BlocksOfOneNameAreAddedUp) {
  NormalEquations system = ZeroSystem({{LandmarkBlock(4), 2}});
  const NormalEquations part = Part({2, 2});
  AddTo(part, {LandmarkBlock(4), LandmarkBlock(4)}, &system);
  const Eigen::Vector2d x(0.3, -1.7);
  Eigen::Vector4d twice;
  twice << x, x;
  EXPECT_NEAR(x.dot(system.hessian * x), twice.dot(part.hessian * twice), 1e-12);
  EXPECT_NEAR(x.dot(system.gradient), twice.dot(part.gradient), 1e-12);
}

TEST(NormalEquationsDeathTest, PartOfAnUnknownBlockIsABug) {
  NormalEquations system = System();
  EXPECT_DEATH(AddTo(Part({2}), {LandmarkBlock(9)}, &system), "Check failed");
}

}  // namespace
}  // namespace plumbline

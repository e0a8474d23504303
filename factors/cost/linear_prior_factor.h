#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace ceres {
class CostFunction;
}

namespace plumbline {

// A prior on a set of parameter blocks from measurements that were marginalised: a linear form
// in the tangent at the point x0 where they were linearised (first-estimate Jacobians: x0
// never moves).
struct LinearPrior {
  enum class Kind {
    kEuclidean,      // size n, tangent n
    kRotation,       // quaternion (x, y, z, w), left tangent of 3
    kYawRotation,    // the same, turned about the world's z axis only: tangent of 1
    kVerticalPlane,  // (a, d), tangent of 2: that of (a, e) about its anchor
  };
  struct Block {
    Kind kind = Kind::kEuclidean;
    int size = 0;        // of the parameter block
    Eigen::VectorXd x0;  // size numbers; of kVerticalPlane (a, e), see anchored_plane.h
    Eigen::Vector2d anchor = Eigen::Vector2d::Zero();  // of kVerticalPlane: x, y of the world

    int tangent_size() const {
      switch (kind) {
        case Kind::kEuclidean:
        case Kind::kVerticalPlane:
          return size;
        case Kind::kYawRotation:
          return 1;
        case Kind::kRotation:
          break;
      }
      return 3;
    }
  };
  std::vector<Block> blocks;
  Eigen::MatrixXd root;    // S, rows x sum of the tangent sizes, in the order of blocks
  Eigen::VectorXd offset;  // r0, rows
};

// r = r0 + S (x [-] x0)        as many residuals as S has rows (see Marginalise())
// Blocks: [ the prior's blocks, in order ]
std::unique_ptr<ceres::CostFunction> CreateLinearPriorFactor(LinearPrior prior);

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

namespace ceres {
class CostFunction;
}

namespace plumbline {

// What is known of a set of parameter blocks from measurements that were marginalised: a
// linear form in the tangent at the point x0 where they were linearised (first-estimate
// Jacobians: x0 never moves).
struct LinearPrior {
  enum class Kind {
    kEuclidean,     // size n, tangent n
    kRotation,      // quaternion (x, y, z, w), left tangent of 3
    kYawRotation,   // the same, turned about the world's z axis only: tangent of 1
    kGeneralPlane,  // (nx, ny, nz, d), tangent of 3 of CreateGeneralPlaneManifold()
  };
  struct Block {
    Kind kind = Kind::kEuclidean;
    int size = 0;        // of the parameter block: 4 for all but kEuclidean
    Eigen::VectorXd x0;  // size numbers

    int tangent_size() const {
      return kind == Kind::kEuclidean ? size : (kind == Kind::kYawRotation ? 1 : 3);
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

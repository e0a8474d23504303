#pragma once

#include <Eigen/Core>

namespace plumbline {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

}  // namespace plumbline

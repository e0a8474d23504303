#include "core/estimation/motion_terms.h"

#include <ceres/cost_function.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/map/map_state.h"
#include "core/trajectory/motion_noise.h"
#include "factors/cost/motion_factor.h"
#include "factors/cost/position_factor.h"
#include "factors/manifold/manifolds.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

constexpr double kOriginSigma = 1e-5;  // m

}  // namespace

void MotionTerm::AddTo(double* total_cost,
                       Eigen::VectorXd* gradient,
                       Eigen::MatrixXd* hessian) const {
  using RowMajor = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor, 3, 4>;
  constexpr size_t kMaxBlocks = 4;
  std::array<const double*, kMaxBlocks> parameters{};
  std::array<std::array<double, 12>, kMaxBlocks> storage{};
  std::array<double*, kMaxBlocks> jacobians{};
  for (size_t b = 0; b < blocks.size(); ++b) {
    parameters[b] = blocks[b].data;
    jacobians[b] = storage[b].data();
  }
  Eigen::Vector3d residuals;
  cost->Evaluate(parameters.data(), residuals.data(), jacobians.data());
  std::array<Eigen::Matrix3d, kMaxBlocks> tangent;
  for (size_t b = 0; b < blocks.size(); ++b) {
    const bool is_rotation = blocks[b].is_rotation;
    const Eigen::Map<const RowMajor> ambient(storage[b].data(), 3, is_rotation ? 4 : 3);
    if (is_rotation) {
      tangent[b] = ambient * RotationPlusJacobian(parameters[b]);
    } else {
      tangent[b] = ambient;
    }
  }
  *total_cost += 0.5 * residuals.squaredNorm();
  for (size_t a = 0; a < blocks.size(); ++a) {
    const int row = blocks[a].row;
    gradient->segment<3>(row) += tangent[a].transpose() * residuals;
    for (size_t b = 0; b < blocks.size(); ++b) {
      hessian->block<3, 3>(row, blocks[b].row) += tangent[a].transpose() * tangent[b];
    }
  }
}

std::vector<MotionTerm> MakeMotionTerms(const TrajectoryOptions& options,
                                        int first,
                                        int known,
                                        std::optional<int64_t> origin_time_ns,
                                        Trajectory* trajectory) {
  const double interval_s = trajectory->knot_interval_s();
  std::vector<MotionTerm> terms;
  const auto add = [&](std::unique_ptr<ceres::CostFunction> cost,
                       bool is_rotation,
                       int first_control_point,
                       int count) {
    MotionTerm term;
    term.cost = std::move(cost);
    for (int i = first_control_point; i < first_control_point + count; ++i) {
      ControlPoint& control_point = trajectory->control_point(i);
      term.blocks.push_back(
          {6 * (i - first) + (is_rotation ? 0 : 3),
           is_rotation,
           is_rotation ? control_point.rotation.data() : control_point.position.data()});
    }
    terms.push_back(std::move(term));
  };
  const MotionNoise noise = MotionNoise::Of(options);
  for (int i = std::max(first, known - 2); i + 2 < trajectory->num_control_points(); ++i) {
    add(CreateRotationAccelerationFactor(noise.angular_rad_s2, interval_s), true, i, 3);
    add(CreatePositionAccelerationFactor(noise.Acceleration(), interval_s), false, i, 3);
  }
  if (!origin_time_ns) return terms;
  add(CreateRotationVelocityFactor(options.initial_turn_rate_stddev_deg_s * M_PI / 180.0,
                                   interval_s),
      true,
      0,
      2);
  add(CreatePositionVelocityFactor(options.initial_speed_stddev_m_s, interval_s), false, 0, 2);
  const Trajectory::Location origin = trajectory->Locate(*origin_time_ns);
  add(CreatePositionFactor(Eigen::Vector3d::Zero(), origin.u, kOriginSigma),
      false,
      origin.first,
      kSplineOrder);
  return terms;
}

}  // namespace plumbline

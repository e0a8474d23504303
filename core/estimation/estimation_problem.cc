#include "core/estimation/estimation_problem.h"

#include <ceres/cost_function.h>
#include <ceres/iteration_callback.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <utility>

#include "core/estimation/block_layout.h"
#include "core/map/map_state.h"
#include "core/map/patch_extent.h"
#include "core/trajectory/motion_noise.h"
#include "core/util/error.h"
#include "factors/cost/motion_factor.h"
#include "factors/cost/point_factor.h"
#include "factors/cost/position_factor.h"
#include "factors/manifold/manifolds.h"
#include "factors/segment/segment_measurement.h"

namespace plumbline {
namespace {

constexpr int kOrder = 4;
// Whitening of the origin's gauge constraint: far below any measured precision, yet well
// conditioned beside the residuals.
constexpr double kOriginSigma = 1e-5;  // m

ceres::Problem::Options ProblemOptions() {
  ceres::Problem::Options options;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;
  return options;
}

}  // namespace

EstimationProblem::EstimationProblem(const Rig& rig,
                                     bool planar,
                                     Trajectory* trajectory,
                                     std::deque<Landmark>* landmarks)
    : rig_(rig),
      planar_(planar),
      trajectory_(trajectory),
      landmarks_(landmarks),
      rotation_manifold_(planar ? CreateYawManifold() : CreateRotationManifold()),
      planar_position_manifold_(
          std::make_unique<ceres::SubsetManifold>(3, std::vector<int>{2})),
      fixed_heading_manifold_(std::make_unique<ceres::SubsetManifold>(2, std::vector<int>{0})),
      problem_(ProblemOptions()) {
  extrinsic_rotations_.resize(rig.scanners.size());
  extrinsic_translations_.resize(rig.scanners.size());
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Rigid3d& body_from_scanner = rig.scanners[i].body_from_scanner;
    Eigen::Map<Eigen::Quaterniond>(extrinsic_rotations_[i].data()) =
        body_from_scanner.rotation;
    Eigen::Map<Eigen::Vector3d>(extrinsic_translations_[i].data()) =
        body_from_scanner.translation;
    problem_.AddParameterBlock(extrinsic_rotations_[i].data(), 4);
    problem_.AddParameterBlock(extrinsic_translations_[i].data(), 3);
    problem_.SetParameterBlockConstant(extrinsic_rotations_[i].data());
    problem_.SetParameterBlockConstant(extrinsic_translations_[i].data());
  }
}

double* EstimationProblem::Data(const BlockId& block) const {
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      return trajectory_->control_point(block.index).rotation.data();
    case BlockId::Kind::kPosition:
      return trajectory_->control_point(block.index).position.data();
    case BlockId::Kind::kLandmark:
      return (*landmarks_)[static_cast<size_t>(block.index)].parameters.data();
  }
  LOG(FATAL) << "unknown block";
  return nullptr;
}

int EstimationProblem::AmbientSize(const BlockId& block) const {
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      return 4;
    case BlockId::Kind::kPosition:
      return 3;
    case BlockId::Kind::kLandmark:
      return (*landmarks_)[static_cast<size_t>(block.index)].num_parameters();
  }
  LOG(FATAL) << "unknown block";
  return 0;
}

LinearPrior::Kind EstimationProblem::KindOf(const BlockId& block) const {
  if (block.kind == BlockId::Kind::kPosition) return LinearPrior::Kind::kEuclidean;
  if (block.kind == BlockId::Kind::kLandmark) {
    const Landmark& landmark = (*landmarks_)[static_cast<size_t>(block.index)];
    return landmark.model == PlaneModel::kVertical ? LinearPrior::Kind::kVerticalPlane
                                                   : LinearPrior::Kind::kEuclidean;
  }
  return planar_ ? LinearPrior::Kind::kYawRotation : LinearPrior::Kind::kRotation;
}

int EstimationProblem::TangentSize(const BlockId& block) const {
  if (block.kind == BlockId::Kind::kRotation) return planar_ ? 1 : 3;
  return AmbientSize(block);
}

const ceres::Manifold* EstimationProblem::ManifoldOf(const BlockId& block) const {
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      return rotation_manifold_.get();
    case BlockId::Kind::kPosition:
      return planar_ ? planar_position_manifold_.get() : nullptr;
    case BlockId::Kind::kLandmark:
      return problem_.GetManifold(Data(block));
  }
  LOG(FATAL) << "unknown block";
  return nullptr;
}

void EstimationProblem::Register(const BlockId& block) {
  double* data = Data(block);
  if (!blocks_.emplace(block, data).second) return;
  problem_.AddParameterBlock(data, AmbientSize(block));
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      problem_.SetManifold(data, rotation_manifold_.get());
      break;
    case BlockId::Kind::kPosition:
      if (planar_) problem_.SetManifold(data, planar_position_manifold_.get());
      break;
    case BlockId::Kind::kLandmark:
      SetLandmarkManifold((*landmarks_)[static_cast<size_t>(block.index)]);
      break;
  }
}

void EstimationProblem::SetLandmarkManifold(const Landmark& landmark) {
  if (landmark.model != PlaneModel::kVertical) return;
  double* data = Data(LandmarkBlock(landmark.id));
  if (landmark.heading_fixed) {
    problem_.SetManifold(data, fixed_heading_manifold_.get());
    return;
  }
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector3d centre =
      extent.empty() ? extent.anchor()
                     : extent.ToWorld(0.5 * (extent.min_corner() + extent.max_corner()));
  plane_manifolds_.push_back(CreateVerticalPlaneManifold(centre.head<2>()));
  problem_.SetManifold(data, plane_manifolds_.back().get());
}

std::vector<double*> EstimationProblem::ControlPointBlocks(int first, int count) {
  std::vector<double*> blocks;
  for (int i = first; i < first + count; ++i) {
    Register(RotationBlock(i));
    blocks.push_back(Data(RotationBlock(i)));
  }
  for (int i = first; i < first + count; ++i) {
    Register(PositionBlock(i));
    blocks.push_back(Data(PositionBlock(i)));
  }
  return blocks;
}

ceres::ResidualBlockId EstimationProblem::AddFactor(
    std::unique_ptr<ceres::CostFunction> factor, const std::vector<double*>& blocks) {
  factors_.push_back(problem_.AddResidualBlock(factor.release(), nullptr, blocks));
  return factors_.back();
}

void EstimationProblem::AddPoints(const Observation& observation) {
  const Landmark& landmark = (*landmarks_)[static_cast<size_t>(observation.landmark_id)];
  const auto scanner = static_cast<size_t>(observation.scanner_index);
  const SegmentWeights weights = ObservationWeights(
      ObservationPoses(*trajectory_, rig_.scanners[scanner].body_from_scanner, observation),
      *landmarks_,
      observation);
  Register(LandmarkBlock(landmark.id));
  for (const ObservedPoint& point : observation.points) {
    const Trajectory::Location at = trajectory_->Locate(point.time_ns);
    const PointMeasurement measurement{
        point.position, at.u, weights.scale * point.whitening, weights.offset * point.offset};
    std::vector<double*> blocks = ControlPointBlocks(at.first, kOrder);
    blocks.push_back(extrinsic_rotations_[scanner].data());
    blocks.push_back(extrinsic_translations_[scanner].data());
    blocks.push_back(Data(LandmarkBlock(landmark.id)));
    AddFactor(CreatePointFactor(measurement, landmark.model, landmark.sign), blocks);
  }
}

void EstimationProblem::AddSegments(const std::vector<const Observation*>& observations,
                                    double huber_width) {
  ObservationGroupCache cache(LinearisedGroup::kFine, 1);
  AddSegments(observations, huber_width, &cache);
}

void EstimationProblem::AddSegments(const std::vector<const Observation*>& observations,
                                    double huber_width,
                                    ObservationGroupCache* cache) {
  for (const ObservationGroupCache::Entry* entry :
       cache->Update(rig_, *trajectory_, *landmarks_, observations, huber_width)) {
    std::vector<double*> blocks = ControlPointBlocks(
        entry->first_control_point, entry->group->group().num_control_points());
    for (const int id : entry->landmark_ids) {
      Register(LandmarkBlock(id));
      blocks.push_back(Data(LandmarkBlock(id)));
    }
    groups_.push_back({entry->group, blocks});
    problem_.AddResidualBlock(
        CreateSegmentGroupFactor(entry->group).release(), nullptr, blocks);
  }
}

void EstimationProblem::AddMotionPrior(int first, const MotionNoise& noise) {
  const double interval_s = trajectory_->knot_interval_s();
  const std::vector<double*> blocks = ControlPointBlocks(first, 3);
  rotation_priors_.push_back(
      AddFactor(CreateRotationAccelerationFactor(noise.angular_rad_s2, interval_s),
                {blocks[0], blocks[1], blocks[2]}));
  position_priors_.push_back(
      AddFactor(CreatePositionAccelerationFactor(noise.Acceleration(), interval_s),
                {blocks[3], blocks[4], blocks[5]}));
}

void EstimationProblem::AddStartVelocityPrior(const TrajectoryOptions& options) {
  const double interval_s = trajectory_->knot_interval_s();
  const std::vector<double*> blocks = ControlPointBlocks(0, 2);
  AddFactor(CreateRotationVelocityFactor(options.initial_turn_rate_stddev_deg_s * M_PI / 180.0,
                                         interval_s),
            {blocks[0], blocks[1]});
  AddFactor(CreatePositionVelocityFactor(options.initial_speed_stddev_m_s, interval_s),
            {blocks[2], blocks[3]});
}

void EstimationProblem::AddOrigin(int64_t time_ns) {
  const Trajectory::Location at = trajectory_->Locate(time_ns);
  const std::vector<double*> blocks = ControlPointBlocks(at.first, kOrder);
  AddFactor(CreatePositionFactor(Eigen::Vector3d::Zero(), at.u, kOriginSigma),
            {blocks[4], blocks[5], blocks[6], blocks[7]});
}

void EstimationProblem::AddTrajectoryTerms(const TrajectoryOptions& options,
                                           const MotionNoise& noise,
                                           int64_t origin_time_ns) {
  AddStartVelocityPrior(options);
  AddOrigin(origin_time_ns);
  for (int i = 0; i + 2 < trajectory_->num_control_points(); ++i) AddMotionPrior(i, noise);
}

void EstimationProblem::AddPrior(const Prior& prior) {
  if (prior.empty()) return;
  std::vector<double*> blocks;
  for (const BlockId& block : prior.blocks) {
    Register(block);
    blocks.push_back(Data(block));
  }
  AddFactor(CreateLinearPriorFactor(prior.linear), blocks);
}

std::vector<BlockId> EstimationProblem::Blocks() const {
  std::vector<BlockId> blocks;
  for (const auto& [block, data] : blocks_) blocks.push_back(block);
  return blocks;
}

namespace {

// Ends a solution after a step that no group has been linearised anew for.
class LinearStepEnds : public ceres::IterationCallback {
 public:
  // count: of the groups' linearisations so far.
  explicit LinearStepEnds(std::function<int()> count) : count_(std::move(count)) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    const int num_linearisations = count_();
    const bool was_linear =
        iteration.iteration > 0 && num_linearisations == num_linearisations_;
    num_linearisations_ = num_linearisations;
    return was_linear ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  std::function<int()> count_;
  int num_linearisations_ = 0;
};

}  // namespace

int EstimationProblem::NumLinearisations() const {
  int count = 0;
  for (const GroupTerm& term : groups_) count += term.group->num_linearisations();
  return count;
}

ceres::Solver::Summary EstimationProblem::Solve(const ceres::Solver::Options& given) {
  ceres::Solver::Options options = given;
  LinearStepEnds linear_step_ends([this] { return NumLinearisations(); });
  if (!groups_.empty()) options.callbacks.push_back(&linear_step_ends);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem_, &summary);
  if (!summary.IsSolutionUsable()) {
    throw Error("the estimation failed: " + summary.message);
  }
  return summary;
}

BlockLayout EstimationProblem::Layout() const {
  BlockLayout layout;
  layout.blocks = Blocks();
  layout.offsets.assign(1, 0);
  for (const BlockId& block : layout.blocks) {
    const int size = TangentSize(block);
    const int free_size = problem_.ParameterBlockTangentSize(Data(block));
    // A landmark that is held in part is held in its heading, a position in its height.
    const bool heading_held = block.kind == BlockId::Kind::kLandmark && free_size < size;
    for (int i = 0; i < size; ++i) {
      layout.is_free.push_back(heading_held ? i > 0 : i < free_size);
    }
    layout.offsets.push_back(layout.offsets.back() + size);
  }
  return layout;
}

EstimationProblem::BlockPositions EstimationProblem::PositionsIn(
    const BlockLayout& layout) const {
  BlockPositions positions;
  for (size_t i = 0; i < layout.blocks.size(); ++i) positions[Data(layout.blocks[i])] = i;
  return positions;
}

void EstimationProblem::ForEachResidualBlock(const BlockLayout& layout,
                                             const ResidualVisitor& visit) const {
  std::vector<ceres::ResidualBlockId> residual_blocks;
  problem_.GetResidualBlocks(&residual_blocks);
  VisitResidualBlocks(residual_blocks, layout, visit);
}

void EstimationProblem::ForEachMotionPrior(bool of_rotations,
                                           const BlockLayout& layout,
                                           const ResidualVisitor& visit) const {
  VisitResidualBlocks(of_rotations ? rotation_priors_ : position_priors_, layout, visit);
}

void EstimationProblem::VisitResidualBlocks(
    const std::vector<ceres::ResidualBlockId>& residual_blocks,
    const BlockLayout& layout,
    const ResidualVisitor& visit) const {
  using RowMajorMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const BlockPositions positions = PositionsIn(layout);
  std::vector<double*> parameters;
  std::vector<std::pair<size_t, size_t>> order;  // position in the layout, in the parameters
  std::vector<double> values;
  std::vector<double*> jacobians;  // by the parameters themselves, not by their tangents
  std::array<double, 16> tangents;
  std::vector<int> columns;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residuals;
  // Ceres' own evaluation of a residual block takes several times what the factors do.
  for (const ceres::ResidualBlockId residual_block : residual_blocks) {
    const ceres::CostFunction& factor =
        *problem_.GetCostFunctionForResidualBlock(residual_block);
    const int num_residuals = factor.num_residuals();
    const std::vector<int>& sizes = factor.parameter_block_sizes();
    problem_.GetParameterBlocksForResidualBlock(residual_block, &parameters);
    order.clear();
    columns.clear();
    for (size_t i = 0; i < parameters.size(); ++i) {
      const auto at = positions.find(parameters[i]);
      if (at != positions.end()) order.emplace_back(at->second, i);  // else: constant
    }
    std::sort(order.begin(), order.end());
    for (const auto& [at, i] : order) {
      for (int column = layout.offsets[at]; column < layout.offsets[at + 1]; ++column) {
        if (layout.is_free[static_cast<size_t>(column)]) columns.push_back(column);
      }
    }
    residuals.resize(num_residuals);
    values.resize(
        static_cast<size_t>(num_residuals * std::accumulate(sizes.begin(), sizes.end(), 0)));
    jacobians.assign(parameters.size(), nullptr);
    double* next = values.data();
    for (const auto& [at, i] : order) {
      jacobians[i] = next;
      next += num_residuals * sizes[i];
    }
    CHECK(factor.Evaluate(parameters.data(), residuals.data(), jacobians.data()));
    jacobian.resize(num_residuals, static_cast<Eigen::Index>(columns.size()));
    Eigen::Index column = 0;
    for (const auto& [at, i] : order) {
      const Eigen::Map<const RowMajorMatrix> by_block(jacobians[i], num_residuals, sizes[i]);
      const ceres::Manifold* manifold = ManifoldOf(layout.blocks[at]);
      const int size = manifold == nullptr ? sizes[i] : manifold->TangentSize();
      if (manifold == nullptr) {
        jacobian.middleCols(column, size) = by_block;
      } else {
        manifold->PlusJacobian(parameters[i], tangents.data());
        jacobian.middleCols(column, size) = by_block.lazyProduct(
            Eigen::Map<const RowMajorMatrix>(tangents.data(), sizes[i], size));
      }
      column += size;
    }
    visit(columns, jacobian, residuals);
  }
}

}  // namespace plumbline

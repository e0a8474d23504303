#include "core/estimation/estimation_problem.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "factors/cost/motion_factor.h"
#include "factors/cost/point_factor.h"
#include "factors/cost/pose_factor.h"
#include "factors/cost/position_factor.h"
#include "factors/cost/segment_factor.h"
#include "factors/manifold/manifolds.h"
#include "factors/segment/segment_measurement.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

// Whitening of the origin's gauge constraint: far below any measured precision, yet well
// conditioned beside the residuals.
constexpr double kOriginSigma = 1e-5;  // m

}  // namespace

EstimationProblem::EstimationProblem(const Rig& rig,
                                     bool planar,
                                     Trajectory* trajectory,
                                     std::deque<Landmark>* landmarks,
                                     RigCalibration* calibration)
    : rig_(rig),
      planar_(planar),
      trajectory_(trajectory),
      landmarks_(landmarks),
      calibration_(calibration),
      rotation_manifold_(planar ? CreateYawManifold() : CreateRotationManifold()),
      planar_position_manifold_(
          std::make_unique<ceres::SubsetManifold>(3, std::vector<int>{2})),
      fixed_heading_manifold_(
          std::make_unique<ceres::SubsetManifold>(2, std::vector<int>{0})) {
  extrinsic_rotations_.resize(rig.scanners.size());
  extrinsic_translations_.resize(rig.scanners.size());
  for (size_t i = 0; i < rig.scanners.size(); ++i) {
    const Rigid3d& body_from_scanner = rig.scanners[i].body_from_scanner;
    Eigen::Map<Eigen::Quaterniond>(extrinsic_rotations_[i].data()) =
        body_from_scanner.rotation;
    Eigen::Map<Eigen::Vector3d>(extrinsic_translations_[i].data()) =
        body_from_scanner.translation;
  }
}

EstimationProblem::EstimationProblem(EstimationProblem&&) = default;
EstimationProblem::~EstimationProblem() = default;

double* EstimationProblem::Data(const BlockId& block) const {
  switch (block.kind) {
    case BlockId::Kind::kRotation:
      return trajectory_->control_point(block.index).rotation.data();
    case BlockId::Kind::kPosition:
      return trajectory_->control_point(block.index).position.data();
    case BlockId::Kind::kLandmark:
      return (*landmarks_)[static_cast<size_t>(block.index)].parameters.data();
    case BlockId::Kind::kScanner:
      return Estimate(block).block.data();
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
    case BlockId::Kind::kScanner:
      return kScannerBlockSize;
  }
  LOG(FATAL) << "unknown block";
  return 0;
}

LinearPrior::Kind EstimationProblem::KindOf(const BlockId& block) const {
  if (block.kind == BlockId::Kind::kPosition || IsScanner(block)) {
    return LinearPrior::Kind::kEuclidean;
  }
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
  return blocks_.at(block);
}

void EstimationProblem::Register(const BlockId& block) {
  if (IsHeld(block) || blocks_.count(block) > 0) return;
  blocks_.emplace(block, MakeManifold(block));
}

const ceres::Manifold* EstimationProblem::MakeManifold(const BlockId& block) {
  if (block.kind == BlockId::Kind::kRotation) return rotation_manifold_.get();
  if (block.kind == BlockId::Kind::kPosition) {
    return planar_ ? planar_position_manifold_.get() : nullptr;
  }
  if (IsScanner(block)) {
    const ScannerBlock& sigmas = Estimate(block).prior_sigma;
    std::vector<int> held;
    for (int i = 0; i < kScannerBlockSize; ++i) {
      if (sigmas[static_cast<size_t>(i)] == 0.0) held.push_back(i);
    }
    if (held.empty()) return nullptr;
    own_manifolds_.push_back(std::make_unique<ceres::SubsetManifold>(kScannerBlockSize, held));
    return own_manifolds_.back().get();
  }
  const Landmark& landmark = (*landmarks_)[static_cast<size_t>(block.index)];
  if (landmark.model != PlaneModel::kVertical) return nullptr;
  if (landmark.heading_fixed) return fixed_heading_manifold_.get();
  const PatchExtent& extent = landmark.extent;
  const Eigen::Vector3d centre = extent.empty() ? extent.anchor() : extent.Centre();
  own_manifolds_.push_back(CreateVerticalPlaneManifold(centre.head<2>()));
  return own_manifolds_.back().get();
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

void EstimationProblem::Add(std::unique_ptr<ceres::CostFunction> factor,
                            const std::vector<double*>& blocks,
                            FactorTerm::Kind kind) {
  factor_terms_.push_back({std::move(factor), blocks, kind});
}

void EstimationProblem::AddFactor(std::unique_ptr<ceres::CostFunction> factor,
                                  const std::vector<BlockId>& blocks) {
  std::vector<double*> data;
  for (const BlockId& block : blocks) {
    Register(block);
    data.push_back(Data(block));
  }
  Add(std::move(factor), data);
}

void EstimationProblem::AddPoints(const Observation& observation) {
  const Landmark& landmark = (*landmarks_)[static_cast<size_t>(observation.landmark_id)];
  const auto scanner = static_cast<size_t>(observation.scanner_index);
  const SegmentWeights weights =
      ObservationWeights(ObservationPoses(*trajectory_, rig_.scanners[scanner], observation),
                         *landmarks_,
                         observation);
  Register(LandmarkBlock(landmark.id));
  for (const ObservedPoint& point : observation.points) {
    const Trajectory::Location at = trajectory_->Locate(point.time_ns);
    const PointMeasurement measurement{
        point.position, at.u, weights.scale * point.whitening, weights.offset * point.offset};
    std::vector<double*> blocks = ControlPointBlocks(at.first, kSplineOrder);
    blocks.push_back(extrinsic_rotations_[scanner].data());
    blocks.push_back(extrinsic_translations_[scanner].data());
    blocks.push_back(Data(LandmarkBlock(landmark.id)));
    Add(CreatePointFactor(measurement, landmark.model, landmark.chart), blocks);
  }
}

void EstimationProblem::AddSegments(const std::vector<const Observation*>& observations,
                                    double huber_width) {
  SegmentGroupCache cache(LinearisedGroup::kFine, 1);
  AddSegments(observations, huber_width, &cache);
}

void EstimationProblem::AddSegments(const std::vector<const Observation*>& observations,
                                    double huber_width,
                                    SegmentGroupCache* cache) {
  segments_.push_back({observations, huber_width});
  const SegmentGroupCache::Loss loss{huber_width, landmarks_held_};
  for (const SegmentGroupCache::Entry* entry :
       cache->Update(rig_, calibration_, *trajectory_, *landmarks_, observations, loss)) {
    std::vector<double*> blocks = ControlPointBlocks(
        entry->first_control_point, entry->group->group().num_control_points());
    for (const int id : entry->landmark_ids) {
      Register(LandmarkBlock(id));
      blocks.push_back(Data(LandmarkBlock(id)));
    }
    ForEachEstimated([&](const BlockId& scanner) {
      Register(scanner);
      blocks.push_back(Data(scanner));
    });
    group_terms_.push_back({entry->group, std::move(blocks)});
  }
}

std::vector<FactorTerm> EstimationProblem::MakeSegmentTerms() const {
  std::vector<FactorTerm> terms;
  for (const Segments& segments : segments_) {
    for (const Observation* observation : segments.observations) {
      terms.push_back(MakeSegmentTerm(*observation, segments.huber_width));
    }
  }
  return terms;
}

FactorTerm EstimationProblem::MakeSegmentTerm(const Observation& observation,
                                              double huber_width) const {
  const Landmark& landmark = (*landmarks_)[static_cast<size_t>(observation.landmark_id)];
  const auto scanner = static_cast<size_t>(observation.scanner_index);
  const SegmentWeights weights =
      ObservationWeights(ObservationPoses(*trajectory_, rig_.scanners[scanner], observation),
                         *landmarks_,
                         observation);
  const SegmentMeasurement measurement = observation.measurement.Unpack();
  std::array<SplineNode, 3> nodes;
  const int first = trajectory_->Locate(measurement.node_times_ns[0]).first;
  for (size_t k = 0; k < nodes.size(); ++k) {
    const Trajectory::Location at = trajectory_->Locate(measurement.node_times_ns[k]);
    nodes[k] = {at.first - first, at.u};
  }
  const int num_control_points = nodes.back().first + kSplineOrder;
  FactorTerm term;
  term.factor = CreateSegmentFactor(
      measurement, nodes, num_control_points, landmark.model, landmark.chart, weights);
  for (int i = first; i < first + num_control_points; ++i) {
    term.blocks.push_back(Data(RotationBlock(i)));
  }
  for (int i = first; i < first + num_control_points; ++i) {
    term.blocks.push_back(Data(PositionBlock(i)));
  }
  // Ceres takes pointers to mutable blocks, also to those that it holds constant.
  term.blocks.push_back(const_cast<double*>(extrinsic_rotations_[scanner].data()));
  term.blocks.push_back(const_cast<double*>(extrinsic_translations_[scanner].data()));
  term.blocks.push_back(Data(LandmarkBlock(landmark.id)));
  term.huber_width = huber_width;
  return term;
}

void EstimationProblem::AddMotionPrior(int first, const MotionNoise& noise) {
  const double interval_s = trajectory_->knot_interval_s();
  const double persistence = noise.Persistence(interval_s);
  if (first == 0 || first - 1 < first_free_) {
    const std::vector<double*> blocks = ControlPointBlocks(first, 3);
    Add(CreateRotationAccelerationFactor(noise.AngularStddev(interval_s), interval_s),
        {blocks[0], blocks[1], blocks[2]},
        FactorTerm::Kind::kRotationAcceleration);
    Add(CreatePositionAccelerationFactor(noise.LinearStddev(interval_s), interval_s),
        {blocks[3], blocks[4], blocks[5]},
        FactorTerm::Kind::kPositionAcceleration);
    return;
  }
  const std::vector<double*> blocks = ControlPointBlocks(first - 1, 4);
  Add(CreateRotationInnovationFactor(
          noise.AngularInnovationStddev(interval_s), persistence, interval_s),
      {blocks[0], blocks[1], blocks[2], blocks[3]},
      FactorTerm::Kind::kRotationAcceleration);
  Add(CreatePositionInnovationFactor(
          noise.LinearInnovationStddev(interval_s), persistence, interval_s),
      {blocks[4], blocks[5], blocks[6], blocks[7]},
      FactorTerm::Kind::kPositionAcceleration);
}

void EstimationProblem::AddStartVelocityPrior(const TrajectoryOptions& options) {
  const double interval_s = trajectory_->knot_interval_s();
  const std::vector<double*> blocks = ControlPointBlocks(0, 2);
  Add(CreateRotationVelocityFactor(options.initial_turn_rate_stddev_deg_s * M_PI / 180.0,
                                   interval_s),
      {blocks[0], blocks[1]});
  Add(CreatePositionVelocityFactor(options.initial_speed_stddev_m_s, interval_s),
      {blocks[2], blocks[3]});
}

void EstimationProblem::AddOrigin(int64_t time_ns) {
  const Trajectory::Location at = trajectory_->Locate(time_ns);
  const std::vector<double*> blocks = ControlPointBlocks(at.first, kSplineOrder);
  Add(CreatePositionFactor(Eigen::Vector3d::Zero(), at.u, kOriginSigma),
      {blocks[4], blocks[5], blocks[6], blocks[7]});
}

void EstimationProblem::AddTrajectoryTerms(const TrajectoryOptions& options,
                                           const MotionProfile& noise,
                                           int64_t origin_time_ns) {
  AddStartVelocityPrior(options);
  AddOrigin(origin_time_ns);
  for (int i = 0; i + 2 < trajectory_->num_control_points(); ++i) {
    AddMotionPrior(i, noise.at[static_cast<size_t>(i)]);
  }
}

void EstimationProblem::AddPrior(const Prior& prior) {
  if (!prior.empty()) AddFactor(CreateLinearPriorFactor(prior.linear), prior.blocks);
}

void EstimationProblem::AddPoseConstraint(const PoseConstraint& constraint) {
  const Trajectory::Location at = trajectory_->Locate(constraint.time_ns);
  Add(CreatePoseFactor(constraint.measurement, at.u),
      ControlPointBlocks(at.first, kSplineOrder));
}

void EstimationProblem::AddOdometry(int first, const OdometryMeasurement& measurement) {
  Add(CreateOdometryFactor(measurement), ControlPointBlocks(first, kSplineOrder));
}

BlockLayout EstimationProblem::Layout() const {
  BlockLayout layout;
  layout.offsets.assign(1, 0);
  for (const auto& [block, manifold] : blocks_) {
    const int size = TangentSize(block);
    const int free_size = manifold == nullptr ? size : manifold->TangentSize();
    // A landmark that is held in part is held in its heading, a position in its height.
    const bool heading_held = IsLandmark(block) && free_size < size;
    for (int i = 0; i < size; ++i) {
      if (IsScanner(block)) {
        layout.is_free.push_back(Estimate(block).prior_sigma[static_cast<size_t>(i)] > 0.0);
      } else {
        layout.is_free.push_back(heading_held ? i > 0 : i < free_size);
      }
    }
    layout.blocks.push_back(block);
    layout.offsets.push_back(layout.offsets.back() + size);
  }
  return layout;
}

EstimationProblem::Values EstimationProblem::ValuesOf(const BlockLayout& layout) const {
  Values values(layout.blocks.size());
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    std::copy_n(Data(layout.blocks[i]), AmbientSize(layout.blocks[i]), values[i].begin());
  }
  return values;
}

void EstimationProblem::SetValues(const BlockLayout& layout, const Values& values) {
  for (size_t i = 0; i < layout.blocks.size(); ++i) {
    std::copy_n(values[i].begin(), AmbientSize(layout.blocks[i]), Data(layout.blocks[i]));
  }
}

void EstimationProblem::Move(const BlockLayout& layout, const Eigen::VectorXd& step) {
  const double* next = step.data();
  for (const BlockId& block : layout.blocks) {
    double* data = Data(block);
    const int size = AmbientSize(block);
    Values::value_type moved;
    if (const ceres::Manifold* manifold = ManifoldOf(block)) {
      manifold->Plus(data, next, moved.data());
      next += manifold->TangentSize();
    } else {
      std::transform(data, data + size, next, moved.begin(), std::plus<>());
      next += size;
    }
    std::copy_n(moved.begin(), size, data);
  }
}

}  // namespace plumbline

#include "core/estimation/estimation_problem.h"

#include <ceres/cost_function.h>
#include <glog/logging.h>

#include <cmath>
#include <utility>

#include "core/util/error.h"
#include "factors/cost/motion_factor.h"
#include "factors/cost/point_factor.h"
#include "factors/cost/pose_factor.h"
#include "factors/cost/position_factor.h"
#include "factors/cost/segment_factor.h"
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
      trajectory_(trajectory),
      landmarks_(landmarks),
      calibration_(calibration),
      unknowns_(planar, trajectory, landmarks, calibration) {
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

std::vector<BlockId> EstimationProblem::EstimatedScanners() const {
  std::vector<BlockId> blocks;
  if (calibration_ == nullptr) return blocks;
  for (size_t i = 0; i < calibration_->scanners.size(); ++i) {
    if (calibration_->scanners[i].IsEstimated()) {
      blocks.push_back(ScannerBlockId(static_cast<int>(i)));
    }
  }
  return blocks;
}

std::vector<double*> EstimationProblem::ControlPointBlocks(int first, int count) {
  std::vector<double*> blocks;
  for (int i = first; i < first + count; ++i) {
    unknowns_.Register(RotationBlock(i));
    blocks.push_back(unknowns_.Data(RotationBlock(i)));
  }
  for (int i = first; i < first + count; ++i) {
    unknowns_.Register(PositionBlock(i));
    blocks.push_back(unknowns_.Data(PositionBlock(i)));
  }
  return blocks;
}

void EstimationProblem::Add(std::unique_ptr<ceres::CostFunction> factor,
                            const std::vector<double*>& blocks,
                            FactorTerm::Kind kind) {
  factor_terms_.push_back({std::move(factor), blocks, kind});
}

void EstimationProblem::AddFactor(std::unique_ptr<ceres::CostFunction> factor,
                                  const std::vector<BlockId>& blocks,
                                  FactorTerm::Kind kind) {
  std::vector<double*> data;
  for (const BlockId& block : blocks) {
    unknowns_.Register(block);
    data.push_back(unknowns_.Data(block));
  }
  Add(std::move(factor), data, kind);
}

void EstimationProblem::AddPoints(const Observation& observation) {
  const Landmark& landmark = (*landmarks_)[static_cast<size_t>(observation.landmark_id)];
  const auto scanner = static_cast<size_t>(observation.scanner_index);
  const SegmentWeights weights =
      ObservationWeights(ObservationPoses(*trajectory_, rig_.scanners[scanner], observation),
                         *landmarks_,
                         observation);
  if (rig_.scanners[scanner].mount) {
    throw Error("single points know no scanner on a mount: batch: {factor: segment}");
  }
  unknowns_.Register(LandmarkBlock(landmark.id));
  for (const ObservedPoint& point : observation.points) {
    const Trajectory::Location at = trajectory_->Locate(point.time_ns);
    const PointMeasurement measurement{
        point.position, at.u, weights.scale * point.whitening, weights.offset * point.offset};
    std::vector<double*> blocks = ControlPointBlocks(at.first, kSplineOrder);
    blocks.push_back(extrinsic_rotations_[scanner].data());
    blocks.push_back(extrinsic_translations_[scanner].data());
    blocks.push_back(unknowns_.Data(LandmarkBlock(landmark.id)));
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
  const SegmentGroupCache::Loss loss{huber_width, unknowns_.landmarks_held()};
  for (const SegmentGroupCache::Entry* entry :
       cache->Update(rig_, calibration_, *trajectory_, *landmarks_, observations, loss)) {
    std::vector<double*> blocks = ControlPointBlocks(
        entry->first_control_point, entry->group->group().num_control_points());
    for (const int id : entry->landmark_ids) {
      unknowns_.Register(LandmarkBlock(id));
      blocks.push_back(unknowns_.Data(LandmarkBlock(id)));
    }
    for (const BlockId& scanner : EstimatedScanners()) {
      unknowns_.Register(scanner);
      blocks.push_back(unknowns_.Data(scanner));
    }
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
  CHECK(!rig_.scanners[scanner].mount) << "single segments know no scanner on a mount";
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
    term.blocks.push_back(unknowns_.Data(RotationBlock(i)));
  }
  for (int i = first; i < first + num_control_points; ++i) {
    term.blocks.push_back(unknowns_.Data(PositionBlock(i)));
  }
  // Ceres takes pointers to mutable blocks, also to those that it holds constant.
  term.blocks.push_back(const_cast<double*>(extrinsic_rotations_[scanner].data()));
  term.blocks.push_back(const_cast<double*>(extrinsic_translations_[scanner].data()));
  term.blocks.push_back(unknowns_.Data(LandmarkBlock(landmark.id)));
  term.huber_width = huber_width;
  return term;
}

void EstimationProblem::AddMotionPrior(int first, const MotionNoise& noise) {
  const double interval_s = trajectory_->knot_interval_s();
  const MotionPersistence linear = noise.LinearPersistence(interval_s);
  if (first == 0 || first - 1 < unknowns_.first_free()) {
    const std::vector<double*> blocks = ControlPointBlocks(first, 3);
    Add(CreateRotationAccelerationFactor(noise.AngularStddev(interval_s), interval_s),
        {blocks[0], blocks[1], blocks[2]},
        FactorTerm::Kind::kRotationAcceleration);
    Add(CreatePositionAccelerationFactor(noise.LinearStddev(interval_s), linear, interval_s),
        {blocks[3], blocks[4], blocks[5]},
        FactorTerm::Kind::kPositionAcceleration);
    return;
  }
  const std::vector<double*> blocks = ControlPointBlocks(first - 1, 4);
  Add(CreateRotationInnovationFactor(noise.AngularInnovationStddev(interval_s),
                                     noise.Persistence(interval_s),
                                     interval_s),
      {blocks[0], blocks[1], blocks[2], blocks[3]},
      FactorTerm::Kind::kRotationAcceleration);
  Add(CreatePositionInnovationFactor(
          noise.LinearInnovationStddev(interval_s), linear, interval_s),
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

void EstimationProblem::AddOdometry(int64_t begin_ns,
                                    int64_t end_ns,
                                    const OdometryMeasurement& measurement) {
  const Trajectory::Location begin = trajectory_->Locate(begin_ns);
  // A knot is the end of the interval before it: it takes no control point after that.
  const Trajectory::Location end = trajectory_->Locate(end_ns - 1);
  const int num_control_points = end.first - begin.first + kSplineOrder;
  Add(CreateOdometryFactor(
          measurement, {0, begin.u}, {end.first - begin.first, end.u}, num_control_points),
      ControlPointBlocks(begin.first, num_control_points));
}

}  // namespace plumbline

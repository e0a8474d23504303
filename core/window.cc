#include "core/window.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/joint_association.h"
#include "core/time.h"
#include "factors/spline.h"

namespace plumbline {
namespace {

constexpr int kOrder = 4;
constexpr int kMaxTrackingRounds = 4;
// Segments beyond this many standard deviations (norm of up to nine residuals) lose influence.
constexpr double kHuberWidth = 5.0;

// The window only has to be good enough for the next associations and as the batch's start: an
// iteration that lowers the cost by less than this share of it is the last one.
constexpr double kFunctionTolerance = 1e-4;

ceres::Solver::Options SolverOptions(ceres::LinearSolverType linear_solver,
                                     int max_iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = linear_solver;
  options.max_num_iterations = max_iterations;
  options.num_threads = 1;  // Ceres sums costs by thread: more of them would change the result
  options.logging_type = ceres::SILENT;
  options.function_tolerance = kFunctionTolerance;
  return options;
}

// Rows and columns of the blocks for which keep() is true.
template <typename Keep>
NormalEquations Restrict(const NormalEquations& equations, Keep keep) {
  NormalEquations part;
  part.offsets.push_back(0);
  std::vector<int> rows;
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    if (!keep(equations.blocks[i])) continue;
    part.blocks.push_back(equations.blocks[i]);
    for (int row = equations.offsets[i]; row < equations.offsets[i + 1]; ++row) {
      rows.push_back(row);
    }
    part.offsets.push_back(static_cast<int>(rows.size()));
  }
  part.hessian = equations.hessian(rows, rows);
  part.gradient = equations.gradient(rows);
  return part;
}

// Inverse on the directions that are estimated; zero on those that are held.
Eigen::MatrixXd Inverse(const NormalEquations& equations) {
  std::vector<int> rows;
  for (int i = 0; i < equations.size(); ++i) {
    if (equations.hessian(i, i) > 0.0) rows.push_back(i);
  }
  const Eigen::MatrixXd free = equations.hessian(rows, rows);
  // Scaled to a unit diagonal, so that metres and radians do not spoil the condition.
  const Eigen::VectorXd scale = free.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(scale.asDiagonal() * free * scale.asDiagonal());
  if (factor.info() != Eigen::Success) {
    throw Error("the poses and planes are not determined by the scans: singular estimate");
  }
  const Eigen::MatrixXd inverse =
      factor.solve(Eigen::MatrixXd::Identity(free.rows(), free.cols()));
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(equations.size(), equations.size());
  covariance(rows, rows) = scale.asDiagonal() * inverse * scale.asDiagonal();
  return covariance;
}

}  // namespace

PoseUncertainty::PoseUncertainty(const NormalEquations& equations)
    : blocks_(equations.blocks),
      offsets_(equations.offsets),
      covariance_(Inverse(equations)) {}

Matrix6d PoseUncertainty::At(const Trajectory& trajectory, int64_t time_ns) const {
  const Eigen::MatrixXd jacobian = JacobianAt(trajectory, time_ns);
  return jacobian * covariance_ * jacobian.transpose();
}

Eigen::MatrixXd PoseUncertainty::JacobianAt(const Trajectory& trajectory,
                                            int64_t time_ns) const {
  const Trajectory::Location at = trajectory.Locate(time_ns);
  const double* rotations[kOrder];
  const double* positions[kOrder];
  for (int j = 0; j < kOrder; ++j) {
    rotations[j] = trajectory.control_point(at.first + j).rotation.data();
    positions[j] = trajectory.control_point(at.first + j).position.data();
  }
  SplinePoseJacobian spline;
  EvaluatePose(rotations, positions, at.u, &spline);
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(6, covariance_.cols());
  for (size_t i = 0; i < blocks_.size(); ++i) {
    const BlockId& block = blocks_[i];
    const int j = block.index - at.first;
    if (block.kind == BlockId::Kind::kLandmark || j < 0 || j >= kOrder) continue;
    const int offset = offsets_[i];
    const bool planar = offsets_[i + 1] - offset == 1;
    if (block.kind == BlockId::Kind::kPosition) {
      jacobian.block<3, 3>(3, offset).diagonal().setConstant(
          spline.position_weights[static_cast<size_t>(j)]);
    } else if (planar) {
      jacobian.block<3, 1>(0, offset) =
          spline.rotation_wrt_control[static_cast<size_t>(j)].col(2);
    } else {
      jacobian.block<3, 3>(0, offset) = spline.rotation_wrt_control[static_cast<size_t>(j)];
    }
  }
  return jacobian;
}

Window::Window(const Rig& rig, bool planar, const MapperOptions& options, MapState* state)
    : rig_(rig), planar_(planar), options_(options), state_(state) {}

void Window::AddMotionPriors(EstimationProblem* problem, int first, int last) const {
  for (int i = first; i <= last; ++i) problem->AddMotionPrior(i, options_.trajectory);
}

void Window::AddStart(EstimationProblem* problem) const {
  problem->AddStartVelocityPrior(options_.trajectory);
  problem->AddOrigin(state_->origin_time_ns);
}

std::unique_ptr<EstimationProblem> Window::TrackingProblem(int first_observation,
                                                           int last_observation) const {
  auto problem = std::make_unique<EstimationProblem>(
      rig_, planar_, &state_->trajectory, &state_->landmarks);
  const int num_control_points = state_->trajectory.num_control_points();
  const int first_triple = std::max(0, tracking_known_ - 2);
  AddMotionPriors(problem.get(), first_triple, num_control_points - 3);
  if (tracking_known_ == 0) {
    AddStart(problem.get());
  } else {
    problem->AddPrior(tracking_prior_);
  }
  std::vector<const Observation*> associated;
  const auto add = [&](int index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    if (observation.landmark_id >= 0) associated.push_back(&observation);
  };
  for (const int index : recent_) add(index);
  for (int index = first_observation; index <= last_observation; ++index) add(index);
  problem->AddSegments(associated, kHuberWidth);
  for (const Landmark& landmark : state_->landmarks) problem->Hold(LandmarkBlock(landmark.id));
  const int first_free = tracking_known_ == 0 ? 0 : tracking_prior_.blocks.front().index;
  for (int i = 0; i < first_free; ++i) {
    problem->Hold(RotationBlock(i));
    problem->Hold(PositionBlock(i));
  }
  return problem;
}

void Window::UpdateUncertainty(const NormalEquations& equations) {
  pose_uncertainty_ = PoseUncertainty(equations);
}

bool Window::AssociateJointly(int first_observation,
                              int last_observation,
                              const std::vector<int>& candidate_ids) {
  std::vector<int> order;
  for (int index = first_observation; index <= last_observation; ++index) {
    order.push_back(index);
  }
  const auto at = [&](int index) -> Observation& {
    return state_->observations[static_cast<size_t>(index)];
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return at(a).length_m() > at(b).length_m();
  });
  std::vector<Pairing> pairings;
  for (const int index : order) {
    const Observation& observation = at(index);
    const int64_t time_ns = observation.middle_time_ns();
    const Eigen::MatrixXd pose_by_control =
        pose_uncertainty_.JacobianAt(state_->trajectory, time_ns);
    const Matrix6d pose_covariance =
        pose_by_control * pose_uncertainty_.covariance() * pose_by_control.transpose();
    for (const PossibleLandmark& possible : PossibleLandmarks(
             observation,
             rig_.scanners[static_cast<size_t>(observation.scanner_index)].body_from_scanner,
             ObservationPoses(state_->trajectory, observation),
             pose_covariance,
             state_->landmarks,
             candidate_ids,
             options_.association)) {
      pairings.push_back({index,
                          possible.id,
                          possible.deviation.value,
                          possible.noise,
                          possible.deviation.by_pose * pose_by_control});
    }
  }
  const std::vector<size_t> chosen =
      ChooseJointly(pairings, pose_uncertainty_.covariance(), options_.association);
  for (const size_t i : chosen) {
    at(pairings[i].observation_index).landmark_id = pairings[i].landmark_id;
  }
  return !chosen.empty();
}

void Window::Track(int first_observation,
                   int last_observation,
                   const std::vector<int>& candidate_ids) {
  const bool has_new_control_points =
      tracking_known_ != state_->trajectory.num_control_points();
  if (has_new_control_points) UpdateUncertainty(TrackingProblem(0, -1)->Linearise());
  std::unique_ptr<EstimationProblem> problem;
  NormalEquations equations;
  for (int round = 0; round < kMaxTrackingRounds; ++round) {
    // By the prediction first, all segments together; once the poses are known, one by one.
    const bool changed =
        round == 0 ? AssociateJointly(first_observation, last_observation, candidate_ids)
                   : Associate(first_observation, last_observation, candidate_ids);
    if (!changed && problem) break;
    problem = TrackingProblem(first_observation, last_observation);
    if (changed) problem->Solve(SolverOptions(ceres::DENSE_NORMAL_CHOLESKY, 4));
    equations = problem->Linearise();
    UpdateUncertainty(equations);
  }
  // The scan becomes part of the prior, so that the next scan's problem is as small.
  equations.gradient.setZero();  // an optimum up to the solver's tolerance
  tracking_prior_ = problem->MarginaliseOnto(equations, equations.blocks);
  tracking_known_ = state_->trajectory.num_control_points();
  recent_.clear();
}

bool Window::Associate(int first_observation,
                       int last_observation,
                       const std::vector<int>& candidate_ids) {
  bool changed = false;
  for (int index = first_observation; index <= last_observation; ++index) {
    Observation& observation = state_->observations[static_cast<size_t>(index)];
    const Rigid3d& body_from_scanner =
        rig_.scanners[static_cast<size_t>(observation.scanner_index)].body_from_scanner;
    const int id =
        FindLandmark(observation,
                     body_from_scanner,
                     ObservationPoses(state_->trajectory, observation),
                     pose_uncertainty_.At(state_->trajectory, observation.middle_time_ns()),
                     state_->landmarks,
                     candidate_ids,
                     options_.association);
    changed |= id != observation.landmark_id;
    observation.landmark_id = id;
  }
  return changed;
}

void Window::Add(int observation_index, bool tracked) {
  const Observation& observation =
      state_->observations[static_cast<size_t>(observation_index)];
  if (state_->trajectory.Locate(observation.measurement.node_times_ns[0]).first < start_)
    return;
  window_.push_back(observation_index);
  if (!tracked) recent_.push_back(observation_index);
}

void Window::Solve(int64_t now_ns, double window_s) {
  EstimationProblem problem(rig_, planar_, &state_->trajectory, &state_->landmarks);
  const int num_control_points = state_->trajectory.num_control_points();
  problem.AddPrior(history_);
  if (start_ == 0) AddStart(&problem);
  AddMotionPriors(&problem, start_, num_control_points - 3);
  std::vector<const Observation*> in_window;
  for (const int index : window_) {
    in_window.push_back(&state_->observations[static_cast<size_t>(index)]);
  }
  problem.AddSegments(in_window, kHuberWidth);
  problem.Solve(SolverOptions(ceres::SPARSE_NORMAL_CHOLESKY, 5));

  const NormalEquations equations = problem.Linearise();
  const int newest = state_->trajectory.Locate(now_ns).first;
  const auto is_newest = [&](const BlockId& block) {
    return block.kind != BlockId::Kind::kLandmark && block.index >= newest;
  };
  NormalEquations poses = Restrict(
      equations, [](const BlockId& block) { return block.kind != BlockId::Kind::kLandmark; });
  poses.gradient.setZero();  // an optimum up to the solver's tolerance
  std::vector<BlockId> newest_blocks;
  for (const BlockId& block : poses.blocks) {
    if (is_newest(block)) newest_blocks.push_back(block);
  }
  tracking_prior_ = problem.MarginaliseOnto(poses, newest_blocks);
  tracking_known_ = num_control_points;
  recent_.clear();
  UpdateUncertainty(TrackingProblem(0, -1)->Linearise());

  // What the planes' uncertainty is to somebody who stands at the newest pose.
  const NormalEquations given_pose =
      Restrict(equations, [&](const BlockId& block) { return !is_newest(block); });
  const Eigen::MatrixXd covariance = Inverse(given_pose);
  for (size_t i = 0; i < given_pose.blocks.size(); ++i) {
    const BlockId& block = given_pose.blocks[i];
    if (block.kind != BlockId::Kind::kLandmark) continue;
    const int size = given_pose.offsets[i + 1] - given_pose.offsets[i];
    Landmark& landmark = state_->landmarks[static_cast<size_t>(block.index)];
    landmark.covariance.setZero();
    landmark.covariance.topLeftCorner(size, size) =
        covariance.block(given_pose.offsets[i], given_pose.offsets[i], size, size);
  }
  const int64_t oldest_ns =
      std::max(state_->trajectory.start_ns(), now_ns - NanosecondsFromSeconds(window_s));
  Marginalise(state_->trajectory.Locate(oldest_ns).first);
}

void Window::Marginalise(int new_start) {
  if (new_start <= start_) return;
  EstimationProblem leaving(rig_, planar_, &state_->trajectory, &state_->landmarks);
  leaving.AddPrior(history_);
  if (start_ == 0) AddStart(&leaving);
  AddMotionPriors(&leaving, start_, new_start - 1);
  std::vector<int> staying;
  std::vector<const Observation*> gone;
  for (const int index : window_) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    const int first =
        state_->trajectory.Locate(observation.measurement.node_times_ns[0]).first;
    if (first >= new_start) {
      staying.push_back(index);
    } else {
      gone.push_back(&observation);
    }
  }
  leaving.AddSegments(gone, kHuberWidth);
  const NormalEquations equations = leaving.Linearise();
  std::vector<BlockId> kept;
  for (const BlockId& block : equations.blocks) {
    if (block.kind == BlockId::Kind::kLandmark || block.index >= new_start) {
      kept.push_back(block);
    }
  }
  history_ = leaving.MarginaliseOnto(equations, kept);
  window_ = std::move(staying);
  start_ = new_start;
}

void Window::MergeLandmarks(int into, int from) {
  const auto find = [&](int id) {
    return std::find(history_.blocks.begin(), history_.blocks.end(), LandmarkBlock(id)) -
           history_.blocks.begin();
  };
  const auto num_blocks = static_cast<std::ptrdiff_t>(history_.blocks.size());
  const std::ptrdiff_t from_at = find(from);
  if (from_at == num_blocks) return;
  const std::ptrdiff_t into_at = find(into);
  std::vector<int> offsets = {0};
  for (const LinearPrior::Block& block : history_.linear.blocks) {
    offsets.push_back(offsets.back() + block.tangent_size());
  }
  LinearPrior::Block& from_block = history_.linear.blocks[static_cast<size_t>(from_at)];
  const int size = from_block.tangent_size();
  const int from_offset = offsets[static_cast<size_t>(from_at)];
  if (into_at == num_blocks) {
    // Landmarks come last and `into` is unknown to the history: it inherits the block. Blocks
    // stay in order because the matrices are taken in the order of the blocks' ids again when
    // the history is next marginalised.
    history_.blocks[static_cast<size_t>(from_at)] = LandmarkBlock(into);
    return;
  }
  LinearPrior::Block& into_block = history_.linear.blocks[static_cast<size_t>(into_at)];
  Eigen::VectorXd shift = into_block.x0 - from_block.x0;
  if (size == 2) shift[0] = std::remainder(shift[0], 2.0 * M_PI);
  Eigen::MatrixXd& root = history_.linear.root;
  history_.linear.offset += root.middleCols(from_offset, size) * shift;
  root.middleCols(offsets[static_cast<size_t>(into_at)], size) +=
      root.middleCols(from_offset, size);
  const Eigen::Index after = root.cols() - from_offset - size;
  Eigen::MatrixXd remaining(root.rows(), root.cols() - size);
  remaining << root.leftCols(from_offset), root.rightCols(after);
  root = remaining;
  history_.blocks.erase(history_.blocks.begin() + from_at);
  history_.linear.blocks.erase(history_.linear.blocks.begin() + from_at);
}

}  // namespace plumbline

#include "core/window/window.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/estimation/block_layout.h"
#include "core/estimation/imu_terms.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/normal_equations.h"
#include "core/estimation/odometry_terms.h"
#include "core/estimation/pose_prior.h"
#include "core/trajectory/motion_noise.h"
#include "core/trajectory/pose_gaussian.h"
#include "core/trajectory/pose_uncertainty.h"
#include "core/util/error.h"
#include "core/util/time.h"
#include "factors/linear_algebra/elimination.h"
#include "factors/linear_algebra/square_root_marginalisation.h"
#include "factors/linear_algebra/symmetric_inverse.h"
#include "factors/manifold/manifolds.h"
#include "factors/spline/so3.h"
#include "factors/spline/spline.h"

namespace plumbline {
namespace {

// The window only has to be good enough for the next associations and as the batch's start: an
// iteration that lowers the cost by less than this share of it is the last one.
constexpr SolverOptions kSolverOptions = {5, 1e-4, 0.0};
constexpr char kNotDetermined[] = "the scans do not determine poses and planes";

// Inverse on the rows and directions that are estimated; zero on the others.
Eigen::MatrixXd InverseOn(const NormalEquations& equations, const std::vector<int>& on) {
  std::vector<int> rows;
  for (const int row : on) {
    if (equations.hessian(row, row) > 0.0) rows.push_back(row);
  }
  const std::optional<Eigen::MatrixXd> inverse =
      SymmetricInverse(equations.hessian(rows, rows));
  if (!inverse) throw Error(kNotDetermined);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(equations.size(), equations.size());
  covariance(rows, rows) = *inverse;
  return covariance;
}

void SetCovariance(const Eigen::MatrixXd& covariance, Landmark* landmark) {
  landmark->covariance.setZero();
  landmark->covariance.topLeftCorner(covariance.rows(), covariance.cols()) = covariance;
}

}  // namespace

Window::Window(const Rig& rig,
               bool planar,
               const MapperOptions& options,
               MotionPrior* motion_prior,
               MapState* state)
    : rig_(rig),
      planar_(planar),
      options_(options),
      motion_prior_(motion_prior),
      state_(state),
      solver_(MakeWindowSolver(options.window.solver, kSolverOptions)) {}

Window::Window(const Window& other, const Rig& rig, MotionPrior* motion_prior, MapState* state)
    : rig_(rig),
      planar_(other.planar_),
      options_(other.options_),
      motion_prior_(motion_prior),
      state_(state),
      solver_(MakeWindowSolver(other.options_.window.solver, kSolverOptions)),
      start_(other.start_),
      prior_(other.prior_),
      inactive_(other.inactive_),
      num_solves_(other.num_solves_),
      last_in_view_(other.last_in_view_),
      window_(other.window_),
      first_constraint_(other.first_constraint_),
      estimates_(other.estimates_) {}

void Window::AddMotionPriors(EstimationProblem* problem, int first, int last) const {
  for (int i = first; i <= last; ++i) problem->AddMotionPrior(i, motion_prior_->At(i));
}

void Window::AddStart(EstimationProblem* problem) const {
  problem->AddStartVelocityPrior(options_.trajectory);
  problem->AddOrigin(state_->origin_time_ns);
  if (motion_prior_->start()) {
    AddGravityStart(*motion_prior_->start(), state_->trajectory, problem);
  }
  AddScannerPriors(state_->calibration, problem);
  if (state_->imu != nullptr) AddImuPrior(*state_->calibration.imu, problem);
}

void Window::AddPoseConstraints(int end, EstimationProblem* problem) const {
  for (size_t i = first_constraint_; i < state_->pose_constraints.size(); ++i) {
    const PoseConstraint& constraint = state_->pose_constraints[i];
    const int first = state_->trajectory.Locate(constraint.time_ns).first;
    if (first < start_ || first >= end) continue;
    problem->AddPoseConstraint(constraint);
  }
}

void Window::Add(int observation_index) {
  const Observation& observation =
      state_->observations[static_cast<size_t>(observation_index)];
  const int first =
      state_->trajectory.Locate(observation.measurement.node_times_ns()[0]).first;
  if (first >= start_) window_.push_back(observation_index);
}

void Window::TakeBack(const std::vector<bool>& is_chosen) {
  std::vector<int> kept;
  for (const int index : window_) {
    Observation& observation = state_->observations[static_cast<size_t>(index)];
    if (is_chosen[static_cast<size_t>(observation.landmark_id)]) {
      observation.landmark_id = -1;
    } else {
      kept.push_back(index);
    }
  }
  window_ = std::move(kept);
  state_->pose_constraints.resize(
      std::min(first_constraint_, state_->pose_constraints.size()));
}

std::set<int> Window::LandmarksInWindow() const {
  std::set<int> ids;
  for (const int index : window_) {
    ids.insert(state_->observations[static_cast<size_t>(index)].landmark_id);
  }
  return ids;
}

Eigen::VectorXd Window::Moved(const EstimationProblem& problem, size_t block) const {
  const BlockId& id = prior_.equations.blocks[block];
  const Eigen::VectorXd& at = prior_.at[block];
  if (IsLandmark(id)) {
    return AnchoredParameters(state_->landmarks[static_cast<size_t>(id.index)]) - at;
  }
  const double* now = problem.unknowns().Data(id);
  if (id.kind != BlockId::Kind::kRotation) {
    return Eigen::Map<const Eigen::VectorXd>(now, at.size()) - at;
  }
  if (planar_) return Eigen::VectorXd::Constant(1, YawDifference(now, at.data()));
  using Quaternion = Eigen::Map<const Eigen::Quaterniond>;
  return Log(Quaternion(now) * Quaternion(at.data()).conjugate());
}

bool Window::ActivateLandmarks(const std::set<int>& in_view) {
  std::set<int> activated_ids;
  for (const int id : in_view) {
    last_in_view_[id] = num_solves_;
    if (inactive_.Contains(id)) activated_ids.insert(id);
  }
  inactive_.Activate(activated_ids, state_->landmarks, &prior_);
  return !activated_ids.empty();
}

void Window::DeactivateLandmarks() {
  std::set<int> deactivated;
  for (const BlockId& block : prior_.equations.blocks) {
    if (!IsLandmark(block)) continue;
    const Landmark& landmark = state_->landmarks[static_cast<size_t>(block.index)];
    // The conditional of a plane that is held in part would be singular.
    if (landmark.heading_fixed) continue;
    if (num_solves_ - last_in_view_[block.index] >= kInactiveAfter)
      deactivated.insert(block.index);
  }
  if (!deactivated.empty()) inactive_.Deactivate(deactivated, start_, &prior_);
}

Window::OutOfView Window::EliminateOutOfView(const std::set<int>& in_view) const {
  const NormalEquations& past = prior_.equations;
  OutOfView out_of_view;
  std::vector<int> order;
  std::vector<int> active_rows;
  for (size_t i = 0; i < past.blocks.size(); ++i) {
    const BlockId& block = past.blocks[i];
    const bool is_active =
        IsScanner(block) || IsImu(block) ||
        (IsLandmark(block) ? in_view.count(block.index) > 0 : block.index >= start_);
    (is_active ? out_of_view.active_blocks : out_of_view.blocks).push_back(i);
    for (int row = past.offsets[i]; row < past.offsets[i + 1]; ++row) {
      (is_active ? active_rows : order).push_back(row);
    }
  }
  const auto num_out_of_view = static_cast<Eigen::Index>(order.size());
  order.insert(order.end(), active_rows.begin(), active_rows.end());
  out_of_view.elimination =
      Elimination::Make(past.hessian(order, order), past.gradient(order), num_out_of_view);
  if (!out_of_view.elimination) throw Error(kNotDetermined);
  return out_of_view;
}

void Window::AddMarginalPrior(const OutOfView& out_of_view, EstimationProblem* problem) const {
  if (out_of_view.active_blocks.empty()) return;
  Prior prior;
  for (const size_t i : out_of_view.active_blocks) {
    const BlockId& block = prior_.equations.blocks[i];
    prior.blocks.push_back(block);
    prior.linear.blocks.push_back({problem->unknowns().KindOf(block),
                                   static_cast<int>(prior_.at[i].size()),
                                   prior_.at[i]});
    if (!IsLandmark(block)) continue;
    prior.linear.blocks.back().anchor =
        AnchorOf(state_->landmarks[static_cast<size_t>(block.index)]);
  }
  const MarginalisedSystem root = plumbline::Marginalise(
      out_of_view.elimination->hessian(), out_of_view.elimination->gradient(), 0);
  prior.linear.root = root.root;
  prior.linear.offset = root.offset;
  problem->AddPrior(prior);
}

void Window::MoveOutOfView(const OutOfView& out_of_view,
                           const EstimationProblem& problem,
                           const NormalEquations& equations,
                           Eigen::MatrixXd covariance,
                           bool inactive_too) {
  if (out_of_view.blocks.empty() && !inactive_too) return;
  const NormalEquations& past = prior_.equations;
  const std::vector<int> active_rows = RowsOf(past, out_of_view.active_blocks);
  const std::vector<int> out_of_view_rows = RowsOf(past, out_of_view.blocks);
  Eigen::VectorXd steps(past.size());
  std::vector<size_t> solved_blocks;  // the marginal prior's active blocks in the solution
  for (const size_t i : out_of_view.active_blocks) {
    solved_blocks.push_back(FindBlock(equations, past.blocks[i]));
    steps.segment(past.offsets[i], BlockSize(past, i)) = Moved(problem, i);
  }
  const std::vector<int> solved_rows = RowsOf(equations, solved_blocks);
  steps(out_of_view_rows) = out_of_view.elimination->BackSubstitute(steps(active_rows));
  const Eigen::MatrixXd gain = out_of_view.elimination->Gain();
  const Eigen::MatrixXd root = out_of_view.elimination->ConditionalRoot();
  CovarianceToAnchored(state_->landmarks, equations, &covariance);
  const Eigen::MatrixXd of_active = covariance(solved_rows, solved_rows);
  const Eigen::MatrixXd spread = gain * of_active;
  Eigen::MatrixXd joint(past.size(), past.size());
  joint(out_of_view_rows, out_of_view_rows) =
      root.transpose() * root + spread * gain.transpose();
  for (const size_t i : out_of_view.blocks) {
    if (!IsLandmark(past.blocks[i])) continue;
    const int row = past.offsets[i];
    const int size = BlockSize(past, i);
    Landmark& landmark = state_->landmarks[static_cast<size_t>(past.blocks[i].index)];
    SetFromAnchored(prior_.at[i] + steps.segment(row, size), &landmark);
    SetCovarianceFromAnchored(joint.block(row, row, size, size), &landmark);
  }
  if (!inactive_too) return;
  joint(active_rows, active_rows) = of_active;
  joint(out_of_view_rows, active_rows) = spread;
  joint(active_rows, out_of_view_rows) = spread.transpose();
  inactive_.Update(prior_, steps, joint, &state_->landmarks);
}

PoseGaussian Window::Solve(int64_t now_ns, double window_s) {
  ++num_solves_;
  const std::set<int> in_view = LandmarksInWindow();
  const bool activated = ActivateLandmarks(in_view);
  const OutOfView out_of_view = EliminateOutOfView(in_view);
  EstimationProblem problem(
      rig_, planar_, &state_->trajectory, &state_->landmarks, &state_->calibration);
  AddMarginalPrior(out_of_view, &problem);
  if (start_ == 0) AddStart(&problem);
  const int num_control_points = state_->trajectory.num_control_points();
  AddMotionPriors(&problem, FirstMotionPrior(), num_control_points - 3);
  const int end_interval = num_control_points - kSplineOrder + 1;
  AddOdometry(*state_, start_, end_interval, &problem);
  if (state_->calibration.imu) state_->calibration.imu->ExtendTo(end_interval);
  AddImu(*state_, start_, end_interval, 1, &problem);
  std::vector<const Observation*> in_window;
  for (const int index : window_) {
    in_window.push_back(&state_->observations[static_cast<size_t>(index)]);
  }
  problem.AddSegments(in_window, options_.association.huber_width, &groups_);
  AddPoseConstraints(num_control_points, &problem);
  const NormalEquations equations = solver_->Solve(&problem);

  const int newest = state_->trajectory.Locate(now_ns).first;
  PoseGaussian newest_poses = NewestPoses(equations, newest);
  if (options_.window.keep_estimates) KeepEstimate(equations, newest, now_ns);

  // Covariance of the planes, given the newest pose.
  Eigen::MatrixXd covariance =
      InverseOn(equations, RowsOf(equations, [&](const BlockId& block) {
                  return !IsControlPoint(block) || block.index < newest;
                }));
  for (size_t i = 0; i < equations.blocks.size(); ++i) {
    const BlockId& block = equations.blocks[i];
    const int row = equations.offsets[i];
    if (IsScanner(block)) {
      state_->calibration.scanners[static_cast<size_t>(block.index)].SetCovariance(covariance,
                                                                                   row);
    }
    if (IsImu(block) || IsBias(block)) {
      SetImuCovariance(block, covariance, row, &*state_->calibration.imu);
    }
    if (!IsLandmark(block)) continue;
    SetCovariance(covariance.block(row, row, BlockSize(equations, i), BlockSize(equations, i)),
                  &state_->landmarks[static_cast<size_t>(block.index)]);
  }
  const int64_t oldest_ns =
      std::max(state_->trajectory.start_ns(), now_ns - NanosecondsFromSeconds(window_s));
  const int new_start = state_->trajectory.Locate(oldest_ns).first;
  LearnMotion(equations, covariance, new_start);
  MoveOutOfView(out_of_view,
                problem,
                equations,
                std::move(covariance),
                !inactive_.empty() && (activated || num_solves_ % kInactivePeriod == 0));
  Marginalise(new_start);
  if (num_solves_ % kInactiveAfter == 0) DeactivateLandmarks();
  return newest_poses;
}

void Window::LearnMotion(const NormalEquations& equations,
                         const Eigen::MatrixXd& covariance,
                         int new_start) {
  const Trajectory& trajectory = state_->trajectory;
  const double per_s2 = 1.0 / (trajectory.knot_interval_s() * trajectory.knot_interval_s());
  const MotionNoise& noise = motion_prior_->usual();
  const MotionPersistence linear = noise.LinearPersistence(trajectory.knot_interval_s());
  const MotionPersistence angular = {
      Eigen::Vector3d::Ones(),
      Eigen::Vector3d::Constant(noise.Persistence(trajectory.knot_interval_s()))};
  const auto variance_of = [&](BlockId::Kind kind, int first) {
    const MotionPersistence& persistence = kind == BlockId::Kind::kRotation ? angular : linear;
    // Derivative of an innovation by the four control points, by axis.
    const Eigen::Array3d v = persistence.velocity;
    const Eigen::Array3d a = persistence.acceleration;
    Eigen::Array<double, 3, 4> weights;
    weights << -a * v, v + a * (1.0 + v), -(1.0 + v) - a, Eigen::Array3d::Ones();
    weights *= per_s2;
    const std::vector<int> rows = RowsOf(equations, [&](const BlockId& block) {
      return block.kind == kind && block.index >= first && block.index < first + 4;
    });
    // Rotations of a rig that moves in the plane have one row, yaw.
    const auto size = static_cast<Eigen::Index>(rows.size()) / 4;
    Eigen::Vector3d variance = Eigen::Vector3d::Zero();
    for (Eigen::Index axis = 0; axis < size; ++axis) {
      const std::vector<int> of_axis = {rows[static_cast<size_t>(axis)],
                                        rows[static_cast<size_t>(size + axis)],
                                        rows[static_cast<size_t>(2 * size + axis)],
                                        rows[static_cast<size_t>(3 * size + axis)]};
      const Eigen::Index row = 3 - size + axis;
      const Eigen::Vector4d weight = weights.row(row).matrix();
      variance[row] = weight.dot(covariance(of_axis, of_axis) * weight);
    }
    return variance;
  };
  for (int i = start_; i < new_start; ++i) {
    motion_prior_->Learn(trajectory,
                         i,
                         variance_of(BlockId::Kind::kPosition, i),
                         variance_of(BlockId::Kind::kRotation, i));
  }
}

PoseGaussian Window::NewestPoses(const NormalEquations& equations, int newest) const {
  std::vector<int> order = RowsOf(equations, [&](const BlockId& block) {
    return (IsControlPoint(block) && block.index < newest) || IsBias(block);
  });
  const auto num_older = static_cast<Eigen::Index>(order.size());
  const std::vector<int> newest_rows = RowsOf(equations, [&](const BlockId& block) {
    return IsControlPoint(block) && block.index >= newest;
  });
  order.insert(order.end(), newest_rows.begin(), newest_rows.end());
  const std::optional<Elimination> older =
      Elimination::Make(equations.hessian(order, order),
                        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(order.size())),
                        num_older);
  if (!older) throw Error(kNotDetermined);
  return PosesFrom(equations, older->hessian(), state_->trajectory, newest);
}

void Window::KeepEstimate(const NormalEquations& equations, int newest, int64_t now_ns) {
  const Eigen::MatrixXd covariance =
      InverseOn(equations, RowsOf(equations, [](const BlockId&) { return true; }));
  const std::vector<int> newest_rows = RowsOf(equations, [&](const BlockId& block) {
    return IsControlPoint(block) && block.index >= newest;
  });
  const std::vector<int> rows = RowsInPoses(equations, newest);
  const int size = 6 * (state_->trajectory.num_control_points() - newest);
  Eigen::MatrixXd of_poses = Eigen::MatrixXd::Zero(size, size);
  of_poses(rows, rows) = covariance(newest_rows, newest_rows);
  WindowEstimate estimate;
  estimate.newest_pose = {now_ns, state_->trajectory.WorldFromBody(now_ns)};
  estimate.pose_covariance =
      PoseUncertainty(newest, std::move(of_poses)).At(state_->trajectory, now_ns);
  for (const BlockId& block : equations.blocks) {
    if (IsLandmark(block)) estimate.landmark_ids.push_back(block.index);
  }
  const std::vector<int> landmark_rows = RowsOf(equations, IsLandmark);
  estimate.landmark_covariance = covariance(landmark_rows, landmark_rows);
  if (!estimates_.empty()) {
    estimates_.back().landmark_ids.clear();
    estimates_.back().landmark_covariance.resize(0, 0);
  }
  estimates_.push_back(std::move(estimate));
}

namespace {

// The observations, of those with these indices, that begin before a knot interval; staying
// receives the indices of the others.
std::vector<const Observation*> ObservationsBefore(int knot_interval,
                                                   const MapState& state,
                                                   const std::vector<int>& indices,
                                                   std::vector<int>* staying) {
  std::vector<const Observation*> before;
  for (const int index : indices) {
    const Observation& observation = state.observations[static_cast<size_t>(index)];
    const int first =
        state.trajectory.Locate(observation.measurement.node_times_ns()[0]).first;
    if (first >= knot_interval) {
      staying->push_back(index);
    } else {
      before.push_back(&observation);
    }
  }
  return before;
}

}  // namespace

void Window::Marginalise(int new_start) {
  if (new_start <= start_) return;
  EstimationProblem leaving(
      rig_, planar_, &state_->trajectory, &state_->landmarks, &state_->calibration);
  if (start_ == 0) AddStart(&leaving);
  AddMotionPriors(&leaving, FirstMotionPrior(), new_start);
  AddOdometry(*state_, start_, new_start, &leaving);
  AddImu(*state_, start_, new_start, 1, &leaving);
  std::vector<int> staying;
  const std::vector<const Observation*> gone =
      ObservationsBefore(new_start, *state_, window_, &staying);
  leaving.AddSegments(gone, options_.association.huber_width, &groups_);
  AddPoseConstraints(new_start, &leaving);
  NormalEquations added = LineariseDense(leaving, leaving.Layout());
  EquationsToAnchored(state_->landmarks, &added);
  groups_.ForgetBefore(new_start);

  // The marginal prior's gradient where its blocks stand now.
  NormalEquations& past = prior_.equations;
  Eigen::VectorXd moved(past.size());
  for (size_t i = 0; i < past.blocks.size(); ++i) {
    moved.segment(past.offsets[i], BlockSize(past, i)) = Moved(leaving, i);
  }
  past.gradient += past.hessian * moved;
  inactive_.Rebase(prior_, moved);

  std::map<BlockId, int> sizes;
  for (const BlockId& block : past.blocks)
    sizes[block] = leaving.unknowns().TangentSize(block);
  for (const BlockId& block : added.blocks)
    sizes[block] = leaving.unknowns().TangentSize(block);
  NormalEquations all = ZeroSystem(sizes);
  AddTo(past, past.blocks, &all);
  AddTo(added, added.blocks, &all);
  // Control points that inactive landmarks depend on stay, as retained control points.
  const auto leaves = [&](const BlockId& block) {
    return IsBefore(block, new_start) && !inactive_.DependsOn(block);
  };
  std::vector<int> order = RowsOf(all, leaves);
  const auto num_leaving = static_cast<Eigen::Index>(order.size());
  const std::vector<int> rows =
      RowsOf(all, [&](const BlockId& block) { return !leaves(block); });
  order.insert(order.end(), rows.begin(), rows.end());
  const std::optional<Elimination> rest =
      Elimination::Make(all.hessian(order, order), all.gradient(order), num_leaving);
  if (!rest) throw Error(kNotDetermined);
  past.blocks.clear();
  past.offsets.assign(1, 0);
  prior_.at.clear();
  for (size_t i = 0; i < all.blocks.size(); ++i) {
    const BlockId& block = all.blocks[i];
    if (leaves(block)) continue;
    past.blocks.push_back(block);
    past.offsets.push_back(past.offsets.back() + BlockSize(all, i));
    if (IsLandmark(block)) {
      prior_.at.push_back(
          AnchoredParameters(state_->landmarks[static_cast<size_t>(block.index)]));
      continue;
    }
    prior_.at.emplace_back(Eigen::Map<const Eigen::VectorXd>(
        leaving.unknowns().Data(block), leaving.unknowns().AmbientSize(block)));
  }
  past.hessian = rest->hessian();
  past.gradient = rest->gradient();
  window_ = std::move(staying);
  MoveStart(new_start);
}

void Window::MoveStart(int new_start) {
  start_ = new_start;
  const std::deque<PoseConstraint>& constraints = state_->pose_constraints;
  while (first_constraint_ < constraints.size() &&
         state_->trajectory.Locate(constraints[first_constraint_].time_ns).first < start_) {
    ++first_constraint_;
  }
}

void Window::MergeLandmarks(int into, int from) {
  std::set<int> activated_ids;
  for (const int id : {into, from}) {
    if (inactive_.Contains(id)) activated_ids.insert(id);
  }
  inactive_.Activate(activated_ids, state_->landmarks, &prior_);
  for (const int id : activated_ids) last_in_view_[id] = num_solves_;
  if (FindBlock(prior_.equations, LandmarkBlock(from)) == prior_.equations.blocks.size()) {
    return;
  }
  const Landmark& landmark = state_->landmarks[static_cast<size_t>(into)];
  const Reanchoring moved =
      MergePlanes(landmark, state_->landmarks[static_cast<size_t>(from)], &prior_);
  inactive_.Merge(into, from, moved.shift, moved.by_into, landmark.heading_fixed);
}

}  // namespace plumbline

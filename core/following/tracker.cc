#include "core/following/tracker.h"

#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/estimation/imu_terms.h"
#include "core/estimation/linearisation.h"
#include "core/estimation/odometry_terms.h"
#include "core/estimation/pose_prior.h"
#include "core/following/scan_on_planes.h"
#include "core/geometry/matrix_types.h"
#include "core/trajectory/pose_gaussian.h"
#include "core/util/error.h"
#include "core/util/quantiles.h"
#include "core/util/time.h"
#include "factors/linear_algebra/symmetric_inverse.h"
#include "factors/spline/so3.h"

namespace plumbline {
namespace {

constexpr int kMaxRounds = 4;
// A step that lowers the cost by less than this share of it is the last one.
constexpr SolverOptions kSolverOptions = {4, 1e-4, 0.0};
// Knot intervals after an unsteady scan in which the window's estimate of the newest control
// points is not trusted: until the spline is no longer held by the scans before.
constexpr int kLooseIntervals = 2;
// A share of associated segments (by length) that drops below this part of the usual one.
constexpr double kSuddenDrop = 0.6;
constexpr double kShareGain = 0.1;
// Points hold the pose where more than this share of them is on no plane.
constexpr double kMaxShareOnNoPlane = 0.25;
// Share of a scan's points that the local map has to know to tell how the rig moved.
constexpr double kMinKnownShare = 0.3;
// Planes that take this share of the points from where the local map has them are not those of
// the scan.
constexpr double kMaxLoss = 0.1;
// Lever over which a bend of the local map turns the rig.
constexpr double kPointsLever = 4.0;  // m

// In empty rooms more than nine tenths of the segments, by length, have planes, in a room of
// furniture three quarters and at times a quarter.
constexpr double kGoodShare = 0.9;

}  // namespace

Tracker::Tracker(const Rig& rig,
                 bool planar,
                 const MapperOptions& options,
                 MotionPrior* motion_prior,
                 MapState* state)
    : rig_(rig),
      planar_(planar),
      options_(options),
      motion_prior_(motion_prior),
      state_(state),
      solver_(MakeWindowSolver(options.window.solver, kSolverOptions)),
      usual_share_(motion_prior->start() ? 0.0 : 1.0) {}

Tracker::Tracker(const Tracker& other,
                 const Rig& rig,
                 MotionPrior* motion_prior,
                 MapState* state)
    : rig_(rig),
      planar_(other.planar_),
      options_(other.options_),
      motion_prior_(motion_prior),
      state_(state),
      solver_(MakeWindowSolver(other.options_.window.solver, kSolverOptions)),
      gaussian_(other.gaussian_),
      prior_(other.prior_),
      recent_(other.recent_),
      pose_uncertainty_(other.pose_uncertainty_),
      loose_until_ns_(other.loose_until_ns_),
      scan_s_(other.scan_s_),
      last_scan_ns_(other.last_scan_ns_),
      bridges_by_motion_(other.bridges_by_motion_),
      is_open_(other.is_open_),
      is_height_open_(other.is_height_open_),
      last_held_ns_(other.last_held_ns_),
      thin_evidence_(other.thin_evidence_),
      needs_points_(other.needs_points_),
      usual_share_on_no_plane_(other.usual_share_on_no_plane_),
      usual_share_(other.usual_share_) {}

std::vector<int> Tracker::FreeRows(Eigen::Index size) const {
  std::vector<int> rows;
  for (int row = 0; row < static_cast<int>(size); ++row) {
    const int component = row % kPoseSize;  // 0, 1: roll, pitch; 5: height
    if (planar_ && (component < 2 || component == 5)) continue;
    rows.push_back(row);
  }
  return rows;
}

Eigen::MatrixXd Tracker::Covariance(const Eigen::MatrixXd& information) const {
  const std::vector<int> rows = FreeRows(information.rows());
  std::optional<Eigen::MatrixXd> inverse =
      planar_ ? SymmetricInverse(information(rows, rows)) : SymmetricInverse(information);
  if (!inverse) throw Error("the scans do not determine the pose");
  if (!planar_) return std::move(*inverse);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(information.rows(), information.cols());
  covariance(rows, rows) = *inverse;
  return covariance;
}

EstimationProblem Tracker::MakeProblem() const {
  EstimationProblem problem(
      rig_, planar_, &state_->trajectory, &state_->landmarks, &state_->calibration);
  problem.HoldLandmarks();
  problem.HoldControlPointsBefore(first());
  problem.AddPrior(prior_);
  const bool at_start = gaussian_.mean.empty();
  if (at_start) {
    problem.AddStartVelocityPrior(options_.trajectory);
    problem.AddOrigin(state_->origin_time_ns);
    if (motion_prior_->start()) {
      AddGravityStart(*motion_prior_->start(), state_->trajectory, &problem);
    }
  }
  // The Gaussian carries the priors between the control points that it has.
  const int known = at_start ? 0 : gaussian_.end();
  const int end = state_->trajectory.num_control_points();
  for (int i = std::max(first(), known - 2); i + 2 < end; ++i) {
    problem.AddMotionPrior(i, motion_prior_->At(i));
  }
  const int first_interval = std::max(first(), known - kSplineOrder + 1);
  AddOdometryByKnots(*state_, first_interval, end - kSplineOrder + 1, &problem);
  if (state_->calibration.imu) state_->calibration.imu->ExtendTo(end - kSplineOrder + 1);
  // Until the window is solved again, biases err alike.
  const double per_step = options_.window.step_s / state_->trajectory.knot_interval_s();
  AddImu(*state_,
         first_interval,
         end - kSplineOrder + 1,
         std::max(1, static_cast<int>(kImuMeansPerInterval * per_step)),
         &problem);
  return problem;
}

void Tracker::FollowOwnMotion() {
  const Trajectory& trajectory = state_->trajectory;
  const bool knows_motion = state_->odometry != nullptr || state_->imu != nullptr;
  if (!knows_motion || gaussian_.end() == trajectory.num_control_points()) return;
  PlaceByWheels();
  EstimationProblem problem = MakeProblem();
  solver_->Solve(&problem);
}

void Tracker::PlaceByWheels() {
  Trajectory& trajectory = state_->trajectory;
  const int known = gaussian_.end();
  if (state_->odometry == nullptr || known == 0 ||
      trajectory.num_control_points() - known <= kSplineOrder) {
    return;
  }
  for (int i = known; i < trajectory.num_control_points(); ++i) {
    // A control point acts most in the middle of the four intervals that it reaches.
    const int64_t time_ns = trajectory.start_ns() + (i - 1) * trajectory.knot_interval_ns();
    const std::optional<PlanarMotion> stated =
        state_->odometry->Between(time_ns - trajectory.knot_interval_ns(), time_ns);
    if (!stated) return;
    const OdometryMeasurement motion = state_->odometry_calibration.Measure(*stated);
    const ControlPoint& before = trajectory.control_point(i - 1);
    ControlPoint& point = trajectory.control_point(i);
    const Eigen::Quaterniond rotation(before.rotation.data());
    Eigen::Map<Eigen::Quaterniond>(point.rotation.data()) =
        rotation * Exp(Eigen::Vector3d(0.0, 0.0, motion.turn));
    Eigen::Map<Eigen::Vector3d>(point.position.data()) =
        Eigen::Map<const Eigen::Vector3d>(before.position.data()) +
        rotation * Eigen::Vector3d(motion.translation.x(), motion.translation.y(), 0.0);
  }
}

PoseGaussian Tracker::Predict() const {
  const EstimationProblem problem = MakeProblem();
  const NormalEquations equations = LineariseDense(problem, problem.Layout());
  return PosesFrom(equations, equations.hessian, state_->trajectory, first());
}

PoseGaussian Tracker::Estimate(int first_observation,
                               int last_observation,
                               const std::vector<PoseConstraint>& constraints) {
  std::vector<const Observation*> associated;
  const auto add = [&](int index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    if (observation.landmark_id >= 0) associated.push_back(&observation);
  };
  for (const int index : recent_) add(index);
  for (int index = first_observation; index <= last_observation; ++index) add(index);
  EstimationProblem problem = MakeProblem();
  problem.AddSegments(associated, options_.association.huber_width);
  for (const PoseConstraint& constraint : constraints) problem.AddPoseConstraint(constraint);
  const NormalEquations equations = solver_->Solve(&problem);
  return PosesFrom(equations, equations.hessian, state_->trajectory, first());
}

void Tracker::Reset(int64_t now_ns, PoseGaussian gaussian) {
  gaussian_ = std::move(gaussian);
  recent_.clear();
  if (now_ns < loose_until_ns_) Loosen();
  prior_ = PosePrior(gaussian_, planar_);
  pose_uncertainty_ = PoseUncertainty(first(), Covariance(Predict().information));
}

bool Tracker::FollowsWell(int64_t now_ns) const {
  return usual_share_ > kGoodShare && IsSteady(now_ns);
}

double Tracker::UnsteadyScale() const {
  // What is given for any rig allows for its turns already.
  return options_.trajectory.estimate_densities ? 10.0 : 1.0;
}

Matrix6d Tracker::UnsteadyCovariance(double scale, double duration_s) const {
  // White acceleration of density q, integrated twice: q^2 T^3 / 3. The body is taken to be
  // upright.
  const double times = scale * std::sqrt(duration_s * duration_s * duration_s / 3.0);
  const ByMotionKind& density = motion_prior_->usual().density;
  constexpr MotionKind kKinds[] = {kTilt, kTilt, kYaw, kHorizontal, kHorizontal, kVertical};
  Matrix6d covariance = Matrix6d::Zero();
  for (const int row : FreeRows(kPoseSize)) {
    const double sigma = times * density[kKinds[row]];
    covariance(row, row) = sigma * sigma;
  }
  return covariance;
}

Matrix6d Tracker::PointsCovariance() const {
  const double position = options_.points.surface_stddev_m;
  const double rotation = position / kPointsLever;
  Matrix6d covariance = Matrix6d::Zero();
  for (const int row : FreeRows(kPoseSize)) {
    const double sigma = row < 3 ? rotation : position;
    covariance(row, row) = sigma * sigma;
  }
  return covariance;
}

void Tracker::Loosen() {
  const Matrix6d of_control_point = UnsteadyCovariance(
      UnsteadyScale(), std::max(state_->trajectory.knot_interval_s(), scan_s_));
  Eigen::MatrixXd covariance = Covariance(gaussian_.information);
  for (Eigen::Index row = 0; row < covariance.rows(); row += kPoseSize) {
    covariance.block<6, 6>(row, row) += of_control_point;
  }
  gaussian_.information = Covariance(covariance);
}

bool Tracker::IsUndecided(int64_t now_ns) const {
  return is_open_ && SecondsBetween(last_held_ns_, now_ns) < options_.tracking.max_undecided_s;
}

std::optional<ScanMatch> Tracker::EstimateByPoints(const ScanMatcher& scan_matcher) {
  ScanMatch match = scan_matcher.Register(
      state_->trajectory,
      pose_uncertainty_.AtBoth(
          state_->trajectory, scan_matcher.begin_ns(), scan_matcher.end_ns()));
  if (match.KnownShare() < kMinKnownShare || match.NearShare() < kMinNearShare) {
    return std::nullopt;
  }
  const PoseGaussian estimate = Estimate(0, -1, match.constraints);
  pose_uncertainty_ = PoseUncertainty(first(), Covariance(estimate.information));
  return match;
}

bool Tracker::WheelsDeny(const Rigid3d& predicted,
                         const Matrix6d& covariance,
                         int64_t scan_end_ns) const {
  if (scan_s_ == 0.0 ||
      !state_->odometry->Covers(scan_end_ns - NanosecondsFromSeconds(scan_s_), scan_end_ns)) {
    return false;
  }
  const Rigid3d estimated = state_->trajectory.WorldFromBody(scan_end_ns);
  const Eigen::Vector3d shift = estimated.translation - predicted.translation;
  const Eigen::Vector3d error(
      Log(estimated.rotation * predicted.rotation.conjugate()).z(), shift.x(), shift.y());
  const Eigen::Matrix3d in_plane = covariance.block<3, 3>(2, 2);
  return error.dot(in_plane.ldlt().solve(error)) > Chi2Quantile(3, kSignificantStddevs);
}

std::optional<ScanMatch> Tracker::SearchElsewhere(const ScanMatcher& scan_matcher,
                                                  const Rigid3d& predicted,
                                                  int64_t scan_end_ns) const {
  // Where nearly all points that the local map knows lie well, they hardly can elsewhere.
  const ScanMatch here = scan_matcher.Match(state_->trajectory, 0, nullptr);
  if (here.KnownShare() > kMinKnownShare && here.NearShare() > 1.0 - kMaxLoss) {
    return std::nullopt;
  }
  const Rigid3d correction =
      predicted * state_->trajectory.WorldFromBody(scan_end_ns).Inverse();
  ScanMatch match = scan_matcher.Search(state_->trajectory, correction, SearchWindow());
  VLOG(1) << "search at " << SecondsBetween(state_->origin_time_ns, scan_end_ns)
          << " s: " << correction.translation.transpose() << " m "
          << Log(correction.rotation).z() * 180.0 / M_PI << " deg; near " << here.num_near
          << " against " << match.num_near << " of " << match.num_known << " known of "
          << match.num_points;
  if (match.KnownShare() < kMinKnownShare || match.NearShare() < kMinNearShare ||
      here.num_near > (1.0 - kMaxLoss) * match.num_near) {
    return std::nullopt;
  }
  return match;
}

bool Tracker::AgreesWithPoints(const ScanMatcher& scan_matcher,
                               const ScanMatch& by_points) const {
  const ScanMatch match = scan_matcher.Match(state_->trajectory, 0, nullptr);
  return match.num_near > (1.0 - kMaxLoss) * by_points.num_near;
}

bool Tracker::AssociatePredicted(int first_observation,
                                 int last_observation,
                                 const LandmarksWithinGap& landmarks,
                                 bool by_points,
                                 bool* unsteady) {
  const Association association =
      AssociateJointly(first_observation, last_observation, landmarks, by_points);
  for (const auto& [index, id] : association.chosen) {
    state_->observations[static_cast<size_t>(index)].landmark_id = id;
  }
  double length_m = 0.0;
  for (int index = first_observation; index <= last_observation; ++index) {
    length_m += state_->observations[static_cast<size_t>(index)].length_m();
  }
  const double share = association.length_m / std::max(length_m, 1e-9);
  *unsteady = association.unsteady || (!by_points && share < kSuddenDrop * usual_share_);
  usual_share_ += kShareGain * (share - usual_share_);
  return !association.chosen.empty();
}

PoseGaussian Tracker::EstimateInRounds(int first_observation,
                                       int last_observation,
                                       const LandmarksWithinGap& landmarks,
                                       const ScanMatcher* scan_matcher,
                                       std::vector<PoseConstraint>* constraints,
                                       bool* unsteady) {
  PoseGaussian estimate;
  for (int round = 0; round < kMaxRounds; ++round) {
    // By the prediction first, all segments together; once the poses are known, one by one,
    // unless they are known not to describe the motion.
    bool changed = false;
    if (round == 0) {
      changed = AssociatePredicted(
          first_observation, last_observation, landmarks, scan_matcher != nullptr, unsteady);
    } else {
      changed = !*unsteady && Associate(first_observation, last_observation, landmarks);
    }
    if (!changed && round > 0) break;
    if (scan_matcher != nullptr) {
      const BeamMask on_no_plane =
          BeamsOnNoPlane(*state_, first_observation, last_observation, *scan_matcher);
      *constraints =
          scan_matcher
              ->Match(state_->trajectory, 0, PointsAlwaysHold() ? nullptr : &on_no_plane)
              .constraints;
    }
    estimate = Estimate(first_observation, last_observation, *constraints);
    pose_uncertainty_ = PoseUncertainty(first(), Covariance(estimate.information));
  }
  return estimate;
}

PoseGaussian Tracker::EstimateWithout(const std::vector<int>& left_out,
                                      int first_observation,
                                      int last_observation,
                                      const std::vector<PoseConstraint>& constraints) {
  for (const int index : left_out) {
    state_->observations[static_cast<size_t>(index)].landmark_id = -1;
  }
  PoseGaussian estimate = Estimate(first_observation, last_observation, constraints);
  pose_uncertainty_ = PoseUncertainty(first(), Covariance(estimate.information));
  return estimate;
}

bool Tracker::PointsAlwaysHold() const { return planar_ && state_->odometry == nullptr; }

bool Tracker::IsOpen(int first_observation, int last_observation) const {
  const double min_width_m = bridges_by_motion_ ? kLongWall : options_.planes.small_m;
  const double flatness_m = options_.association.surface_flatness_m;
  // All points or wheels hold the heading of a rig that moves in the plane.
  return planar_ ? WallsLeaveOpen(
                       *state_, first_observation, last_observation, min_width_m, flatness_m)
                 : WallsLeavePoseOpen(rig_,
                                      *state_,
                                      first_observation,
                                      last_observation,
                                      min_width_m,
                                      flatness_m);
}

bool Tracker::IsHeightOpen(int first_observation, int last_observation) const {
  return !planar_ && HeightIsOpen(*state_,
                                  first_observation,
                                  last_observation,
                                  options_.association.surface_flatness_m);
}

PoseGaussian Tracker::BridgeByMotion(int first_observation, int last_observation) {
  const int end = state_->trajectory.num_control_points();
  if (state_->imu == nullptr) motion_prior_->Bridge(end - kSplineOrder + 1, end);
  return EstimateWithout(
      OnNarrowPlanes(*state_, first_observation, last_observation, kLongWall),
      first_observation,
      last_observation,
      {});
}

void Tracker::LeaveToPoints(int first_observation,
                            int last_observation,
                            const ScanMatch& match,
                            ScanEstimate* estimate) {
  std::vector<int> all(static_cast<size_t>(last_observation - first_observation + 1));
  std::iota(all.begin(), all.end(), first_observation);
  estimate->constraints = match.constraints;
  estimate->gaussian =
      EstimateWithout(all, first_observation, last_observation, estimate->constraints);
  estimate->share_on_no_plane = 1.0;
}

Tracker::ScanEstimate Tracker::EstimateScan(int first_observation,
                                            int last_observation,
                                            const LandmarksWithinGap& landmarks,
                                            const ScanMatcher* scan_matcher,
                                            const std::optional<ScanMatch>& by_points,
                                            const std::pair<Rigid3d, Matrix6d>& wheels) {
  ScanEstimate estimate;
  estimate.gaussian = EstimateInRounds(first_observation,
                                       last_observation,
                                       landmarks,
                                       by_points ? scan_matcher : nullptr,
                                       &estimate.constraints,
                                       &estimate.unsteady);
  if (scan_matcher != nullptr) {
    estimate.share_on_no_plane = ShareOnNoPlane(
        *state_, first_observation, last_observation, scan_matcher->num_points());
  }
  if (by_points && options_.rules.points_over_planes &&
      !AgreesWithPoints(*scan_matcher, *by_points)) {
    // The planes would have the rig elsewhere: most of the scan says that they are others.
    LeaveToPoints(first_observation, last_observation, *by_points, &estimate);
  }
  if (scan_matcher == nullptr || scan_matcher->num_points() == 0 || !planar_ ||
      state_->odometry == nullptr) {
    return estimate;
  }
  // Wheels that slip in a turn are followed where the scan fits no plane any more.
  const bool denied = WheelsDeny(wheels.first, wheels.second, last_scan_ns_);
  if (!denied && !estimate.unsteady) return estimate;
  const auto match = SearchElsewhere(*scan_matcher, wheels.first, last_scan_ns_);
  // Against the wheels' word, most of the scan has to say so.
  if (match && (denied || match->num_near > kMinNearShare * match->num_points)) {
    Loosen();
    prior_ = PosePrior(gaussian_, planar_);
    LeaveToPoints(first_observation, last_observation, *match, &estimate);
  }
  return estimate;
}

void Tracker::Track(int first_observation,
                    int last_observation,
                    const LandmarksWithinGap& landmarks,
                    const ScanMatcher* scan_matcher) {
  const bool has_new_control_points =
      gaussian_.end() != state_->trajectory.num_control_points();
  if (!planar_ && !is_height_open_ && !gaussian_.mean.empty()) {
    motion_prior_->FollowHeight(state_->trajectory, gaussian_.end() - 1);
  }
  if (has_new_control_points) {
    pose_uncertainty_ = PoseUncertainty(first(), Covariance(Predict().information));
  }
  const int64_t scan_end_ns =
      state_->observations[static_cast<size_t>(last_observation)].end_time_ns();
  const Rigid3d by_wheels = state_->trajectory.WorldFromBody(scan_end_ns);
  const Matrix6d wheels_covariance = pose_uncertainty_.At(state_->trajectory, scan_end_ns);
  std::optional<ScanMatch> by_points;
  const bool bridges = bridges_by_motion_ && is_open_;
  if (scan_matcher != nullptr && needs_points_ && !bridges && scan_matcher->num_points() > 0)
    by_points = EstimateByPoints(*scan_matcher);
  const Eigen::Vector3d predicted = state_->trajectory.WorldFromBody(scan_end_ns).translation;
  const Matrix6d covariance = pose_uncertainty_.At(state_->trajectory, scan_end_ns);
  scan_s_ = last_scan_ns_ == 0 ? 0.0 : SecondsBetween(last_scan_ns_, scan_end_ns);
  last_scan_ns_ = scan_end_ns;
  ScanEstimate estimate = EstimateScan(first_observation,
                                       last_observation,
                                       landmarks,
                                       scan_matcher,
                                       by_points,
                                       {by_wheels, wheels_covariance});
  const std::vector<int> withheld =
      thin_evidence_.Withhold(*state_,
                              first_observation,
                              last_observation,
                              predicted,
                              covariance.bottomRightCorner<3, 3>(),
                              state_->trajectory.WorldFromBody(scan_end_ns).translation);
  if (options_.rules.thin_evidence && !withheld.empty()) {
    estimate.gaussian =
        EstimateWithout(withheld, first_observation, last_observation, estimate.constraints);
  }
  is_open_ = IsOpen(first_observation, last_observation);
  if (bridges_by_motion_ && is_open_) {
    estimate.constraints.clear();
    estimate.gaussian = BridgeByMotion(first_observation, last_observation);
  }
  usual_share_on_no_plane_ +=
      kShareGain * (estimate.share_on_no_plane - usual_share_on_no_plane_);
  is_height_open_ = IsHeightOpen(first_observation, last_observation);
  if (!is_open_) last_held_ns_ = scan_end_ns;
  needs_points_ =
      PointsAlwaysHold() || is_open_ || is_height_open_ ||
      std::max(estimate.share_on_no_plane, usual_share_on_no_plane_) > kMaxShareOnNoPlane;
  state_->pose_constraints.insert(state_->pose_constraints.end(),
                                  estimate.constraints.begin(),
                                  estimate.constraints.end());
  // The scan becomes part of the prior, so that the next scan's system is as small.
  gaussian_ = std::move(estimate.gaussian);
  recent_.clear();
  if (estimate.unsteady) {
    loose_until_ns_ = scan_end_ns + kLooseIntervals * state_->trajectory.knot_interval_ns();
    Loosen();
  }
  prior_ = PosePrior(gaussian_, planar_);
}

}  // namespace plumbline

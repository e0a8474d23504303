#include "core/following/scan_follower.h"

#include <glog/logging.h>
#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/association/association.h"
#include "core/association/model_frame.h"
#include "core/association/plane_merging.h"
#include "core/association/undecided_planes.h"
#include "core/estimation/odometry_terms.h"
#include "core/following/scan_on_planes.h"
#include "core/geometry/angles.h"
#include "core/geometry/matrix_types.h"
#include "core/map/map_frame.h"
#include "core/segmentation/segmentation.h"
#include "core/sensor/beam_instant.h"
#include "core/sensor/gravity.h"
#include "core/sensor/rig.h"
#include "core/sensor/scanner_motion.h"
#include "core/surface/landmark_view.h"
#include "core/util/error.h"
#include "core/util/time.h"
#include "core/visibility/resegmentation.h"

namespace plumbline {
namespace {

// Distance from a slope that their scan plane grazes within which traces found no wall: the
// accuracy of sloped planes at their far ends.
constexpr double kOnGrazed = 0.15;  // m

// A direction that no normal comes nearer to than a right angle less 20 degrees is open.
constexpr double kMinHeldSine = 0.34;

// Returns the part of a pose's covariance that concerns planes seen in the last scans.
Matrix6d Relative(const Matrix6d& covariance) {
  const double variance = covariance.bottomRightCorner<3, 3>().trace();
  return covariance * std::min(1.0, kUnheldStddev * kUnheldStddev / variance);
}

}  // namespace

ScanFollower::ScanFollower(const ScanFollower& other)
    : rig_(other.rig_),
      planar_(other.planar_),
      options_(other.options_),
      scan_period_s_(other.scan_period_s_),
      odometry_(other.odometry_),
      imu_(other.imu_),
      tentative_planes_(other.tentative_planes_),
      motion_prior_(other.motion_prior_),
      state_(std::make_unique<MapState>(*other.state_)),
      window_(std::make_unique<Window>(*other.window_, rig_, &motion_prior_, state_.get())),
      tracker_(std::make_unique<Tracker>(*other.tracker_, rig_, &motion_prior_, state_.get())),
      scan_matcher_(other.scan_matcher_ == nullptr
                        ? nullptr
                        : std::make_unique<ScanMatcher>(*other.scan_matcher_, rig_)),
      scan_times_ns_(other.scan_times_ns_),
      previous_ranges_(other.previous_ranges_),
      last_known_ns_(other.last_known_ns_),
      last_known_scan_(other.last_known_scan_),
      may_found_(other.may_found_),
      last_solved_interval_(other.last_solved_interval_),
      last_solved_scan_(other.last_solved_scan_),
      num_calibrated_(other.num_calibrated_),
      segmentation_watch_(other.segmentation_watch_) {}

ScannerMotion ScanFollower::PredictMotion(const ScanLine& scan_line) const {
  ScannerMotion motion;
  if (!started()) return motion;
  const int64_t time_ns = BeamInstant(scan_line, scan_line.num_beams() / 2, rig_);
  Eigen::Vector3d angular_world;
  Eigen::Vector3d linear_world;
  state_->trajectory.Velocity(time_ns, &angular_world, &linear_world);
  const Rigid3d world_from_body = state_->trajectory.WorldFromBody(time_ns);
  const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
  const Rigid3d body_from_scanner = scanner.BodyFromScanner(time_ns);
  const Eigen::Quaterniond scanner_from_world =
      (world_from_body.rotation * body_from_scanner.rotation).conjugate();
  const Eigen::Vector3d arm_world = world_from_body.rotation * body_from_scanner.translation;
  Eigen::Vector3d linear =
      scanner_from_world * (linear_world + angular_world.cross(arm_world));
  if (scanner.mount) {
    const Eigen::Vector3d turn_world =
        world_from_body.rotation *
        (scanner.mount->StatedAt(time_ns, scanner.delay_s).rate_rad_s * scanner.mount->axis);
    const Eigen::Vector3d from_axis_world =
        arm_world - world_from_body.rotation * scanner.mount->point;
    linear += scanner_from_world * turn_world.cross(from_axis_world);
    angular_world += turn_world;
  }
  motion.velocity_m_s = linear.head<2>();
  motion.yaw_rate_rad_s = (scanner_from_world * angular_world).z();
  return motion;
}

std::vector<Observation> ScanFollower::Observe(const Scan& scan) {
  const Stopwatch::Running running(&segmentation_watch_);
  const size_t num_lines = scan.scan_lines.size();
  std::vector<std::vector<Observation>> found(num_lines);
  tbb::parallel_for(size_t{0}, num_lines, [&](size_t i) {
    const ScanLine& scan_line = scan.scan_lines[i];
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(scan_line.scanner_index)];
    for (const Segment& segment : SegmentScanLine(
             scan_line, scanner, PredictMotion(scan_line), options_.segmentation)) {
      found[i].push_back(MakeObservation(
          scan_line, scanner, segment, options_.batch.factor == FactorKind::kPoint));
      found[i].back().scan_line_index = scan.scan_line_indices[i];
    }
  });
  std::vector<Observation> observations;
  for (std::vector<Observation>& line : found) {
    for (Observation& observation : line) {
      observation.scan_index = static_cast<int>(scan_times_ns_.size());
      observations.push_back(std::move(observation));
    }
  }
  return observations;
}

std::optional<ModelFrame> ScanFollower::FindFrame(const std::vector<Observation>& observations,
                                                  bool* sees_slopes) const {
  *sees_slopes = false;
  const std::optional<ModelFrame> frame = FindModelFrame(rig_, planar_, observations);
  if (!frame || planar_) return frame;
  // A level trace on a roof looks like a wall's until other traces show the roof.
  UndecidedPlanes planes(options_);
  for (size_t i = 0; i < observations.size(); ++i) {
    const Observation& observation = observations[i];
    const Scanner& scanner = rig_.scanners[static_cast<size_t>(observation.scanner_index)];
    const Rigid3d world_from_body{frame->world_from_body, Eigen::Vector3d::Zero()};
    const ObservationPoses poses(observation.measurement.node_times_ns(),
                                 {world_from_body, world_from_body, world_from_body},
                                 scanner);
    planes.Offer(
        observation,
        static_cast<int>(i),
        poses,
        MeasureLine(
            observation, poses, Matrix6d::Zero(), options_.association.surface_flatness_m));
  }
  const std::set<int> no_walls = planes.OnSlopes();
  *sees_slopes = !no_walls.empty();
  if (!*sees_slopes) return frame;
  const std::optional<ModelFrame> by_walls =
      FindModelFrame(rig_, planar_, observations, no_walls);
  return by_walls ? by_walls : frame;
}

bool ScanFollower::HoldsPosition() const {
  Eigen::Matrix3d normals = Eigen::Matrix3d::Zero();
  for (const Landmark& landmark : state_->landmarks) {
    // An arc's are those at its ends.
    const PatchExtent& extent = landmark.extent;
    for (const Eigen::Vector2d& at : {extent.min_corner(), extent.max_corner()}) {
      const Eigen::Vector3d normal = landmark.NormalNear(extent.ToWorld(at));
      normals += 0.5 * normal * normal.transpose();
    }
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(normals, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()[0] > kMinHeldSine * kMinHeldSine;
}

void ScanFollower::MakeMap(const Scan& scan,
                           const Eigen::Quaterniond& world_from_body,
                           std::optional<int64_t> knot_ns) {
  const double interval_s = std::max(options_.trajectory.knot_interval_s,
                                     options_.trajectory.min_scans_per_knot * scan_period_s_);
  // Later scan lines may lie before this one by their scanners' time offsets.
  double earliest_s = 0.0;
  for (const Scanner& scanner : rig_.scanners) {
    earliest_s = std::min(earliest_s, 2.0 * scanner.time_offset_s);
  }
  const int64_t interval_ns = NanosecondsFromSeconds(interval_s);
  int64_t start_ns = scan.start_ns + NanosecondsFromSeconds(earliest_s);
  if (knot_ns) start_ns -= (start_ns - *knot_ns) % interval_ns;
  Trajectory trajectory(start_ns, interval_ns, {world_from_body, Eigen::Vector3d::Zero()});
  state_ = std::make_unique<MapState>(MapState{trajectory, {}, {}, scan.start_ns, {}});
  state_->odometry = odometry_;
  state_->odometry_calibration = OdometryCalibration(options_.odometry);
  state_->calibration = RigCalibration(rig_, planar_);
  if (imu_ != nullptr) {
    state_->imu = imu_;
    state_->calibration.imu.emplace(*rig_.imu, planar_, interval_s);
  }
  state_->trajectory.ExtendTo(scan.end_ns);
  window_ = std::make_unique<Window>(rig_, planar_, options_, &motion_prior_, state_.get());
  tracker_ = std::make_unique<Tracker>(rig_, planar_, options_, &motion_prior_, state_.get());
  if (options_.points.hold_pose) {
    scan_matcher_ =
        std::make_unique<ScanMatcher>(rig_, planar_, options_.points, scan_period_s_);
  }
  last_known_ns_ = scan.end_ns;
}

bool ScanFollower::StartByGravity(const Scan& scan, std::optional<int64_t> knot_ns) {
  if (imu_ == nullptr || planar_ || Observe(scan).empty()) return false;
  // What the options say of any rig: those here leave the motion to the IMU.
  const std::optional<UpDirection> up =
      FindUp(*imu_, *rig_.imu, scan.start_ns, TrajectoryOptions().acceleration_density_m_s2);
  if (!up) return false;
  GravityStart start;
  start.time_ns = scan.start_ns;
  start.world_from_body =
      Eigen::Quaterniond::FromTwoVectors(up->up_body, Eigen::Vector3d::UnitZ());
  start.tilt_stddev_rad = up->stddev_rad;
  motion_prior_.set_start(start);
  MakeMap(scan, start.world_from_body, knot_ns);
  try {
    Follow(scan);
  } catch (const LostTrack&) {
    return false;
  }
  return true;
}

bool ScanFollower::Start(const Scan& scan, bool must_hold, std::optional<int64_t> knot_ns) {
  std::vector<Observation> observations = Observe(scan);
  bool sees_slopes = false;
  const std::optional<ModelFrame> frame = FindFrame(observations, &sees_slopes);
  if (!frame) return false;
  must_hold = must_hold && sees_slopes;
  MakeMap(scan, frame->world_from_body, knot_ns);
  if (scan_matcher_ != nullptr) {
    scan_matcher_->Take(scan);
    scan_matcher_->Remember(state_->trajectory, true);
  }
  scan_times_ns_.push_back(scan.start_ns);
  for (Observation& observation : observations) {
    state_->observations.push_back(std::move(observation));
  }
  poses_.emplace(rig_, state_->trajectory);
  // One scan must do for a start: its segments become planes at once, the first wall first.
  const int reference = frame->reference_observation;
  const auto offer = [&](int index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    tentative_planes_.Offer(
        observation, index, poses_->Of(observation), Matrix6d::Zero(), index == reference);
  };
  offer(reference);
  const int num_observations = static_cast<int>(state_->observations.size());
  for (int index = 0; index < num_observations; ++index) {
    if (index != reference) offer(index);
  }
  StartPlanes(1, must_hold ? 2 : 1);
  const bool has_reference =
      state_->observations[static_cast<size_t>(reference)].landmark_id == 0;
  // Other traces may show that what looked like the reference wall is a slope.
  if (!has_reference || !TraitsOf(state_->landmarks.front()).has_heading) return false;
  if (must_hold && !HoldsPosition()) return false;
  Landmark& first_wall = state_->landmarks.front();
  first_wall.heading_fixed = true;
  first_wall.parameters[0] = 0.0;
  SolveWindow(scan.end_ns);
  return true;
}

void ScanFollower::Accept(int observation_index, bool tracked) {
  const Observation& observation =
      state_->observations[static_cast<size_t>(observation_index)];
  CountObservation(observation, poses_->Of(observation), state_.get());
  window_->Add(observation_index);
  if (!tracked) tracker_->Add(observation_index);
}

void ScanFollower::Judge(const Observation& observation) {
  Landmark& landmark = state_->landmarks[static_cast<size_t>(observation.landmark_id)];
  if (landmark.IsJudged()) return;
  for (const Hypothesis& on : HypothesesOf(
           observation,
           poses_->Of(observation),
           tracker_->pose_uncertainty().At(state_->trajectory, observation.middle_time_ns()),
           {LandmarkView(landmark)},
           options_.association)) {
    landmark.Judge(on.distance2);
  }
}

void ScanFollower::AddLandmark(TentativePlane plane) {
  plane.landmark.id = static_cast<int>(state_->landmarks.size());
  state_->landmarks.push_back(std::move(plane.landmark));
  for (const int index : plane.observations) {
    state_->observations[static_cast<size_t>(index)].landmark_id = state_->landmarks.back().id;
    Accept(index, false);
  }
}

bool ScanFollower::IsRedundantPlane(const TentativePlane& plane) const {
  const int scan_index = static_cast<int>(scan_times_ns_.size()) - 1;
  return std::any_of(
      state_->landmarks.begin(), state_->landmarks.end(), [&](const Landmark& landmark) {
        return landmark.num_segments > 0 &&
               IsWithinGap(landmark, scan_index, options_.loop_closure) &&
               IsRedundant(plane.landmark, landmark, MaxRangeNoise(rig_));
      });
}

void ScanFollower::StartPlanes(int min_scans, int min_scanners) {
  const bool needs_age =
      min_scans > 1 && (scan_matcher_ == nullptr || scan_matcher_->SeesMotion());
  for (TentativePlane& plane :
       tentative_planes_.TakeReady(min_scans, needs_age, min_scanners)) {
    // An observation that served two tentative planes belongs to the one that came first.
    const auto is_taken = [&](int index) {
      return state_->observations[static_cast<size_t>(index)].landmark_id >= 0;
    };
    std::vector<int>& indices = plane.observations;
    indices.erase(std::remove_if(indices.begin(), indices.end(), is_taken), indices.end());
    if (static_cast<int>(indices.size()) < min_scans || IsRedundantPlane(plane)) continue;
    AddLandmark(std::move(plane));
  }
}

void ScanFollower::SolveWindow(int64_t now_ns) {
  const double window_s = options_.window.num_scans * scan_period_s_;
  PoseGaussian newest = window_->Solve(now_ns, window_s);
  state_->calibration.ApplyTo(&rig_);
  tracker_->Reset(now_ns, std::move(newest));
  // Poses that have left the window will not change before the batch.
  Calibrate(*state_, num_calibrated_, window_->start(), &state_->odometry_calibration);
  num_calibrated_ = window_->start();
  for (const auto& [into, from] : FindMergeable(rig_, *state_, options_, last_solved_scan_)) {
    const Landmark& older = state_->landmarks[static_cast<size_t>(into)];
    // Cylinders wait for the batch: the marginal prior can not take them to another anchor.
    if (older.num_segments == 0 || older.IsCurved()) continue;
    if (!MayBeTakenUp(older, last_solved_scan_, options_.loop_closure)) continue;
    window_->MergeLandmarks(into, from);
    MergeInto(into, from, state_.get());
  }
  last_solved_interval_ = state_->trajectory.Locate(now_ns).first;
  last_solved_scan_ = static_cast<int>(scan_times_ns_.size()) - 1;
}

void ScanFollower::FaceWall() {
  if (!motion_prior_.start()) return;
  TurnToWall(rig_, state_.get());
  window_->ForgetEstimates();
}

void ScanFollower::BridgeByMotion(int64_t now_ns) {
  std::vector<bool> is_narrow;
  for (const Landmark& landmark : state_->landmarks) {
    is_narrow.push_back(!landmark.heading_fixed && IsNarrowWall(landmark, kLongWall));
  }
  window_->TakeBack(is_narrow);
  if (imu_ == nullptr) {
    motion_prior_.Bridge(window_->start(), state_->trajectory.num_control_points());
  }
  tracker_->set_bridges_by_motion(true);
  may_found_ = false;
  SolveWindow(now_ns);
}

void ScanFollower::EndBridging() {
  tracker_->set_bridges_by_motion(false);
  may_found_ = true;
}

void ScanFollower::CheckNotLost(int64_t now_ns) {
  const Matrix6d covariance = tracker_->pose_uncertainty().At(state_->trajectory, now_ns);
  const double rotation = std::sqrt(covariance.topLeftCorner<3, 3>().trace());
  // The motion prior bridges one open direction, as along a smooth corridor.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance.bottomRightCorner<3, 3>(), Eigen::EigenvaluesOnly);
  const double position = std::sqrt(solver.eigenvalues().head<2>().sum());
  if (position < options_.tracking.lost_position_m &&
      rotation < kRadiansPerDegree * options_.tracking.lost_rotation_deg) {
    last_known_ns_ = now_ns;
    last_known_scan_ = scan_times_ns_.size() - 1;
    return;
  }
  // A few blind scans may be bridged, just as missing ones; and any number while wheels say
  // how the rig goes, to what they know of it.
  if (SecondsBetween(last_known_ns_, now_ns) < options_.max_gap_s) return;
  if (planar_ && odometry_ != nullptr && odometry_->Covers(last_known_ns_, now_ns)) return;
  char text[200];
  std::snprintf(text,
                sizeof(text),
                "lost track of the rig %.3f s after the start of the map: the planes in view "
                "leave its pose open by %.2f m and %.1f deg",
                SecondsBetween(state_->origin_time_ns, last_known_ns_),
                position,
                rotation * 180.0 / M_PI);
  throw LostTrack(text);
}

void ScanFollower::Follow(const Scan& scan) {
  try {
    FollowWhileKnown(scan);
  } catch (const LostTrack&) {
    throw;
  } catch (const std::runtime_error& error) {
    // The estimate broke down before the pose's covariance told.
    throw LostTrack("lost track of the rig " +
                    FormatSeconds(SecondsBetween(state_->origin_time_ns, last_known_ns_)) +
                    " after the start of the map: " + error.what());
  }
}

void ScanFollower::EndAtLastKnown() {
  scan_times_ns_.resize(last_known_scan_ + 1);
  std::deque<Observation>& observations = state_->observations;
  while (!observations.empty() &&
         observations.back().scan_index > static_cast<int>(last_known_scan_)) {
    observations.pop_back();
  }
  std::deque<PoseConstraint>& constraints = state_->pose_constraints;
  while (!constraints.empty() && constraints.back().time_ns > last_known_ns_) {
    constraints.pop_back();
  }
  state_->trajectory.ShrinkTo(last_known_ns_);
  RebuildLandmarks(rig_, state_.get());
}

Scan ScanFollower::WithoutRepetitions(const Scan& scan) {
  Scan kept = scan;
  previous_ranges_.resize(rig_.scanners.size());
  for (ScanLine& scan_line : kept.scan_lines) {
    std::vector<float>& previous =
        previous_ranges_[static_cast<size_t>(scan_line.scanner_index)];
    const bool repeats = scan_line.ranges == previous;
    previous = scan_line.ranges;
    if (!repeats) continue;
    std::fill(scan_line.ranges.begin(),
              scan_line.ranges.end(),
              std::numeric_limits<float>::infinity());
  }
  return kept;
}

void ScanFollower::FollowWhileKnown(const Scan& recorded) {
  const Scan scan = WithoutRepetitions(recorded);
  state_->trajectory.ExtendTo(scan.end_ns);
  tracker_->FollowOwnMotion();
  const int first = static_cast<int>(state_->observations.size());
  const int scan_index = static_cast<int>(scan_times_ns_.size());
  if (scan_matcher_ != nullptr) {
    scan_matcher_->Take(scan);
    scan_matcher_->LeaveOutMoving(state_->trajectory);
    for (const MovingBeams& beams : scan_matcher_->FindMovingBeams()) {
      state_->moving_beams.push_back(beams);
    }
  }
  for (Observation& observation : Observe(scan)) {
    if (scan_matcher_ != nullptr &&
        scan_matcher_->IsMoving(
            observation.scan_line_index, observation.first_beam, observation.last_beam)) {
      continue;
    }
    state_->observations.push_back(std::move(observation));
  }
  scan_times_ns_.push_back(scan.start_ns);
  const int last = static_cast<int>(state_->observations.size()) - 1;
  tracker_->Track(first,
                  last,
                  {state_->landmarks, scan_index, options_.loop_closure},
                  scan_matcher_.get());
  const bool may_found = may_found_ && !tracker_->IsUndecided(scan.end_ns);
  if (scan_matcher_ != nullptr) scan_matcher_->Remember(state_->trajectory, may_found);
  const auto is_on_plane = [](const Observation& o) { return o.landmark_id >= 0; };
  if (odometry_ == nullptr &&
      std::none_of(
          state_->observations.begin() + first, state_->observations.end(), is_on_plane)) {
    motion_prior_.Forget();
  }
  CheckNotLost(scan.end_ns);
  // The poses of an unsteady rig, and so the places where planes intersect, are hardly known.
  if (options_.window.resegment && tracker_->IsSteady(scan.end_ns)) {
    ResegmentScan(rig_,
                  options_,
                  scan,
                  static_cast<size_t>(first),
                  tracker_->pose_uncertainty().At(state_->trajectory, scan.end_ns),
                  state_.get());
  }
  TakeObservations(first, last);
  if (may_found) StartPlanes(options_.planes.min_scans);
  tentative_planes_.DropStale(scan.end_ns);
  const bool in_half_steps =
      options_.rules.half_window_steps && !tracker_->FollowsWell(scan.end_ns);
  const double share = in_half_steps ? 0.5 : 1.0;
  const int step = static_cast<int>(
      share * std::max(2.0, options_.window.step_s / state_->trajectory.knot_interval_s()));
  if (state_->trajectory.Locate(scan.end_ns).first >= last_solved_interval_ + step) {
    SolveWindow(scan.end_ns);
  }
}

void ScanFollower::TakeObservations(int first, int last) {
  poses_.emplace(rig_, state_->trajectory);
  for (int index = first; index <= last; ++index) {
    const Observation& observation = state_->observations[static_cast<size_t>(index)];
    if (observation.landmark_id >= 0) {
      Judge(observation);
      Accept(index, true);
    } else if (observation.num_points > 0 &&  // has beams left
               !Grazes(observation, poses_->Of(observation), state_->landmarks, kOnGrazed)) {
      tentative_planes_.Offer(observation,
                              index,
                              poses_->Of(observation),
                              Relative(tracker_->pose_uncertainty().At(
                                  state_->trajectory, observation.middle_time_ns())) +
                                  ScannerCovariance(rig_, *state_, observation));
    }
  }
}

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/options/mapper_options.h"
#include "core/registration/local_map.h"
#include "core/registration/occupancy_grid.h"
#include "core/sensor/moving_beams.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"
#include "core/trajectory/pose_constraint.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// The error of a scan's predicted motion: the errors of the poses at its beginning and at its
// end (each: rotation in rad and position in m, world frame); between these the error passes
// linearly.
using MotionVector = Eigen::Matrix<double, 12, 1>;
using MotionMatrix = Eigen::Matrix<double, 12, 12>;

// Share of a scan's points near the local map from which it tells how the rig moved, and no
// other start is tried.
inline constexpr double kMinNearShare = 0.6;

// ScanMatch says how well the points of a scan agree with the local map.
struct ScanMatch {
  // Constraint by the points of each scan line on the pose in its middle.
  std::vector<PoseConstraint> constraints;
  // Normal equations of all scan lines together, for the error of the scan's motion.
  MotionMatrix hessian = MotionMatrix::Zero();
  MotionVector gradient = MotionVector::Zero();
  int num_points = 0;  // in all
  int num_known = 0;   // where the local map knows a direction
  int num_near = 0;    // of these, within a few standard deviations of where it says
  int num_cells = 0;   // that gave a direction

  double KnownShare() const { return num_points > 0 ? 1.0 * num_known / num_points : 0.0; }
  double NearShare() const { return num_known > 0 ? 1.0 * num_near / num_known : 0.0; }
};

// Beams of a scan, by scan line and beam.
using BeamMask = std::vector<std::vector<bool>>;

// SearchWindow is the space in which a scan is searched for, to all sides of where it is
// believed to be.
struct SearchWindow {
  double position_m = 1.0;
  double turn_rad = 40.0 * M_PI / 180.0;
  size_t num_places = 3;  // that are followed
};

// ScanMatcher holds the rig to a local map of what it saw lately, surface or not.
class ScanMatcher {
 public:
  ScanMatcher(const Rig& rig, bool planar, const PointOptions& options, double scan_period_s);
  // Goes on from where another one stands, with a rig of its own.
  ScanMatcher(const ScanMatcher& other, const Rig& rig) : ScanMatcher(other) { rig_ = &rig; }

  static constexpr int kNumLevels = 3;

  // Takes the points of the newest scan.
  void Take(const Scan& scan);
  // Finds the points that lie, by the trajectory's poses, where beams passed before: they
  // move, and neither Match nor the local map takes them. None where these would be most of
  // the scan: it is then the rig that is elsewhere.
  void LeaveOutMoving(const Trajectory& trajectory);
  // How many of the scan's points lie, by the trajectory, where the place was seen to be
  // empty: what has moved there since, or what the trajectory has misplaced.
  int NumInEmpty(const Trajectory& trajectory);
  // The beams of the newest scan that move, by scan line and beam: runs of at least two.
  std::vector<MovingBeams> FindMovingBeams() const;
  // Whether something has moved lately, in most scans of some seconds; so at the start, when
  // nobody can tell.
  bool SeesMotion() const { return motion_ > kMotion; }
  // Whether most points of these beams of a scan line, by its index in the recording, move.
  bool IsMoving(int scan_line_index, int first_beam, int last_beam) const;
  // Matches them with the local map, from the trajectory's poses on: the normal equations of
  // one Gauss-Newton step. Each cell counts as one measurement, since its points share the
  // deviation of its surface, and repeats itself as long as the beams meet the same spot.
  // level: of the cells' size, from 0, the finest, to kNumLevels - 1; each is twice as large
  // as the one before it, and catches points from twice as far away. chosen: the beams to
  // take; nullptr: all.
  ScanMatch Match(const Trajectory& trajectory, int level, const BeamMask* chosen) const {
    return MatchMoved(trajectory, level, chosen, MotionVector::Zero());
  }
  // Moves the scan to where the local map has what it shows, from the trajectory's poses,
  // whose error has this covariance: first by the likeliest of several turns, then from coarse
  // cells to fine ones. Returns the match there.
  ScanMatch Register(const Trajectory& trajectory, const MotionMatrix& covariance) const;
  // Moves a scan of a rig that moves in the plane to where the local map has what it shows,
  // from anywhere in a window about the trajectory's poses as they are once a correction moves
  // the world: the poses of a grid that most points agree with, each followed from coarse
  // cells to fine ones (correlative matching). Returns the match of the best.
  ScanMatch Search(const Trajectory& trajectory,
                   const Rigid3d& correction,
                   const SearchWindow& window) const;
  // The instants of the scan's first and last point; there has to be a point.
  int64_t begin_ns() const { return begin_ns_; }
  int64_t end_ns() const { return end_ns_; }
  // Adds the points to the local map, by the trajectory as it is now. may_found: whether they
  // may found cells, or only add to those that there are.
  void Remember(const Trajectory& trajectory, bool may_found);

  int num_points() const;  // of the newest scan, without those that move
  // A mask of all beams of the scan.
  BeamMask AllBeams() const;
  // Takes the beams first .. last of a scan line, by its index in the recording, out of a
  // mask.
  void Exclude(int scan_line_index, int first_beam, int last_beam, BeamMask* mask) const;

 private:
  static constexpr double kMotion = 0.3;

  // The valid points of one scan line, or of a part of it that took no longer than one pose
  // correction serves.
  struct Line {
    int scanner_index = 0;
    int scan_line_index = 0;  // in the recording
    int num_beams = 0;
    std::vector<int> beams;                  // that have a return
    std::vector<Eigen::Vector2d> p_scanner;  // m
    std::vector<int64_t> times_ns;
    std::vector<bool> moves;  // empty: none does
    bool Moves(size_t i) const { return !moves.empty() && moves[i]; }
    int64_t middle_ns() const { return times_ns.front() / 2 + times_ns.back() / 2; }
  };

  // Matches the points as they lie when the predicted motion is moved by an error.
  ScanMatch MatchMoved(const Trajectory& trajectory,
                       int level,
                       const BeamMask* chosen,
                       const MotionVector& error) const;
  // The errors that most points of a few beams agree with, the best first.
  std::vector<MotionVector> LikeliestErrors(const Trajectory& trajectory,
                                            const Rigid3d& correction,
                                            const SearchWindow& window) const;
  // The error that the likeliest turn means.
  MotionVector BestTurn(const Trajectory& trajectory, const MotionMatrix& covariance) const;
  // Gauss-Newton steps from an error on, from coarse cells to fine ones.
  MotionVector Refine(const Trajectory& trajectory,
                      const MotionMatrix& information,
                      int coarsest_level,
                      MotionVector error) const;
  // The derivative of the error in the middle of a scan line by that of the motion.
  Eigen::Matrix<double, 6, 12> ByMotion(const Line& line) const;
  ScanMotion MotionOf(const Line& line, PoseSampler* poses) const;
  // Which points of a line lie where the place was seen to be empty.
  std::vector<bool> InEmpty(const Line& line, PoseSampler* poses);
  void MatchLine(const Line& line,
                 int level,
                 const std::vector<bool>* chosen,
                 const MotionVector& error,
                 PoseSampler* poses,
                 ScanMatch* match) const;

  const Rig* rig_;
  PointOptions options_;
  double scan_period_s_;
  double repeated_weight_;
  int max_age_scans_;
  int forget_period_scans_;
  int trace_period_scans_;
  int still_scans_;
  std::vector<LocalMap> maps_;  // by level
  OccupancyGrid occupancy_;
  std::vector<Line> lines_;
  int64_t begin_ns_ = 0;  // of the newest scan's points
  int64_t end_ns_ = 0;
  int scan_index_ = 0;
  int next_check_scan_ = 0;  // for what moves
  int last_check_scan_ = 0;
  double motion_ = 1.0;  // share of the late scans in which something moved
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/geometry/matrix_types.h"
#include "core/geometry/rigid3.h"
#include "core/geometry/scan_plane_motion.h"
#include "core/local_map/local_map.h"
#include "core/options/mapper_options.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"
#include "core/trajectory/pose_constraint.h"
#include "core/trajectory/trajectory.h"

namespace plumbline {

// How the points of a scan agree with the local map.
struct ScanMatch {
  // What the points of each scan line say of the pose in its middle.
  std::vector<PoseConstraint> constraints;
  // The same of all scan lines together, for an error of all poses of the scan.
  Matrix6d hessian = Matrix6d::Zero();
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  int num_points = 0;  // in all
  int num_known = 0;   // where the local map knows a direction
  int num_near = 0;    // of these, within a few standard deviations of where it says
  int num_cells = 0;   // that gave a direction

  double KnownShare() const { return num_points > 0 ? 1.0 * num_known / num_points : 0.0; }
  double NearShare() const { return num_known > 0 ? 1.0 * num_near / num_known : 0.0; }
};

// Beams of a scan, by scan line and beam.
using BeamMask = std::vector<std::vector<bool>>;

// ScanMatcher holds the rig to a local map of what it saw lately, surface or not.
class ScanMatcher {
 public:
  ScanMatcher(const Rig& rig, bool planar, const PointOptions& options, double scan_period_s);

  static constexpr int kNumLevels = 3;

  // Takes the points of the newest scan.
  void Take(const Scan& scan);
  // Matches them with the local map, from the trajectory's poses on: the normal equations of
  // one Gauss-Newton step. Each cell counts as one measurement, since its points share the
  // deviation of its surface, and repeats itself as long as the beams meet the same spot.
  // level: of the cells' size, from 0, the finest, to kNumLevels - 1; each is twice as large as
  // the one before it, and catches points from twice as far away. chosen: the beams to take;
  // nullptr: all.
  ScanMatch Match(const Trajectory& trajectory, int level, const BeamMask* chosen) const {
    return MatchMoved(trajectory, level, chosen, Rigid3d());
  }
  // Moves the scan as a rigid whole to where the local map has what it shows: from the
  // trajectory's poses, whose error has this covariance (rotation in rad, position in m; world
  // frame), first by the likeliest of several turns, then from coarse cells to fine ones.
  // Returns the match there.
  ScanMatch Register(const Trajectory& trajectory, const Matrix6d& covariance) const;
  // Adds the points to the local map, by the trajectory as it is now.
  void Remember(const Trajectory& trajectory);

  int num_points() const;     // of the newest scan
  int64_t middle_ns() const;  // of its first scan line that has points; there has to be one
  // A mask of all beams of the scan.
  BeamMask AllBeams() const;
  // Takes the beams first .. last of a scan line, by its index in the recording, out of a mask.
  void Exclude(int scan_line_index, int first_beam, int last_beam, BeamMask* mask) const;

 private:
  // The valid points of one scan line.
  struct Line {
    int scanner_index = 0;
    int scan_line_index = 0;  // in the recording
    int num_beams = 0;
    std::vector<int> beams;  // that have a return
    std::vector<Eigen::Vector2d> p_scanner;  // m
    std::vector<int64_t> times_ns;
    int64_t middle_ns() const { return times_ns.front() / 2 + times_ns.back() / 2; }
  };

  // Matches the points as they lie when the predicted poses are moved by the correction.
  ScanMatch MatchMoved(const Trajectory& trajectory,
                       int level,
                       const BeamMask* chosen,
                       const Rigid3d& correction) const;
  Rigid3d BestTurn(const Trajectory& trajectory,
                   const Eigen::Vector3d& body_world,
                   double stddev_rad) const;
  ScanMotion MotionOf(const Line& line, PoseSampler* poses) const;
  void MatchLine(const Line& line,
                 int level,
                 const std::vector<bool>* chosen,
                 const Rigid3d& correction,
                 PoseSampler* poses,
                 ScanMatch* match) const;

  const Rig& rig_;
  PointOptions options_;
  double repeated_weight_;
  int max_age_scans_;
  std::vector<LocalMap> maps_;  // by level
  std::vector<Line> lines_;
  int scan_index_ = 0;
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "core/association/plane_through_lines.h"
#include "core/association/tentative_plane.h"
#include "core/map/observation.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"

namespace plumbline {

// Traces that may lie on walls, ramps, roofs or on nothing. A single trace leaves its plane
// open about itself, and the traces of one scan line lie on the scan plane, whatever they are
// on. So traces are collected until they determine a plane of any direction, by two scanners
// or while the rig moves on; only then it is decided whether the plane is vertical, horizontal
// or general. (Paper, section 4.4.)
class UndecidedPlanes {
 public:
  explicit UndecidedPlanes(const MapperOptions& options) : options_(options) {}

  // Gives the observation, a trace along this line, to the planes that it may lie on, or
  // starts a new one.
  void Offer(const Observation& observation,
             int observation_index,
             const ObservationPoses& poses,
             const MeasuredLine& line);

  // Removes and returns the planes that are decided and fit to become landmarks. needs_age:
  // see TentativePlanes. At the first scan (min_scans 1) two scanners have to show a wall,
  // three traces another plane.
  std::vector<TentativePlane> TakeReady(int min_scans, bool needs_age);

  // Whether most of these observations lie on a plane that is known to be no wall, by other
  // traces of as many scans.
  bool AreOnNoWall(const std::vector<int>& observations, int min_scans) const;
  // All observations on planes that two scanners show to be ramps, roofs or the like.
  std::set<int> OnSlopes() const;

  // Drops planes that nothing has confirmed for a while, or that stay undecided.
  void DropStale(int64_t now_ns);

 private:
  struct Trace {
    int observation_index = 0;
    int scan_index = 0;
    int scan_line_index = 0;
    Eigen::Vector3d start_world = Eigen::Vector3d::Zero();
    Eigen::Vector3d end_world = Eigen::Vector3d::Zero();
    Eigen::Vector3d scan_normal_world = Eigen::Vector3d::Zero();
    Eigen::Vector3d scanner_world = Eigen::Vector3d::Zero();
  };
  struct Plane {
    std::vector<Trace> traces;
    TentativePlane seen;  // without a landmark until it is decided
    Eigen::Vector3d low = Eigen::Vector3d::Constant(1e300);  // around the traces, world
    Eigen::Vector3d high = Eigen::Vector3d::Constant(-1e300);
  };

  bool Takes(const Plane& plane, const MeasuredLine& line, const Trace& trace) const;
  void Record(const Observation& observation,
              const ObservationPoses& poses,
              const MeasuredLine& line,
              const Trace& trace,
              Plane* plane) const;
  // Returns the kind of plane that two scanners show; nothing while they do not.
  std::optional<Landmark> ShownByTwo(const Plane& plane) const;
  // Makes the landmark where the traces decide which kind of plane it is.
  bool Decide(int min_scans, bool needs_age, Plane* plane) const;

  const MapperOptions& options_;
  std::deque<Plane> planes_;
};

}  // namespace plumbline

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "simulation/world/walk.h"

namespace plumbline {

// An oscillation adds amplitude * sin(2 pi frequency t + phase), t since the start of the
// path.
struct Oscillation {
  double amplitude = 0.0;  // rad or m
  double frequency_hz = 1.0;
  double phase_rad = 0.0;

  double At(double time_s) const;
};

// The rig stands still for some time at a place along the path.
struct Pause {
  double at_m = 0.0;  // travelled since the start
  double duration_s = 0.0;
  std::string location;  // "file:line", for messages
};

// The rig passes near a way point: it turns there, along a corner, into the next direction.
struct WayPoint {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  // building frame, m
  std::string location;                                // "file:line", for messages
};

// PathOptions are an experiment's description of the path.
struct PathOptions {
  std::string location;  // "file:line", for messages
  std::vector<WayPoint> way_points;
  // The rig is carried along points in space, with stops and turns on the spot, instead of
  // along way_points; its pauses are the walk's stops.
  std::optional<WalkOptions> walk;
  bool closed = false;          // back to the first way point, and on
  double laps = 1.0;            // to travel; counts for closed paths, when length_m is 0
  double length_m = 0.0;        // to travel; 0: the laps, or to the last way point
  double start_fraction = 0.0;  // of one lap or of the whole way, where the rig starts
  double corner_radius_m = 0.5;
  double height_m = 1.5;  // of the body's origin: in the building frame; on a walk, above it
  double speed_m_s = 1.0;
  std::vector<Pause> pauses;
  Oscillation roll, pitch, yaw, height;  // added to the motion along the path
  int64_t start_ns = 0;
};

// A path moves the rig along a walk (simulation/world/walk.h), or along way points at constant
// speed, heading along the path, as an analytic function of time. Straight stretches are
// joined by corners along which the curvature is
//   k(s) = 2 turn / length * sin^2(pi s / length) ,
// so that the yaw rate is continuous and smooth, and no polynomial spline can follow exactly.
// A corner begins and ends where a circular arc of corner_radius_m would.
class Path {
 public:
  // Throws Error naming file and line when corners do not fit between the way points, or the
  // length or the pauses do not fit the path.
  explicit Path(const PathOptions& options);

  // world_from_body, at start_ns() <= time_ns <= end_ns(), in the building's frame.
  Rigid3d PoseAt(int64_t time_ns) const;

  int64_t start_ns() const { return options_.start_ns; }
  int64_t end_ns() const { return end_ns_; }
  bool is_walk() const { return walk_ != nullptr; }
  // Length of one lap; for open paths, of the whole way.
  double lap_length_m() const { return lap_length_m_; }

  // Metres travelled at an instant.
  double TravelledAt(int64_t time_ns) const;
  // Place and heading (rad) at a distance from the first way point, without oscillations.
  Eigen::Vector3d PlaceAndHeadingAt(double distance_m) const;
  // The way point that was passed last at an instant, as "file:line".
  const std::string& LocationAt(int64_t time_ns) const;

 private:
  // A piece is a straight stretch (turn 0) or a corner.
  struct Piece {
    double begin_m = 0.0;  // distance of its begin along the path
    double length_m = 0.0;
    Eigen::Vector2d begin = Eigen::Vector2d::Zero();
    Eigen::Vector2d end = Eigen::Vector2d::Zero();
    double heading_rad = 0.0;  // at the begin
    double turn_rad = 0.0;
    size_t way_point = 0;
  };
  struct Corner {
    double turn_rad = 0.0;
    double tangent_m = 0.0;  // from the way point to begin and end of the corner
    double length_m = 0.0;
  };

  Corner MakeCorner(size_t way_point) const;
  void MakePieces();
  void AddStraight(const Eigen::Vector2d& from, const Eigen::Vector2d& to, size_t way_point);
  void AddCorner(const Corner& corner, size_t way_point);
  void CheckPauses(double travel_m) const;
  const Piece& PieceAt(double* distance_m) const;

  PathOptions options_;
  std::shared_ptr<const Walk> walk_;  // null: along pieces_
  std::vector<Piece> pieces_;
  double lap_length_m_ = 0.0;
  double start_m_ = 0.0;
  int64_t end_ns_ = 0;
};

}  // namespace plumbline

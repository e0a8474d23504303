#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/registration/visit.h"
#include "core/sensor/odometry.h"
#include "core/trajectory/trajectory.h"
#include "core/util/time.h"
#include "test/testing/planar_world.h"

namespace plumbline {

// A rig goes round and round through a corridor that closes in itself, at 1 m/s, and believes
// that it turns by a little more than it does.
class RingWay {
 public:
  static constexpr double kSpacing = 0.2;  // m, between scan lines

  // drift: rad per metre of the way. slip: rad, by which the rig once turns without believing
  // so, half a round after its start.
  RingWay(double length_m, double drift, double slip = 0.0) {
    world_.AddWalls({{0, 0}, {20, 0}, {20, 12}, {0, 12}, {0, 0}});
    world_.AddWalls({{2, 2}, {18, 2}, {18, 10}, {2, 10}, {2, 2}});
    // What tells one place from another: doors that stand back, and columns.
    for (const double x : {3.1, 6.0, 7.6, 12.9, 15.2}) AddNiche({x, 0.0}, 0.9);
    for (const double x : {4.4, 9.7, 11.2, 16.1}) AddNiche({x, 12.0}, 1.3);
    for (const Eigen::Vector2d& at : std::vector<Eigen::Vector2d>{
             {0.3, 4.0}, {0.3, 7.2}, {19.7, 3.3}, {19.7, 5.0}, {19.7, 8.9}}) {
      world_.columns.push_back({at, 0.2});
    }
    if (slip != 0.0) {
      // Half a round on it must not look alike.
      for (const double x : {4.0, 8.5, 11.0}) {
        world_.AddWalls({{x, 1.55}, {x + 0.8, 1.55}, {x + 0.8, 2.0}, {x, 2.0}});
      }
    }
    constexpr double kStep = 0.01;  // m
    true_.push_back({0.0, {3.0, 1.0}});
    believed_ = true_;
    while (kStep * static_cast<double>(true_.size()) < length_m) {
      const double way = kStep * static_cast<double>(true_.size());
      const double turn = Curvature(std::fmod(way, kRound)) * kStep;
      true_.push_back(true_.back() * PlanarPose{turn, {kStep, 0.0}});
      const bool slips = way < 0.5 * kRound && way + kStep >= 0.5 * kRound;
      believed_.push_back(
          believed_.back() *
          PlanarPose{turn + drift * kStep + (slips ? slip : 0.0), {kStep, 0.0}});
      wheels_.push_back({NanosecondsFromSeconds(way), counted_.position, counted_.heading});
      counted_ = counted_ * PlanarPose{turn, {kStep, 0.0}};
    }
    trajectory_.ExtendTo(NanosecondsFromSeconds(length_m - 1.0));
    for (int i = 0; i < trajectory_.num_control_points(); ++i) {
      const PlanarPose& pose = At(believed_, 0.1 * (i - 1));
      ControlPoint& point = trajectory_.control_point(i);
      point.position = {pose.position.x(), pose.position.y(), 0.0};
      Eigen::Map<Eigen::Quaterniond>(point.rotation.data()) =
          Eigen::AngleAxisd(pose.heading, Eigen::Vector3d::UnitZ());
    }
    for (double way = 0.0; way < length_m - 1.0; way += kSpacing) TakeScan(way);
  }

  PlanarPose TruePose(int64_t time_ns) const { return At(true_, 1e-9 * double(time_ns)); }
  const std::vector<PlacedScan>& scans() const { return scans_; }
  const Trajectory& trajectory() const { return trajectory_; }
  // Wheels that do not slip.
  Odometry wheels() const { return Odometry(wheels_); }

 private:
  static constexpr double kRadius = 1.0;  // m, of the corners
  // The straights of the centre line, from corner to corner, and the whole round.
  static constexpr double kLong = 16.0, kShort = 8.0;
  static constexpr double kRound = 2.0 * (kLong + kShort) + 2.0 * M_PI * kRadius;

  // Along the lower side first, which the way begins in, 1 m after its left end.
  static double Curvature(double way) {
    const double corner = 0.5 * M_PI * kRadius;
    double at = way + 1.0;
    for (const double straight : {kLong, kShort, kLong, kShort}) {
      if (at < straight) return 0.0;
      at -= straight;
      if (at < corner) return 1.0 / kRadius;
      at -= corner;
    }
    return 0.0;
  }

  static const PlanarPose& At(const std::vector<PlanarPose>& poses, double way) {
    const auto index = static_cast<size_t>(std::max(0.0, std::round(100.0 * way)));
    return poses[std::min(index, poses.size() - 1)];
  }

  void AddNiche(const Eigen::Vector2d& at, double width) {
    const double depth = at.y() == 0.0 ? 0.25 : -0.25;
    world_.AddWalls({at,
                     at + Eigen::Vector2d(0.0, depth),
                     at + Eigen::Vector2d(width, depth),
                     at + Eigen::Vector2d(width, 0.0)});
  }

  void TakeScan(double way) {
    const PlanarPose& pose = At(true_, way);
    const PlanarPose& believed = At(believed_, way);
    PlacedScan scan;
    scan.time_ns = NanosecondsFromSeconds(way);
    scan.way_m = way;
    scan.scanner = believed.position;
    for (int beam = -90; beam <= 90; ++beam) {
      const double angle = beam * M_PI / 180.0;
      const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
      const double range = world_.CastRay(pose.position, pose.Rotation() * direction);
      if (range < 15.0) scan.ends.push_back(believed * (range * direction));
    }
    scans_.push_back(scan);
  }

  PlanarWorld world_;
  PlanarPose counted_;
  std::vector<OdometrySample> wheels_;
  std::vector<PlanarPose> true_;  // every centimetre
  std::vector<PlanarPose> believed_;
  Trajectory trajectory_{0, 100'000'000, Rigid3d()};
  std::vector<PlacedScan> scans_;
};

}  // namespace plumbline

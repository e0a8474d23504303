#pragma once

#include <Eigen/Geometry>
#include <cstdint>

namespace plumbline {

// GravityStart is what is known of a rig at the start of a map that no scan's planes show.
struct GravityStart {
  int64_t time_ns = 0;
  // z points against gravity. The heading is a choice, and held.
  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();
  double tilt_stddev_rad = 0.0;
  double heading_stddev_rad = 1e-5;
  // Of a rig that stands or is walked. Where nothing else shows how fast it goes, traces that
  // a nod sweeps over a floor look like its motion.
  double speed_stddev_m_s = 0.5;
};

}  // namespace plumbline

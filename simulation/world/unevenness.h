#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "simulation/world/building.h"

namespace plumbline {

// UnevennessOptions say how far real surfaces lie off their planes.
struct UnevennessOptions {
  double stddev_m = 0.0;       // along the normal; 0 switches it off
  double correlation_m = 0.5;  // length over which the deviation changes
};

// Unevenness is a smooth random deviation of each face from its plane, stationary, Gaussian
// and with the covariance stddev^2 exp(-|p - q|^2 / (2 correlation^2)): the same wherever and
// whenever a spot is seen. It sums cosines with random wave vectors (Rahimi, Recht 2007).
class Unevenness {
 public:
  Unevenness(const UnevennessOptions& options, const Building& building, uint64_t seed);

  // Returns how much longer a beam is that meets the face at p_world, m.
  double RangeError(int face_id,
                    const Eigen::Vector3d& p_world,
                    const Eigen::Vector3d& direction_world) const;

 private:
  struct Wave {
    Eigen::Vector3d vector;  // rad / m
    double phase_rad = 0.0;
  };

  double amplitude_m_ = 0.0;              // of each wave
  std::vector<Eigen::Vector3d> normals_;  // of the faces
  std::vector<std::vector<Wave>> waves_;  // of the faces
};

}  // namespace plumbline

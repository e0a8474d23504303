#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/map/map_state.h"

namespace plumbline {

// ThinEvidence withholds planes from a scan where all that speaks for a direction that was
// open is one plane: somebody who walks past is as easily taken for it, and the rig would
// jump. It is believed once a second plane says so, or many of the points, or once it has
// stood still for a while beside the motion that was predicted without it.
class ThinEvidence {
 public:
  // predicted: the rig's position by all that was known before the planes of the scan, with
  // its covariance (world, m and m^2). estimated: by these planes. Returns the observations of
  // first .. last whose planes are not to be taken yet.
  std::vector<int> Withhold(const MapState& state,
                            int first_observation,
                            int last_observation,
                            const Eigen::Vector3d& predicted,
                            const Eigen::Matrix3d& covariance,
                            const Eigen::Vector3d& estimated);

 private:
  // A plane that alone would have moved the rig.
  struct Sighting {
    int64_t time_ns = 0;
    int landmark_id = 0;
    double shift_m = 0.0;
  };

  // Whether the newest sighting repeats earlier ones for long enough.
  bool HasStoodStill() const;

  std::deque<Sighting> sightings_;  // of one landmark, none far from the one before it
};

}  // namespace plumbline

#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <set>
#include <vector>

#include "core/map/observation.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The model frame as seen from the body, from the segments of one scan (paper, section 4.5): z
// is normal to floor and ceiling, x is the normal of one wall.
struct ModelFrame {
  Eigen::Quaterniond world_from_body = Eigen::Quaterniond::Identity();
  int reference_observation = -1;  // whose wall's normal is the x axis
};

// Looks for the direction z that agrees with the largest total length of segments: segments of
// tilted scanners on floor and ceiling are perpendicular to it, and so are the normals of
// walls that two scanners see; segments on these walls have no say. The direction must lie
// within 35 degrees of the body's z axis; planar rigs take that axis itself. no_walls:
// observations that are known to lie on no wall. Returns nothing when the scan shows no floor,
// ceiling or wall clearly enough.
std::optional<ModelFrame> FindModelFrame(const Rig& rig,
                                         bool planar,
                                         const std::vector<Observation>& scan,
                                         const std::set<int>& no_walls = {});

}  // namespace plumbline

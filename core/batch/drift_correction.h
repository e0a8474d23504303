#pragma once

#include <optional>
#include <vector>

#include "core/geometry/planar_pose.h"
#include "core/map/map_state.h"
#include "core/registration/visit.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Bends a trajectory so that its pose in the middle of each visit becomes the corrected one
// (world_from_visit, by visit), and what lies between moves evenly with the way. scans: what
// the visits were cut from.
void BendTrajectory(const std::vector<PlacedScan>& scans,
                    const std::vector<Visit>& visits,
                    const std::vector<PlanarPose>& corrected,
                    Trajectory* trajectory);

// Looks in a map of level scan planes for places that the rig came back to without knowing
// them: where it has drifted farther than its covariances allow, so that the walls seen again
// stand beside themselves. Where there are such places, bends the trajectory so that they lie
// in one, and decides anew which walls of different visits are one. Reads the recording once.
// Returns by how much it has moved the rig at most, in m, and nothing where all stays as it
// was; else the landmarks are to be estimated anew.
std::optional<double> CorrectDrift(const Rig& rig,
                                   RecordingReader* recording,
                                   MapState* state);

}  // namespace plumbline

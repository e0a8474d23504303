#pragma once

#include <vector>

#include "core/association/association.h"
#include "core/geometry/matrix_types.h"
#include "core/map/map_state.h"
#include "core/options/mapper_options.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"
#include "core/visibility/occupancy_grids.h"

namespace plumbline {

// Moves the ends of segments to where their planes meet others, and returns how many segments
// changed. Segmentation knows a single scan line: near a corner the ranges alone can not tell
// on which of two surfaces a beam lies, so that it leaves out good beams and now and then
// takes in a few of a surface that has too few for a segment of its own. Such beams lie off
// always to the same side, and far out, where they turn the plane most. With the planes
// estimated, the crossing of two of them is known to millimetres, whatever a beam's own noise.
//
// Beams that can not lie on the segment's plane are left out (Occlusion): those in an
// opening, those behind corners. openings: of the landmarks, by id, from what an earlier call
// has counted; counted: for the next call, nullptr where there is none. An end is left alone
// where the segment still follows its plane when the other would be far off; where no plane
// meets its own, and where beams have been left out, beams that are hardly the plane's go.
// Observations left without beams (num_points = 0), or off their plane, lose their landmark.
// Segments that change are taken to their planes' traces (MakeObservationOn); in the last
// call, where nothing is counted, also those that are on no trace of their plane yet.
//
// Beams that no segment has taken and single planes explain become short runs
// (BeamAssociation): those beyond an end, which are too few for a segment, tell as much of a
// plane seen at a grazing angle as hundreds of others; those between two lines segmentation
// leaves out for their noise and that of their neighbours, as an association refuses a segment
// that has a beam or two of another surface. What is left to a plane then would lean one way.
// Reads the recording once, from its beginning, and works on the threads of the caller's
// tbb::task_arena.
int ResegmentRecording(const Rig& rig,
                       const MapperOptions& options,
                       RecordingReader* recording,
                       const std::vector<PlaneOpenings>& openings,
                       OccupancyGrids* counted,
                       MapState* state);

// The same for the scan that the rig has just been tracked by, with the planes known so far:
// its observations, the last ones from first_observation on. All that have a landmark are
// taken to its trace, and stay there: what the batch knows better of the plane is small beside
// the noise of the segment's own line. There are no openings and no short runs yet, and of
// most corners only one face has been seen: what lies close behind it is left out too
// (Occlusion::BehindWalls). pose_covariance: of the rig's poses in the scan, at most.
void ResegmentScan(const Rig& rig,
                   const MapperOptions& options,
                   const Scan& scan,
                   size_t first_observation,
                   const Matrix6d& pose_covariance,
                   MapState* state);

}  // namespace plumbline

#pragma once

#include <vector>

#include "core/association/association.h"
#include "core/geometry/matrix_types.h"
#include "core/map/map_state.h"
#include "core/map/observation_poses.h"
#include "core/options/mapper_options.h"
#include "core/sensor/recording.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_reader.h"
#include "core/visibility/occupancy_grids.h"

namespace plumbline {

// Moves the ends of a recording's segments to where their planes intersect others, and returns
// how many segments changed. Segmentation knows a single scan line: near a corner the ranges
// alone can not show on which of two surfaces a beam lies, so that segmentation leaves out
// good beams and now and then takes in a few of a surface that has too few for a segment of
// its own. Such beams lie off always to the same side, and far out, where they turn the plane
// most. With the planes estimated, the intersection of two of them is known to millimetres,
// whatever a beam's own noise.
//
// Beams that can not lie on the segment's plane, in an opening or behind a corner, are left
// out (Occlusion). openings: of the landmarks, by id, from the counts of an earlier call;
// counted: the counts for the next call, nullptr where there is none. An end is left alone
// where the segment still follows its plane at a place where the other plane would be far off.
// Where no plane intersects its own, and where beams have been left out, the last beams go if
// they are hardly on the plane. Observations left without beams (num_points = 0), or off their
// plane, lose their landmark. Segments that change are taken to their planes' traces
// (MakeObservationOn); in the last call, where nothing is counted, so are those that are on no
// trace of their plane yet.
//
// Beams that no segment has taken and single planes explain become sub-minimum segments
// (BeamAssociation). Those beyond an end, too few for a segment, determine a plane seen at a
// grazing angle as well as hundreds of others do. Those between two segments were left out by
// segmentation for their noise and that of their neighbours, or are parts of a segment that
// association refused because a beam or two lay on another surface: the beams that are left to
// the plane without them would lean to one side. Where the pose is not known without them to a
// beam's noise, along the normal of the plane, they are left out: the pose that chose them is
// the one that they would hold, right or wrong (a pillar in a round room).
//
// Reads the recording once, from its beginning, and works on the threads of the caller's
// tbb::task_arena.
int ResegmentRecording(const Rig& rig,
                       const MapperOptions& options,
                       RecordingReader* recording,
                       const PoseCovarianceAt& pose_covariance,
                       const std::vector<PlaneOpenings>& openings,
                       OccupancyGrids* counted,
                       MapState* state);

// Moves the ends of the segments of the scan that the rig has just been tracked by, with the
// planes known so far; its observations are the last ones, from first_observation on. All that
// have a landmark are taken to its trace, and stay there: what the batch knows better of the
// plane is small beside the noise of the segment's own line. There are no openings and no
// sub-minimum segments yet, and of most corners only one face has been seen: beams that meet a
// plane close behind that face are left out too (Occlusion::BehindWalls). pose_covariance: at
// least that of the rig's poses in the scan.
void ResegmentScan(const Rig& rig,
                   const MapperOptions& options,
                   const Scan& scan,
                   size_t first_observation,
                   const Matrix6d& pose_covariance,
                   MapState* state);

}  // namespace plumbline

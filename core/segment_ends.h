#pragma once

#include "core/map_state.h"
#include "core/mapper_options.h"
#include "core/opening_map.h"
#include "core/recording.h"
#include "core/rig.h"

namespace plumbline {

// Moves the ends of segments to where their planes meet others, and returns how many segments
// changed. Segmentation knows a single scan line: near a corner the ranges alone can not tell
// on which of two surfaces a beam lies, so that it leaves out good beams and now and then
// takes in a few of a surface that has too few for a segment of its own. Such beams lie off
// always to the same side, and far out, where they turn the plane most. With the planes
// estimated, the crossing of two of them is known to millimetres, whatever a beam's own noise.
//
// Beams that can not lie on the segment's plane are left out (HiddenBeams): those in an
// opening that an earlier call has counted, those behind corners. Counts the planes' openings
// for the next call; counted: nullptr where there is none. An end is left alone where the
// segment still follows its plane when the other would be far off; where no plane meets its
// own, and where beams have been left out, beams that are hardly the plane's go. Observations
// left without beams (num_points = 0), or off their plane, lose their landmark. In the last
// call, where nothing is counted, all segments are taken to their planes' traces
// (MakeObservationOn); before, those that change.
//
// Beams beyond such an end that lie on the plane met there, and belong to no segment, become
// short runs: seen at a grazing angle, a few of them tell as much of a plane as hundreds of
// others. Reads the recording once, from its beginning.
int RecutSegments(const Rig& rig,
                  const MapperOptions& options,
                  RecordingReader* recording,
                  const OpeningMap& openings,
                  OpeningMap* counted,
                  MapState* state);

}  // namespace plumbline

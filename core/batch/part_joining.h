#pragma once

#include "core/following/checkpoint.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Joins parts of a recording that follow each other, where the later one's surfaces match
// those of the earlier one and lie where the motion before the gap leads, or, of a rig that
// moves in the plane, where wheels say how it went between them: to one part with the model
// frame of the earlier one, whose state has a gap where nothing was followed. Surfaces
// that both saw become one; the batch then estimates all together. Other parts stay as they
// are.
void JoinParts(const Rig& rig, bool planar, FollowedRecording* followed);

}  // namespace plumbline

#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"
#include "core/recording/messages.h"

namespace plumbline {

// Poses of frames in the rig's body, by a recording's static transforms.
struct StaticFrames {
  std::string body;                                // frame that is the body; empty: none
  std::map<std::string, Rigid3d> body_from_frame;  // of the frames that were asked for
};

// Finds the frame that carries all of the frames, as far as these are known at all: base_link
// where it does, else the one nearest to the root. Slashes before names do not count.
StaticFrames FindStaticFrames(const std::vector<Transform>& transforms,
                              const std::vector<std::string>& frames);

}  // namespace plumbline

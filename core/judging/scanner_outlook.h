#pragma once

#include <cstdint>
#include <vector>

#include "core/judging/sampled_line.h"
#include "core/sensor/rig.h"

namespace plumbline {

// The attitude of a scanner as its own scan lines show it.
enum class Attitude {
  kUnknown,  // the rig hardly turned, or too little is seen
  kLevel,    // all that it sees turns when the rig does: walls
  kTilted,   // some of what it sees stays when the rig turns: floor or ceiling
  kNodding   // it moves against the rig (nodding.h)
};

struct OwnAttitude {
  Attitude attitude = Attitude::kUnknown;
  int num_turns = 0;         // half seconds in which the rig turned
  double still_share = 0.0;  // of the length of the traces in these, that did not turn
  double alike_share = 0.0;  // of these, in which most of its traces turned alike
};

// Judges each scanner from its traces while the rig turns about the vertical. The stamps of
// all have to come from one clock.
std::vector<OwnAttitude> JudgeAttitudes(const std::vector<std::vector<SampledLine>>& sample);

// StepTurn is the turn that a scanner's traces made together in its own frame, in a step of a
// fifth of a second.
struct StepTurn {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  double turn_rad = 0.0;  // against the rig's turn, where the scanner stands level
};
std::vector<StepTurn> CommonTurns(const std::vector<SampledLine>& lines);

// Heights at which a tilted scanner sees level traces, as those of floor and ceiling.
struct LevelTraces {
  bool is_seen = false;
  double height_m = 0.0;  // above the body's origin
  double share = 0.0;     // of the scan lines that have such a trace
};
struct HeightView {
  bool is_tilted =
      false;  // as the rig file says, always or now and then: only then heights are seen
  LevelTraces floor;
  LevelTraces ceiling;
};
HeightView FindHeights(const std::vector<SampledLine>& lines, const Scanner& scanner);

}  // namespace plumbline

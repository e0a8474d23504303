#pragma once

namespace plumbline {

// Beams first .. last of a scan line that met something that moves.
struct MovingBeams {
  int scan_line_index = 0;  // position in the recording's sequence of scan lines
  int first_beam = 0;
  int last_beam = 0;  // inclusive
};

}  // namespace plumbline

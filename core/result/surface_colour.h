#pragma once

#include <array>
#include <cstdint>

namespace plumbline {

// The bright colour red, green, blue that a surface has in all files of a result. It depends
// on the surface's id only; hues of successive ids are far apart.
std::array<uint8_t, 3> SurfaceColour(int plane_id);

// The colour of a point: that of its surface, grey on none, dark grey on something that moves.
std::array<uint8_t, 3> PointColour(int plane_id);

}  // namespace plumbline

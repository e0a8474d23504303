#pragma once

#include <string>

#include "core/judging/check.h"

namespace plumbline {

// check.svg: a row for each topic (one scan line, rate and returns over time, returns by beam
// angle) and, with a rig file, the rig with its scan planes and the points of the first second
// from above and from the side. The same report gives the same bytes.
std::string DrawCheck(const CheckReport& report);

}  // namespace plumbline

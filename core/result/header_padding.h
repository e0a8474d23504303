#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace plumbline {

// Spaces for the digits that the largest number of points has more: with them, text headers
// that hold the number `times` times are of the same length for every number, so that they can
// be filled in at the end.
inline std::string HeaderPadding(int64_t num_points, size_t times) {
  const size_t num_digits = std::to_string(num_points).size();
  return std::string(times * (std::numeric_limits<int64_t>::digits10 + 1 - num_digits), ' ');
}

}  // namespace plumbline

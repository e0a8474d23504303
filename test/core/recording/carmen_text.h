#pragma once

#include <string>

namespace plumbline {

// A line of a front laser, its ranges 1, 2, ... cm longer than a metre.
inline std::string FlaserLine(int num_ranges, const std::string& time) {
  std::string line = "FLASER " + std::to_string(num_ranges);
  for (int i = 0; i < num_ranges; ++i) {
    line += " 1." + std::string(i < 10 ? "0" : "") + std::to_string(i % 100);
  }
  return line + " 0.1 0.2 0.3 0.1 0.2 0.3 " + time + " nohost 0.250000\n";
}

}  // namespace plumbline

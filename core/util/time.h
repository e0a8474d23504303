#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace plumbline {

// Instants are int64 nanoseconds on the recording's clock. Subtract first, convert afterwards:
// a double holds nanoseconds since 1970 only to 0.2 microseconds.
inline double SecondsBetween(int64_t start_ns, int64_t end_ns) {
  return static_cast<double>(end_ns - start_ns) * 1e-9;
}

inline int64_t NanosecondsFromSeconds(double seconds) {
  const double nanoseconds = seconds * 1e9;
  // Rounds as std::llround does, without the call of a library: this is asked for every beam.
  return static_cast<int64_t>(nanoseconds + (nanoseconds < 0.0 ? -0.5 : 0.5));
}

// "12.345 s", for messages.
inline std::string FormatSeconds(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3f s", seconds);
  return text;
}

}  // namespace plumbline

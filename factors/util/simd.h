#pragma once

#include <cstddef>
#include <cstring>

namespace plumbline {

// Numbers side by side in one register: two on all x86-64 and ARM64 processors, four where the
// build is for those with AVX2. For loops of which the compiler does not make vector
// instructions by itself.
#ifdef PLUMBLINE_X86_64_V3
constexpr int kLanes = 4;
#else
constexpr int kLanes = 2;
#endif
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

inline Lanes LoadLanes(const double* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

inline void StoreLanes(const Lanes& lanes, double* to) {
  std::memcpy(to, &lanes, sizeof(lanes));
}

// visit(0), visit(1), ...
template <typename Visit>
Lanes MakeLanes(const Visit& visit) {
  Lanes lanes;
  for (int k = 0; k < kLanes; ++k) lanes[k] = visit(k);
  return lanes;
}

inline double SumOf(const Lanes& lanes) {
  double sum = 0.0;
  for (int k = 0; k < kLanes; ++k) sum += lanes[k];
  return sum;
}

// NaN where b is.
inline Lanes Smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }

}  // namespace plumbline

#pragma once

#include <cstddef>
#include <cstring>

namespace plumbline {

// Numbers side by side in one register: two on all x86-64 and ARM64 processors, four where the
// build is for those with AVX2. For loops of which the compiler does not make vector
// instructions by itself.
#ifdef PLUMBLINE_X86_64_V3
constexpr int kSimdWidth = 4;
#else
constexpr int kSimdWidth = 2;
#endif
using Simd = double __attribute__((vector_size(kSimdWidth * sizeof(double))));

inline Simd LoadSimd(const double* from) {
  Simd simd;
  std::memcpy(&simd, from, sizeof(simd));
  return simd;
}

inline void StoreSimd(const Simd& simd, double* to) { std::memcpy(to, &simd, sizeof(simd)); }

// visit(0), visit(1), ...
template <typename Visit>
Simd MakeSimd(const Visit& visit) {
  Simd simd;
  for (int k = 0; k < kSimdWidth; ++k) simd[k] = visit(k);
  return simd;
}

inline double SumOf(const Simd& simd) {
  double sum = 0.0;
  for (int k = 0; k < kSimdWidth; ++k) sum += simd[k];
  return sum;
}

// NaN where b is.
inline Simd Smaller(const Simd& a, const Simd& b) { return a < b ? a : b; }

}  // namespace plumbline

#include "simulation/world/random.h"

#include <cmath>

namespace plumbline {

Random::Random(std::initializer_list<uint64_t> key) {
  for (const uint64_t word : key) {
    state_ ^= word;
    state_ = Next();
  }
}

uint64_t Random::Next() {
  state_ += 0x9e3779b97f4a7c15u;
  uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

double Random::Uniform() { return static_cast<double>(Next() >> 11) * 0x1p-53; }

double Random::Gaussian() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  while (true) {
    const double x = 2 * Uniform() - 1;
    const double y = 2 * Uniform() - 1;
    const double square = x * x + y * y;
    if (square >= 1.0 || square == 0.0) continue;
    const double scale = std::sqrt(-2 * std::log(square) / square);
    spare_ = scale * y;
    has_spare_ = true;
    return scale * x;
  }
}

}  // namespace plumbline

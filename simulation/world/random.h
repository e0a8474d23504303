#pragma once

#include <cstdint>
#include <initializer_list>

namespace plumbline {

// Random numbers whose sequence is fixed by this code and not by the standard library, so that
// recordings have the same bytes everywhere: SplitMix64 (Steele, Lea, Flood 2014), and the
// polar method (Marsaglia 1964) for the normal distribution.
class Random {
 public:
  // Different keys give independent sequences.
  explicit Random(std::initializer_list<uint64_t> key);

  double Uniform();   // in [0, 1)
  double Gaussian();  // mean 0, standard deviation 1

 private:
  uint64_t Next();

  uint64_t state_ = 0;
  double spare_ = 0.0;  // the polar method makes two at a time
  bool has_spare_ = false;
};

}  // namespace plumbline

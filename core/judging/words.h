#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace plumbline {

// A number with its digits after the point.
std::string Decimal(double value, int digits);

// "12 %"; "0.3 %" below one per cent.
std::string PercentOf(double share);

// "from 3 to 8 s, from 20 to 21 s": runs of the seconds, which are sorted, at least min_length
// long; empty where there are none. Six at most, then how many more there are.
std::string SpansInWords(const std::vector<int64_t>& seconds, size_t min_length);

// "left, right and rear".
std::string Enumerate(const std::vector<std::string>& names);

// Breaks a text between words into lines of at most `width` letters, each with its end; the
// first begins with `first`, the others with `indent`.
std::string Wrapped(const std::string& text,
                    const std::string& first,
                    const std::string& indent,
                    size_t width);

}  // namespace plumbline

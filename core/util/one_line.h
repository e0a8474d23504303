#pragma once

#include <cstddef>
#include <string>

namespace plumbline {

// The text as valid UTF-8 on one line: line breaks, other control characters and bytes that
// are no UTF-8 become escapes (\n, \t, \x1b). Names that come from a file may hold anything.
std::string OnOneLine(const std::string& text);

// OnOneLine() of a text of any length: what exceeds max_bytes becomes "...".
std::string OnOneLine(const std::string& text, size_t max_bytes);

}  // namespace plumbline

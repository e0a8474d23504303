#pragma once

#include <stdexcept>
#include <string>

#include "core/util/one_line.h"

namespace plumbline {

// Bad input or a failed estimate. The message is one line, whatever names it quotes, and names
// the file and line, or the instant, at fault. Thrown anywhere below apps/, caught once in each
// app, which prints it and exits with 1. A violated assumption of our own is a glog CHECK
// instead.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(OnOneLine(message)) {}
};

}  // namespace plumbline

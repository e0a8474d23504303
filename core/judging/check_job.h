#pragma once

#include <string>

namespace plumbline {

// The job of plumbline_check.
struct CheckJob {
  std::string recording;
  std::string rig;     // file; empty: none
  std::string output;  // directory; empty: named after the recording, in the current directory
};

struct CheckOutcome {
  std::string text;  // for the user
  bool is_mappable = true;
};

// Looks at the recording, and writes check.json, check.svg and, without a rig file, rig.yaml.
// Throws Error where a file can not be read or written.
CheckOutcome RunCheckJob(const CheckJob& job);

}  // namespace plumbline

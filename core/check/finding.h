#pragma once

#include <string>

namespace plumbline {

enum class Severity {
  kNote,     // worth knowing
  kWarning,  // the map will lack something, or be less precise than it says
  kStop,     // no map, or a wrong one, comes of the recording and the rig file as they are
};

// Finding is one thing that plumbline_check has to tell.
struct Finding {
  Severity severity = Severity::kNote;
  std::string subject;   // the topic that it is about; empty: the whole recording or rig
  std::string sentence;  // what is so, with its figures
  std::string advice;    // what to change; empty where there is nothing to do
};

}  // namespace plumbline

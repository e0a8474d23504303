#pragma once

#include <string>

namespace plumbline {

enum class Severity {
  kNote,     // worth knowing
  kWarning,  // the map will lack something, or be less precise than it says
  kStop,     // no map, or a wrong one, comes of the recording and the rig file as they are
};

// The subject of a finding. Subjects stand in the order in which they are to be believed: an
// earlier one brings forth what looks like a later one, never the other way round.
enum class Subject {
  kRecording,  // the file and its topics
  kClock,      // stamps and their order
  kHeader,     // angles and times of beams, frames, doublings
  kRanges,
  kWheels,
  kMounting,  // where the scanners sit, by what they see
  kView,      // whether what they see is enough
};

// Finding is one thing that plumbline_check has to tell.
struct Finding {
  Severity severity = Severity::kNote;
  std::string subject;   // the topic that it is about; empty: the whole recording or rig
  std::string sentence;  // what is so, with its figures
  std::string advice;    // what to change; empty where there is nothing to do
  Subject about = Subject::kRecording;
  // Whether scanners that sit as the rig file says would seem to sit otherwise by this.
  bool moves_places = false;
  // Whether RecordingReader::warnings() tell it, too.
  bool is_told_by_reader = false;
};

}  // namespace plumbline

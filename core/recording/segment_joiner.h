#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "core/recording/message_file.h"
#include "core/recording/messages.h"

namespace plumbline {

// Appends the next segment of a revolution; false, and nothing is done, where it is none: its
// beams have to go on where the line's end, in angle and in time, with the same increment and
// frame, and both together must not exceed a turn. Beams that are missing in between, no more
// than the segment has, have no return; a beam that both have is taken once. Where
// time_increment is 0, the stamps of the segments say how fast the scanner turns.
bool AppendSegment(const ScanLineMessage& segment, ScanLineMessage* line);

// SegmentJoiner makes one scan line of each revolution that a scanner sends in several
// messages, such as of 30 degrees each. Of other scanners each message is a scan line.
class SegmentJoiner {
 public:
  // Takes a scan line and the messages that it is made of, at least one; both are valid during
  // the call only.
  using Take = std::function<void(const std::vector<MessageRef>&, const ScanLineMessage&)>;

  explicit SegmentJoiner(Take take) : take_(std::move(take)) {}

  // Messages in the order of the file. Once a message goes on where the topic's last one
  // ended, the topic's messages are segments: each is kept until the revolution is over. The
  // segment before is a scan line of its own.
  void Add(const MessageRef& message, const ScanLineMessage& scan_line);
  // Takes what is kept.
  void Finish();

 private:
  struct Topic {
    bool has_segments = false;
    std::vector<MessageRef> parts;  // of the line; empty: nothing is kept
    ScanLineMessage line;           // where there are no segments: the last, without ranges
  };
  void TakeKept(Topic* topic);

  Take take_;
  std::map<uint32_t, Topic> topics_;  // by index
};

}  // namespace plumbline

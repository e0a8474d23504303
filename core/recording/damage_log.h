#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace plumbline {

// "1 message", "3 messages".
std::string CountText(uint64_t count, const std::string& noun);

// Counts what is wrong with a file, kind by kind, so that a thousand damages of one kind are
// one sentence.
class DamageLog {
 public:
  // kind: a sentence without its end; there should be few different ones.
  // position: byte of the file where it is. num_bytes: that were passed over for it.
  void Add(const std::string& kind, uint64_t position, uint64_t num_bytes = 0);

  // "kind: N times, M bytes, first at byte P", in the order of their first occurrence.
  std::vector<std::string> Sentences() const;

 private:
  struct Entry {
    std::string kind;
    uint64_t count = 0;
    uint64_t num_bytes = 0;
    uint64_t first_position = 0;
  };
  std::vector<Entry> entries_;
};

}  // namespace plumbline

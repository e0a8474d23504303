#include "core/recording/damage_log.h"

#include <algorithm>

namespace plumbline {

std::string CountText(uint64_t count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

void DamageLog::Add(const std::string& kind, uint64_t position, uint64_t num_bytes) {
  auto entry = std::find_if(entries_.begin(), entries_.end(), [&kind](const Entry& known) {
    return known.kind == kind;
  });
  if (entry == entries_.end()) {
    entry = entries_.insert(entries_.end(), {kind, 0, 0, position});
  }
  ++entry->count;
  entry->num_bytes += num_bytes;
}

std::vector<std::string> DamageLog::Sentences() const {
  std::vector<std::string> sentences;
  for (const Entry& entry : entries_) {
    std::string sentence = entry.kind + ": ";
    if (entry.count > 1) sentence += std::to_string(entry.count) + " times, ";
    if (entry.num_bytes > 0) sentence += std::to_string(entry.num_bytes) + " bytes, ";
    if (entry.count > 1) sentence += "first ";
    sentences.push_back(sentence + "at byte " + std::to_string(entry.first_position));
  }
  return sentences;
}

}  // namespace plumbline

#pragma once

#include <cstdint>
#include <cstdio>
#include <set>
#include <string>
#include <vector>

#include "core/recording/message_file.h"
#include "core/util/one_line.h"

namespace plumbline {

// Words of the errors and warnings about a recording.

// Names and topics in messages, and how many of them.
inline constexpr size_t kMaxQuotedBytes = 200;
inline constexpr size_t kMaxListedTopics = 20;

inline std::string Shown(const std::string& text) { return OnOneLine(text, kMaxQuotedBytes); }

inline std::string Quoted(const std::string& text) { return "'" + Shown(text) + "'"; }

inline std::string ReceiptText(uint64_t receipt_ns) {
  char text[64];
  std::snprintf(text,
                sizeof(text),
                "%llu.%09llu s",
                static_cast<unsigned long long>(receipt_ns / 1'000'000'000),
                static_cast<unsigned long long>(receipt_ns % 1'000'000'000));
  return text;
}

inline std::string TopicsText(const std::set<std::string>& topics) {
  std::string text;
  size_t num_listed = 0;
  for (const std::string& topic : topics) {
    if (++num_listed > kMaxListedTopics) {
      return text + " and " + std::to_string(topics.size() - kMaxListedTopics) + " more";
    }
    text += (text.empty() ? " " : ", ") + Shown(topic);
  }
  return text.empty() ? " none" : text;
}

// Messages of one scanner that are lost for one reason.
struct LostMessages {
  int count = 0;
  uint64_t first_receipt_ns = 0;

  void Add(const MessageRef& message) {
    if (count++ == 0) first_receipt_ns = message.receipt_ns;
  }
  // Adds a sentence, if there are any; whose: "scanner 'left'", why: "that can not be
  // decoded".
  void WarnOf(const std::string& whose,
              const std::string& why,
              std::vector<std::string>* warnings) const {
    if (count == 0) return;
    warnings->push_back(whose + ": " + std::to_string(count) +
                        (count == 1 ? " message is lost " : " messages are lost ") + why +
                        ", the first recorded at " + ReceiptText(first_receipt_ns));
  }
};

}  // namespace plumbline

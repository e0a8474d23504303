#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/recording/message_file.h"
#include "test/core/recording/byte_text.h"

namespace plumbline {

// The messages that a reader of recordings visits, each as text(message, data). Reads them
// again, from the last to the first: the reader has to find the same.
template <typename Message, typename Reader, typename Wants, typename Text>
std::vector<std::string> ScannedMessages(const Wants& wants,
                                         const Text& text,
                                         Reader* reader) {
  std::vector<Message> places;
  std::vector<std::string> messages;
  reader->Scan(wants, [&](const Message& message, ByteView data) {
    places.push_back(message);
    messages.push_back(text(message, data));
    return true;
  });
  for (size_t i = places.size(); i-- > 0;) {
    EXPECT_EQ(text(places[i], reader->Read(places[i])), messages[i]);
  }
  return messages;
}

// Those of a file as "topic time data".
inline std::vector<std::string> ScannedMessages(const MessageFile::Wants& wants,
                                                MessageFile* file) {
  const auto text = [&](const MessageRef& message, ByteView data) {
    return file->topics()[message.topic_index].name + " " +
           std::to_string(message.receipt_ns) + " " + TextOf(data);
  };
  return ScannedMessages<MessageRef>(wants, text, file);
}

}  // namespace plumbline

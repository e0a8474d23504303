#pragma once

#include <cstdint>
#include <string>

#include "test/core/recording/byte_text.h"

namespace plumbline {

// Records of MCAP files, written by hand (https://mcap.dev/spec).

inline std::string McapMagicText() { return "\x89MCAP0\r\n"; }

inline std::string McapRecordText(int type, const std::string& content) {
  return BytesOf(static_cast<uint8_t>(type)) + BytesOf(uint64_t{content.size()}) + content;
}

inline std::string McapSchemaText(uint16_t id, const std::string& type) {
  return McapRecordText(
      3, BytesOf(id) + WithLength(type) + WithLength("ros2msg") + WithLength(""));
}

// metadata: keys and values, each behind its length.
inline std::string McapChannelText(uint16_t id,
                                   uint16_t schema,
                                   const std::string& topic,
                                   const std::string& encoding,
                                   const std::string& metadata = "") {
  return McapRecordText(4,
                        BytesOf(id) + BytesOf(schema) + WithLength(topic) +
                            WithLength(encoding) + WithLength(metadata));
}

inline std::string McapMessageText(uint16_t channel,
                                   uint64_t time_ns,
                                   const std::string& data) {
  return McapRecordText(
      5, BytesOf(channel) + BytesOf(uint32_t{0}) + BytesOf(time_ns) + BytesOf(time_ns) + data);
}

inline std::string McapChunkText(const std::string& compression,
                                 uint64_t unpacked_size,
                                 uint32_t unpacked_crc,
                                 const std::string& records) {
  return McapRecordText(6,
                        BytesOf(uint64_t{1}) + BytesOf(uint64_t{2}) + BytesOf(unpacked_size) +
                            BytesOf(unpacked_crc) + WithLength(compression) +
                            BytesOf(uint64_t{records.size()}) + records);
}

// Entries: times and offsets of messages, 8 bytes each.
inline std::string McapMessageIndexText(uint16_t channel, const std::string& entries) {
  return McapRecordText(7, BytesOf(channel) + WithLength(entries));
}

// Without the lengths of the chunk's parts, which nobody reads.
inline std::string McapChunkIndexText(uint64_t position) {
  return McapRecordText(8, BytesOf(uint64_t{1}) + BytesOf(uint64_t{2}) + BytesOf(position));
}

// Counts: the id of a channel and the number of its messages, 2 and 8 bytes.
inline std::string McapStatisticsText(uint32_t num_chunks, const std::string& counts) {
  return McapRecordText(11,
                        BytesOf(uint64_t{0}) + BytesOf(uint16_t{1}) + BytesOf(uint32_t{1}) +
                            BytesOf(uint32_t{0}) + BytesOf(uint32_t{0}) + BytesOf(num_chunks) +
                            BytesOf(uint64_t{1}) + BytesOf(uint64_t{2}) + WithLength(counts));
}

// The end of the data, the summary, and the end of the file. data: all that comes before.
inline std::string McapFileText(const std::string& data, const std::string& summary) {
  const std::string begin = McapMagicText() + data + McapRecordText(15, BytesOf(uint32_t{0}));
  return begin + summary +
         McapRecordText(2,
                        BytesOf(summary.empty() ? uint64_t{0} : uint64_t{begin.size()}) +
                            BytesOf(uint64_t{0}) + BytesOf(uint32_t{0})) +
         McapMagicText();
}

}  // namespace plumbline

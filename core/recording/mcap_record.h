#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// An MCAP file is its magic, a sequence of records, and its magic again. A record:
//   type (uint8), length of the content (uint64), content
// The data come first: header, then schemas, channels and messages, in chunks (which may be
// packed) or not, each chunk followed by an index of its messages. What comes behind the end
// of the data repeats schemas and channels, and says where the chunks are and how many
// messages each channel has.
// https://mcap.dev/spec
struct McapRecord {
  enum class Type : uint8_t {
    kHeader = 1,
    kFooter = 2,
    kSchema = 3,
    kChannel = 4,
    kMessage = 5,
    kChunk = 6,
    kMessageIndex = 7,
    kChunkIndex = 8,
    kAttachment = 9,
    kAttachmentIndex = 10,
    kStatistics = 11,
    kMetadata = 12,
    kMetadataIndex = 13,
    kSummaryOffset = 14,
    kDataEnd = 15,
  };

  static constexpr uint64_t kHeadBytes = 9;

  Type type = Type::kHeader;
  uint64_t begin = 0;  // of the content: position in the source
  uint64_t size = 0;   // of the content

  // The end of the record; the largest number where it would be beyond.
  uint64_t end() const { return size > UINT64_MAX - begin ? UINT64_MAX : begin + size; }
};

inline constexpr uint8_t kMcapMagic[] = {0x89, 'M', 'C', 'A', 'P', 0x30, '\r', '\n'};

// The record that begins at `offset` of the source; nullopt where its type does not exist, or
// its head is not there. Its content may lie beyond the end of the source.
std::optional<McapRecord> ReadMcapRecord(ByteSource* source, uint64_t offset);

// Contents of records; each is read whole: nullopt where its lengths contradict each other.

struct McapSchema {  // of messages: their type
  uint16_t id = 0;
  std::string name;
};

struct McapChannel {  // one publisher of one topic
  uint16_t id = 0;
  uint16_t schema_id = 0;
  std::string topic;
  std::string encoding;  // "ros1" or "cdr", say
  std::map<std::string, std::string> metadata;
};

struct McapMessage {
  static constexpr uint64_t kHeadBytes = 22;  // before its data

  uint16_t channel_id = 0;
  uint64_t log_time_ns = 0;
};

struct McapChunk {
  std::string compression;  // "", "lz4" or "zstd"
  uint64_t unpacked_size = 0;
  uint32_t unpacked_crc = 0;  // 0: none
  uint64_t begin = 0;         // of the packed records: position in the source
  uint64_t size = 0;          // of these
};

struct McapStatistics {
  uint32_t num_chunks = 0;
  std::map<uint16_t, uint64_t> message_counts;  // by channel
};

std::optional<McapSchema> ReadMcapSchema(ByteSource* source, const McapRecord& record);
std::optional<McapChannel> ReadMcapChannel(ByteSource* source, const McapRecord& record);
std::optional<McapMessage> ReadMcapMessage(ByteSource* source, const McapRecord& record);
std::optional<McapChunk> ReadMcapChunk(ByteSource* source, const McapRecord& record);
std::optional<McapStatistics> ReadMcapStatistics(ByteSource* source, const McapRecord& record);
// Returns where the summary begins, by a footer; 0 where there is none.
std::optional<uint64_t> ReadMcapFooter(ByteSource* source, const McapRecord& record);
// Returns where the messages of one channel begin in a chunk, by the message index behind it.
std::optional<std::vector<uint64_t>> ReadMcapMessageIndex(ByteSource* source,
                                                          const McapRecord& record);
// Returns where the chunk is that a chunk index describes.
std::optional<uint64_t> ReadMcapChunkIndex(ByteSource* source, const McapRecord& record);

}  // namespace plumbline

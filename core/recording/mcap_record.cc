#include "core/recording/mcap_record.h"

#include <algorithm>

namespace plumbline {
namespace {

// Names, definitions of types, and maps of a few entries.
constexpr uint64_t kMaxDescriptionBytes = uint64_t{16} << 20;

bool TakeText(ByteCursor* cursor, std::string* text) {
  uint32_t length = 0;
  ByteView bytes;
  if (!cursor->Take(&length) || !cursor->Take(length, &bytes)) return false;
  text->assign(reinterpret_cast<const char*>(bytes.data), bytes.size);
  return true;
}

// A map is its length in bytes and its keys and values.
template <typename Take>
bool TakeMap(ByteCursor* cursor, const Take& take_entry) {
  uint32_t length = 0;
  ByteView bytes;
  if (!cursor->Take(&length) || !cursor->Take(length, &bytes)) return false;
  ByteCursor entries(bytes);
  while (entries.num_left() > 0) {
    if (!take_entry(&entries)) return false;
  }
  return true;
}

bool ViewContent(ByteSource* source, const McapRecord& record, ByteView* content) {
  return record.size <= kMaxDescriptionBytes &&
         source->View(record.begin, static_cast<size_t>(record.size), content);
}

}  // namespace

std::optional<McapRecord> ReadMcapRecord(ByteSource* source, uint64_t offset) {
  ByteView bytes;
  if (!source->View(offset, McapRecord::kHeadBytes, &bytes)) return std::nullopt;
  ByteCursor cursor(bytes);
  uint8_t type = 0;
  McapRecord record;
  if (!cursor.Take(&type) || !cursor.Take(&record.size)) return std::nullopt;
  // Types from 128 on are anybody's own.
  if (type == 0 || (type > 15 && type < 128)) return std::nullopt;
  record.type = static_cast<McapRecord::Type>(type);
  record.begin = offset + McapRecord::kHeadBytes;
  return record;
}

std::optional<McapSchema> ReadMcapSchema(ByteSource* source, const McapRecord& record) {
  ByteView content;
  if (!ViewContent(source, record, &content)) return std::nullopt;
  ByteCursor cursor(content);
  McapSchema schema;
  std::string encoding;
  std::string definition;
  if (!cursor.Take(&schema.id) || !TakeText(&cursor, &schema.name) ||
      !TakeText(&cursor, &encoding) || !TakeText(&cursor, &definition)) {
    return std::nullopt;
  }
  return schema;
}

std::optional<McapChannel> ReadMcapChannel(ByteSource* source, const McapRecord& record) {
  ByteView content;
  if (!ViewContent(source, record, &content)) return std::nullopt;
  ByteCursor cursor(content);
  McapChannel channel;
  const auto take_entry = [&channel](ByteCursor* entries) {
    std::string key;
    std::string value;
    if (!TakeText(entries, &key) || !TakeText(entries, &value)) return false;
    channel.metadata[key] = value;
    return true;
  };
  if (!cursor.Take(&channel.id) || !cursor.Take(&channel.schema_id) ||
      !TakeText(&cursor, &channel.topic) || !TakeText(&cursor, &channel.encoding) ||
      !TakeMap(&cursor, take_entry)) {
    return std::nullopt;
  }
  return channel;
}

std::optional<McapMessage> ReadMcapMessage(ByteSource* source, const McapRecord& record) {
  ByteView content;
  if (record.size < McapMessage::kHeadBytes ||
      !source->View(record.begin, McapMessage::kHeadBytes, &content)) {
    return std::nullopt;
  }
  ByteCursor cursor(content);
  McapMessage message;
  uint32_t sequence = 0;
  if (!cursor.Take(&message.channel_id) || !cursor.Take(&sequence) ||
      !cursor.Take(&message.log_time_ns)) {
    return std::nullopt;
  }
  return message;
}

std::optional<McapChunk> ReadMcapChunk(ByteSource* source, const McapRecord& record) {
  // Two times, size, checksum, the name of the compression, size of the records.
  constexpr uint64_t kMaxHeadBytes = 8 + 8 + 8 + 4 + 4 + 64 + 8;
  ByteView head;
  const uint64_t there = std::min(
      {record.size, kMaxHeadBytes, source->size() - std::min(source->size(), record.begin)});
  if (!source->View(record.begin, static_cast<size_t>(there), &head)) return std::nullopt;
  ByteCursor cursor(head);
  McapChunk chunk;
  uint64_t start_ns = 0;
  uint64_t end_ns = 0;
  if (!cursor.Take(&start_ns) || !cursor.Take(&end_ns) || !cursor.Take(&chunk.unpacked_size) ||
      !cursor.Take(&chunk.unpacked_crc) || !TakeText(&cursor, &chunk.compression) ||
      !cursor.Take(&chunk.size)) {
    return std::nullopt;
  }
  const uint64_t head_size = there - cursor.num_left();
  if (chunk.size != record.size - head_size) return std::nullopt;
  chunk.begin = record.begin + head_size;
  return chunk;
}

std::optional<McapStatistics> ReadMcapStatistics(ByteSource* source,
                                                 const McapRecord& record) {
  ByteView content;
  if (!ViewContent(source, record, &content)) return std::nullopt;
  ByteCursor cursor(content);
  McapStatistics statistics;
  uint64_t num_messages = 0;
  uint16_t num_schemas = 0;
  uint32_t num_channels = 0, num_attachments = 0, num_metadata = 0;
  uint64_t start_ns = 0, end_ns = 0;
  const auto take_entry = [&statistics](ByteCursor* entries) {
    uint16_t channel_id = 0;
    uint64_t count = 0;
    if (!entries->Take(&channel_id) || !entries->Take(&count)) return false;
    statistics.message_counts[channel_id] = count;
    return true;
  };
  if (!cursor.Take(&num_messages) || !cursor.Take(&num_schemas) ||
      !cursor.Take(&num_channels) || !cursor.Take(&num_attachments) ||
      !cursor.Take(&num_metadata) || !cursor.Take(&statistics.num_chunks) ||
      !cursor.Take(&start_ns) || !cursor.Take(&end_ns) || !TakeMap(&cursor, take_entry)) {
    return std::nullopt;
  }
  return statistics;
}

std::optional<uint64_t> ReadMcapFooter(ByteSource* source, const McapRecord& record) {
  ByteView content;
  uint64_t summary_begin = 0;
  if (!ViewContent(source, record, &content)) return std::nullopt;
  ByteCursor cursor(content);
  if (!cursor.Take(&summary_begin)) return std::nullopt;
  return summary_begin;
}

std::optional<std::vector<uint64_t>> ReadMcapMessageIndex(ByteSource* source,
                                                          const McapRecord& record) {
  ByteView content;
  if (!ViewContent(source, record, &content)) return std::nullopt;
  ByteCursor cursor(content);
  uint16_t channel_id = 0;
  std::vector<uint64_t> offsets;
  const auto take_entry = [&offsets](ByteCursor* entries) {
    uint64_t time_ns = 0;
    uint64_t offset = 0;
    if (!entries->Take(&time_ns) || !entries->Take(&offset)) return false;
    offsets.push_back(offset);
    return true;
  };
  if (!cursor.Take(&channel_id) || !TakeMap(&cursor, take_entry)) return std::nullopt;
  return offsets;
}

std::optional<uint64_t> ReadMcapChunkIndex(ByteSource* source, const McapRecord& record) {
  ByteView content;
  if (!ViewContent(source, record, &content)) return std::nullopt;
  ByteCursor cursor(content);
  uint64_t start_ns = 0, end_ns = 0, position = 0;
  if (!cursor.Take(&start_ns) || !cursor.Take(&end_ns) || !cursor.Take(&position)) {
    return std::nullopt;
  }
  return position;
}

}  // namespace plumbline

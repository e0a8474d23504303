#include "core/recording/mcap_file.h"

#include <algorithm>
#include <boost/crc.hpp>
#include <optional>
#include <utility>

#include "core/recording/decode.h"
#include "core/recording/message_limits.h"
#include "core/util/error.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

constexpr size_t kWindowBytes = size_t{64} << 10;
constexpr uint64_t kMaxChunkBytes = UINT32_MAX;
constexpr size_t kMaxQuotedBytes = 100;
constexpr uint64_t kFooterBytes = McapRecord::kHeadBytes + 8 + 8 + 4;
// Says in a MessageRef that the message lies in no chunk.
constexpr uint32_t kNoChunk = UINT32_MAX;

const char kNoRecord[] = "damaged MCAP file: what is no record was passed over";
const char kBreaksOff[] = "damaged MCAP file: a record breaks off";
const char kBadRecord[] = "damaged MCAP file: a record can not be read and was passed over";
const char kPartOfChunk[] = "damaged MCAP file: what is no record was passed over in a chunk";
const char kUnknownTopic[] = "damaged MCAP file: a message belongs to no topic and is lost";
const char kTwoChannels[] = "damaged MCAP file: a topic is described in two ways";
const char kChecksum[] = "damaged MCAP file: the checksum of a chunk does not fit its bytes";

MessageEncoding EncodingOf(const std::string& name) {
  if (name == "cdr") return MessageEncoding::kCdr;
  if (name == "ros1") return MessageEncoding::kRos1;
  return MessageEncoding::kUnknown;
}

bool HasChecksum(ByteSource* chunk, uint32_t checksum) {
  boost::crc_32_type sum;
  for (uint64_t begin = 0; begin < chunk->size();) {
    ByteView bytes;
    const uint64_t size = std::min<uint64_t>(kWindowBytes, chunk->size() - begin);
    if (!chunk->View(begin, static_cast<size_t>(size), &bytes)) return false;
    sum.process_bytes(bytes.data, bytes.size);
    begin += size;
  }
  return sum.checksum() == checksum;
}

}  // namespace

McapFile::McapFile(std::unique_ptr<InputFile> file)
    : file_(std::move(file)), window_(file_.get(), kWindowBytes), chunks_(file_.get()) {}

void McapFile::Scan(const Wants& wants, const Visit& visit) {
  wants_ = wants;
  visit_ = visit;
  ReadSummary();
  uint64_t position = sizeof(kMcapMagic);
  while (!ends_ && position < file_->size()) position = ReadTopRecord(position);
  wants_ = nullptr;
  visit_ = nullptr;
  CompareWithSummary();
  for (std::string& sentence : damages_.Sentences()) warnings_.push_back(std::move(sentence));
}

// The footer lies before the magic at the end of the file, and says where the summary begins.
void McapFile::ReadSummary() {
  if (file_->size() < 2 * sizeof(kMcapMagic) + kFooterBytes) return;
  const uint64_t footer_position = file_->size() - sizeof(kMcapMagic) - kFooterBytes;
  const std::optional<McapRecord> footer = ReadMcapRecord(&window_, footer_position);
  if (!footer || footer->type != McapRecord::Type::kFooter) return;
  const std::optional<uint64_t> begin = ReadMcapFooter(&window_, *footer);
  if (!begin) return;
  in_summary_ = true;
  summary_.is_there = true;  // a writer may leave all of it out
  for (uint64_t position = *begin; position > 0 && position < footer_position;) {
    const std::optional<McapRecord> record = ReadMcapRecord(&window_, position);
    if (!record || record->end() > footer_position) {
      summary_.is_there = false;
      break;
    }
    if (record->type == McapRecord::Type::kChunkIndex) {
      const std::optional<uint64_t> chunk = ReadMcapChunkIndex(&window_, *record);
      if (chunk) summary_.positions.push_back(*chunk);
    } else if (record->type == McapRecord::Type::kStatistics) {
      const std::optional<McapStatistics> statistics = ReadMcapStatistics(&window_, *record);
      summary_.has_statistics = statistics.has_value();
      if (statistics) summary_.statistics = *statistics;
    } else if (record->type == McapRecord::Type::kSchema ||
               record->type == McapRecord::Type::kChannel) {
      ReadRecord(*record, kNoChunk, position, &window_);
    }
    position = record->end();
  }
  std::sort(summary_.positions.begin(), summary_.positions.end());
  in_summary_ = false;
}

// Returns a place behind `position` at which a chunk begins, by the summary; else the end of
// the file.
uint64_t McapFile::NextChunkPosition(uint64_t position) const {
  const auto chunk =
      std::upper_bound(summary_.positions.begin(), summary_.positions.end(), position);
  return chunk == summary_.positions.end() ? file_->size() : std::min(*chunk, file_->size());
}

// Returns where the next record begins.
uint64_t McapFile::ReadTopRecord(uint64_t position) {
  const std::optional<McapRecord> record = ReadMcapRecord(&window_, position);
  if (record && record->type == McapRecord::Type::kChunk) return ReadChunk(*record, position);
  if (record && (record->type == McapRecord::Type::kDataEnd ||
                 record->type == McapRecord::Type::kFooter)) {
    ends_ = true;
    return file_->size();
  }
  if (!record || record->end() > file_->size()) {
    const uint64_t next = NextChunkPosition(position);
    damages_.Add(record ? kBreaksOff : kNoRecord, position, next - position);
    return next;
  }
  if (!ReadRecord(*record, kNoChunk, position, &window_)) damages_.Add(kBadRecord, position);
  return record->end();
}

uint64_t McapFile::ReadChunk(const McapRecord& record, uint64_t position) {
  const std::optional<McapChunk> chunk = ReadMcapChunk(&window_, record);
  if (!chunk || chunk->size > kMaxChunkBytes || chunk->unpacked_size > kMaxChunkBytes) {
    const uint64_t next = NextChunkPosition(position);
    damages_.Add(kBadRecord, position, next - position);
    return next;
  }
  BagRecord stored;
  stored.compression = chunk->compression.empty() ? "none" : chunk->compression;
  stored.data_begin = chunk->begin;
  stored.data_size = static_cast<uint32_t>(chunk->size);
  stored.unpacked_size = static_cast<uint32_t>(chunk->unpacked_size);
  const uint32_t chunk_index = chunks_.Add(stored);
  ++num_chunks_;
  const ChunkStore::Contents contents = chunks_.Open(chunk_index);
  const bool is_whole = contents.problem.empty();
  if (!is_whole) {
    damages_.Add("damaged MCAP file: a chunk can not be read whole, since " + contents.problem,
                 position);
  } else if (chunk->unpacked_crc != 0 && !HasChecksum(contents.source, chunk->unpacked_crc)) {
    damages_.Add(kChecksum, position);
  }
  const bool is_good =
      ReadChunkRecords(chunk_index, position, MessageOffsets(record.end()), contents.source);
  if (is_whole && is_good) return record.end();
  // Where the chunk claims too much, others may lie in what it claims.
  return std::min(NextChunkPosition(position), std::min(record.end(), file_->size()));
}

// Returns where the messages in a chunk begin, by the index behind it, increasing.
std::vector<uint64_t> McapFile::MessageOffsets(uint64_t chunk_end) {
  std::vector<uint64_t> offsets;
  for (uint64_t position = chunk_end; position < file_->size();) {
    const std::optional<McapRecord> record = ReadMcapRecord(&window_, position);
    if (!record || record->type != McapRecord::Type::kMessageIndex) break;
    const std::optional<std::vector<uint64_t>> more = ReadMcapMessageIndex(&window_, *record);
    if (!more) break;
    offsets.insert(offsets.end(), more->begin(), more->end());
    position = record->end();
  }
  std::sort(offsets.begin(), offsets.end());
  return offsets;
}

// False where something in the chunk is no record; what follows is read where the index of the
// chunk says where a message begins.
bool McapFile::ReadChunkRecords(uint32_t chunk_index,
                                uint64_t chunk_position,
                                const std::vector<uint64_t>& message_offsets,
                                ByteSource* chunk) {
  bool is_good = true;
  for (uint64_t offset = 0; offset < chunk->size();) {
    const std::optional<McapRecord> record = ReadMcapRecord(chunk, offset);
    if (record && record->end() <= chunk->size()) {
      if (!ReadRecord(*record, chunk_index, chunk_position, chunk)) {
        damages_.Add(kBadRecord, chunk_position);
      }
      offset = record->end();
      continue;
    }
    const auto known =
        std::upper_bound(message_offsets.begin(), message_offsets.end(), offset);
    const uint64_t next = known == message_offsets.end()
                              ? chunk->size()
                              : std::min<uint64_t>(*known, chunk->size());
    damages_.Add(kPartOfChunk, chunk_position, next - offset);
    offset = next;
    is_good = false;
  }
  return is_good;
}

// Takes up a schema, a channel or a message; false where its content makes no sense.
//   part    the chunk's index, or kNoChunk
//   place   where a damage is said to be
bool McapFile::ReadRecord(const McapRecord& record,
                          uint32_t part,
                          uint64_t place,
                          ByteSource* source) {
  if (record.type == McapRecord::Type::kSchema) {
    const std::optional<McapSchema> schema = ReadMcapSchema(source, record);
    if (schema) schemas_.emplace(schema->id, schema->name);
    return schema.has_value();
  }
  if (record.type == McapRecord::Type::kChannel) {
    const std::optional<McapChannel> channel = ReadMcapChannel(source, record);
    if (channel) AddChannel(*channel, place);
    return channel.has_value();
  }
  if (record.type == McapRecord::Type::kMessage) ReadMessage(record, part, place, source);
  return true;
}

// The first description of a channel counts: the summary's, if there is one.
void McapFile::AddChannel(const McapChannel& channel, uint64_t place) {
  RecordingTopic topic;
  topic.name = channel.topic;
  const auto schema = schemas_.find(channel.schema_id);
  if (schema != schemas_.end()) {
    topic.type = schema->second;
  } else if (in_summary_) {
    return;  // which may have its schemas last; the data have both
  }
  topic.encoding = EncodingOf(channel.encoding);
  const auto definition = channel.metadata.find("md5sum");  // of what was a ROS 1 bag
  if (definition != channel.metadata.end() && topic.encoding == MessageEncoding::kRos1) {
    topic.definition = definition->second;
  }
  topic.kind = KindOf(topic);
  const auto [known, is_new] =
      topic_indices_.emplace(channel.id, static_cast<uint32_t>(topics_.size()));
  if (!is_new) {
    const RecordingTopic& first = topics_[known->second];
    if (first.name != topic.name || first.type != topic.type) {
      damages_.Add(kTwoChannels, place);
    }
    return;
  }
  topics_.push_back(topic);
  wanted_.push_back(wants_(topics_.back()));
}

void McapFile::ReadMessage(const McapRecord& record,
                           uint32_t part,
                           uint64_t place,
                           ByteSource* source) {
  const std::optional<McapMessage> head = ReadMcapMessage(source, record);
  const auto topic = head ? topic_indices_.find(head->channel_id) : topic_indices_.end();
  if (topic == topic_indices_.end()) {
    damages_.Add(kUnknownTopic, place);
    return;
  }
  ++topics_[topic->second].num_messages;
  if (!wanted_[topic->second]) return;
  MessageRef message;
  message.receipt_ns = head->log_time_ns;
  message.topic_index = topic->second;
  message.part = part;
  message.begin = record.begin + McapMessage::kHeadBytes;
  const uint64_t size = record.size - McapMessage::kHeadBytes;
  ByteView data;
  if (size > kMaxMessageBytes ||
      !source->View(message.begin, static_cast<size_t>(size), &data)) {
    damages_.Add(kTooLarge, place);
    return;
  }
  message.size = static_cast<uint32_t>(size);
  visit_(message, data);
}

void McapFile::CompareWithSummary() {
  if (!summary_.is_there || !ends_) {
    warnings_.push_back(
        summary_.is_there
            ? "the end of the recording's data is missing: all that could be read was used"
            : "the recording was never closed, or its summary is damaged: all that could be "
              "read was used");
  }
  if (!summary_.has_statistics) return;
  const McapStatistics& statistics = summary_.statistics;
  if (statistics.num_chunks != num_chunks_) {
    warnings_.push_back("the summary of the recording states " +
                        CountText(statistics.num_chunks, "chunk") + ", but " +
                        std::to_string(num_chunks_) + " could be read");
  }
  for (const auto& [channel_id, topic_index] : topic_indices_) {
    const RecordingTopic& topic = topics_[topic_index];
    const auto stated = statistics.message_counts.find(channel_id);
    const uint64_t num_stated = stated == statistics.message_counts.end() ? 0 : stated->second;
    if (!wanted_[topic_index] || num_stated == topic.num_messages) continue;
    warnings_.push_back("topic " + OnOneLine(topic.name, kMaxQuotedBytes) +
                        ": the summary of the recording states " +
                        CountText(num_stated, "message") + ", but " +
                        std::to_string(topic.num_messages) + " could be found");
  }
}

ByteView McapFile::Read(const MessageRef& message) {
  ByteView data;
  ByteSource* source = message.part == kNoChunk ? &window_ : chunks_.Open(message.part).source;
  if (!source->View(message.begin, message.size, &data)) {
    throw Error(path() + ": has changed while it was read");
  }
  return data;
}

}  // namespace plumbline

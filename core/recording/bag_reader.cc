#include "core/recording/bag_reader.h"

#include <glog/logging.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/recording/message_limits.h"
#include "core/util/error.h"
#include "core/util/one_line.h"

namespace plumbline {
namespace {

// Index data and the next chunk's header.
constexpr size_t kWindowBytes = size_t{32} << 10;
constexpr size_t kMaxQuotedBytes = 100;

const char kMagic[] = "#ROSBAG V";
const char kVersionLine[] = "#ROSBAG V2.0\n";
constexpr size_t kVersionLineBytes = sizeof(kVersionLine) - 1;

// Recorders pad the header, so that there is space for what they know only at the end.
constexpr uint64_t kHeaderBytes = 4096;

const char kBreaksOffAtOnce[] = ": the recording breaks off in its header";
const char kHeaderDamaged[] = ": the header of the recording is damaged";
const char kNoRecord[] = "damaged bag: what is no record was passed over";
const char kMisplaced[] =
    "damaged bag: a record where none of its kind belongs was passed over";
const char kPartOfChunk[] = "damaged bag: what is no message was passed over in a chunk";
const char kNoConnection[] = "damaged bag: a topic's description can not be read";
const char kTwoConnections[] = "damaged bag: a topic is described in two ways";
const char kUnknownTopic[] = "damaged bag: a message belongs to no topic and is lost";

bool AreSame(const BagConnection& a, const BagConnection& b) {
  return a.topic == b.topic && a.type == b.type && a.md5sum == b.md5sum;
}

}  // namespace

BagReader::BagReader(const std::string& path, const std::string& name)
    : file_(path, name), window_(&file_, kWindowBytes), chunks_(&file_) {
  ByteView bytes;
  const auto begins_with = [&](const char* text, size_t size) {
    return window_.View(0, size, &bytes) && std::equal(text, text + size, bytes.data);
  };
  if (!begins_with(kMagic, sizeof(kMagic) - 1)) throw Error(name + ": is not a ROS 1 bag");
  if (!begins_with(kVersionLine, kVersionLineBytes)) {
    throw Error(name + ": is a ROS 1 bag, but not of version 2.0");
  }
}

void BagReader::Scan(const Wants& wants, const Visit& visit) {
  CHECK_EQ(header_.data_begin, 0u) << "Scan() twice";
  wants_ = wants;
  visit_ = visit;
  uint64_t position = ReadHeader();
  while (position < file_.size()) position = ReadTopRecord(position);
  wants_ = nullptr;
  visit_ = nullptr;
  CompareWithIndex();
  for (std::string& sentence : damages_.Sentences()) warnings_.push_back(std::move(sentence));
}

// Returns where the records after the bag's header begin.
uint64_t BagReader::ReadHeader() {
  const std::optional<BagRecord> header = ReadBagRecord(&window_, kVersionLineBytes);
  if (!header || header->type != BagRecord::Type::kBagHeader) {
    throw Error(name() + (file_.size() < kHeaderBytes ? kBreaksOffAtOnce : kHeaderDamaged));
  }
  if (header->end() > file_.size() && file_.size() < kHeaderBytes) {
    throw Error(name() + kBreaksOffAtOnce);
  }
  if (!header->encryptor.empty()) throw Error(name() + ": the recording is encrypted");
  header_ = *header;
  if (header_.index_position > 0) {
    index_ = ReadBagIndex(&window_, header_.index_position);
    for (const BagConnection& connection : index_.connections) {
      AddConnection(connection, header_.index_position);
    }
  }
  if (header_.end() == file_.size() || ReadBagRecord(&window_, header_.end())) {
    return header_.end();
  }
  damages_.Add(kNoRecord, header_.end());
  return NextKnownPosition(kVersionLineBytes);
}

// Returns a place behind `position` at which a record begins, by the index; else the end of
// the file.
uint64_t BagReader::NextKnownPosition(uint64_t position) const {
  uint64_t next = file_.size();
  const auto chunk =
      std::upper_bound(index_.positions.begin(), index_.positions.end(), position);
  if (chunk != index_.positions.end()) next = std::min(next, *chunk);
  if (header_.index_position > position) next = std::min(next, header_.index_position);
  return next;
}

// Returns where the next record begins.
uint64_t BagReader::ReadTopRecord(uint64_t position) {
  const std::optional<BagRecord> record = ReadBagRecord(&window_, position);
  if (record && record->type == BagRecord::Type::kChunk) return ReadChunk(*record);
  if (!record || record->end() > file_.size()) {
    const uint64_t next = NextKnownPosition(position);
    damages_.Add(kNoRecord, position, next - position);
    return next;
  }
  if (record->type == BagRecord::Type::kConnection) {
    const std::optional<BagConnection> connection = ReadBagConnection(&window_, *record);
    if (!connection) {
      damages_.Add(kNoConnection, position);
    } else {
      AddConnection(*connection, position);
    }
  } else if (record->type == BagRecord::Type::kMessage ||
             record->type == BagRecord::Type::kBagHeader) {
    damages_.Add(kMisplaced, position);
  }
  return record->end();
}

uint64_t BagReader::ReadChunk(BagRecord record) {
  ++num_chunks_;
  if (header_.index_position == 0 && record.data_size == 0) {
    // The chunk that was being written: its sizes would have come last.
    record.data_size = static_cast<uint32_t>(
        std::min<uint64_t>(file_.size() - record.data_begin, UINT32_MAX));
    record.unpacked_size = record.data_size;
  }
  ChunkIndex index;
  if (record.end() < file_.size()) index = ReadChunkIndex(&window_, record.end());
  for (const auto& [connection_id, count] : index.message_counts) {
    chunk_index_counts_[connection_id] += count;
  }
  const uint32_t chunk_index = chunks_.Add(record);
  const ChunkStore::Contents contents = chunks_.Open(chunk_index);
  const bool is_packed = record.compression != "none";
  const uint64_t end = std::min(record.end(), file_.size());
  if (!contents.problem.empty()) {
    damages_.Add("damaged bag: a chunk can not be read whole, since " + contents.problem,
                 record.data_begin);
  }
  const uint64_t damage =
      ReadChunkRecords(chunk_index, record.data_begin, index.offsets, contents.source);
  // Where the chunk claims too much, others may lie in what it claims.
  const uint64_t read_until = is_packed ? contents.end : record.data_begin + damage;
  if (contents.problem.empty() && damage == contents.source->size()) return end;
  const uint64_t next = NextKnownPosition(read_until > 0 ? read_until - 1 : 0);
  return std::max(std::min(next, end), record.data_begin);
}

// Returns where in the chunk the first damage is; the size of the chunk where none is.
uint64_t BagReader::ReadChunkRecords(uint32_t chunk_index,
                                     uint64_t chunk_position,
                                     const std::vector<uint32_t>& message_offsets,
                                     ByteSource* chunk) {
  // Returns where a message begins behind `offset`, if the index has it.
  const auto next_message = [&](uint64_t offset) -> uint64_t {
    const auto next = std::upper_bound(message_offsets.begin(), message_offsets.end(), offset);
    return next == message_offsets.end() ? chunk->size()
                                         : std::min<uint64_t>(*next, chunk->size());
  };
  uint64_t first_damage = chunk->size();
  for (uint64_t offset = 0; offset < chunk->size();) {
    const std::optional<BagRecord> record = ReadBagRecord(chunk, offset);
    const bool is_here = record && record->end() <= chunk->size();
    uint64_t next = is_here ? record->end() : next_message(offset);
    if (is_here && record->type == BagRecord::Type::kMessage) {
      // The length of a message that makes no sense need not be right.
      const bool good = ReadMessage(chunk_index, chunk_position, *record, chunk);
      if (!good) next = std::min(next, next_message(offset));
    } else if (is_here && record->type == BagRecord::Type::kConnection) {
      const std::optional<BagConnection> connection = ReadBagConnection(chunk, *record);
      const bool good = connection && AddConnection(*connection, chunk_position);
      if (!connection) damages_.Add(kNoConnection, chunk_position);
      if (!good) next = std::min(next, next_message(offset));
    } else {
      next = next_message(offset);
      damages_.Add(kPartOfChunk, chunk_position);
      first_damage = std::min(first_damage, offset);
    }
    offset = next;
  }
  return first_damage;
}

// False where the message makes no sense.
bool BagReader::ReadMessage(uint32_t chunk_index,
                            uint64_t chunk_position,
                            const BagRecord& record,
                            ByteSource* chunk) {
  const auto known = connection_indices_.find(record.connection_id);
  if (known == connection_indices_.end()) {
    damages_.Add(kUnknownTopic, chunk_position);
    return false;
  }
  Tally& tally = tallies_[known->second];
  ++tally.num_found;
  if (!tally.wanted) return true;
  ByteView data;
  if (record.data_size > kMaxMessageBytes ||
      !chunk->View(record.data_begin, record.data_size, &data)) {
    damages_.Add(kTooLarge, chunk_position);
    return false;
  }
  BagMessage message;
  message.receipt_ns = record.time_ns;
  message.connection_index = known->second;
  message.chunk_index = chunk_index;
  message.begin = static_cast<uint32_t>(record.data_begin);
  message.size = record.data_size;
  return visit_(message, data);
}

// The first description of a connection counts: the index's, if there is one. False where this
// one differs.
bool BagReader::AddConnection(const BagConnection& connection, uint64_t position) {
  const auto [known, is_new] =
      connection_indices_.emplace(connection.id, static_cast<uint32_t>(connections_.size()));
  if (!is_new) {
    const bool same = AreSame(connections_[known->second], connection);
    if (!same) damages_.Add(kTwoConnections, position);
    return same;
  }
  connections_.push_back(connection);
  tallies_.push_back({wants_(connection), 0});
  return true;
}

void BagReader::CompareWithIndex() {
  if (header_.index_position == 0) {
    warnings_.push_back(
        "the bag was never closed and has no index: all that could be read was used");
    if (num_chunks_ == 0) warnings_.push_back("the bag holds no messages");
  } else {
    if (!index_.is_whole) {
      warnings_.push_back(
          "the index of the bag is missing or damaged: all that could be read was used");
    }
    const auto compare = [this](uint32_t stated, size_t found, const std::string& noun) {
      if (stated == found) return;
      warnings_.push_back("the header of the bag states " + CountText(stated, noun) +
                          ", but " + std::to_string(found) + " could be read");
    };
    compare(header_.chunk_count, num_chunks_, "chunk");
    compare(header_.connection_count, connections_.size(), "topic");
  }
  for (size_t i = 0; i < connections_.size(); ++i) {
    if (!tallies_[i].wanted) continue;
    const uint64_t num_found = tallies_[i].num_found;
    const auto stated_in = [&](const std::map<uint32_t, uint64_t>& counts) {
      const auto count = counts.find(connections_[i].id);
      return count == counts.end() ? 0 : count->second;
    };
    // A bag that was never closed may lack the index of its last chunk.
    const uint64_t num_stated =
        std::max(stated_in(index_.message_counts), stated_in(chunk_index_counts_));
    const bool may_be_more = num_stated == 0 || !index_.is_whole;
    if (num_found == num_stated || (num_found > num_stated && may_be_more)) continue;
    warnings_.push_back("topic " + OnOneLine(connections_[i].topic, kMaxQuotedBytes) +
                        ": the index of the bag states " + CountText(num_stated, "message") +
                        ", but " + std::to_string(num_found) + " could be found");
  }
}

ByteView BagReader::Read(const BagMessage& message) {
  ByteView data;
  if (!chunks_.Open(message.chunk_index).source->View(message.begin, message.size, &data)) {
    throw Error(name() + ": has changed while it was read");
  }
  return data;
}

}  // namespace plumbline

#include "core/recording/bag_index.h"

#include <algorithm>
#include <optional>

namespace plumbline {
namespace {

constexpr uint64_t kChunkInfoEntryBytes = 8;   // connection id, number of messages
constexpr uint64_t kIndexDataEntryBytes = 12;  // time of receipt, offset in the chunk

// Adds one chunk info; false where its data are not there.
bool AddChunkInfo(ByteSource* file, const BagRecord& record, BagIndex* index) {
  index->positions.push_back(record.chunk_position);
  for (uint32_t i = 0; i < record.count; ++i) {
    ByteView entry;
    uint32_t connection_id = 0;
    uint32_t count = 0;
    if (!file->View(record.data_begin + i * kChunkInfoEntryBytes, 8, &entry)) return false;
    ByteCursor cursor(entry);
    if (!cursor.Take(&connection_id) || !cursor.Take(&count)) return false;
    index->message_counts[connection_id] += count;
  }
  return true;
}

bool AddIndexRecord(ByteSource* file, const BagRecord& record, BagIndex* index) {
  if (record.type == BagRecord::Type::kChunkInfo) return AddChunkInfo(file, record, index);
  if (record.type != BagRecord::Type::kConnection) return false;
  const std::optional<BagConnection> connection = ReadBagConnection(file, record);
  if (connection) index->connections.push_back(*connection);
  return connection.has_value();
}

}  // namespace

BagIndex ReadBagIndex(ByteSource* file, uint64_t position) {
  BagIndex index;
  while (position < file->size()) {
    const std::optional<BagRecord> record = ReadBagRecord(file, position);
    if (!record || record->end() > file->size() || !AddIndexRecord(file, *record, &index)) {
      break;
    }
    position = record->end();
  }
  index.is_whole = position == file->size();
  std::sort(index.positions.begin(), index.positions.end());
  return index;
}

ChunkIndex ReadChunkIndex(ByteSource* file, uint64_t position) {
  ChunkIndex index;
  while (position < file->size()) {
    const std::optional<BagRecord> record = ReadBagRecord(file, position);
    if (!record || record->type != BagRecord::Type::kIndexData ||
        record->end() > file->size()) {
      break;
    }
    index.message_counts[record->connection_id] += record->count;
    for (uint32_t i = 0; i < record->count; ++i) {
      ByteView entry;
      uint32_t offset = 0;
      if (!file->View(record->data_begin + i * kIndexDataEntryBytes + 8, 4, &entry) ||
          !ByteCursor(entry).Take(&offset)) {
        break;
      }
      index.offsets.push_back(offset);
    }
    position = record->end();
  }
  std::sort(index.offsets.begin(), index.offsets.end());
  return index;
}

}  // namespace plumbline

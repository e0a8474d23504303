#include "core/recording/bag_record.h"

#include <algorithm>

namespace plumbline {
namespace {

// The longest header of a record is a connection's, with its topic.
constexpr uint32_t kMaxHeaderBytes = 1 << 20;
// The definition of a connection's type with all that it is made of.
constexpr uint32_t kMaxConnectionBytes = 16 << 20;

using Fields = std::map<std::string, ByteView>;

template <typename Number>
bool ReadNumber(const Fields& fields, const char* name, Number* value) {
  const auto field = fields.find(name);
  if (field == fields.end() || field->second.size != sizeof(Number)) return false;
  return ByteCursor(field->second).Take(value);
}

bool ReadText(const Fields& fields, const char* name, std::string* text) {
  const auto field = fields.find(name);
  if (field == fields.end()) return false;
  text->assign(reinterpret_cast<const char*>(field->second.data), field->second.size);
  return true;
}

// A time is two numbers: seconds, and nanoseconds within them.
bool ReadTime(const Fields& fields, const char* name, uint64_t* time_ns) {
  const auto field = fields.find(name);
  if (field == fields.end() || field->second.size != 8) return false;
  ByteCursor cursor(field->second);
  uint32_t seconds = 0;
  uint32_t nanoseconds = 0;
  if (!cursor.Take(&seconds) || !cursor.Take(&nanoseconds)) return false;
  *time_ns = uint64_t{seconds} * 1'000'000'000 + nanoseconds;
  return true;
}

// False where the record lacks a field of its type, or its data have another length than its
// fields say.
bool ReadFieldsOfType(const Fields& fields, BagRecord* record) {
  switch (record->type) {
    case BagRecord::Type::kMessage:
      return ReadNumber(fields, "conn", &record->connection_id) &&
             ReadTime(fields, "time", &record->time_ns);
    case BagRecord::Type::kBagHeader:
      ReadText(fields, "encryptor", &record->encryptor);
      return ReadNumber(fields, "index_pos", &record->index_position) &&
             ReadNumber(fields, "conn_count", &record->connection_count) &&
             ReadNumber(fields, "chunk_count", &record->chunk_count);
    case BagRecord::Type::kIndexData:
      return ReadNumber(fields, "conn", &record->connection_id) &&
             ReadNumber(fields, "count", &record->count) &&
             record->data_size == uint64_t{record->count} * 12;
    case BagRecord::Type::kChunk:
      return ReadText(fields, "compression", &record->compression) &&
             ReadNumber(fields, "size", &record->unpacked_size);
    case BagRecord::Type::kChunkInfo:
      return ReadNumber(fields, "chunk_pos", &record->chunk_position) &&
             ReadNumber(fields, "count", &record->count) &&
             record->data_size == uint64_t{record->count} * 8;
    case BagRecord::Type::kConnection:
      return ReadNumber(fields, "conn", &record->connection_id) &&
             ReadText(fields, "topic", &record->topic);
  }
  return false;
}

}  // namespace

std::optional<std::map<std::string, ByteView>> ReadBagFields(ByteView header) {
  Fields fields;
  ByteCursor cursor(header);
  while (cursor.num_left() > 0) {
    uint32_t size = 0;
    ByteView field;
    if (!cursor.Take(&size) || !cursor.Take(size, &field)) return std::nullopt;
    const uint8_t* end = field.data + field.size;
    const uint8_t* equals = std::find(field.data, end, uint8_t{'='});
    if (equals == end) return std::nullopt;
    const std::string name(reinterpret_cast<const char*>(field.data),
                           static_cast<size_t>(equals - field.data));
    const ByteView value = {equals + 1, static_cast<size_t>(end - equals - 1)};
    if (!fields.emplace(name, value).second) return std::nullopt;
  }
  return fields;
}

std::optional<BagRecord> ReadBagRecord(ByteSource* source, uint64_t offset) {
  ByteView bytes;
  uint32_t header_size = 0;
  if (!source->View(offset, 4, &bytes) || !ByteCursor(bytes).Take(&header_size) ||
      header_size > kMaxHeaderBytes ||
      !source->View(offset + 4, size_t{header_size} + 4, &bytes)) {
    return std::nullopt;
  }
  BagRecord record;
  ByteCursor cursor(bytes);
  ByteView header;
  if (!cursor.Take(header_size, &header) || !cursor.Take(&record.data_size)) {
    return std::nullopt;
  }
  record.data_begin = offset + 4 + header_size + 4;
  const std::optional<Fields> fields = ReadBagFields(header);
  uint8_t type = 0;
  if (!fields || !ReadNumber(*fields, "op", &type)) return std::nullopt;
  record.type = static_cast<BagRecord::Type>(type);
  if (!ReadFieldsOfType(*fields, &record)) return std::nullopt;
  return record;
}

std::optional<BagConnection> ReadBagConnection(ByteSource* source, const BagRecord& record) {
  ByteView data;
  if (record.data_size > kMaxConnectionBytes ||
      !source->View(record.data_begin, record.data_size, &data)) {
    return std::nullopt;
  }
  BagConnection connection;
  connection.id = record.connection_id;
  connection.topic = record.topic;
  const std::optional<Fields> fields = ReadBagFields(data);
  if (!fields || !ReadText(*fields, "type", &connection.type) ||
      !ReadText(*fields, "md5sum", &connection.md5sum)) {
    return std::nullopt;
  }
  return connection;
}

}  // namespace plumbline

#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "core/recording/byte_source.h"

namespace plumbline {

// A ROS 1 bag of format 2.0 is the line "#ROSBAG V2.0" and a sequence of records:
//   length of the header (uint32), header, length of the data (uint32), data
// The header is a sequence of fields: length (uint32), "name=value". Which record it is says
// its field "op":
//   bag header   index_pos, conn_count, chunk_count    the first record
//   chunk        compression, size (unpacked)          data: connections and messages, packed
//   index data   conn, count                           after a chunk: where its messages are
//   connection   conn, topic                           data: fields type, md5sum, ...
//   message      conn, time                            data: the serialised message
//   chunk info   chunk_pos, count                      at the end: messages of each chunk
// https://wiki.ros.org/Bags/Format/2.0
struct BagRecord {
  enum class Type : uint8_t {
    kMessage = 2,
    kBagHeader = 3,
    kIndexData = 4,
    kChunk = 5,
    kChunkInfo = 6,
    kConnection = 7,
  };

  Type type = Type::kMessage;
  uint64_t data_begin = 0;  // position in the source
  uint32_t data_size = 0;
  // Fields of the header, as far as the type has them; else 0 or empty.
  uint32_t connection_id = 0;
  uint32_t count = 0;  // entries of index data or chunk info
  uint32_t connection_count = 0;
  uint32_t chunk_count = 0;
  uint32_t unpacked_size = 0;
  uint64_t index_position = 0;
  uint64_t chunk_position = 0;
  uint64_t time_ns = 0;  // when the message was received, since 1970
  std::string compression;
  std::string topic;
  std::string encryptor;

  uint64_t end() const { return data_begin + data_size; }
};

// The record that begins at `offset` of the source; nullopt where the bytes there are none.
// The record's data may lie beyond the end of the source (end() > source->size()): whether
// they are there is the caller's question.
std::optional<BagRecord> ReadBagRecord(ByteSource* source, uint64_t offset);

// A connection: one publisher of one topic. Messages name it by its id.
struct BagConnection {
  uint32_t id = 0;
  std::string topic;
  std::string type;
  std::string md5sum;  // of the type's definition
};

// The connection that a record of that type describes; nullopt where its data do not.
std::optional<BagConnection> ReadBagConnection(ByteSource* source, const BagRecord& record);

// The fields of a header, by name; nullopt where the bytes are no such fields.
std::optional<std::map<std::string, ByteView>> ReadBagFields(ByteView header);

}  // namespace plumbline

#pragma once

#include <cstdint>
#include <string>

#include "test/core/recording/byte_text.h"

namespace plumbline {

// Records of ROS 1 bags, written by hand (core/recording/bag_record.h).

inline std::string BagField(const std::string& name, const std::string& value) {
  return WithLength(name + "=" + value);
}

inline std::string BagRecordText(const std::string& header, const std::string& data) {
  return WithLength(header) + WithLength(data);
}

inline std::string BagConnectionText(uint32_t id,
                                     const std::string& topic,
                                     const std::string& type,
                                     const std::string& md5sum) {
  return BagRecordText(
      BagField("conn", BytesOf(id)) + BagField("op", "\7") + BagField("topic", topic),
      BagField("topic", topic) + BagField("type", type) + BagField("md5sum", md5sum));
}

inline std::string BagMessageText(uint32_t connection,
                                  uint32_t seconds,
                                  const std::string& data) {
  return BagRecordText(BagField("conn", BytesOf(connection)) + BagField("op", "\2") +
                           BagField("time", BytesOf(seconds) + BytesOf(uint32_t{0})),
                       data);
}

// Before it, where `data` are the packed ones: how long they were.
inline std::string BagChunkText(const std::string& compression,
                                size_t unpacked_size,
                                const std::string& data) {
  return BagRecordText(BagField("compression", compression) + BagField("op", "\5") +
                           BagField("size", BytesOf(static_cast<uint32_t>(unpacked_size))),
                       data);
}

// The version's line and the header, 4096 bytes and a line together.
inline std::string BagHeaderText(uint64_t index_position,
                                 uint32_t num_connections,
                                 uint32_t num_chunks) {
  const std::string header = BagField("chunk_count", BytesOf(num_chunks)) +
                             BagField("conn_count", BytesOf(num_connections)) +
                             BagField("index_pos", BytesOf(index_position)) +
                             BagField("op", "\3");
  return "#ROSBAG V2.0\n" + BagRecordText(header, std::string(4088 - header.size(), ' '));
}

// One entry of index data or of a chunk info: the record's entries follow each other.
inline std::string BagIndexDataText(uint32_t connection, const std::string& entries) {
  return BagRecordText(
      BagField("ver", BytesOf(uint32_t{1})) + BagField("conn", BytesOf(connection)) +
          BagField("count", BytesOf(static_cast<uint32_t>(entries.size() / 12))) +
          BagField("op", "\4"),
      entries);
}

inline std::string BagChunkInfoText(uint64_t position, const std::string& entries) {
  return BagRecordText(
      BagField("ver", BytesOf(uint32_t{1})) + BagField("chunk_pos", BytesOf(position)) +
          BagField("count", BytesOf(static_cast<uint32_t>(entries.size() / 8))) +
          BagField("op", "\6"),
      entries);
}

}  // namespace plumbline

#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "core/recording/bag_record.h"
#include "core/recording/byte_source.h"

namespace plumbline {

// BagIndex holds the index at the end of a bag: its connections, and where its chunks are with
// how many messages of which connection. All of it may be missing or wrong. The bag is read
// from its start, and the index serves to find the next chunk behind a damage and to notice
// what is missing.
struct BagIndex {
  bool is_whole = false;  // nothing but connections and chunk infos up to the end of the file
  std::vector<BagConnection> connections;
  std::vector<uint64_t> positions;              // of the chunks, increasing
  std::map<uint32_t, uint64_t> message_counts;  // by connection id
};

// Reads the index that begins at `position` of the file.
BagIndex ReadBagIndex(ByteSource* file, uint64_t position);

// The index data of one chunk, which follow it.
struct ChunkIndex {
  std::vector<uint32_t> offsets;                // of the messages in the chunk, increasing
  std::map<uint32_t, uint64_t> message_counts;  // by connection id
};

// Reads the index data that begin at `position` of the file, if any do.
ChunkIndex ReadChunkIndex(ByteSource* file, uint64_t position);

}  // namespace plumbline

#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <string>
#include <vector>

#include "core/recording/bag_record.h"
#include "core/recording/byte_source.h"

namespace plumbline {

// Gives access to what the chunks of a bag hold. Chunks that are not packed are looked at in
// the file; of the packed ones, the last few that were used are kept unpacked.
class ChunkStore {
 public:
  // The file must outlive it.
  explicit ChunkStore(const InputFile* file);

  // Returns the index of the chunk. Only what lies within the file counts as its data.
  uint32_t Add(const BagRecord& record);

  struct Contents {
    ByteSource* source = nullptr;  // valid until the next call of Open()
    std::string problem;           // why it is not whole; empty if it is
    uint64_t end = 0;              // of the packed bytes that were used: position in the file
  };
  Contents Open(uint32_t chunk_index);

 private:
  struct Chunk {
    std::string compression;
    uint64_t data_begin = 0;
    uint32_t data_size = 0;
    uint32_t unpacked_size = 0;
    bool breaks_off = false;  // with the file
  };
  struct Unpacked {
    uint32_t chunk_index = 0;
    std::vector<uint8_t> bytes;
    std::string problem;
    uint64_t num_taken = 0;
  };

  const Unpacked& Unpack(uint32_t chunk_index);

  FileWindow window_;
  std::vector<Chunk> chunks_;
  std::list<Unpacked> unpacked_;  // last used first
  // Open() has returned one of these two last.
  SourceRange in_file_;
  MemorySource in_memory_;
};

}  // namespace plumbline

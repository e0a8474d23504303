#include "core/recording/chunk_store.h"

#include <algorithm>
#include <utility>

#include "core/recording/unpack.h"

namespace plumbline {
namespace {

constexpr size_t kWindowBytes = size_t{256} << 10;
// Where scanners were recorded one after the other, reading in the order of the stamps goes
// to and fro between as many chunks.
constexpr size_t kMaxUnpackedChunks = 8;
constexpr size_t kMaxKeptBytes = size_t{32} << 20;  // unless one alone is larger

}  // namespace

ChunkStore::ChunkStore(const InputFile* file)
    : window_(file, kWindowBytes), in_file_(&window_, 0, 0), in_memory_(ByteView{}) {}

uint32_t ChunkStore::Add(const BagRecord& record) {
  Chunk& chunk = chunks_.emplace_back();
  chunk.compression = record.compression;
  chunk.data_begin = record.data_begin;
  const uint64_t available = window_.size() - record.data_begin;
  chunk.data_size = static_cast<uint32_t>(std::min<uint64_t>(record.data_size, available));
  chunk.unpacked_size = record.unpacked_size;
  chunk.breaks_off = record.data_size > available;
  return static_cast<uint32_t>(chunks_.size() - 1);
}

const ChunkStore::Unpacked& ChunkStore::Unpack(uint32_t chunk_index) {
  const auto known = std::find_if(
      unpacked_.begin(), unpacked_.end(), [chunk_index](const Unpacked& unpacked) {
        return unpacked.chunk_index == chunk_index;
      });
  if (known != unpacked_.end()) {
    unpacked_.splice(unpacked_.begin(), unpacked_, known);
    return unpacked_.front();
  }
  size_t num_bytes = chunks_[chunk_index].unpacked_size;
  for (const Unpacked& unpacked : unpacked_) num_bytes += unpacked.bytes.size();
  while (!unpacked_.empty() &&
         (unpacked_.size() >= kMaxUnpackedChunks || num_bytes > kMaxKeptBytes)) {
    num_bytes -= unpacked_.back().bytes.size();
    unpacked_.pop_back();
  }
  const Chunk& chunk = chunks_[chunk_index];
  SourceRange packed(&window_, chunk.data_begin, chunk.data_size);
  Unpacked& unpacked = unpacked_.emplace_front();
  unpacked.chunk_index = chunk_index;
  unpacked.problem = plumbline::Unpack(
      chunk.compression, &packed, chunk.unpacked_size, &unpacked.bytes, &unpacked.num_taken);
  return unpacked;
}

ChunkStore::Contents ChunkStore::Open(uint32_t chunk_index) {
  const Chunk& chunk = chunks_[chunk_index];
  Contents contents;
  uint64_t unpacked_size = chunk.data_size;
  if (chunk.compression == "none") {
    in_file_ = SourceRange(&window_, chunk.data_begin, chunk.data_size);
    contents.source = &in_file_;
    contents.end = chunk.data_begin + chunk.data_size;
    if (chunk.breaks_off) contents.problem = "it breaks off";
  } else {
    const Unpacked& unpacked = Unpack(chunk_index);
    unpacked_size = unpacked.bytes.size();
    in_memory_ = MemorySource({unpacked.bytes.data(), unpacked.bytes.size()});
    contents.source = &in_memory_;
    contents.end = chunk.data_begin + unpacked.num_taken;
    contents.problem = unpacked.problem;
  }
  if (contents.problem.empty() && unpacked_size != chunk.unpacked_size) {
    contents.problem = "it has not the size that it states";
  }
  return contents;
}

}  // namespace plumbline

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/recording/byte_source.h"

namespace plumbline {

// No chunk is unpacked to more: recorders begin a new one at 768 kB.
inline constexpr size_t kMaxUnpackedBytes = size_t{512} << 20;

// Unpacks what recordings call "bz2", "lz4" or "zstd". Returns what is wrong with the packed
// bytes, empty if nothing. Where they break off, what comes before is unpacked; where they are
// damaged, nothing is: no checksum says which part of it holds.
//   unpacked_size   what the recording says to expect; need not be true
//   *num_taken      packed bytes that were used
std::string Unpack(const std::string& compression,
                   ByteSource* packed,
                   uint32_t unpacked_size,
                   std::vector<uint8_t>* unpacked,
                   uint64_t* num_taken);

}  // namespace plumbline

#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "core/recording/byte_source.h"

namespace plumbline {

// Decoder unpacks a stream of packed bytes, piece by piece.
class Decoder {
 public:
  // The outcome of decoding one piece.
  struct Step {
    size_t num_taken = 0;  // packed bytes that were used
    size_t num_given = 0;  // bytes that were unpacked
    bool at_end = false;   // of the stream; what follows does not belong to it
    bool failed = false;
  };

  virtual ~Decoder() = default;
  virtual Step Run(ByteView in, uint8_t* out, size_t out_size) = 0;
};

// compression: "bz2", "lz4" (frames) or "zstd"; nullptr for any other.
std::unique_ptr<Decoder> MakeDecoder(const std::string& compression);

}  // namespace plumbline

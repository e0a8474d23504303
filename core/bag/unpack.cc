#include "core/bag/unpack.h"

#include <bzlib.h>
#include <glog/logging.h>
#include <lz4frame.h>

#include <algorithm>
#include <cstddef>

namespace plumbline {
namespace {

constexpr size_t kPieceBytes = size_t{64} << 10;
// Scan lines are packed to a third. A few kB of bz2 can stand for gigabytes.
constexpr uint64_t kMaxRatio = 1000;

// What a decoder did with one piece.
struct Step {
  size_t num_taken = 0;
  size_t num_given = 0;
  bool at_end = false;
  bool failed = false;
};

class Bz2Decoder {
 public:
  Bz2Decoder() { CHECK_EQ(BZ2_bzDecompressInit(&stream_, 0, 0), BZ_OK); }
  ~Bz2Decoder() { BZ2_bzDecompressEnd(&stream_); }
  Bz2Decoder(const Bz2Decoder&) = delete;
  Bz2Decoder& operator=(const Bz2Decoder&) = delete;

  Step Run(ByteView in, uint8_t* out, size_t out_size) {
    // The interface predates const; the input is only read.
    stream_.next_in = const_cast<char*>(reinterpret_cast<const char*>(in.data));
    stream_.avail_in = static_cast<unsigned>(in.size);
    stream_.next_out = reinterpret_cast<char*>(out);
    stream_.avail_out = static_cast<unsigned>(out_size);
    const int outcome = BZ2_bzDecompress(&stream_);
    Step step;
    step.num_taken = in.size - stream_.avail_in;
    step.num_given = out_size - stream_.avail_out;
    step.at_end = outcome == BZ_STREAM_END;
    step.failed = outcome != BZ_OK && outcome != BZ_STREAM_END;
    return step;
  }

 private:
  bz_stream stream_ = {};
};

class Lz4Decoder {
 public:
  Lz4Decoder() {
    CHECK(!LZ4F_isError(LZ4F_createDecompressionContext(&context_, LZ4F_VERSION)));
  }
  ~Lz4Decoder() { LZ4F_freeDecompressionContext(context_); }
  Lz4Decoder(const Lz4Decoder&) = delete;
  Lz4Decoder& operator=(const Lz4Decoder&) = delete;

  Step Run(ByteView in, uint8_t* out, size_t out_size) {
    Step step;
    step.num_taken = in.size;
    step.num_given = out_size;
    const size_t outcome =
        LZ4F_decompress(context_, out, &step.num_given, in.data, &step.num_taken, nullptr);
    step.failed = LZ4F_isError(outcome) != 0;
    step.at_end = outcome == 0;
    if (step.failed) step.num_taken = step.num_given = 0;
    return step;
  }

 private:
  LZ4F_dctx* context_ = nullptr;
};

template <typename Decoder>
std::string UnpackAll(ByteSource* packed,
                      size_t expected_size,
                      std::vector<uint8_t>* unpacked,
                      uint64_t* num_taken) {
  Decoder decoder;
  const size_t max_size = static_cast<size_t>(
      std::min<uint64_t>(kMaxUnpackedBytes, (uint64_t{1} << 20) + kMaxRatio * packed->size()));
  // A size that is a lie must not cost memory; what is too little grows.
  unpacked->resize(
      std::clamp(expected_size + 1, kPieceBytes, std::min(max_size, size_t{4} << 20)));
  size_t num_unpacked = 0;
  std::string problem;
  for (bool at_end = false; !at_end;) {
    if (num_unpacked == unpacked->size()) {
      if (unpacked->size() >= max_size) {
        problem = "it holds more than any recorder packs";
        break;
      }
      unpacked->resize(std::min(2 * unpacked->size(), max_size));
    }
    ByteView piece;
    packed->View(*num_taken, std::min(kPieceBytes, packed->size() - *num_taken), &piece);
    const Step step =
        decoder.Run(piece, unpacked->data() + num_unpacked, unpacked->size() - num_unpacked);
    *num_taken += step.num_taken;
    num_unpacked += step.num_given;
    at_end = step.at_end;
    if (step.failed) {
      problem = "its bytes are damaged";
      num_unpacked = 0;
    }
    if (!at_end && step.num_taken == 0 && step.num_given == 0 && problem.empty()) {
      problem = "it breaks off";
    }
    if (!problem.empty()) break;
  }
  unpacked->resize(num_unpacked);
  if (unpacked->capacity() / 2 > num_unpacked + kPieceBytes) unpacked->shrink_to_fit();
  return problem;
}

}  // namespace

std::string Unpack(const std::string& compression,
                   ByteSource* packed,
                   uint32_t unpacked_size,
                   std::vector<uint8_t>* unpacked,
                   uint64_t* num_taken) {
  *num_taken = 0;
  unpacked->clear();
  if (compression == "bz2") {
    return UnpackAll<Bz2Decoder>(packed, unpacked_size, unpacked, num_taken);
  }
  if (compression == "lz4") {
    return UnpackAll<Lz4Decoder>(packed, unpacked_size, unpacked, num_taken);
  }
  return "it is packed in an unknown way";
}

}  // namespace plumbline

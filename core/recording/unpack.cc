#include "core/recording/unpack.h"

#include <algorithm>
#include <cstddef>
#include <memory>

#include "core/recording/decoder.h"

namespace plumbline {
namespace {

constexpr size_t kPieceBytes = size_t{64} << 10;
// Scan lines are packed to a third. A few kB of bz2 can stand for gigabytes.
constexpr uint64_t kMaxRatio = 1000;
constexpr uint64_t kSmallBytes = uint64_t{1} << 20;
// Recorders that use it write larger chunks; of a black image it leaves next to nothing.
constexpr uint64_t kSmallZstdBytes = uint64_t{16} << 20;

std::string UnpackAll(Decoder* decoder,
                      ByteSource* packed,
                      size_t expected_size,
                      uint64_t small_bytes,
                      std::vector<uint8_t>* unpacked,
                      uint64_t* num_taken) {
  const size_t max_size = static_cast<size_t>(
      std::min<uint64_t>(kMaxUnpackedBytes, small_bytes + kMaxRatio * packed->size()));
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
    const Decoder::Step step =
        decoder->Run(piece, unpacked->data() + num_unpacked, unpacked->size() - num_unpacked);
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
  const std::unique_ptr<Decoder> decoder = MakeDecoder(compression);
  if (decoder == nullptr) return "it is packed in an unknown way";
  const uint64_t small_bytes = compression == "zstd" ? kSmallZstdBytes : kSmallBytes;
  return UnpackAll(decoder.get(), packed, unpacked_size, small_bytes, unpacked, num_taken);
}

}  // namespace plumbline

#include "core/recording/unpacked_copy.h"

#include <glog/logging.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/recording/byte_source.h"
#include "core/recording/decoder.h"
#include "core/util/error.h"

namespace plumbline {
namespace {

constexpr size_t kPieceBytes = size_t{256} << 10;
// Logs are packed to a tenth. A few kB can stand for gigabytes.
constexpr uint64_t kMaxRatio = 200;
constexpr uint64_t kSmallBytes = uint64_t{16} << 20;

void WriteAll(int file, const std::string& path, const uint8_t* bytes, size_t size) {
  while (size > 0) {
    const ssize_t num_written = write(file, bytes, size);
    if (num_written < 0 && errno == EINTR) continue;
    if (num_written < 0) {
      throw Error(path + ": its unpacked copy can not be written among the temporary files: " +
                  strerror(errno));
    }
    bytes += num_written;
    size -= static_cast<size_t>(num_written);
  }
}

}  // namespace

UnpackedCopy::UnpackedCopy(const std::string& path, const std::string& compression) {
  copy_path_ = (std::filesystem::temp_directory_path() / "plumbline_XXXXXX").string();
  const int copy = mkstemp(copy_path_.data());
  if (copy < 0) {
    throw Error(path + ": its unpacked copy can not be written among the temporary files: " +
                strerror(errno));
  }
  try {
    Unpack(path, compression, copy);
  } catch (...) {
    close(copy);
    unlink(copy_path_.c_str());
    throw;
  }
  close(copy);
}

UnpackedCopy::~UnpackedCopy() { unlink(copy_path_.c_str()); }

void UnpackedCopy::Unpack(const std::string& path, const std::string& compression, int copy) {
  const InputFile file(path);
  FileWindow packed(&file, kPieceBytes);
  std::unique_ptr<Decoder> decoder = MakeDecoder(compression);
  CHECK(decoder != nullptr) << compression;
  const uint64_t max_size = kSmallBytes + kMaxRatio * packed.size();
  std::vector<uint8_t> unpacked(kPieceBytes);
  uint64_t num_taken = 0;
  uint64_t num_given = 0;
  for (bool in_stream = true; in_stream || num_taken < packed.size();) {
    ByteView piece;
    packed.View(
        num_taken,
        static_cast<size_t>(std::min<uint64_t>(kPieceBytes, packed.size() - num_taken)),
        &piece);
    const Decoder::Step step = decoder->Run(piece, unpacked.data(), unpacked.size());
    num_taken += step.num_taken;
    num_given += step.num_given;
    if (num_given > max_size) throw Error(path + ": unpacks to more than any recording does");
    WriteAll(copy, path, unpacked.data(), step.num_given);
    if (step.failed) {
      problem_ = "its packed bytes are damaged at byte " + std::to_string(num_taken);
      return;
    }
    in_stream = !step.at_end;
    // Parallel packers write one stream after the other.
    if (step.at_end) decoder = MakeDecoder(compression);
    if (in_stream && step.num_taken == 0 && step.num_given == 0) {
      problem_ = "it breaks off";
      return;
    }
  }
}

}  // namespace plumbline

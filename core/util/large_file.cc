#include "core/util/large_file.h"

#include <fcntl.h>
#include <glog/logging.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include "core/util/error.h"

namespace plumbline {

namespace {

// Written to the cache at a time: for more, the system takes large blocks of memory, which are
// seldom ones that have been used before (three times as slow).
constexpr size_t kCachedPiece = size_t{1} << 16;

}  // namespace

LargeFile::LargeFile(const std::string& path, const std::string& name, int64_t cached_bytes)
    : name_(name),
      cached_bytes_(cached_bytes),
      file_(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
  if (file_ < 0) Fail();
  for (auto& block : blocks_) {
    block.reset(static_cast<char*>(std::aligned_alloc(kAlignment, kBlockBytes)));
    CHECK(block != nullptr) << "out of memory";
  }
}

LargeFile::~LargeFile() {
  if (writing_.valid()) writing_.wait();
  if (file_ >= 0) close(file_);
}

void LargeFile::Fail() const {
  throw Error(name_ + ": can not be written: " + std::strerror(errno));
}

void LargeFile::Append(const void* data, size_t size) {
  const char* from = static_cast<const char*>(data);
  while (size > 0) {
    const size_t taken = std::min(size, kBlockBytes - num_filled_);
    std::memcpy(blocks_[0].get() + num_filled_, from, taken);
    num_filled_ += taken;
    from += taken;
    size -= taken;
    if (num_filled_ == kBlockBytes) WriteBlock();
  }
}

void LargeFile::WriteBlock() {
  if (writing_.valid()) writing_.get();
  if (!is_direct_ && offset_ >= cached_bytes_) {
    is_direct_ = TurnDirect(true);
    if (!is_direct_) cached_bytes_ = std::numeric_limits<int64_t>::max();
  }
  const auto write = [this, data = blocks_[0].get(), size = num_filled_, offset = offset_] {
    WriteAt(data, size, offset);
  };
  offset_ += static_cast<int64_t>(num_filled_);
  num_filled_ = 0;
  if (is_direct_) {
    std::swap(blocks_[0], blocks_[1]);
    writing_ = std::async(std::launch::async, write);
  } else {
    write();
  }
}

bool LargeFile::TurnDirect(bool on) {
  const int flags = fcntl(file_, F_GETFL);
  return flags >= 0 && fcntl(file_, F_SETFL, on ? flags | O_DIRECT : flags & ~O_DIRECT) == 0;
}

void LargeFile::WriteAt(const char* data, size_t size, int64_t offset) {
  bool may_be_cached = true;
  while (size > 0) {
    const size_t piece = is_direct_ ? size : std::min(size, kCachedPiece);
    const ssize_t written = pwrite(file_, data, piece, offset);
    if (written < 0) {
      if (errno == EINTR) continue;
      // File systems state their conditions of direct writing in this way only.
      if (errno != EINVAL || !may_be_cached || !TurnDirect(false)) Fail();
      may_be_cached = false;
      continue;
    }
    data += written;
    size -= static_cast<size_t>(written);
    offset += written;
  }
}

void LargeFile::Finish(const std::string& beginning) {
  CHECK_GE(file_, 0) << "Finish() twice";
  if (writing_.valid()) writing_.get();
  if (is_direct_ && !TurnDirect(false)) Fail();
  WriteAt(blocks_[0].get(), num_filled_, offset_);
  WriteAt(beginning.data(), beginning.size(), 0);
  if (close(std::exchange(file_, -1)) != 0) Fail();
}

}  // namespace plumbline

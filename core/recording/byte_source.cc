#include "core/recording/byte_source.h"

#include <fcntl.h>
#include <glog/logging.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "core/util/error.h"

namespace plumbline {

InputFile::InputFile(const std::string& path, const std::string& name) : name_(name) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    throw Error(name + (errno == ENOENT
                            ? ": no such file"
                            : ": can not be read: " + std::string(strerror(errno))));
  }
  // Asked before it is opened: to open a pipe would wait for someone to fill it.
  if (!S_ISREG(status.st_mode)) throw Error(name + ": is not a file");
  file_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0 || fstat(file_, &status) != 0) {
    throw Error(name + ": can not be read: " + strerror(errno));
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

InputFile::~InputFile() {
  if (file_ >= 0) close(file_);
}

void InputFile::Read(uint64_t offset, size_t size, uint8_t* bytes) const {
  while (size > 0) {
    const ssize_t num_read = pread(file_, bytes, size, static_cast<off_t>(offset));
    if (num_read < 0 && errno == EINTR) continue;
    if (num_read < 0) throw Error(name_ + ": can not be read: " + strerror(errno));
    if (num_read == 0) throw Error(name_ + ": has become shorter while it was read");
    bytes += num_read;
    size -= static_cast<size_t>(num_read);
    offset += static_cast<uint64_t>(num_read);
  }
}

const uint8_t* FileWindow::Fetch(uint64_t offset, size_t size) {
  if (offset < begin_ || offset + size > begin_ + num_bytes_) {
    const uint64_t num_bytes =
        std::min<uint64_t>(std::max(size, window_bytes_), this->size() - offset);
    num_bytes_ = 0;  // until they are there
    if (window_.size() < num_bytes) window_.resize(static_cast<size_t>(num_bytes));
    file_->Read(offset, static_cast<size_t>(num_bytes), window_.data());
    begin_ = offset;
    num_bytes_ = static_cast<size_t>(num_bytes);
  }
  return window_.data() + (offset - begin_);
}

const uint8_t* SourceRange::Fetch(uint64_t offset, size_t size) {
  ByteView bytes;
  CHECK(source_->View(begin_ + offset, size, &bytes)) << "range beyond its source";
  return bytes.data;
}

}  // namespace plumbline

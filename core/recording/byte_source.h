#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace plumbline {

// Bytes that belong to someone else.
struct ByteView {
  const uint8_t* data = nullptr;
  size_t size = 0;
};

// Takes numbers (in the byte order of the file: little endian, as the processor's) and texts
// from the front of a view, and never more than it holds: false, and nothing taken, then.
class ByteCursor {
 public:
  explicit ByteCursor(ByteView bytes) : left_(bytes) {}

  size_t num_left() const { return left_.size; }

  bool Take(size_t size, ByteView* bytes) {
    if (size > left_.size) return false;
    *bytes = {left_.data, size};
    left_ = {left_.data + size, left_.size - size};
    return true;
  }
  template <typename Number>
  bool Take(Number* value) {
    static_assert(std::is_arithmetic_v<Number>);
    ByteView bytes;
    if (!Take(sizeof(Number), &bytes)) return false;
    std::memcpy(value, bytes.data, sizeof(Number));
    return true;
  }

 private:
  ByteView left_;
};

// ByteSource holds bytes that are looked at piece by piece: a file, a part of one, memory.
class ByteSource {
 public:
  virtual ~ByteSource() = default;

  virtual uint64_t size() const = 0;
  // The bytes [offset, offset + size), valid until the next call; false where the source does
  // not hold them all.
  bool View(uint64_t offset, size_t size, ByteView* bytes) {
    if (offset > this->size() || size > this->size() - offset) return false;
    *bytes = {Fetch(offset, size), size};
    return true;
  }

 protected:
  virtual const uint8_t* Fetch(uint64_t offset, size_t size) = 0;  // is within the source
};

// An open file. Its size is taken once: what is appended later does not exist.
class InputFile {
 public:
  // name: what errors call the file, where that is not its path. Throws Error that names the
  // file when there is none or it can not be read.
  explicit InputFile(const std::string& path) : InputFile(path, path) {}
  InputFile(const std::string& path, const std::string& name);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& name() const { return name_; }
  uint64_t size() const { return size_; }
  // Throws Error when the bytes are not there (any more).
  void Read(uint64_t offset, size_t size, uint8_t* bytes) const;

 private:
  std::string name_;
  int file_ = -1;
  uint64_t size_ = 0;
};

// Looks at a file through a window of some bytes, which is moved where it is needed.
class FileWindow : public ByteSource {
 public:
  FileWindow(const InputFile* file, size_t window_bytes)
      : file_(file), window_bytes_(window_bytes) {}

  uint64_t size() const override { return file_->size(); }

 protected:
  const uint8_t* Fetch(uint64_t offset, size_t size) override;

 private:
  const InputFile* file_;
  size_t window_bytes_;
  uint64_t begin_ = 0;
  size_t num_bytes_ = 0;
  std::vector<uint8_t> window_;
};

// A part of another source, which must hold it and outlive it.
class SourceRange : public ByteSource {
 public:
  SourceRange(ByteSource* source, uint64_t begin, uint64_t size)
      : source_(source), begin_(begin), size_(size) {}

  uint64_t size() const override { return size_; }

 protected:
  const uint8_t* Fetch(uint64_t offset, size_t size) override;

 private:
  ByteSource* source_;
  uint64_t begin_;
  uint64_t size_;
};

// Bytes in memory, which must outlive it.
class MemorySource : public ByteSource {
 public:
  explicit MemorySource(ByteView bytes) : bytes_(bytes) {}

  uint64_t size() const override { return bytes_.size; }

 protected:
  const uint8_t* Fetch(uint64_t offset, size_t /*size*/) override {
    return bytes_.data + offset;
  }

 private:
  ByteView bytes_;
};

}  // namespace plumbline

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <future>
#include <memory>
#include <string>

namespace plumbline {

// A file written from front to back, of which the first bytes may be replaced at the end.
// What goes beyond the first cached_bytes is written past the system's cache, where the file
// system allows it, while the caller goes on: a file of gigabytes would only push out what
// others have there, and memory that nobody has used before is slower than the disk.
class LargeFile {
 public:
  static constexpr int64_t kCachedBytes = int64_t{32} << 20;

  // name: of the file in errors. All functions throw Error naming it when writing fails, which
  // may be in a later call than the one whose bytes it was.
  LargeFile(const std::string& path,
            const std::string& name,
            int64_t cached_bytes = kCachedBytes);
  ~LargeFile();
  LargeFile(const LargeFile&) = delete;
  LargeFile& operator=(const LargeFile&) = delete;

  void Append(const void* data, size_t size);
  // Writes what is left, `beginning` over the first bytes, and closes the file. Call once, at
  // the end.
  void Finish(const std::string& beginning);

 private:
  // Alignment that direct writing needs in memory and in the file, or a multiple of it.
  static constexpr size_t kAlignment = 4096;
  static constexpr size_t kBlockBytes = size_t{1} << 20;

  struct Free {
    void operator()(char* block) const { std::free(block); }
  };

  void WriteBlock();
  bool TurnDirect(bool on);
  void WriteAt(const char* data, size_t size, int64_t offset);
  [[noreturn]] void Fail() const;

  std::string name_;
  int64_t cached_bytes_;
  int file_;
  bool is_direct_ = false;
  // The block that is being filled, with num_filled_ bytes, and the one that is being written.
  std::array<std::unique_ptr<char, Free>, 2> blocks_;
  size_t num_filled_ = 0;
  int64_t offset_ = 0;  // where the block that is being filled goes
  std::future<void> writing_;
};

}  // namespace plumbline

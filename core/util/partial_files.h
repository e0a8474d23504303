#pragma once

#include <string>

namespace plumbline {

// Common parts of files and directories that are not whole yet. They have names that nobody
// can foresee and are locked (flock) by the process that writes them. The system takes the
// lock away when that process ends, however it ends: what is without a lock is a leftover.

// ".<name>.<random>.partial", another one each time.
std::string PartialName(const std::string& name);
// Whether PartialName(name) may have given this name.
bool IsPartialName(const std::string& entry, const std::string& name);

// An open file, closed at the end; with the file, its lock goes.
class OpenFile {
 public:
  explicit OpenFile(int descriptor = -1) : descriptor_(descriptor) {}
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;

  bool is_open() const { return descriptor_ >= 0; }
  int descriptor() const { return descriptor_; }

 private:
  int descriptor_;
};

// Creates a file that did not exist, locked and open for reading and writing. Not open, with
// errno set, where that is not possible.
OpenFile CreateLocked(const std::string& path);

enum class LockState {
  kTaken,    // no process had it; now this one does
  kInUse,    // another process has it
  kUnknown,  // not a file of this user, or on a file system without locks
};
// Looks who has the lock of a file, without following a link. kTaken: `file` holds the lock.
LockState TryLock(const std::string& path, OpenFile* file);

}  // namespace plumbline

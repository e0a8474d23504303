#include "core/util/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include "core/util/error.h"

namespace plumbline {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void Fail(const std::string& path) {
  throw Error(path + ": can not be written: " + std::strerror(errno));
}

void RemoveLeftovers(const fs::path& target) {
  std::error_code error;
  const fs::path parent = target.has_parent_path() ? target.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(parent, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!IsPartialName(entry->path().filename().string(), target.filename().string())) continue;
    OpenFile lock;
    if (TryLock(entry->path().string(), &lock) == LockState::kTaken) {
      std::remove(entry->path().c_str());
    }
  }
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  const fs::path target(path);
  RemoveLeftovers(target);
  temporary_path_ = (target.parent_path() / PartialName(target.filename().string())).string();
  lock_ = CreateLocked(temporary_path_);
  if (!lock_.is_open()) Fail(path_);
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_path_(std::move(other.temporary_path_)),
      lock_(std::move(other.lock_)) {
  other.temporary_path_.clear();
}

AtomicFile::~AtomicFile() {
  if (!temporary_path_.empty()) std::remove(temporary_path_.c_str());
}

void AtomicFile::Commit() {
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0) Fail(path_);
  temporary_path_.clear();
}

void WriteFileAtomically(const std::string& path, const std::string& content) {
  AtomicFile file(path);
  WriteWholeFile(file.temporary_path(), content, path);
  file.Commit();
}

void WriteWholeFile(const std::string& path,
                    const std::string& content,
                    const std::string& name) {
  errno = 0;
  std::ofstream stream(path, std::ios::binary | std::ios::trunc);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  if (!stream) {
    throw Error(name + ": can not be written: " + std::strerror(errno != 0 ? errno : EIO));
  }
}

}  // namespace plumbline

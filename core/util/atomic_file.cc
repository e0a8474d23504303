#include "core/util/atomic_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "core/util/error.h"

namespace plumbline {

namespace fs = std::filesystem;

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  const fs::path target(path);
  // The process id keeps two runs that write to one directory apart.
  const std::string name =
      "." + target.filename().string() + "." + std::to_string(getpid()) + ".partial";
  temporary_path_ = (target.parent_path() / name).string();
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)), temporary_path_(std::move(other.temporary_path_)) {
  other.temporary_path_.clear();
}

AtomicFile::~AtomicFile() {
  if (!temporary_path_.empty()) std::remove(temporary_path_.c_str());
}

void AtomicFile::Commit() {
  if (std::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    throw Error(path_ + ": can not be written: " + std::strerror(errno));
  }
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

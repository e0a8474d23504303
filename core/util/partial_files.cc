#include "core/util/partial_files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <utility>

namespace plumbline {
namespace {

constexpr char kSuffix[] = ".partial";
constexpr size_t kNumRandom = 12;

bool TryFlock(int descriptor, int operation) {
  int result = 0;
  do {
    result = flock(descriptor, operation);
  } while (result != 0 && errno == EINTR);
  return result == 0;
}

}  // namespace

std::string PartialName(const std::string& name) {
  constexpr char kLetters[] = "abcdefghijklmnopqrstuvwxyz234567";  // 32
  std::random_device random;  // of the system
  std::string letters;
  for (size_t i = 0; i < kNumRandom; ++i) letters += kLetters[random() % 32];
  return "." + name + "." + letters + kSuffix;
}

bool IsPartialName(const std::string& entry, const std::string& name) {
  const std::string start = "." + name + ".";
  return entry.size() == start.size() + kNumRandom + sizeof(kSuffix) - 1 &&
         entry.compare(0, start.size(), start) == 0 &&
         entry.compare(start.size() + kNumRandom, std::string::npos, kSuffix) == 0;
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

OpenFile& OpenFile::operator=(OpenFile&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

OpenFile CreateLocked(const std::string& path) {
  while (true) {
    OpenFile file(
        open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666));
    if (!file.is_open()) return file;
    TryFlock(file.descriptor(), LOCK_EX);  // some file systems have no locks
    // Who removes leftovers may have taken the file for one before it was locked.
    struct stat status = {};
    if (fstat(file.descriptor(), &status) == 0 && status.st_nlink > 0) return file;
  }
}

LockState TryLock(const std::string& path, OpenFile* file) {
  *file = OpenFile(open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status = {};
  if (!file->is_open() || fstat(file->descriptor(), &status) != 0 ||
      !S_ISREG(status.st_mode) || status.st_uid != geteuid()) {
    return LockState::kUnknown;
  }
  if (TryFlock(file->descriptor(), LOCK_EX | LOCK_NB)) return LockState::kTaken;
  return errno == EWOULDBLOCK ? LockState::kInUse : LockState::kUnknown;
}

}  // namespace plumbline

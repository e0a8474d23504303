#include "core/result/result_directory.h"

#include <fcntl.h>
#include <glog/logging.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <system_error>
#include <vector>

#include "core/result/result_files.h"
#include "core/util/error.h"

namespace plumbline {

namespace fs = std::filesystem;

namespace {

constexpr char kLock[] = "lock";
constexpr char kNew[] = "new";
constexpr char kOld[] = "old";
constexpr char kCheckpoint[] = "checkpoint.bin";

[[noreturn]] void Fail(const std::string& path, const std::string& why) {
  throw Error(path + ": can not be used as output directory: " + why);
}

bool IsRealDirectory(const fs::path& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() == fs::file_type::directory;
}

bool Exists(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(fs::symlink_status(path, ignored));
}

std::vector<fs::path> EntriesOf(const fs::path& directory) {
  std::vector<fs::path> entries;
  std::error_code error;
  for (fs::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    entries.push_back(entry->path());
  }
  return entries;
}

// Renames without replacing anything; false with errno set where that is not possible.
bool Move(const fs::path& from, const fs::path& to) {
  if (renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;  // not known to this file system
  if (Exists(to)) {
    errno = EEXIST;
    return false;
  }
  return std::rename(from.c_str(), to.c_str()) == 0;
}

// Removes the files of a result from a directory, and the directory. Moves what else lies there
// to another one, so that nothing is lost that is not ours; what can not be moved stays.
void Dissolve(const fs::path& from, const fs::path& to) {
  if (!IsRealDirectory(from)) return;
  std::error_code ignored;
  for (const fs::path& entry : EntriesOf(from)) {
    const std::string name = entry.filename().string();
    const bool is_directory = IsRealDirectory(entry);
    if (!is_directory && IsResultFile(name)) {
      fs::remove(entry, ignored);
    } else if (is_directory && IsPartName(name)) {
      Dissolve(entry, to / name);
    } else {
      fs::create_directories(to, ignored);
      if (!Move(entry, to / name)) {
        LOG(WARNING) << (to / name).string() << " stays in " << from.string() << ": "
                     << std::strerror(errno);
      }
    }
  }
  fs::remove(from, ignored);  // if it is empty
}

// Ends a partial directory whose lock this process holds.
void DissolvePartial(const fs::path& partial, const fs::path& target) {
  std::error_code ignored;
  // Where directories can not be exchanged, there is an instant without a result.
  if (IsRealDirectory(partial / kOld)) Move(partial / kOld, target);
  Dissolve(partial / kOld, target);
  Dissolve(partial / kNew, target);
  for (const fs::path& entry : EntriesOf(partial)) {
    const std::string name = entry.filename().string();
    if (name == kCheckpoint || IsPartialName(name, kCheckpoint)) fs::remove(entry, ignored);
  }
  fs::remove(partial / kLock, ignored);
  fs::remove(partial, ignored);
}

// Whether the directory is the root of a mounted file system, which can not be renamed.
bool IsMountPoint(const fs::path& directory) {
  struct statx status = {};
  return statx(AT_FDCWD, directory.c_str(), AT_SYMLINK_NOFOLLOW, 0, &status) == 0 &&
         (status.stx_attributes_mask & STATX_ATTR_MOUNT_ROOT) != 0 &&
         (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

// Has what was written on the disk before its name changes, in case the machine stops.
void WriteThrough(const fs::path& path, const std::string& name) {
  for (const fs::path& entry : EntriesOf(path)) {
    WriteThrough(entry, name + "/" + entry.filename().string());
  }
  const OpenFile file(open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC));
  // Some file systems know no fsync of directories.
  if (!file.is_open() || (fsync(file.descriptor()) != 0 && errno != EINVAL)) {
    throw Error(name + ": can not be written: " + std::strerror(errno));
  }
}

// The directory itself where a link leads to it: the link stays.
fs::path ResolvedTarget(const std::string& path) {
  std::error_code error;
  fs::path target = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error) Fail(path, error.message());
  if (!target.has_filename()) target = target.parent_path();
  if (target == target.root_path()) Fail(path, "it is the root of the file system");
  if (!Exists(target)) return target;
  if (fs::is_symlink(fs::symlink_status(target))) Fail(path, "it is a link that leads nowhere");
  if (!IsRealDirectory(target)) Fail(path, "it is a file");
  if (fs::equivalent(target, fs::current_path(error), error)) {
    Fail(path, "a result replaces the whole directory, which must not be the current one");
  }
  if (IsMountPoint(target)) {
    Fail(path,
         "it is a mount point, which can not be replaced by a whole result; give a "
         "directory inside it");
  }
  if (access(target.c_str(), W_OK | X_OK) != 0) Fail(path, std::strerror(errno));
  return target;
}

}  // namespace

ResultDirectory::ResultDirectory(const std::string& path, bool keep_checkpoint)
    : path_(path), target_(ResolvedTarget(path)), keep_checkpoint_(keep_checkpoint) {
  try {
    CreateParents();
    // Created first, so that of two runs that begin at once, one at least sees the other.
    CreatePartial();
    RemoveLeftovers();
  } catch (const Error&) {
    Discard();
    throw;
  }
}

ResultDirectory::~ResultDirectory() {
  if (!committed_) Discard();
}

void ResultDirectory::Discard() {
  // The next run finds the checkpoint as if this one had been killed.
  if (keep_checkpoint_ && HasCheckpoint()) return;
  if (lock_.is_open()) DissolvePartial(partial_, target_);
  std::error_code ignored;
  for (auto parent = created_parents_.rbegin(); parent != created_parents_.rend(); ++parent) {
    fs::remove(*parent, ignored);  // if it is empty
  }
}

void ResultDirectory::CreateParents() {
  const fs::path parent = target_.parent_path();
  for (fs::path missing = parent; !Exists(missing); missing = missing.parent_path()) {
    created_parents_.insert(created_parents_.begin(), missing);
  }
  std::error_code error;
  fs::create_directories(parent, error);
  if (error) Fail(path_, error.message());
}

void ResultDirectory::RemoveLeftovers() const {
  for (const fs::path& entry : EntriesOf(target_.parent_path())) {
    if (!IsPartialName(entry.filename().string(), target_.filename().string()) ||
        entry == partial_ || !IsRealDirectory(entry)) {
      continue;
    }
    OpenFile lock;
    const LockState state = TryLock((entry / kLock).string(), &lock);
    if (state == LockState::kInUse) Fail(path_, "another run is writing its result there");
    if (state != LockState::kTaken) continue;
    if (keep_checkpoint_ && !HasCheckpoint()) Move(entry / kCheckpoint, partial_ / kCheckpoint);
    DissolvePartial(entry, target_);
  }
}

void ResultDirectory::CreatePartial() {
  const fs::path parent = target_.parent_path();
  partial_ = parent / PartialName(target_.filename().string());
  // mkdir() neither follows a link nor takes what is there.
  if (mkdir(partial_.c_str(), 0777) == 0) {
    lock_ = CreateLocked((partial_ / kLock).string());
    if (lock_.is_open() && mkdir((partial_ / kNew).c_str(), 0777) == 0) return;
  }
  const std::string why = std::strerror(errno);
  rmdir(partial_.c_str());
  Fail(path_, "no directory can be made beside it, in " + parent.string() + ": " + why);
}

std::string ResultDirectory::Folder(const std::string& part) const {
  if (part.empty()) return (partial_ / kNew).string();
  CHECK(IsPartName(part)) << part;
  const fs::path folder = partial_ / kNew / part;
  std::error_code error;
  fs::create_directory(folder, error);
  if (error) Fail(FinalName(part), error.message());
  return folder.string();
}

std::string ResultDirectory::FinalName(const std::string& part) const {
  return (part.empty() ? fs::path(path_) : fs::path(path_) / part).string();
}

std::string ResultDirectory::CheckpointPath() const { return (partial_ / kCheckpoint).string(); }

bool ResultDirectory::HasCheckpoint() const { return Exists(partial_ / kCheckpoint); }

uintmax_t ResultDirectory::FreeSpace() const {
  std::error_code error;
  const fs::space_info space = fs::space(partial_, error);
  return error ? std::numeric_limits<uintmax_t>::max() : space.available;
}

// What the user has under a name of the new result is found before the change: all or nothing.
void ResultDirectory::CheckNamesAreFree(const fs::path& from, const fs::path& to) const {
  for (const fs::path& entry : EntriesOf(from)) {
    const fs::path other = to / entry.filename();
    const std::string name = (fs::path(path_) / other.lexically_relative(target_)).string();
    if (!Exists(other)) continue;
    const bool is_directory = IsRealDirectory(other);
    if (is_directory != IsRealDirectory(entry)) {
      throw Error(name + ": can not be written: is " + (is_directory ? "a directory" : "a file"));
    }
    if (is_directory) CheckNamesAreFree(entry, other);
  }
}

void ResultDirectory::Commit() {
  CHECK(!committed_) << "Commit() twice";
  const fs::path result = partial_ / kNew;
  CheckNamesAreFree(result, target_);
  WriteThrough(result, path_);
  struct stat status = {};
  if (!Exists(target_)) {
    if (!Move(result, target_)) Fail(path_, std::strerror(errno));
  } else {
    if (stat(target_.c_str(), &status) == 0) chmod(result.c_str(), status.st_mode & 07777);
    if (renameat2(AT_FDCWD, result.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
      if (errno != EINVAL && errno != ENOSYS) Fail(path_, std::strerror(errno));
      // A file system that can not exchange: if this process is killed between the two, the next
      // run puts the earlier result back.
      if (!Move(target_, partial_ / kOld) || !Move(result, target_)) {
        Fail(path_, std::strerror(errno));
      }
    }
  }
  committed_ = true;
  const OpenFile parent(
      open(target_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (parent.is_open()) fsync(parent.descriptor());
  DissolvePartial(partial_, target_);
}

}  // namespace plumbline

#include "core/util/partial_files.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <set>
#include <string>
#include <utility>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

TEST(PartialNameTest, NobodyCanForeseeItButItIsKnown) {
  std::set<std::string> names;
  for (int i = 0; i < 100; ++i) {
    const std::string name = PartialName("map.ply");
    EXPECT_TRUE(IsPartialName(name, "map.ply")) << name;
    EXPECT_EQ(name.front(), '.');  // hidden
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 100u);
}

TEST(PartialNameTest, OtherNamesAreNone) {
  const std::string name = PartialName("map.ply");
  EXPECT_FALSE(IsPartialName(name, "map"));
  EXPECT_FALSE(IsPartialName(name, "map.pcd"));
  EXPECT_FALSE(IsPartialName(name.substr(1), "map.ply"));
  EXPECT_FALSE(IsPartialName(name + "x", "map.ply"));
  EXPECT_FALSE(IsPartialName(name.substr(0, name.size() - 1) + "x", "map.ply"));
  EXPECT_FALSE(IsPartialName("map.ply", "map.ply"));
  EXPECT_FALSE(IsPartialName("", "map.ply"));
}

class LockTest : public TemporaryDirectoryTest {
 protected:
  std::string path() const { return (directory_ / "file").string(); }

  // What another process finds.
  LockState StateForAnotherProcess() const {
    const pid_t child = fork();
    if (child == 0) {
      OpenFile file;
      _exit(static_cast<int>(TryLock(path(), &file)));
    }
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    return static_cast<LockState>(WEXITSTATUS(status));
  }
};

TEST_F(LockTest, FileIsInUseUntilItIsClosed) {
  {
    OpenFile file = CreateLocked(path());
    ASSERT_TRUE(file.is_open());
    EXPECT_EQ(write(file.descriptor(), "abc", 3), 3);
    EXPECT_EQ(StateForAnotherProcess(), LockState::kInUse);
    // The lock moves with the file.
    OpenFile moved = std::move(file);
    EXPECT_EQ(StateForAnotherProcess(), LockState::kInUse);
    OpenFile assigned;
    assigned = std::move(moved);
    EXPECT_EQ(StateForAnotherProcess(), LockState::kInUse);
  }
  EXPECT_EQ(ReadBytes(path()), "abc");
  EXPECT_EQ(StateForAnotherProcess(), LockState::kTaken);
}

TEST_F(LockTest, WhoTakesTheLockHasIt) {
  WriteBytes(path(), "leftover");
  OpenFile file;
  ASSERT_EQ(TryLock(path(), &file), LockState::kTaken);
  EXPECT_EQ(StateForAnotherProcess(), LockState::kInUse);
  file = OpenFile();
  EXPECT_EQ(StateForAnotherProcess(), LockState::kTaken);
}

// The system takes it away with the process.
TEST_F(LockTest, ProcessThatDiesLeavesALeftover) {
  const pid_t child = fork();
  if (child == 0) {
    const OpenFile file = CreateLocked(path());
    _exit(file.is_open() ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), 0);
  OpenFile file;
  EXPECT_EQ(TryLock(path(), &file), LockState::kTaken);
}

TEST_F(LockTest, FileThatIsThereIsNotCreated) {
  WriteBytes(path(), "the user's");
  EXPECT_FALSE(CreateLocked(path()).is_open());
  EXPECT_EQ(errno, EEXIST);
  EXPECT_EQ(ReadBytes(path()), "the user's");
  EXPECT_FALSE(CreateLocked((directory_ / "no" / "folder").string()).is_open());
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(LockTest, LinksFoldersAndWhatIsNotThereAreUnknown) {
  OpenFile file;
  EXPECT_EQ(TryLock(path(), &file), LockState::kUnknown);
  WriteBytes(directory_ / "target", "");
  std::filesystem::create_symlink(directory_ / "target", path());
  EXPECT_EQ(TryLock(path(), &file), LockState::kUnknown);
  EXPECT_FALSE(CreateLocked(path()).is_open());
  EXPECT_EQ(TryLock(directory_.string(), &file), LockState::kUnknown);
}

}  // namespace
}  // namespace plumbline

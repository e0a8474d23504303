#include "core/util/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::StartsWith;

class AtomicFileTest : public TemporaryDirectoryTest {
 protected:
  size_t NumFiles() const {
    return static_cast<size_t>(
        std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }
};

TEST_F(AtomicFileTest, AppearsOnCommit) {
  const fs::path path = directory_ / "file";
  WriteBytes(path, "old");
  {
    AtomicFile file(path.string());
    WriteWholeFile(file.temporary_path(), "new", file.path());
    EXPECT_EQ(ReadBytes(path), "old");
    file.Commit();
  }
  EXPECT_EQ(ReadBytes(path), "new");
  EXPECT_EQ(NumFiles(), 1u);
}

TEST_F(AtomicFileTest, LeavesNothingWithoutCommit) {
  {
    AtomicFile file((directory_ / "file").string());
    WriteWholeFile(file.temporary_path(), "new", file.path());
    EXPECT_EQ(NumFiles(), 1u);
    const AtomicFile moved = std::move(file);
    EXPECT_EQ(NumFiles(), 1u);
  }
  EXPECT_EQ(NumFiles(), 0u);
}

TEST_F(AtomicFileTest, RemovesLeftoversButNoFileInUse) {
  const std::string path = (directory_ / "file").string();
  const std::string leftover = PartialName("file");
  const std::string other_file = PartialName("another file");
  WriteBytes(directory_ / leftover, "of a process that was killed");
  WriteBytes(directory_ / other_file, "not of this file");
  fs::create_symlink("target", directory_ / PartialName("file"));
  const AtomicFile in_use(path);
  EXPECT_FALSE(fs::exists(directory_ / leftover));
  WriteFileAtomically(path, "content");
  EXPECT_TRUE(fs::exists(in_use.temporary_path()));
  EXPECT_TRUE(fs::exists(directory_ / other_file));
  EXPECT_EQ(NumFiles(), 4u) << "file, the one in use, the other file's, the link";
}

TEST_F(AtomicFileTest, TemporaryNamesCanNotBeForeseen) {
  const std::string path = (directory_ / "file").string();
  std::set<std::string> names;
  for (int i = 0; i < 100; ++i) names.insert(AtomicFile(path).temporary_path());
  EXPECT_EQ(names.size(), 100u);
}

TEST_F(AtomicFileTest, ReplacesALinkAndNotItsTarget) {
  WriteBytes(directory_ / "target", "target");
  fs::create_symlink("target", directory_ / "file");
  WriteFileAtomically((directory_ / "file").string(), "content");
  EXPECT_EQ(ReadBytes(directory_ / "target"), "target");
  EXPECT_FALSE(fs::is_symlink(directory_ / "file"));
}

TEST_F(AtomicFileTest, WorksInTheCurrentDirectory) {
  const fs::path previous = fs::current_path();
  fs::current_path(directory_);
  WriteFileAtomically("file", "content");
  fs::current_path(previous);
  EXPECT_EQ(ReadBytes(directory_ / "file"), "content");
}

TEST_F(AtomicFileTest, NamesTheFileThatCanNotBeWritten) {
  const std::string missing = (directory_ / "missing" / "file").string();
  EXPECT_EQ(ErrorOf([&] { WriteFileAtomically(missing, "content"); }),
            missing + ": can not be written: No such file or directory");
  EXPECT_EQ(ErrorOf([&] { WriteFileAtomically(directory_.string(), "content"); }),
            directory_.string() + ": can not be written: Is a directory");
}

TEST_F(AtomicFileTest, FullDiskIsAnErrorAndLeavesNothing) {
  const std::string path = (directory_ / "file").string();
  const std::string error = ErrorOf([&] {
    const FileSizeLimit limit(10'000);
    WriteFileAtomically(path, std::string(100'000, 'x'));
  });
  EXPECT_THAT(error, StartsWith(path + ": can not be written: "));
  EXPECT_EQ(NumFiles(), 0u);
}

}  // namespace
}  // namespace plumbline

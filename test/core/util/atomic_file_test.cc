#include "core/util/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

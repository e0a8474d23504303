#include "core/result/result_directory.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>

#include "core/result/result_files.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ResultDirectoryTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    output_ = directory_ / "output";
  }

  static void Fill(const ResultDirectory& result, const std::string& content) {
    for (const char* name : {"map.ply", "trajectory.tum", "summary.json"}) {
      WriteBytes(fs::path(result.Folder()) / name, content);
    }
  }

  void Commit(const std::string& content) const {
    ResultDirectory result(output_.string());
    Fill(result, content);
    result.Commit();
  }

  // Everything below a directory.
  static std::set<std::string> NamesIn(const fs::path& directory) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(directory)) {
      names.insert(entry.path().lexically_relative(directory).string());
    }
    return names;
  }

  // What a process does that is killed before its work is at an end.
  template <typename Action>
  static void Killed(const Action& action) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      action();
      kill(getpid(), SIGKILL);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
  }

  fs::path output_;
};

TEST_F(ResultDirectoryTest, AppearsOnCommitWithPartsAndNothingElse) {
  {
    ResultDirectory result(output_.string());
    Fill(result, "new");
    WriteBytes(fs::path(result.Folder("part_2")) / "map.ply", "new");
    EXPECT_EQ(result.FinalName("part_2"), (output_ / "part_2").string());
    EXPECT_FALSE(fs::exists(output_));
    result.Commit();
  }
  EXPECT_THAT(NamesIn(directory_),
              ElementsAre("output",
                          "output/map.ply",
                          "output/part_2",
                          "output/part_2/map.ply",
                          "output/summary.json",
                          "output/trajectory.tum"));
}

TEST_F(ResultDirectoryTest, FilesOfTheEarlierResultGoAndThoseOfTheUserStay) {
  {
    ResultDirectory result(output_.string());
    Fill(result, "old");
    WriteBytes(fs::path(result.Folder()) / "window_planes.json", "old");
    WriteBytes(fs::path(result.Folder("part_2")) / "map.ply", "old");
    WriteBytes(fs::path(result.Folder("part_3")) / "map.ply", "old");
    result.Commit();
  }
  WriteBytes(output_ / "notes.txt", "notes");
  WriteBytes(output_ / "part_2" / "notes.txt", "notes");
  fs::create_directories(output_ / "photos" / "map.ply");
  fs::create_symlink("nowhere", output_ / "link");
  fs::permissions(output_, fs::perms::owner_all);
  Commit("new");
  EXPECT_THAT(NamesIn(directory_),
              ElementsAre("output",
                          "output/link",
                          "output/map.ply",
                          "output/notes.txt",
                          "output/part_2",
                          "output/part_2/notes.txt",
                          "output/photos",
                          "output/photos/map.ply",
                          "output/summary.json",
                          "output/trajectory.tum"));
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "new");
  EXPECT_EQ(ReadBytes(output_ / "part_2" / "notes.txt"), "notes");
  EXPECT_EQ(fs::status(output_).permissions(), fs::perms::owner_all);
}

TEST_F(ResultDirectoryTest, TheCheckpointOfAKilledRunIsTakenOverByWhoAsksForIt) {
  Killed([&] {
    ResultDirectory result(output_.string());
    WriteBytes(result.CheckpointPath(), "followed");
    Fill(result, "killed");
    kill(getpid(), SIGKILL);
  });
  for (int i = 0; i < 2; ++i) {  // it outlives a run without a result
    const ResultDirectory failed(output_.string(), true);
    ASSERT_TRUE(failed.HasCheckpoint());
    EXPECT_EQ(ReadBytes(failed.CheckpointPath()), "followed");
  }
  {
    ResultDirectory result(output_.string(), true);
    Fill(result, "new");
    result.Commit();
  }
  EXPECT_FALSE(ResultDirectory(output_.string(), true).HasCheckpoint());
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "new");
}

TEST_F(ResultDirectoryTest, TheCheckpointOfAKilledRunGoesWithTheNextRunFromTheStart) {
  Killed([&] {
    const ResultDirectory result(output_.string());
    WriteBytes(result.CheckpointPath(), "followed");
    kill(getpid(), SIGKILL);
  });
  Commit("new");
  EXPECT_THAT(
      NamesIn(directory_),
      ElementsAre("output", "output/map.ply", "output/summary.json", "output/trajectory.tum"));
}

// Results replace each other until a reader has seen some of them. It never sees two at once, and
// never none.
TEST_F(ResultDirectoryTest, ReadersSeeOneResultOrTheOther) {
  Commit("0");
  const pid_t writer = fork();
  ASSERT_GE(writer, 0);
  for (int i = 1; writer == 0; ++i) Commit(std::to_string(i));
  std::set<std::string> seen;
  int num_missing = 0;
  int num_mixed = 0;
  while (seen.size() < 10 && waitpid(writer, nullptr, WNOHANG) == 0) {
    // Files that are opened by way of the directory belong to the same result. Those of one that
    // has been replaced in the meantime may be gone.
    const OpenFile result(open(output_.c_str(), O_RDONLY | O_DIRECTORY));
    num_missing += result.is_open() ? 0 : 1;
    std::set<std::string> contents;
    for (const char* name : {"map.ply", "summary.json"}) {
      const OpenFile file(openat(result.descriptor(), name, O_RDONLY));
      char text[16] = {};
      if (file.is_open() && read(file.descriptor(), text, sizeof(text) - 1) > 0) {
        contents.insert(text);
      }
    }
    num_mixed += contents.size() > 1 ? 1 : 0;
    seen.insert(contents.begin(), contents.end());
  }
  kill(writer, SIGKILL);
  waitpid(writer, nullptr, 0);
  EXPECT_EQ(num_missing, 0);
  EXPECT_EQ(num_mixed, 0);
  EXPECT_EQ(seen.size(), 10u);
}

TEST_F(ResultDirectoryTest, WithoutCommitNothingChanges) {
  { const ResultDirectory result((directory_ / "a" / "b" / "output").string()); }
  EXPECT_THAT(NamesIn(directory_), IsEmpty());
  Commit("old");
  {
    const ResultDirectory result(output_.string());
    Fill(result, "new");
  }
  EXPECT_EQ(NamesIn(directory_).size(), 4u);
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "old");
}

TEST_F(ResultDirectoryTest, TheNextRunRemovesWhatAKilledOneLeft) {
  Commit("old");
  Killed([this] {
    auto* result = new ResultDirectory(output_.string());
    Fill(*result, "killed");
  });
  EXPECT_EQ(NamesIn(directory_).size(), 4u + 6u) << "of the killed run";
  fs::create_directories(directory_ / PartialName("output") / "of_the_user");
  Commit("new");
  EXPECT_EQ(NamesIn(directory_).size(), 4u + 2u) << "of the user";
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "new");
}

// A run that was killed right after the change, before it moved the user's files.
TEST_F(ResultDirectoryTest, TheNextRunGivesTheUsersFilesBack) {
  Commit("old");
  const fs::path partial = directory_ / PartialName("output");
  fs::create_directories(partial / "new");
  WriteBytes(partial / "lock", "");
  WriteBytes(partial / "new" / "notes.txt", "notes");
  WriteBytes(partial / "new" / "map.ply", "older");
  WriteBytes(output_ / "kept.txt", "kept");
  { const ResultDirectory result(output_.string()); }
  EXPECT_FALSE(fs::exists(partial));
  EXPECT_EQ(ReadBytes(output_ / "notes.txt"), "notes");
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "old");
  Commit("new");
  EXPECT_EQ(ReadBytes(output_ / "notes.txt"), "notes");
  EXPECT_EQ(ReadBytes(output_ / "kept.txt"), "kept");
}

// As it is left on a file system that can not exchange directories, killed in between.
TEST_F(ResultDirectoryTest, TheNextRunPutsTheEarlierResultBack) {
  const fs::path partial = directory_ / PartialName("output");
  fs::create_directories(partial / "old");
  WriteBytes(partial / "lock", "");
  WriteBytes(partial / "old" / "map.ply", "old");
  WriteBytes(partial / "old" / "notes.txt", "notes");
  { const ResultDirectory result(output_.string()); }
  EXPECT_THAT(NamesIn(directory_), ElementsAre("output", "output/map.ply", "output/notes.txt"));
}

TEST_F(ResultDirectoryTest, ASecondRunIsRefused) {
  ResultDirectory first(output_.string());
  Fill(first, "first");
  EXPECT_EQ(ErrorOf([&] { ResultDirectory second(output_.string()); }),
            output_.string() + ": can not be used as output directory: another run is writing "
                               "its result there");
  const ResultDirectory elsewhere((directory_ / "other").string());
  first.Commit();
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "first");
}

TEST_F(ResultDirectoryTest, ALinkToTheDirectoryStays) {
  Commit("old");
  fs::create_directory_symlink("output", directory_ / "link");
  {
    ResultDirectory result((directory_ / "link" / "").string());
    Fill(result, "new");
    result.Commit();
  }
  EXPECT_TRUE(fs::is_symlink(directory_ / "link"));
  EXPECT_EQ(ReadBytes(output_ / "map.ply"), "new");
}

TEST_F(ResultDirectoryTest, RefusesWhatCanNotBeReplaced) {
  const auto error_of = [](const std::string& path) {
    return ErrorOf([&] { const ResultDirectory result(path); });
  };
  const fs::path file = directory_ / "file";
  WriteBytes(file, "content");
  EXPECT_THAT(error_of(file.string()), HasSubstr("it is a file"));
  EXPECT_THAT(error_of((file / "below").string()), HasSubstr("Not a directory"));
  EXPECT_THAT(error_of("/"), HasSubstr("the root of the file system"));
  EXPECT_THAT(error_of("."), HasSubstr("must not be the current one"));
  EXPECT_THAT(error_of("/proc"), HasSubstr("mount point"));
  EXPECT_THAT(error_of("/proc/nothing"), HasSubstr("no directory can be made beside it, in /proc"));
  fs::create_symlink("nowhere", directory_ / "link");
  EXPECT_THAT(error_of((directory_ / "link").string()), HasSubstr("leads nowhere"));
  EXPECT_THAT(NamesIn(directory_), ElementsAre("file", "link"));
}

TEST_F(ResultDirectoryTest, CommitsNothingWhereAFileCanNotTakeItsName) {
  fs::create_directories(output_ / "summary.json");
  WriteBytes(output_ / "part_2", "a file");
  {
    ResultDirectory result(output_.string());
    Fill(result, "new");
    EXPECT_EQ(ErrorOf([&] { result.Commit(); }),
              (output_ / "summary.json").string() + ": can not be written: is a directory");
    fs::remove(fs::path(result.Folder()) / "summary.json");
    result.Folder("part_2");
    EXPECT_EQ(ErrorOf([&] { result.Commit(); }),
              (output_ / "part_2").string() + ": can not be written: is a file");
  }
  EXPECT_THAT(NamesIn(directory_), ElementsAre("output", "output/part_2", "output/summary.json"));
}

TEST(ResultFilesTest, NamesOfPartsAreNumbers) {
  EXPECT_EQ(PartName(12), "part_12");
  EXPECT_TRUE(IsPartName("part_12"));
  for (const char* name : {"part_", "part_0", "part_01", "part_1a", "part_1/", "my_part_1", ""}) {
    EXPECT_FALSE(IsPartName(name)) << name;
  }
}

}  // namespace
}  // namespace plumbline

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "core/recording/recording_source.h"
#include "test/core/recording/carmen_text.h"
#include "test/core/recording/mcap_text.h"
#include "test/core/recording/packing.h"
#include "test/core/recording/recording_dump.h"
#include "test/testing/paths.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

constexpr int kNumMessages = 6;  // of each topic

// A recording that another program has written (test/data/recordings/README.md).
std::string PathOf(const std::string& name) { return TestDataDir() + "/recordings/" + name; }

class OpenRecordingTest : public TemporaryDirectoryTest {
 protected:
  std::unique_ptr<RecordingSource> Open(const std::string& bytes) {
    WriteBytes(directory_ / "file", bytes);
    return OpenRecording((directory_ / "file").string());
  }
  std::string ErrorWith(const std::string& bytes) {
    return ErrorOf([&] { Open(bytes); });
  }
};

TEST_F(OpenRecordingTest, SaysWhatAFileLooksLike) {
  const std::string path = (directory_ / "file").string();
  EXPECT_EQ(ErrorWith(""),
            path +
                ": is no recording that can be read, but an empty file; what can be read: " +
                kRecordingFormats);
  EXPECT_THAT(ErrorWith("#ROSBAG V1.2\n"), HasSubstr("'rosbag fix'"));
  EXPECT_THAT(ErrorWith("ply\nformat ascii 1.0\n"), HasSubstr("a point cloud (PLY)"));
  EXPECT_THAT(ErrorWith("\x1f\x8b\x08 packed"), HasSubstr("a gzip file; unpack it first"));
  EXPECT_THAT(ErrorWith("time,x,y\n1,2,3\n"), HasSubstr("a text that begins with 'time,x,y'"));
  EXPECT_THAT(ErrorWith(std::string("\1\2\0\3", 4)), HasSubstr("a file of an unknown kind"));
  EXPECT_THAT(ErrorWith("SQLite format 3"), HasSubstr("a text that begins with"));
}

TEST_F(OpenRecordingTest, ContentCountsNotTheName) {
  const fs::path path = directory_ / "recording.bag";
  fs::copy_file(PathOf("zstd.mcap"), path);
  EXPECT_EQ(OpenRecording(path.string())->format(), "MCAP file");
}

TEST_F(OpenRecordingTest, FolderNeedsFiles) {
  EXPECT_THAT(ErrorOf([&] { OpenRecording(directory_.string()); }),
              HasSubstr(directory_.string() + ": is a folder without a recording"));
  WriteBytes(directory_ / "metadata.yaml",
             "rosbag2_bagfile_information:\n  relative_file_paths:\n    - gone.db3\n");
  EXPECT_THAT(ErrorOf([&] { OpenRecording(directory_.string()); }),
              HasSubstr("gone.db3: no such file"));
}

TEST_F(OpenRecordingTest, FolderIsReadWithoutAFileThatIsGone) {
  fs::copy(PathOf("folder"), directory_, fs::copy_options::recursive);
  fs::remove(directory_ / "recording_1.db3.zstd");
  const RecordingDump dump = Dump(directory_.string());
  EXPECT_EQ(dump.messages.size(), 5u * kNumMessages / 2);
  EXPECT_THAT(
      dump.warnings,
      ElementsAre(HasSubstr("metadata.yaml names recording_1.db3.zstd, which is not in "
                            "the folder")));
}

TEST_F(OpenRecordingTest, FolderWhoseFilesHaveOtherNamesIsRead) {
  fs::copy(PathOf("folder"), directory_, fs::copy_options::recursive);
  const size_t num_messages = Dump(directory_.string()).messages.size();
  WriteBytes(
      directory_ / "metadata.yaml",
      "rosbag2_bagfile_information:\n  relative_file_paths: [walk_0.db3, walk_1.db3]\n");
  const RecordingDump renamed = Dump(directory_.string());
  EXPECT_EQ(renamed.messages.size(), num_messages);
  EXPECT_THAT(renamed.warnings, Contains(HasSubstr("metadata.yaml names walk_0.db3")));
  WriteBytes(directory_ / "metadata.yaml", "");
  const RecordingDump empty = Dump(directory_.string());
  EXPECT_EQ(empty.messages.size(), num_messages);
  EXPECT_THAT(empty.warnings, Contains(HasSubstr("all are read")));
}

// What a recorder leaves that is killed has no metadata.yaml yet.
TEST_F(OpenRecordingTest, FolderWithoutMetadataIsReadInTheOrderOfItsNumbers) {
  for (const char* name : {"recording_10.db3", "recording_9.db3"}) {
    fs::copy_file(PathOf("recording.db3"), directory_ / name);
  }
  const std::unique_ptr<RecordingSource> source = OpenRecording(directory_.string());
  EXPECT_EQ(source->format(), "rosbag2 recording, rosbag2 database, 2 files");
  source->Visit({});
  EXPECT_THAT(source->topics(), SizeIs(12));
}

TEST_F(OpenRecordingTest, FirstBytesTellTheFormat) {
  EXPECT_EQ(Open("#ROSBAG V2.0\n")->format(), "ROS 1 bag");
  EXPECT_EQ(Open(McapFileText("", ""))->format(), "MCAP file");
  EXPECT_EQ(Open("ODOM 1 2 3 0 0 0 70.2 host 0.3\n")->format(), "CARMEN log");
  EXPECT_EQ(Open("# any comment\n\r\n# another\nPARAM a 1 1.0 host 0\n")->format(),
            "CARMEN log");
  // Of comments alone, CARMEN's own says it.
  EXPECT_EQ(Open("# CARMEN\n# message_name [message contents] ...\n# no more")->format(),
            "CARMEN log");
  EXPECT_THAT(ErrorWith("# a comment\n# another\n"), HasSubstr("a text that begins with"));
  EXPECT_THAT(ErrorWith("ODOMETER\n"), HasSubstr("a text that begins with 'ODOMETER'"));
}

// What a full disk leaves of a file may be zeros alone.
TEST_F(OpenRecordingTest, ZerosAreNoText) {
  EXPECT_THAT(ErrorWith(std::string(100, '\0')), HasSubstr("a file of an unknown kind"));
  EXPECT_THAT(ErrorWith(std::string("ODOM 1 2\0 3\n", 12)), HasSubstr("an unknown kind"));
}

TEST_F(OpenRecordingTest, PackedFilesAreOpenedOnce) {
  for (const char* compression : {"bz2", "zstd"}) {
    const std::string packed = Pack(compression, FlaserLine(180, "70.1"));
    EXPECT_EQ(Open(packed)->format(), "CARMEN log");
    EXPECT_EQ(Open(packed)->path(), (directory_ / "file").string());
    EXPECT_THAT(
        ErrorWith(Pack(compression, packed)),
        HasSubstr((directory_ / "file").string() + ": is no recording that can be read"));
    const std::unique_ptr<RecordingSource> damaged = Open(packed + "no stream");
    EXPECT_THAT(damaged->warnings(),
                ElementsAre(HasSubstr("the file can not be unpacked whole, since its packed "
                                      "bytes are damaged at byte ")));
  }
}

TEST_F(OpenRecordingTest, FileOfAFolderThatCanNotBeOpenedIsPassedOver) {
  WriteBytes(directory_ / "walk_0.bag", "no bag");
  fs::copy_file(PathOf("recording.db3"), directory_ / "walk_1.db3");
  const std::unique_ptr<RecordingSource> source = OpenRecording(directory_.string());
  EXPECT_EQ(source->format(), "rosbag2 recording, rosbag2 database");
  EXPECT_THAT(source->warnings(),
              ElementsAre(HasSubstr("a file of the recording was passed over: " +
                                    (directory_ / "walk_0.bag").string())));
  fs::remove(directory_ / "walk_1.db3");
  EXPECT_THAT(ErrorOf([&] { OpenRecording(directory_.string()); }),
              HasSubstr((directory_ / "walk_0.bag").string() + ": is no recording"));
}

TEST_F(OpenRecordingTest, FileThatIsNotThereIsNamed) {
  EXPECT_THAT(ErrorOf([&] { OpenRecording((directory_ / "gone.bag").string()); }),
              HasSubstr("gone.bag: no such file"));
}

}  // namespace
}  // namespace plumbline

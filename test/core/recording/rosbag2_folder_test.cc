#include "core/recording/rosbag2_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "test/core/recording/byte_text.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A file of some topics with one message each, "message of <file>/<topic>".
class FakeFile : public MessageFile {
 public:
  FakeFile(std::string path, std::vector<std::string> names, std::vector<std::string> warnings)
      : path_(std::move(path)), names_(std::move(names)), warnings_(std::move(warnings)) {}

  const std::string& path() const override { return path_; }
  std::string format() const override { return "fake"; }
  void Scan(const Wants& wants, const Visit& visit) override {
    for (const std::string& name : names_) {
      RecordingTopic topic;
      topic.name = name;
      const bool is_wanted = wants(topic);
      topic.num_messages = 1;  // known only now
      topics_.push_back(topic);
      MessageRef message;
      message.topic_index = static_cast<uint32_t>(topics_.size() - 1);
      if (is_wanted) visit(message, Read(message));
    }
  }
  const std::vector<RecordingTopic>& topics() const override { return topics_; }
  ByteView Read(const MessageRef& message) override {
    read_ = "message of " + path_ + names_[message.topic_index];
    return ViewOf(read_);
  }
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  std::string path_;
  std::vector<std::string> names_;
  std::vector<std::string> warnings_;
  std::vector<RecordingTopic> topics_;
  std::string read_;
};

std::vector<std::unique_ptr<MessageFile>> ThreeFiles() {
  std::vector<std::unique_ptr<MessageFile>> files;
  files.push_back(std::make_unique<FakeFile>(
      "in/a", std::vector<std::string>{"/x", "/y"}, std::vector<std::string>{"is damaged"}));
  files.push_back(std::make_unique<FakeFile>(
      "in/b", std::vector<std::string>{}, std::vector<std::string>{}));
  files.push_back(std::make_unique<FakeFile>(
      "in/c", std::vector<std::string>{"/y", "/z"}, std::vector<std::string>{"breaks off"}));
  return files;
}

TEST(Rosbag2FolderTest, TopicsAndMessagesOfAllFilesFollowEachOther) {
  Rosbag2Folder folder("in", ThreeFiles());
  EXPECT_EQ(folder.format(), "rosbag2 recording, fake, 3 files");
  std::vector<MessageRef> places;
  std::vector<std::string> messages;
  folder.Scan([](const RecordingTopic&) { return true; },
              [&](const MessageRef& message, ByteView data) {
                places.push_back(message);
                messages.push_back(TextOf(data));
                return true;
              });
  EXPECT_THAT(
      messages,
      ElementsAre(
          "message of in/a/x", "message of in/a/y", "message of in/c/y", "message of in/c/z"));
  ASSERT_EQ(folder.topics().size(), 4u);
  for (size_t i = 4; i-- > 0;) {
    EXPECT_EQ(places[i].topic_index, i);
    EXPECT_EQ(folder.topics()[i].num_messages, 1u);
    EXPECT_EQ(TextOf(folder.Read(places[i])), messages[i]);
  }
  EXPECT_THAT(folder.warnings(), ElementsAre("a: is damaged", "c: breaks off"));
}

TEST(Rosbag2FolderTest, WhatIsWantedIsAskedOfEveryFile) {
  Rosbag2Folder folder("in", ThreeFiles());
  std::vector<std::string> messages;
  folder.Scan([](const RecordingTopic& topic) { return topic.name == "/y"; },
              [&](const MessageRef& message, ByteView data) {
                EXPECT_EQ(folder.topics()[message.topic_index].name, "/y");
                messages.push_back(TextOf(data));
                return true;
              });
  EXPECT_THAT(messages, ElementsAre("message of in/a/y", "message of in/c/y"));
}

TEST(Rosbag2FolderTest, WarningsOfTheOnlyFileNeedNoName) {
  std::vector<std::unique_ptr<MessageFile>> files = ThreeFiles();
  files.resize(1);
  Rosbag2Folder folder("in", std::move(files));
  folder.Scan([](const RecordingTopic&) { return false; },
              [](const MessageRef&, ByteView) { return true; });
  EXPECT_EQ(folder.format(), "rosbag2 recording, fake");
  EXPECT_THAT(folder.warnings(), ElementsAre("is damaged"));
}

class FilesOfFolderTest : public TemporaryDirectoryTest {
 protected:
  void SetUp() override {
    TemporaryDirectoryTest::SetUp();
    for (const char* name :
         {"walk_10.db3", "walk_9.db3", "walk_2.mcap.zstd", "notes.txt", "walk.db3-wal"}) {
      WriteBytes(directory_ / name, "");
    }
    std::filesystem::create_directory(directory_ / "folder.bag");
  }
  void WriteMetadata(const std::string& files) {
    WriteBytes(directory_ / "metadata.yaml",
               "rosbag2_bagfile_information:\n  relative_file_paths: " + files + "\n");
  }
  // Names without the folder.
  std::vector<std::string> Files() {
    const FolderFiles found = FilesOfFolder(directory_.string());
    warnings_ = found.warnings;
    std::vector<std::string> names;
    for (const std::string& file : found.files) {
      EXPECT_EQ(std::filesystem::path(file).parent_path(), directory_);
      names.push_back(std::filesystem::path(file).filename().string());
    }
    return names;
  }

  std::vector<std::string> warnings_;
};

TEST_F(FilesOfFolderTest, WithoutMetadataAllRecordingsCountByTheirNumbers) {
  EXPECT_THAT(Files(), ElementsAre("walk_9.db3", "walk_10.db3", "walk_2.mcap.zstd"));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(FilesOfFolderTest, MetadataNamesFilesAndTheirOrder) {
  WriteMetadata("[old_folder/walk_10.db3, walk_2.mcap.zstd, walk_9.db3]");
  EXPECT_THAT(Files(), ElementsAre("walk_10.db3", "walk_2.mcap.zstd", "walk_9.db3"));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(FilesOfFolderTest, FileThatMetadataDoesNotNameIsNotReadAndTold) {
  WriteMetadata("[walk_10.db3, walk_9.db3]");
  EXPECT_THAT(Files(), ElementsAre("walk_10.db3", "walk_9.db3"));
  EXPECT_THAT(warnings_,
              ElementsAre("metadata.yaml does not name walk_2.mcap.zstd, which is in the "
                          "folder; it is not read"));
}

TEST_F(FilesOfFolderTest, FileThatIsGoneLetsAllOthersCount) {
  WriteMetadata("[walk_10.db3, walk_11.db3]");
  EXPECT_THAT(Files(), ElementsAre("walk_9.db3", "walk_10.db3", "walk_2.mcap.zstd"));
  EXPECT_THAT(warnings_,
              ElementsAre("metadata.yaml names walk_11.db3, which is not in the folder; the "
                          "files that are there are read"));
}

TEST_F(FilesOfFolderTest, MetadataThatCanNotBeReadIsTold) {
  WriteMetadata("{walk: 9}");
  EXPECT_THAT(Files(), ElementsAre("walk_9.db3", "walk_10.db3", "walk_2.mcap.zstd"));
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_THAT(warnings_[0], HasSubstr((directory_ / "metadata.yaml").string() + ":2"));
  EXPECT_THAT(warnings_[0], HasSubstr("what it says of the files is not known; all are read"));
}

TEST_F(FilesOfFolderTest, FolderWithoutFilesIsAnError) {
  for (const char* name : {"walk_10.db3", "walk_9.db3", "walk_2.mcap.zstd"}) {
    std::filesystem::remove(directory_ / name);
  }
  EXPECT_THAT(ErrorOf([&] { Files(); }),
              HasSubstr(directory_.string() + ": is a folder without a recording"));
}

}  // namespace
}  // namespace plumbline

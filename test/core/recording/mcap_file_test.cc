// Files of other programs, and damages at every place of them: recording_source_test.cc.

#include "core/recording/mcap_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/crc.hpp>
#include <string>
#include <vector>

#include "test/core/recording/mcap_text.h"
#include "test/core/recording/packing.h"
#include "test/core/recording/scanned_messages.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const char kLaserScan[] = "sensor_msgs/msg/LaserScan";

std::string Description() {
  return McapSchemaText(7, kLaserScan) + McapChannelText(1, 7, "/scan", "cdr");
}

std::string Messages() {
  return McapMessageText(1, 10, "first") + McapMessageText(1, 11, "") +
         McapMessageText(1, 12, "third");
}

uint32_t ChecksumOf(const std::string& bytes) {
  boost::crc_32_type sum;
  sum.process_bytes(bytes.data(), bytes.size());
  return sum.checksum();
}

std::string CountOf(uint16_t channel, uint64_t count) {
  return BytesOf(channel) + BytesOf(count);
}

class McapFileTest : public TemporaryDirectoryTest {
 protected:
  // Visits all messages as "topic time data", and reads them again.
  std::vector<std::string> Scan(const std::string& bytes) {
    const std::string path = (directory_ / "file").string();
    WriteBytes(path, bytes);
    McapFile file(std::make_unique<InputFile>(path, "name"));
    const std::vector<std::string> messages =
        ScannedMessages([](const RecordingTopic&) { return true; }, &file);
    topics_ = file.topics();
    warnings_ = file.warnings();
    return messages;
  }

  std::vector<RecordingTopic> topics_;
  std::vector<std::string> warnings_;
};

TEST_F(McapFileTest, MessagesNeedNoChunksAndNoSummary) {
  EXPECT_THAT(Scan(McapFileText(Description() + Messages(), "")),
              ElementsAre("/scan 10 first", "/scan 11 ", "/scan 12 third"));
  EXPECT_THAT(warnings_, IsEmpty());
  ASSERT_EQ(topics_.size(), 1u);
  EXPECT_EQ(topics_[0].type, kLaserScan);
  EXPECT_EQ(topics_[0].encoding, MessageEncoding::kCdr);
  EXPECT_EQ(topics_[0].kind, MessageKind::kLaserScan);
  EXPECT_EQ(topics_[0].num_messages, 3u);
}

TEST_F(McapFileTest, ChunksMayBePacked) {
  const std::string records = Description() + Messages();
  for (const char* compression : {"", "lz4", "zstd"}) {
    const std::string packed =
        std::string(compression).empty() ? records : Pack(compression, records);
    const std::string chunk =
        McapChunkText(compression, records.size(), ChecksumOf(records), packed);
    EXPECT_EQ(
        Scan(McapFileText(chunk, McapChunkIndexText(8) + McapStatisticsText(1, CountOf(1, 3))))
            .size(),
        3u);
    EXPECT_THAT(warnings_, IsEmpty()) << compression;
  }
}

TEST_F(McapFileTest, ChecksumThatDoesNotFitIsTold) {
  const std::string records = Description() + Messages();
  const std::string chunk =
      McapChunkText("", records.size(), ChecksumOf(records) + 1, records);
  EXPECT_EQ(Scan(McapFileText(chunk, "")).size(), 3u);
  EXPECT_THAT(warnings_,
              ElementsAre("damaged MCAP file: the checksum of a chunk does not fit its bytes: "
                          "at byte 8"));
}

TEST_F(McapFileTest, Ros1DefinitionsComeFromMetadata) {
  const std::string schema = McapSchemaText(7, "sensor_msgs/LaserScan");
  for (const std::string definition : {"90c7ef2dc6895d81024acba2ac42f369", "other"}) {
    Scan(McapFileText(
        schema + McapChannelText(
                     1, 7, "/scan", "ros1", WithLength("md5sum") + WithLength(definition)),
        ""));
    ASSERT_EQ(topics_.size(), 1u);
    EXPECT_EQ(topics_[0].kind,
              definition == "other" ? MessageKind::kOther : MessageKind::kLaserScan);
  }
}

TEST_F(McapFileTest, SummaryThatStatesOtherNumbersIsTold) {
  EXPECT_EQ(
      Scan(McapFileText(Description() + Messages(), McapStatisticsText(1, CountOf(1, 9))))
          .size(),
      3u);
  EXPECT_THAT(warnings_,
              ElementsAre("the summary of the recording states 1 chunk, but 0 could be read",
                          "topic /scan: the summary of the recording states 9 messages, but 3 "
                          "could be found"));
}

TEST_F(McapFileTest, FileThatWasNeverClosedIsReadAsFarAsItGoes) {
  const std::string whole = McapMagicText() + Description() + Messages();
  EXPECT_THAT(Scan(whole.substr(0, whole.size() - 1)),
              ElementsAre("/scan 10 first", "/scan 11 "));
  EXPECT_THAT(warnings_,
              ElementsAre(HasSubstr("the recording was never closed"),
                          HasSubstr("damaged MCAP file: a record breaks off: ")));
}

TEST_F(McapFileTest, MessagesWithoutATopicAndSecondDescriptionsAreTold) {
  EXPECT_THAT(Scan(McapFileText(Description() + McapMessageText(2, 5, "lost") +
                                    McapChannelText(1, 7, "/other", "cdr") + Messages(),
                                "")),
              ElementsAre("/scan 10 first", "/scan 11 ", "/scan 12 third"));
  EXPECT_THAT(warnings_,
              ElementsAre(HasSubstr("a message belongs to no topic and is lost: at byte "),
                          HasSubstr("a topic is described in two ways: at byte ")));
}

// The summary says where the next chunk is, the index of a chunk where its messages are.
TEST_F(McapFileTest, BehindADamageTheNextChunkAndTheNextMessageAreFound) {
  const std::string rubbish(50, '\x7f');
  const std::string records = Description() + McapMessageText(1, 10, "first") + rubbish +
                              McapMessageText(1, 12, "third");
  const std::string chunk = McapChunkText("", records.size(), 0, records);
  const uint64_t third = records.size() - McapMessageText(1, 12, "third").size();
  const std::string data =
      rubbish + chunk + McapMessageIndexText(1, BytesOf(uint64_t{12}) + BytesOf(third));
  EXPECT_THAT(Scan(McapFileText(data, McapChunkIndexText(8 + rubbish.size()))),
              ElementsAre("/scan 10 first", "/scan 12 third"));
  EXPECT_THAT(
      warnings_,
      ElementsAre("damaged MCAP file: what is no record was passed over: 50 bytes, at "
                  "byte 8",
                  HasSubstr("what is no record was passed over in a chunk: 50 bytes")));
}

TEST_F(McapFileTest, FileThatBecomesShorterIsAnError) {
  const std::string path = (directory_ / "file").string();
  WriteBytes(path, McapFileText(Description() + Messages(), ""));
  McapFile file(std::make_unique<InputFile>(path, "name"));
  MessageRef beyond;
  beyond.part = UINT32_MAX;
  beyond.begin = 1000;
  beyond.size = 10;
  EXPECT_EQ(ErrorOf([&] { file.Read(beyond); }), "name: has changed while it was read");
}

}  // namespace
}  // namespace plumbline

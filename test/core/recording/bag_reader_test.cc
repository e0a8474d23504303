// Bags that other programs have written, and damages at every place of them:
// core/sensor/damaged_recording_test.cc, recording_source_test.cc.

#include "core/recording/bag_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "test/core/recording/bag_text.h"
#include "test/core/recording/packing.h"
#include "test/core/recording/scanned_messages.h"
#include "test/testing/temporary_directory.h"

namespace plumbline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const char kNeverClosed[] =
    "the bag was never closed and has no index: all that could be read was used";

// Two topics, three messages.
std::string Chunk() {
  return BagConnectionText(3, "/scan", "a/B", "12") + BagMessageText(3, 10, "first") +
         BagConnectionText(5, "/wheels", "c/D", "34") + BagMessageText(5, 11, "second") +
         BagMessageText(3, 12, "third");
}

class BagReaderTest : public TemporaryDirectoryTest {
 protected:
  // Visits the messages of the topics as "topic seconds data", and reads them again.
  std::vector<std::string> Scan(const std::string& bytes, const std::string& topic = "") {
    const std::string path = (directory_ / "file").string();
    WriteBytes(path, bytes);
    BagReader reader(path, "name");
    const auto wants = [&](const BagConnection& connection) {
      return topic.empty() || connection.topic == topic;
    };
    const auto text = [&](const BagMessage& message, ByteView data) {
      return reader.connections()[message.connection_index].topic + " " +
             std::to_string(message.receipt_ns / 1'000'000'000) + " " + TextOf(data);
    };
    const std::vector<std::string> messages =
        ScannedMessages<BagMessage>(wants, text, &reader);
    counts_.clear();
    for (size_t i = 0; i < reader.connections().size(); ++i) {
      counts_.push_back(reader.num_messages(i));
    }
    warnings_ = reader.warnings();
    return messages;
  }

  std::vector<uint64_t> counts_;  // of messages, by connection
  std::vector<std::string> warnings_;
};

TEST_F(BagReaderTest, ClosedBagIsReadWithoutComplaint) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::string chunk = Chunk();
    const std::string packed =
        std::string(compression) == "none" ? chunk : Pack(compression, chunk);
    const std::string body = BagChunkText(compression, chunk.size(), packed);
    const uint64_t position = BagHeaderText(0, 0, 0).size();
    const std::string counts = BytesOf(uint32_t{3}) + BytesOf(uint32_t{2}) +
                               BytesOf(uint32_t{5}) + BytesOf(uint32_t{1});
    const std::string bag = BagHeaderText(position + body.size(), 2, 1) + body +
                            BagConnectionText(3, "/scan", "a/B", "12") +
                            BagConnectionText(5, "/wheels", "c/D", "34") +
                            BagChunkInfoText(position, counts);
    EXPECT_THAT(Scan(bag),
                ElementsAre("/scan 10 first", "/wheels 11 second", "/scan 12 third"));
    EXPECT_THAT(warnings_, IsEmpty()) << compression;
    EXPECT_THAT(counts_, ElementsAre(2, 1));
  }
}

TEST_F(BagReaderTest, MessagesThatNobodyWantsAreCounted) {
  const std::string chunk = Chunk();
  const std::string bag = BagHeaderText(0, 0, 0) + BagChunkText("none", chunk.size(), chunk);
  EXPECT_THAT(Scan(bag, "/wheels"), ElementsAre("/wheels 11 second"));
  EXPECT_THAT(counts_, ElementsAre(2, 1));
  EXPECT_THAT(warnings_, ElementsAre(kNeverClosed));
}

// As a recorder leaves it that is killed: no index, and the last chunk without its sizes.
TEST_F(BagReaderTest, ChunkThatWasBeingWrittenIsRead) {
  const std::string chunk = Chunk();
  const std::string open_chunk = BagChunkText("none", 0, "") + chunk;
  EXPECT_THAT(Scan(BagHeaderText(0, 0, 0) + BagChunkText("none", chunk.size(), chunk) +
                   open_chunk.substr(0, open_chunk.size() - 2)),
              ElementsAre("/scan 10 first",
                          "/wheels 11 second",
                          "/scan 12 third",
                          "/scan 10 first",
                          "/wheels 11 second"));
  EXPECT_THAT(warnings_, Contains(kNeverClosed));
}

TEST_F(BagReaderTest, IndexThatStatesMoreIsTold) {
  const std::string chunk = Chunk();
  const std::string body = BagChunkText("none", chunk.size(), chunk);
  const uint64_t position = BagHeaderText(0, 0, 0).size();
  const std::string bag =
      BagHeaderText(position + body.size(), 3, 2) + body +
      BagConnectionText(3, "/scan", "a/B", "12") +
      BagConnectionText(5, "/wheels", "c/D", "34") +
      BagChunkInfoText(position, BytesOf(uint32_t{3}) + BytesOf(uint32_t{9})) +
      BagChunkInfoText(position, BytesOf(uint32_t{5}) + BytesOf(uint32_t{1}));
  EXPECT_EQ(Scan(bag).size(), 3u);
  EXPECT_THAT(warnings_,
              ElementsAre("the header of the bag states 2 chunks, but 1 could be read",
                          "the header of the bag states 3 topics, but 2 could be read",
                          "topic /scan: the index of the bag states 9 messages, but 2 could "
                          "be found"));
}

TEST_F(BagReaderTest, MessageOfAnUnknownTopicAndASecondDescriptionAreTold) {
  const std::string chunk =
      BagConnectionText(3, "/scan", "a/B", "12") + BagMessageText(4, 10, "lost") +
      BagConnectionText(3, "/other", "a/B", "12") + BagMessageText(3, 12, "found");
  const std::string bag = BagHeaderText(0, 0, 0) + BagChunkText("none", chunk.size(), chunk);
  EXPECT_THAT(Scan(bag), ElementsAre("/scan 12 found"));
  EXPECT_THAT(warnings_,
              ElementsAre(kNeverClosed,
                          HasSubstr("a message belongs to no topic and is lost: at byte "),
                          HasSubstr("a topic is described in two ways: at byte ")));
}

TEST_F(BagReaderTest, WhatIsNoRecordIsPassedOverToTheNextChunk) {
  const std::string chunk = Chunk();
  const std::string body = BagChunkText("none", chunk.size(), chunk);
  const std::string rubbish = std::string(100, '\xff');
  const uint64_t position = BagHeaderText(0, 0, 0).size();
  const std::string chunk_index =
      BagChunkInfoText(position + rubbish.size(), BytesOf(uint32_t{3}) + BytesOf(uint32_t{2}));
  const std::string bag = BagHeaderText(position + rubbish.size() + body.size(), 1, 1) +
                          rubbish + body + BagConnectionText(3, "/scan", "a/B", "12") +
                          chunk_index;
  EXPECT_EQ(Scan(bag, "/scan").size(), 2u);
  EXPECT_THAT(warnings_,
              Contains(HasSubstr("damaged bag: what is no record was passed over")));
}

TEST_F(BagReaderTest, FilesThatCanNotBeReadSayWhy) {
  EXPECT_EQ(ErrorOf([&] { Scan("#ROSBAX"); }), "name: is not a ROS 1 bag");
  EXPECT_EQ(ErrorOf([&] { Scan("#ROSBAG V1.2\n"); }),
            "name: is a ROS 1 bag, but not of version 2.0");
  EXPECT_EQ(ErrorOf([&] { Scan("#ROSBAG V2.0\n"); }),
            "name: the recording breaks off in its header");
  EXPECT_EQ(ErrorOf([&] { Scan(BagHeaderText(0, 0, 0).substr(0, 4000)); }),
            "name: the recording breaks off in its header");
  EXPECT_EQ(ErrorOf([&] { Scan("#ROSBAG V2.0\n" + std::string(5000, 'x')); }),
            "name: the header of the recording is damaged");
  const std::string encrypted =
      BagField("chunk_count", BytesOf(uint32_t{0})) +
      BagField("conn_count", BytesOf(uint32_t{0})) + BagField("encryptor", "aes") +
      BagField("index_pos", BytesOf(uint64_t{0})) + BagField("op", "\3");
  EXPECT_EQ(ErrorOf([&] {
              Scan("#ROSBAG V2.0\n" + BagRecordText(encrypted, std::string(4096, ' ')));
            }),
            "name: the recording is encrypted");
  Scan(BagHeaderText(0, 0, 0));
  EXPECT_THAT(warnings_, ElementsAre(kNeverClosed, "the bag holds no messages"));
}

}  // namespace
}  // namespace plumbline

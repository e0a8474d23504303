#include "core/recording/mcap_record.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "test/core/recording/mcap_text.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

std::string EntryOf(const std::string& key, const std::string& value) {
  return WithLength(key) + WithLength(value);
}

// Reads the record at the begin of the bytes by the function for its type.
template <typename Content>
std::optional<Content> Read(std::optional<Content> (*read)(ByteSource*, const McapRecord&),
                            const std::string& bytes) {
  MemorySource source(ViewOf(bytes));
  const std::optional<McapRecord> record = ReadMcapRecord(&source, 0);
  return record ? read(&source, *record) : std::nullopt;
}

// The content is read from the whole record alone: not from one that is cut, nor from one that
// says itself that it is shorter. Its last bytes, of which there are so many, are not needed.
template <typename Content>
void ExpectWholeOnly(std::optional<Content> (*read)(ByteSource*, const McapRecord&),
                     const std::string& whole,
                     size_t num_unneeded = 0) {
  ASSERT_TRUE(Read(read, whole));
  for (size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(Read(read, whole.substr(0, size))) << size;
  }
  const size_t content_size = whole.size() - McapRecord::kHeadBytes;
  for (size_t size = 0; size + num_unneeded < content_size; ++size) {
    std::string lie = whole;
    lie.replace(1, 8, BytesOf(uint64_t{size}));
    EXPECT_FALSE(Read(read, lie)) << size;
  }
}

TEST(McapRecordTest, IsItsTypeAndItsLength) {
  const std::string bytes = "xx" + McapRecordText(5, "content");
  MemorySource source(ViewOf(bytes));
  const std::optional<McapRecord> record = ReadMcapRecord(&source, 2);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->type, McapRecord::Type::kMessage);
  EXPECT_EQ(record->begin, 11u);
  EXPECT_EQ(record->size, 7u);
  EXPECT_EQ(record->end(), bytes.size());
  EXPECT_FALSE(ReadMcapRecord(&source, bytes.size() - 8));
  EXPECT_FALSE(ReadMcapRecord(&source, ~uint64_t{0}));
}

TEST(McapRecordTest, TypesAreThoseOfTheStandardAndAnybodysOwn) {
  for (int type = 0; type < 256; ++type) {
    const std::string bytes = McapRecordText(type, "");
    MemorySource source(ViewOf(bytes));
    EXPECT_EQ(ReadMcapRecord(&source, 0).has_value(), (type >= 1 && type <= 15) || type >= 128)
        << type;
  }
}

TEST(McapRecordTest, EndDoesNotOverflow) {
  std::string bytes = McapRecordText(5, "");
  bytes.replace(1, 8, BytesOf(~uint64_t{0}));
  MemorySource source(ViewOf(bytes));
  EXPECT_EQ(ReadMcapRecord(&source, 0)->end(), UINT64_MAX);
}

TEST(McapRecordTest, SchemaNamesAType) {
  const std::string bytes = McapSchemaText(7, "sensor_msgs/msg/LaserScan");
  const std::optional<McapSchema> schema = Read(ReadMcapSchema, bytes);
  ASSERT_TRUE(schema);
  EXPECT_EQ(schema->id, 7);
  EXPECT_EQ(schema->name, "sensor_msgs/msg/LaserScan");
  ExpectWholeOnly(ReadMcapSchema, bytes);
}

TEST(McapRecordTest, ChannelIsATopicWithMetadata) {
  const std::string bytes =
      McapChannelText(3, 7, "/scan", "ros1", EntryOf("md5sum", "90c7") + EntryOf("b", ""));
  const std::optional<McapChannel> channel = Read(ReadMcapChannel, bytes);
  ASSERT_TRUE(channel);
  EXPECT_EQ(channel->id, 3);
  EXPECT_EQ(channel->schema_id, 7);
  EXPECT_EQ(channel->topic, "/scan");
  EXPECT_EQ(channel->encoding, "ros1");
  EXPECT_THAT(channel->metadata, ElementsAre(Pair("b", ""), Pair("md5sum", "90c7")));
  ExpectWholeOnly(ReadMcapChannel, bytes);
  // A key without a value.
  EXPECT_FALSE(Read(ReadMcapChannel, McapChannelText(3, 7, "/a", "cdr", WithLength("key"))));
}

TEST(McapRecordTest, MessageHasAHeadAndMayHaveNoData) {
  const std::string bytes = McapMessageText(3, 1'600'000'000'000'000'005, "");
  const std::optional<McapMessage> message = Read(ReadMcapMessage, bytes);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->channel_id, 3);
  EXPECT_EQ(message->log_time_ns, 1'600'000'000'000'000'005u);
  EXPECT_EQ(bytes.size(), McapRecord::kHeadBytes + McapMessage::kHeadBytes);
  ExpectWholeOnly(ReadMcapMessage, bytes);
}

TEST(McapRecordTest, ChunkSaysWhereItsRecordsAre) {
  const std::string bytes = McapChunkText("zstd", 5000, 77, "packed");
  const std::optional<McapChunk> chunk = Read(ReadMcapChunk, bytes);
  ASSERT_TRUE(chunk);
  EXPECT_EQ(chunk->compression, "zstd");
  EXPECT_EQ(chunk->unpacked_size, 5000u);
  EXPECT_EQ(chunk->unpacked_crc, 77u);
  EXPECT_EQ(bytes.substr(static_cast<size_t>(chunk->begin), static_cast<size_t>(chunk->size)),
            "packed");
  // The records may lie beyond the end of what there is, but must fill the chunk.
  EXPECT_TRUE(Read(ReadMcapChunk, bytes.substr(0, bytes.size() - 3)));
  std::string lie = bytes;
  lie.replace(bytes.size() - 6 - 8, 8, BytesOf(uint64_t{5}));
  EXPECT_FALSE(Read(ReadMcapChunk, lie));
  EXPECT_FALSE(Read(ReadMcapChunk, bytes.substr(0, bytes.size() - 6 - 1)));
}

TEST(McapRecordTest, StatisticsCountChunksAndMessages) {
  const std::string bytes =
      McapStatisticsText(4,
                         BytesOf(uint16_t{3}) + BytesOf(uint64_t{1000}) +
                             BytesOf(uint16_t{1}) + BytesOf(uint64_t{20}));
  const std::optional<McapStatistics> statistics = Read(ReadMcapStatistics, bytes);
  ASSERT_TRUE(statistics);
  EXPECT_EQ(statistics->num_chunks, 4u);
  EXPECT_THAT(statistics->message_counts, ElementsAre(Pair(1, 20), Pair(3, 1000)));
  ExpectWholeOnly(ReadMcapStatistics, bytes);
}

TEST(McapRecordTest, FooterSaysWhereTheSummaryBegins) {
  const std::string bytes =
      McapRecordText(2, BytesOf(uint64_t{900}) + BytesOf(uint64_t{0}) + BytesOf(uint32_t{0}));
  EXPECT_EQ(Read(ReadMcapFooter, bytes), 900u);
  ExpectWholeOnly(ReadMcapFooter, bytes, 12);
}

TEST(McapRecordTest, IndexesSayWhereMessagesAndChunksAre) {
  const std::string messages =
      McapMessageIndexText(3,
                           BytesOf(uint64_t{5}) + BytesOf(uint64_t{400}) +
                               BytesOf(uint64_t{6}) + BytesOf(uint64_t{100}));
  const auto offsets = Read(ReadMcapMessageIndex, messages);
  ASSERT_TRUE(offsets);
  EXPECT_THAT(*offsets, ElementsAre(400, 100));
  ExpectWholeOnly(ReadMcapMessageIndex, messages);
  const std::string chunk = McapChunkIndexText(4117);
  EXPECT_EQ(Read(ReadMcapChunkIndex, chunk), 4117u);
  ExpectWholeOnly(ReadMcapChunkIndex, chunk);
}

// A length of 4 GB in a description costs no memory, and is believed of no record.
TEST(McapRecordTest, DescriptionsAreShort) {
  const std::string bytes = McapSchemaText(7, std::string((16 << 20) + 1, 'x'));
  EXPECT_FALSE(Read(ReadMcapSchema, bytes));
}

}  // namespace
}  // namespace plumbline

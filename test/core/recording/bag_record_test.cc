#include "core/recording/bag_record.h"

#include <gtest/gtest.h>

#include <string>

#include "test/core/recording/bag_text.h"

namespace plumbline {
namespace {

std::optional<BagRecord> Read(const std::string& bytes, uint64_t offset = 0) {
  MemorySource source(ViewOf(bytes));
  return ReadBagRecord(&source, offset);
}

std::string MessageHeader() {
  return BagField("conn", BytesOf(uint32_t{3})) + BagField("op", "\2") +
         BagField("time", BytesOf(uint32_t{1600000000}) + BytesOf(uint32_t{5}));
}

TEST(BagRecord, ReadsTheFieldsOfAMessage) {
  const std::optional<BagRecord> record =
      Read("xx" + BagRecordText(MessageHeader(), "data"), 2);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->type, BagRecord::Type::kMessage);
  EXPECT_EQ(record->connection_id, 3u);
  EXPECT_EQ(record->time_ns, 1600000000000000005u);
  EXPECT_EQ(record->data_begin, 2 + 4 + MessageHeader().size() + 4);
  EXPECT_EQ(record->data_size, 4u);
}

TEST(BagRecord, DataMayLieBeyondTheEndButNotTheHeader) {
  const std::string bytes = BagRecordText(MessageHeader(), "data");
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::optional<BagRecord> record = Read(bytes.substr(0, size));
    EXPECT_EQ(record.has_value(), size >= bytes.size() - 4) << size;
    EXPECT_EQ(record ? record->end() : bytes.size(), bytes.size());
  }
  EXPECT_FALSE(Read(bytes, ~uint64_t{0}));
  EXPECT_FALSE(Read(bytes, bytes.size() + 1));
}

TEST(BagRecord, LengthsThatLieAreNoRecord) {
  std::string bytes = BagRecordText(MessageHeader(), "data");
  for (const size_t position : {size_t{0}, size_t{4}}) {  // of the header, of its first field
    for (const uint32_t length : {0xffffffffu, 0x7fffffffu, 1000u, 1u}) {
      std::string lie = bytes;
      lie.replace(position, 4, BytesOf(length));
      EXPECT_FALSE(Read(lie)) << position << " " << length;
    }
  }
}

TEST(BagRecord, FieldsMustBeThoseOfTheType) {
  EXPECT_FALSE(Read(BagRecordText(BagField("op", "\2"), "")));  // none else
  EXPECT_FALSE(Read(
      BagRecordText(MessageHeader() + BagField("conn", BytesOf(uint32_t{1})), "")));  // twice
  EXPECT_FALSE(Read(BagRecordText(MessageHeader() + WithLength("nothing"), "")));  // no value
  EXPECT_FALSE(Read(BagRecordText(BagField("op", "\1"), "")));  // of version 1.2
  // Index data of two messages take 24 bytes.
  const std::string index = BagField("conn", BytesOf(uint32_t{0})) +
                            BagField("count", BytesOf(uint32_t{2})) + BagField("op", "\4");
  EXPECT_TRUE(Read(BagRecordText(index, std::string(24, '\0'))));
  EXPECT_FALSE(Read(BagRecordText(index, std::string(23, '\0'))));
}

TEST(BagRecord, ConnectionNeedsTypeAndMd5Sum) {
  const std::string header =
      BagField("conn", BytesOf(uint32_t{1})) + BagField("op", "\7") + BagField("topic", "/a");
  for (const bool whole : {true, false}) {
    const std::string bytes = BagRecordText(
        header, BagField("md5sum", "12") + BagField(whole ? "type" : "typo", "b/C"));
    MemorySource source(ViewOf(bytes));
    const auto connection = ReadBagConnection(&source, *ReadBagRecord(&source, 0));
    ASSERT_EQ(connection.has_value(), whole);
    if (!whole) continue;
    EXPECT_EQ(connection->topic, "/a");
    EXPECT_EQ(connection->type, "b/C");
    EXPECT_EQ(connection->md5sum, "12");
  }
}

}  // namespace
}  // namespace plumbline

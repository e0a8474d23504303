#include "core/recording/bag_record.h"

#include <gtest/gtest.h>

#include <string>

namespace plumbline {
namespace {

std::string Number(uint32_t value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string Field(const std::string& field) {
  return Number(static_cast<uint32_t>(field.size())) + field;
}

std::string Record(const std::string& header, const std::string& data) {
  return Number(static_cast<uint32_t>(header.size())) + header +
         Number(static_cast<uint32_t>(data.size())) + data;
}

std::optional<BagRecord> Read(const std::string& bytes, uint64_t offset = 0) {
  MemorySource source({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  return ReadBagRecord(&source, offset);
}

std::string MessageHeader() {
  return Field("conn=" + Number(3)) + Field(std::string("op=\2", 4)) +
         Field("time=" + Number(1600000000) + Number(5));
}

TEST(BagRecord, ReadsTheFieldsOfAMessage) {
  const std::optional<BagRecord> record = Read("xx" + Record(MessageHeader(), "data"), 2);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->type, BagRecord::Type::kMessage);
  EXPECT_EQ(record->connection_id, 3u);
  EXPECT_EQ(record->time_ns, 1600000000000000005u);
  EXPECT_EQ(record->data_begin, 2 + 4 + MessageHeader().size() + 4);
  EXPECT_EQ(record->data_size, 4u);
}

TEST(BagRecord, DataMayLieBeyondTheEndButNotTheHeader) {
  const std::string bytes = Record(MessageHeader(), "data");
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::optional<BagRecord> record = Read(bytes.substr(0, size));
    EXPECT_EQ(record.has_value(), size >= bytes.size() - 4) << size;
    EXPECT_EQ(record ? record->end() : bytes.size(), bytes.size());
  }
  EXPECT_FALSE(Read(bytes, ~uint64_t{0}));
  EXPECT_FALSE(Read(bytes, bytes.size() + 1));
}

TEST(BagRecord, LengthsThatLieAreNoRecord) {
  std::string bytes = Record(MessageHeader(), "data");
  for (const size_t position : {size_t{0}, size_t{4}}) {  // of the header, of its first field
    for (const uint32_t length : {0xffffffffu, 0x7fffffffu, 1000u, 1u}) {
      std::string lie = bytes;
      lie.replace(position, 4, Number(length));
      EXPECT_FALSE(Read(lie)) << position << " " << length;
    }
  }
}

TEST(BagRecord, FieldsMustBeThoseOfTheType) {
  EXPECT_FALSE(Read(Record(Field(std::string("op=\2", 4)), "")));                // none else
  EXPECT_FALSE(Read(Record(MessageHeader() + Field("conn=" + Number(1)), "")));  // twice
  EXPECT_FALSE(Read(Record(MessageHeader() + Field("nothing"), "")));            // no value
  EXPECT_FALSE(Read(Record(Field("op=\1"), "")));  // of version 1.2
  // Index data of two messages take 24 bytes.
  const std::string index =
      Field("conn=" + Number(0)) + Field("count=" + Number(2)) + Field("op=\4");
  EXPECT_TRUE(Read(Record(index, std::string(24, '\0'))));
  EXPECT_FALSE(Read(Record(index, std::string(23, '\0'))));
}

TEST(BagRecord, ConnectionNeedsTypeAndMd5Sum) {
  const std::string header = Field("conn=" + Number(1)) + Field("op=\7") + Field("topic=/a");
  for (const bool whole : {true, false}) {
    const std::string bytes =
        Record(header, Field("md5sum=12") + Field(whole ? "type=b/C" : "typo=b/C"));
    MemorySource source({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
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

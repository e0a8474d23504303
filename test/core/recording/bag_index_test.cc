#include "core/recording/bag_index.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "test/core/recording/bag_text.h"

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

std::string CountOf(uint32_t connection, uint32_t count) {
  return BytesOf(connection) + BytesOf(count);
}

// Of a message received at second 7.
std::string OffsetOf(uint32_t offset) {
  return BytesOf(uint32_t{7}) + BytesOf(uint32_t{0}) + BytesOf(offset);
}

BagIndex IndexIn(const std::string& bytes, uint64_t position = 0) {
  MemorySource source(ViewOf(bytes));
  return ReadBagIndex(&source, position);
}

ChunkIndex ChunkIndexIn(const std::string& bytes, uint64_t position = 0) {
  MemorySource source(ViewOf(bytes));
  return ReadChunkIndex(&source, position);
}

TEST(BagIndexTest, HoldsConnectionsAndWhatChunksHoldOfThem) {
  const std::string bytes = "before" + BagConnectionText(3, "/scan", "a/B", "12") +
                            BagConnectionText(5, "/wheels", "c/D", "34") +
                            BagChunkInfoText(9000, CountOf(3, 10) + CountOf(5, 2)) +
                            BagChunkInfoText(4117, CountOf(3, 7));
  const BagIndex index = IndexIn(bytes, 6);
  EXPECT_TRUE(index.is_whole);
  ASSERT_EQ(index.connections.size(), 2u);
  EXPECT_EQ(index.connections[0].topic, "/scan");
  EXPECT_EQ(index.connections[1].id, 5u);
  EXPECT_EQ(index.connections[1].md5sum, "34");
  EXPECT_THAT(index.positions, ElementsAre(4117, 9000));
  EXPECT_THAT(index.message_counts, ElementsAre(Pair(3, 17), Pair(5, 2)));
}

TEST(BagIndexTest, WhatBreaksOffIsReadUpToItsLastWholeRecord) {
  const std::string connection = BagConnectionText(3, "/scan", "a/B", "12");
  const std::string info = BagChunkInfoText(4117, CountOf(3, 7));
  const std::string bytes = connection + info;
  for (size_t size = 0; size < bytes.size(); ++size) {
    const BagIndex index = IndexIn(bytes.substr(0, size));
    EXPECT_EQ(index.is_whole, size == 0 || size == connection.size()) << size;
    EXPECT_EQ(index.connections.size(), size < connection.size() ? 0u : 1u) << size;
    EXPECT_THAT(index.positions, IsEmpty()) << size;
  }
}

TEST(BagIndexTest, OtherRecordsAndPlacesBehindTheEndAreNoIndex) {
  const std::string connection = BagConnectionText(3, "/scan", "a/B", "12");
  const BagIndex index = IndexIn(connection + BagMessageText(3, 1, "data") + connection);
  EXPECT_FALSE(index.is_whole);
  EXPECT_EQ(index.connections.size(), 1u);
  EXPECT_FALSE(IndexIn(connection, connection.size() + 1).is_whole);
  EXPECT_FALSE(IndexIn(connection, ~uint64_t{0}).is_whole);
}

TEST(ChunkIndexTest, OffsetsOfAllConnectionsIncrease) {
  const std::string bytes = BagIndexDataText(3, OffsetOf(500) + OffsetOf(100)) +
                            BagIndexDataText(5, OffsetOf(300)) +
                            BagIndexDataText(3, OffsetOf(700)) + BagMessageText(3, 1, "data") +
                            BagIndexDataText(3, OffsetOf(900));
  const ChunkIndex index = ChunkIndexIn("x" + bytes, 1);
  EXPECT_THAT(index.offsets, ElementsAre(100, 300, 500, 700));
  EXPECT_THAT(index.message_counts, ElementsAre(Pair(3, 3), Pair(5, 1)));
}

TEST(ChunkIndexTest, IsEmptyWhereNoneFollowsTheChunk) {
  EXPECT_THAT(ChunkIndexIn("").offsets, IsEmpty());
  EXPECT_THAT(ChunkIndexIn(BagChunkText("none", 0, "")).offsets, IsEmpty());
  const std::string bytes = BagIndexDataText(3, OffsetOf(500) + OffsetOf(100));
  for (size_t size = 0; size < bytes.size(); ++size) {
    const ChunkIndex index = ChunkIndexIn(bytes.substr(0, size));
    EXPECT_THAT(index.offsets, IsEmpty()) << size;
    EXPECT_THAT(index.message_counts, IsEmpty()) << size;
  }
}

}  // namespace
}  // namespace plumbline

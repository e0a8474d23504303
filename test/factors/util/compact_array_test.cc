#include "factors/util/compact_array.h"

#include <gtest/gtest.h>

#include <memory>
#include <utility>

namespace plumbline {
namespace {

TEST(CompactArray, HoldsWhatItIsGiven) {
  const CompactArray<int> array(std::vector<int>{3, 1, 2});
  ASSERT_EQ(array.size(), 3u);
  EXPECT_EQ(array[0], 3);
  EXPECT_EQ(std::vector<int>(array.begin(), array.end()), (std::vector<int>{3, 1, 2}));
  EXPECT_EQ(array, (std::vector<int>{3, 1, 2}));
  EXPECT_FALSE(array == (std::vector<int>{3, 1}));
  EXPECT_FALSE(array == (std::vector<int>{3, 1, 4}));
  EXPECT_EQ(sizeof(array), sizeof(void*));
}

TEST(CompactArray, EmptyHasNoMemory) {
  const CompactArray<int> array(std::vector<int>{});
  EXPECT_TRUE(array.empty());
  EXPECT_EQ(array.size(), 0u);
  EXPECT_EQ(array.begin(), nullptr);
  EXPECT_EQ(array.begin(), array.end());
}

// Elements that own something are copied, moved and destroyed with their array.
TEST(CompactArray, OwnsItsElements) {
  const auto element = std::make_shared<int>(7);
  {
    CompactArray<std::shared_ptr<int>> a(std::vector<std::shared_ptr<int>>(2, element));
    EXPECT_EQ(element.use_count(), 3);
    CompactArray<std::shared_ptr<int>> b = a;
    EXPECT_EQ(element.use_count(), 5);
    const CompactArray<std::shared_ptr<int>> c = std::move(a);
    EXPECT_TRUE(a.empty());
    EXPECT_EQ(element.use_count(), 5);
    b = c;
    EXPECT_EQ(element.use_count(), 5);
    b = {};
    EXPECT_EQ(element.use_count(), 3);
  }
  EXPECT_EQ(element.use_count(), 1);
}

}  // namespace
}  // namespace plumbline

#include "core/util/free_memory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/types.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace {

size_t allocated_bytes = 0;
unsigned num_arenas = 0;
std::vector<std::string> settings;  // "name=value" of what was set

template <typename Value>
int Tell(Value value, void* old_value) {
  std::memcpy(old_value, &value, sizeof(value));
  return 0;
}

}  // namespace

// Stands in for jemalloc, which the tests are not linked with.
extern "C" int mallctl(
    const char* name, void* old_value, size_t* old_size, void* new_value, size_t new_size) {
  const std::string what = name;
  if (what == "epoch") return 0;
  if (new_value != nullptr) {
    ssize_t value = 0;
    EXPECT_EQ(new_size, sizeof(value));
    std::memcpy(&value, new_value, sizeof(value));
    settings.push_back(what + "=" + std::to_string(value));
    return 0;
  }
  if (what == "stats.allocated") {
    EXPECT_EQ(*old_size, sizeof(size_t));
    return Tell(allocated_bytes, old_value);
  }
  if (what == "arenas.narenas") {
    EXPECT_EQ(*old_size, sizeof(unsigned));
    return Tell(num_arenas, old_value);
  }
  return 1;
}

namespace plumbline {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(FreeMemoryTest, SmallJobKeepsIt) {
  settings.clear();
  num_arenas = 2;
  allocated_bytes = (size_t{128} << 20) - 1;
  ReturnFreeMemoryOfLargeJob();
  EXPECT_THAT(settings, IsEmpty());
}

TEST(FreeMemoryTest, LargeJobHasAllArenasGiveItBackWithinASecond) {
  settings.clear();
  num_arenas = 2;
  allocated_bytes = size_t{128} << 20;
  ReturnFreeMemoryOfLargeJob();
  EXPECT_THAT(settings,
              ElementsAre("arenas.dirty_decay_ms=1000",
                          "arena.0.dirty_decay_ms=1000",
                          "arena.1.dirty_decay_ms=1000"));
}

}  // namespace
}  // namespace plumbline

#include "core/util/ordered_pipeline.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace plumbline {
namespace {

struct Item {
  int number = 0;
  int result = 0;
};

// The results of 0 .. count - 1, in the order in which they were taken.
std::vector<int> Squares(int num_threads, int count) {
  std::vector<int> taken;
  tbb::task_arena(num_threads).execute([&] {
    int next = 0;
    RunOrderedPipeline<Item>(
        [&](Item* item) {
          item->number = next;
          return next++ < count;
        },
        [](Item* item) {
          // Later ones would overtake.
          if (item->number % 3 == 0)
            std::this_thread::sleep_for(std::chrono::microseconds(200));
          item->result = item->number * item->number;
        },
        [&](Item* item) { taken.push_back(item->result); });
  });
  return taken;
}

TEST(RunOrderedPipeline, TakesAllInTheOrderInWhichTheyWereRead) {
  std::vector<int> expected;
  for (int i = 0; i < 200; ++i) expected.push_back(i * i);
  for (const int num_threads : {1, 2, 5}) {
    EXPECT_EQ(Squares(num_threads, 200), expected) << num_threads;
  }
  for (const int num_threads : {1, 2}) EXPECT_TRUE(Squares(num_threads, 0).empty());
}

TEST(RunOrderedPipeline, AnErrorIsThrownOn) {
  for (const int num_threads : {1, 2}) {
    int next = 0;
    int num_taken = 0;
    const auto run = [&] {
      RunOrderedPipeline<Item>(
          [&](Item* item) {
            item->number = next++;
            return true;
          },
          [](Item* item) {
            if (item->number == 20) throw std::runtime_error("twenty");
          },
          [&](Item*) { ++num_taken; });
    };
    EXPECT_THROW(tbb::task_arena(num_threads).execute(run), std::runtime_error);
    EXPECT_LE(num_taken, 20);
  }
}

}  // namespace
}  // namespace plumbline

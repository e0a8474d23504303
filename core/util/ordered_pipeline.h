#pragma once

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <vector>

namespace plumbline {

// Reads items one after the other, works on them on all threads of the caller's
// tbb::task_arena, and takes up what has come of them in the order they were read in: the
// outcome does not depend on the number of threads.
//   bool read(Item*)   fills the next item, which may hold an earlier one; false at the end
//   void work(Item*)   on any thread, beside other items' work and the other two
//   void take(Item*)   never beside another's
// The first exception ends it and is thrown on.
template <typename Item, typename Read, typename Work, typename Take>
void RunOrderedPipeline(const Read& read, const Work& work, const Take& take) {
  const auto num_threads = static_cast<size_t>(tbb::this_task_arena::max_concurrency());
  if (num_threads == 1) {
    for (Item item; read(&item);) {
      work(&item);
      take(&item);
    }
    return;
  }
  // Items are done with in order: at most the last num_items are in use.
  const size_t num_items = 2 * num_threads;
  std::vector<Item> items(num_items);
  size_t next = 0;
  const auto source = [&](tbb::flow_control& control) -> Item* {
    Item* item = &items[next % num_items];
    ++next;
    if (!read(item)) control.stop();
    return item;
  };
  const auto through = [&](Item* item) {
    work(item);
    return item;
  };
  const auto sink = [&](Item* item) { take(item); };
  tbb::parallel_pipeline(
      num_items,
      tbb::make_filter<void, Item*>(tbb::filter_mode::serial_in_order, source) &
          tbb::make_filter<Item*, Item*>(tbb::filter_mode::parallel, through) &
          tbb::make_filter<Item*, void>(tbb::filter_mode::serial_in_order, sink));
}

}  // namespace plumbline

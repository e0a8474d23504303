#include "core/util/free_memory.h"

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <string>

// jemalloc's (jemalloc/jemalloc.h); nullptr in programs that are not linked with it.
extern "C" int mallctl(const char* name,
                       void* old_value,
                       size_t* old_size,
                       void* new_value,
                       size_t new_size) __attribute__((weak));

namespace plumbline {
namespace {

constexpr size_t kLarge = size_t{128} << 20;  // bytes

// Zero where jemalloc does not tell.
template <typename Value>
Value Read(const char* name) {
  Value value = 0;
  size_t size = sizeof(value);
  return mallctl(name, &value, &size, nullptr, 0) == 0 ? value : Value{0};
}

}  // namespace

void ReturnFreeMemoryOfLargeJob() {
  if (mallctl == nullptr) return;
  uint64_t epoch = 1;
  mallctl("epoch", nullptr, nullptr, &epoch, sizeof(epoch));  // takes its figures anew
  if (Read<size_t>("stats.allocated") < kLarge) return;
  ssize_t decay_ms = 1000;
  mallctl("arenas.dirty_decay_ms", nullptr, nullptr, &decay_ms, sizeof(decay_ms));
  const auto num_arenas = Read<unsigned>("arenas.narenas");
  for (unsigned i = 0; i < num_arenas; ++i) {  // those that have not been used yet refuse
    mallctl(("arena." + std::to_string(i) + ".dirty_decay_ms").c_str(),
            nullptr,
            nullptr,
            &decay_ms,
            sizeof(decay_ms));
  }
}

}  // namespace plumbline

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

// On one core, as the figures of docs/performance.md.
int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  tbb::task_arena(1).execute([] { benchmark::RunSpecifiedBenchmarks(); });
  benchmark::Shutdown();
  return 0;
}

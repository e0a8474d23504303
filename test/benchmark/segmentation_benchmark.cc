#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/segmentation/segmentation.h"
#include "test/testing/planar_world.h"

namespace plumbline {
namespace {

// Arguments: number of beams, range noise in mm. Each iteration takes another noisy scan line.
void SegmentScene(benchmark::State& state, const PlanarWorld& world) {
  const int num_beams = static_cast<int>(state.range(0));
  Scanner scanner;
  scanner.range_noise_m = 1e-3 * static_cast<double>(state.range(1));
  const PlanarWorldScan scan = TakePlanarWorldScan(world, {0, 0}, 0.2, num_beams, 1.5 * M_PI);
  std::mt19937_64 random(42);
  std::vector<ScanLine> scan_lines;
  for (int i = 0; i < 64; ++i) {
    scan_lines.push_back(AddRangeNoise(scan.scan_line, scanner.range_noise_m, &random));
  }
  size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(SegmentScanLine(scan_lines[next++ % 64], scanner, {}, {}));
  }
  state.counters["per_beam"] = benchmark::Counter(
      num_beams, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void Room(benchmark::State& state) {
  SegmentScene(state, PlanarWorld().AddWalls({{-3, -2}, {5, -2}, {5, 3}, {-3, 3}, {-3, -2}}));
}

void Corridor(benchmark::State& state) {
  SegmentScene(
      state, PlanarWorld().AddWalls({{-15, -1}, {14, -1}, {14, 1.2}, {-15, 1.2}, {-15, -1}}));
}

void ColumnsInARoom(benchmark::State& state) {
  PlanarWorld world = PlanarWorld().AddWalls({{-6, -5}, {6, -5}, {6, 5}, {-6, 5}, {-6, -5}});
  for (int i = 0; i < 8; ++i) {
    world.columns.push_back({{3.0 * std::cos(0.7 * i), 3.0 * std::sin(0.7 * i)}, 0.2});
  }
  SegmentScene(state, world);
}

void Settings(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"beams", "sigma_mm"})->ArgsProduct({{270, 1080}, {10, 30}});
}

BENCHMARK(Room)->Apply(Settings);
BENCHMARK(Corridor)->Apply(Settings);
BENCHMARK(ColumnsInARoom)->Apply(Settings);

}  // namespace
}  // namespace plumbline

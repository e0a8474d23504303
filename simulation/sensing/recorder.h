#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "simulation/sensing/simulator.h"

namespace plumbline {

// Recorder turns what errorless scanners see into what the recording has: noise, and the
// faults that lie in the scanners. Lines have to come in the order of their stamps. The random
// numbers of each line depend only on the seed, the scanner and the line.
class Recorder {
 public:
  Recorder(const Experiment& experiment, uint64_t seed);

  // nullopt while the scanner is gone.
  std::optional<ScanLine> Record(const PerfectScanLine& perfect);

 private:
  const Episode* EpisodeAt(const ScannerFaults& faults, int64_t stamp_ns) const;
  void Scatter(const PerfectScanLine& perfect, double share, ScanLine* scan_line) const;

  Rig rig_;
  NoiseOptions noise_;
  FaultOptions faults_;
  int64_t start_ns_ = 0;
  uint64_t seed_ = 0;
  std::vector<std::vector<float>> last_ranges_;  // of each scanner, before it froze
};

}  // namespace plumbline

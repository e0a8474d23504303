#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/map/map_state.h"
#include "core/sensor/rig.h"

namespace plumbline {

// Counts what a scanner's lines hold, by second: whether it measures at all, and whether it
// measures anew.
class ScannerActivity {
 public:
  // first_second: of the recording, from which the seconds count.
  explicit ScannerActivity(int first_second = 0) : first_second_(first_second) {}

  // Takes in the next line of a scanner, taken time_s after first_second. num_used: of its
  // points, on planes.
  void Add(int scanner_index,
           double time_s,
           int64_t num_points,
           int64_t num_used,
           uint64_t fingerprint);

  struct Second {
    int num_lines = 0;
    int num_repeated = 0;  // lines that hold the very ranges of the one before
    int64_t num_points = 0;
    int64_t num_used = 0;
  };
  int first_second() const { return first_second_; }
  // Counts by scanner, and by second since first_second.
  const std::vector<std::vector<Second>>& seconds() const { return seconds_; }
  // The first second in which any scanner measures, and the one after the last.
  std::pair<size_t, size_t> Span() const;

 private:
  int first_second_;
  std::vector<std::vector<Second>> seconds_;
  std::vector<uint64_t> last_fingerprints_;
};

// A second with next to nothing (kHardlyAnyShare) of what the scanner usually has is silent,
// and so is the scanner after this number of them in a row. It is frozen in a second in which
// most of its lines repeat the one before.
inline constexpr int kMinSilent = 2;  // s

// A number that differs for lines of different ranges; 0 for one with hardly any.
uint64_t FingerprintOf(const std::vector<float>& ranges);

// ScannerAgreement says how well a scanner agrees with the map and with the other scanners.
struct ScannerAgreement {
  int64_t num_points = 0;
  int num_segments = 0;     // on planes
  double used_share = 0.0;  // of its points, on planes
  // Share of its points on planes that hardly any other scanner sees.
  double alone_share = 0.0;
  // Root mean square difference between where it and where the others see a plane in the same
  // second, m.
  double difference_m = 0.0;
  int num_differences = 0;
  // That difference over the standard deviation that the noise lets expect.
  double difference_ratio = 0.0;
  // Root mean square distance of its segments from their planes, over the noise's.
  double deviation_ratio = 0.0;
};

std::vector<ScannerAgreement> CompareScanners(const Rig& rig,
                                              const MapState& state,
                                              const ScannerActivity& activity,
                                              int64_t start_ns);

// The kind of fault of a scanner.
struct ScannerFault {
  int scanner_index = -1;
  bool contradicts = false;  // the other scanners
  std::string sentence;      // naming the scanner
};

// The faults of scanners: silent, frozen, off all planes, or in contradiction to the others.
std::vector<ScannerFault> FindScannerFaults(const Rig& rig,
                                            const std::vector<ScannerAgreement>& agreements,
                                            const ScannerActivity& activity);

}  // namespace plumbline

#include "core/sensor/scan_order.h"

#include <algorithm>
#include <cstdio>
#include <tuple>

#include "core/util/time.h"

namespace plumbline {

namespace {

constexpr double kMinGapS = 0.5;      // in which a walking rig leaves what it has seen
constexpr double kMinAbsenceS = 1.0;  // drivers start one after the other
constexpr double kMinPeriods = 10.0;  // slow scanners may lose some scan lines
constexpr int kMaxGapWarnings = 10;   // more of them would bury the others

std::string SecondsText(double seconds) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.3f s", seconds);
  return text;
}

std::string CountText(int count) {
  return std::to_string(count) + (count == 1 ? " scan line" : " scan lines");
}

double Median(std::vector<double>* values) {
  if (values->empty()) return 0.0;
  const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

// Marks the longest strictly increasing subsequence; of equally long ones the one that keeps
// what comes first. A single stamp far in the future thus costs one scan line, not all after
// it.
std::vector<bool> LongestIncreasingSubsequence(const std::vector<int64_t>& stamps) {
  // From the back: tails[k] is where the largest stamp stands that k + 1 stamps can begin
  // with.
  std::vector<size_t> tails;
  std::vector<size_t> successors(stamps.size(), stamps.size());
  for (size_t i = stamps.size(); i-- > 0;) {
    const auto tail = std::lower_bound(
        tails.begin(), tails.end(), stamps[i], [&stamps](size_t index, int64_t stamp) {
          return stamps[index] > stamp;
        });
    if (tail != tails.begin()) successors[i] = *(tail - 1);
    if (tail == tails.end()) {
      tails.push_back(i);
    } else {
      *tail = i;
    }
  }
  std::vector<bool> kept(stamps.size(), false);
  if (tails.empty()) return kept;
  for (size_t i = tails.back(); i < stamps.size(); i = successors[i]) kept[i] = true;
  return kept;
}

// Scan lines that were passed over for one reason.
struct PassedOver {
  int count = 0;
  int64_t first_ns = 0;

  void Add(int64_t time_ns) {
    if (count++ == 0) first_ns = time_ns;
  }
};

// The messages of one scanner.
struct ScannerStamps {
  std::vector<size_t> positions;  // usable, in the order of the recording
  std::vector<int64_t> stamps;    // of these
  PassedOver unusable;
  PassedOver repeated;  // first_ns: stamp of the scan line used before it
  PassedOver jumped;
  double period_s = 0.0;
  int64_t first_ns = 0;
  int64_t last_ns = 0;
};

// Reduces positions and stamps to those with strictly increasing stamps.
void KeepIncreasing(ScannerStamps* scanner) {
  const std::vector<bool> kept = LongestIncreasingSubsequence(scanner->stamps);
  ScannerStamps increasing = *scanner;
  increasing.positions.clear();
  increasing.stamps.clear();
  for (size_t i = 0; i < kept.size(); ++i) {
    const int64_t stamp_ns = scanner->stamps[i];
    const int64_t previous_ns =
        increasing.stamps.empty() ? stamp_ns : increasing.stamps.back();
    if (kept[i]) {
      increasing.positions.push_back(scanner->positions[i]);
      increasing.stamps.push_back(stamp_ns);
    } else if (!increasing.stamps.empty() && stamp_ns == previous_ns) {
      increasing.repeated.Add(previous_ns);
    } else {
      increasing.jumped.Add(previous_ns);
    }
  }
  *scanner = std::move(increasing);
}

void FindPeriod(ScannerStamps* scanner, std::vector<double>* all_periods_s) {
  if (scanner->stamps.empty()) return;
  scanner->first_ns = scanner->stamps.front();
  scanner->last_ns = scanner->stamps.back();
  std::vector<double> periods_s;
  for (size_t i = 1; i < scanner->stamps.size(); ++i) {
    periods_s.push_back(SecondsBetween(scanner->stamps[i - 1], scanner->stamps[i]));
  }
  all_periods_s->insert(all_periods_s->end(), periods_s.begin(), periods_s.end());
  scanner->period_s = Median(&periods_s);
}

void WarnOfPassedOver(const std::string& name,
                      const ScannerStamps& scanner,
                      int64_t start_ns,
                      std::vector<std::string>* warnings) {
  const auto warn = [&](const PassedOver& passed_over, const std::string& reason) {
    if (passed_over.count == 0) return;
    warnings->push_back("scanner '" + name + "': " + CountText(passed_over.count) +
                        " passed over: " + reason + ", first at " +
                        SecondsText(SecondsBetween(start_ns, passed_over.first_ns)));
  };
  warn(scanner.unusable, "no ranges, or angles or time increments that make no sense");
  warn(scanner.repeated, "time stamps repeated");
  warn(scanner.jumped, "time stamps that jump against the others");
}

void WarnOfAbsence(const std::string& name,
                   const ScannerStamps& scanner,
                   int64_t start_ns,
                   int64_t end_ns,
                   std::vector<std::string>* warnings) {
  if (scanner.stamps.empty()) {
    warnings->push_back("scanner '" + name + "' has no usable scan line");
    return;
  }
  const double threshold_s = std::max(kMinAbsenceS, kMinPeriods * scanner.period_s);
  const double late_s = SecondsBetween(start_ns, scanner.first_ns);
  const double early_s = SecondsBetween(scanner.last_ns, end_ns);
  if (late_s > threshold_s) {
    warnings->push_back("scanner '" + name + "' starts late: its first scan line is at " +
                        SecondsText(late_s));
  }
  if (early_s > threshold_s) {
    warnings->push_back("scanner '" + name + "' stops early: its last scan line is at " +
                        SecondsText(SecondsBetween(start_ns, scanner.last_ns)) + ", " +
                        SecondsText(early_s) + " before the end of the recording");
  }
}

void WarnOfGaps(const std::vector<ScanStamp>& stamps, ScanOrder* order) {
  const double threshold_s = std::max(kMinGapS, kMinPeriods * order->scan_period_s);
  const std::vector<size_t>& positions = order->positions;
  const int64_t start_ns = stamps[positions.front()].stamp_ns;
  int num_gaps = 0;
  for (size_t i = 1; i < positions.size(); ++i) {
    const int64_t before_ns = stamps[positions[i - 1]].stamp_ns;
    const double gap_s = SecondsBetween(before_ns, stamps[positions[i]].stamp_ns);
    if (gap_s <= threshold_s || ++num_gaps > kMaxGapWarnings) continue;
    order->warnings.push_back("no scanner delivered anything for " + SecondsText(gap_s) +
                              " after " + SecondsText(SecondsBetween(start_ns, before_ns)));
  }
  if (num_gaps > kMaxGapWarnings) {
    order->warnings.push_back(std::to_string(num_gaps - kMaxGapWarnings) +
                              " more gaps longer than " + SecondsText(threshold_s));
  }
}

}  // namespace

ScanOrder OrderScanLines(const Rig& rig, const std::vector<ScanStamp>& stamps) {
  std::vector<ScannerStamps> scanners(rig.scanners.size());
  for (size_t position = 0; position < stamps.size(); ++position) {
    ScannerStamps& scanner = scanners[static_cast<size_t>(stamps[position].scanner_index)];
    if (stamps[position].usable) {
      scanner.positions.push_back(position);
      scanner.stamps.push_back(stamps[position].stamp_ns);
    } else {
      scanner.unusable.Add(stamps[position].stamp_ns);
    }
  }

  ScanOrder order;
  std::vector<double> periods_s;
  for (ScannerStamps& scanner : scanners) {
    KeepIncreasing(&scanner);
    FindPeriod(&scanner, &periods_s);
    order.positions.insert(
        order.positions.end(), scanner.positions.begin(), scanner.positions.end());
  }
  order.scan_period_s = Median(&periods_s);
  const auto key = [&stamps](size_t position) {
    return std::make_tuple(stamps[position].stamp_ns, stamps[position].scanner_index);
  };
  std::sort(order.positions.begin(), order.positions.end(), [&key](size_t a, size_t b) {
    return key(a) < key(b);
  });

  const bool empty = order.positions.empty();
  const int64_t start_ns = empty ? 0 : stamps[order.positions.front()].stamp_ns;
  const int64_t end_ns = empty ? 0 : stamps[order.positions.back()].stamp_ns;
  for (size_t i = 0; i < scanners.size(); ++i) {
    const std::string& name = rig.scanners[i].name;
    // Where nothing is left there is no start to count from.
    const int64_t origin_ns = empty ? scanners[i].unusable.first_ns : start_ns;
    WarnOfPassedOver(name, scanners[i], origin_ns, &order.warnings);
    WarnOfAbsence(name, scanners[i], start_ns, end_ns, &order.warnings);
  }
  if (!empty) WarnOfGaps(stamps, &order);
  return order;
}

}  // namespace plumbline

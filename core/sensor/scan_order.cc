#include "core/sensor/scan_order.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "core/util/date.h"
#include "core/util/time.h"

namespace plumbline {

namespace {

constexpr double kMinGapS = 0.5;      // in which a walking rig leaves what it has seen
constexpr double kMinAbsenceS = 1.0;  // drivers start one after the other
constexpr double kMinPeriods = 10.0;  // slow scanners may lose some scan lines
constexpr int kMaxGapWarnings = 10;   // more of them would bury the others
constexpr double kMaxPauseS = 3600.0;  // in one recording, of all scanners
// The least time between neighbouring lines of a scanner, of its period: any stamp that jumps
// onto regular ones is nearer than half a period to one of them.
constexpr double kMinSpacing = 0.6;

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

// The messages of one scanner.
struct ScannerStamps {
  std::vector<size_t> positions;  // usable, in the order of the recording
  std::vector<int64_t> stamps;    // of these
  PassedOverLines passed_over;
  double period_s = 0.0;
  int64_t first_ns = 0;
  int64_t last_ns = 0;
};

// Marks what was not kept and yet fills a place that the kept ones leave free: messages that
// were held up on their way, or written in another order. stamps: one is kept.
void KeepWhatFits(const std::vector<int64_t>& stamps, std::vector<bool>* kept) {
  std::set<int64_t> known;
  std::vector<int64_t> sorted = stamps;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<double> periods_s;
  for (size_t i = 1; i < sorted.size(); ++i) {
    periods_s.push_back(SecondsBetween(sorted[i - 1], sorted[i]));
  }
  const double spacing_s = kMinSpacing * Median(&periods_s);
  for (size_t i = 0; i < stamps.size(); ++i) {
    if ((*kept)[i]) known.insert(stamps[i]);
  }
  const int64_t margin_ns = NanosecondsFromSeconds(kMinGapS);
  const int64_t first_ns = *known.begin() - margin_ns;
  const int64_t last_ns = *known.rbegin() + margin_ns;
  for (size_t i = 0; i < stamps.size(); ++i) {
    if ((*kept)[i] || stamps[i] < first_ns || stamps[i] > last_ns) continue;
    const auto after = known.lower_bound(stamps[i]);
    if (after != known.end() && *after == stamps[i]) continue;
    if (after != known.end() && SecondsBetween(stamps[i], *after) < spacing_s) continue;
    if (after != known.begin() && SecondsBetween(*std::prev(after), stamps[i]) < spacing_s) {
      continue;
    }
    (*kept)[i] = true;
    known.insert(stamps[i]);
  }
}

// Reduces positions and stamps to those with strictly increasing stamps, in their order.
void KeepIncreasing(ScannerStamps* scanner) {
  if (scanner->stamps.empty()) return;
  std::vector<bool> kept = LongestIncreasingSubsequence(scanner->stamps);
  KeepWhatFits(scanner->stamps, &kept);
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
      increasing.passed_over.repeated.Add(previous_ns);
    } else {
      increasing.passed_over.jumped.Add(previous_ns);
    }
  }
  std::vector<size_t> order(increasing.stamps.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&increasing](size_t a, size_t b) {
    return increasing.stamps[a] < increasing.stamps[b];
  });
  const ScannerStamps unsorted = increasing;
  for (size_t i = 0; i < order.size(); ++i) {
    increasing.positions[i] = unsorted.positions[order[i]];
    increasing.stamps[i] = unsorted.stamps[order[i]];
  }
  *scanner = std::move(increasing);
}

// A run of instants without a gap between them.
struct Run {
  size_t first = 0;
  size_t last = 0;  // one past
};

// Marks the runs that last less than a second and are told by is_apart(before, after) to lie
// apart, at each of their ends at which there are others. times_ns: sorted.
template <typename IsApart>
std::vector<bool> MarkShortRunsApart(const std::vector<int64_t>& times_ns,
                                     double max_gap_s,
                                     const IsApart& is_apart) {
  std::vector<Run> runs;
  for (size_t i = 0; i < times_ns.size(); ++i) {
    if (i == 0 || SecondsBetween(times_ns[i - 1], times_ns[i]) > max_gap_s)
      runs.push_back({i, i});
    runs.back().last = i + 1;
  }
  std::vector<bool> is_marked(times_ns.size(), false);
  // The run with the most instants is what the others lie apart from.
  const auto most = std::max_element(runs.begin(), runs.end(), [](const Run& a, const Run& b) {
    return a.last - a.first < b.last - b.first;
  });
  for (size_t i = 0; i < runs.size(); ++i) {
    const auto [first, last] = runs[i];
    if (runs.begin() + static_cast<std::ptrdiff_t>(i) == most) continue;
    if (SecondsBetween(times_ns[first], times_ns[last - 1]) >= kMinAbsenceS) continue;
    if (i > 0 && !is_apart(first - 1, first)) continue;
    if (i + 1 < runs.size() && !is_apart(last - 1, last)) continue;
    std::fill(is_marked.begin() + static_cast<std::ptrdiff_t>(first),
              is_marked.begin() + static_cast<std::ptrdiff_t>(last),
              true);
  }
  return is_marked;
}

double MedianStep(const std::vector<int64_t>& times_ns) {
  std::vector<double> steps_s;
  for (size_t i = 1; i < times_ns.size(); ++i) {
    steps_s.push_back(SecondsBetween(times_ns[i - 1], times_ns[i]));
  }
  return Median(&steps_s);
}

// Takes out runs of less than a second whose distance from the others the recorder's clock
// does not confirm.
void PassOverUnconfirmed(const std::vector<ScanStamp>& stamps, ScannerStamps* scanner) {
  std::vector<int64_t> receipts_ns;
  for (const size_t position : scanner->positions) {
    receipts_ns.push_back(stamps[position].receipt_ns);
  }
  const double period_s = MedianStep(scanner->stamps);
  const double received_s = MedianStep(receipts_ns);
  // Recordings that were converted may say nothing of when a message was received.
  if (received_s < 0.5 * period_s || received_s > 2.0 * period_s) return;
  const double max_gap_s = std::max(kMinGapS, kMinPeriods * period_s);
  const std::vector<bool> is_apart =
      MarkShortRunsApart(scanner->stamps, max_gap_s, [&](size_t before, size_t after) {
        const double gap_s = SecondsBetween(scanner->stamps[before], scanner->stamps[after]);
        return SecondsBetween(receipts_ns[before], receipts_ns[after]) < 0.5 * gap_s;
      });
  size_t num_kept = 0;
  for (size_t i = 0; i < is_apart.size(); ++i) {
    if (is_apart[i]) {
      scanner->passed_over.apart.Add(scanner->stamps[i]);
      continue;
    }
    scanner->positions[num_kept] = scanner->positions[i];
    scanner->stamps[num_kept++] = scanner->stamps[i];
  }
  scanner->positions.resize(num_kept);
  scanner->stamps.resize(num_kept);
}

// Takes out runs of less than a second that lie more than an hour from all other lines.
void PassOverFarAway(std::vector<ScannerStamps>* scanners) {
  std::vector<int64_t> times_ns;
  for (const ScannerStamps& scanner : *scanners) {
    times_ns.insert(times_ns.end(), scanner.stamps.begin(), scanner.stamps.end());
  }
  std::sort(times_ns.begin(), times_ns.end());
  const std::vector<bool> is_apart =
      MarkShortRunsApart(times_ns, kMaxPauseS, [](size_t, size_t) { return true; });
  std::set<int64_t> far_ns;
  for (size_t i = 0; i < is_apart.size(); ++i) {
    if (is_apart[i]) far_ns.insert(times_ns[i]);
  }
  for (ScannerStamps& scanner : *scanners) {
    size_t num_kept = 0;
    for (size_t i = 0; i < scanner.stamps.size(); ++i) {
      if (far_ns.count(scanner.stamps[i]) > 0) {
        scanner.passed_over.apart.Add(scanner.stamps[i]);
        continue;
      }
      scanner.positions[num_kept] = scanner.positions[i];
      scanner.stamps[num_kept++] = scanner.stamps[i];
    }
    scanner.positions.resize(num_kept);
    scanner.stamps.resize(num_kept);
  }
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
                      const std::string& unusable_reason,
                      int64_t start_ns,
                      std::vector<std::string>* warnings) {
  const auto warn = [&](const PassedOver& passed_over, const std::string& reason) {
    if (passed_over.count == 0) return;
    warnings->push_back("scanner '" + name + "': " + CountText(passed_over.count) +
                        " passed over: " + reason + ", first at " +
                        SecondsText(SecondsBetween(start_ns, passed_over.first_ns)));
  };
  warn(scanner.passed_over.unusable,
       "no ranges, or angles or times that make no sense" +
           (unusable_reason.empty() ? "" : " (" + unusable_reason + ")"));
  warn(scanner.passed_over.repeated, "time stamps repeated");
  warn(scanner.passed_over.jumped, "time stamps that jump against the others");
  if (scanner.passed_over.apart.count == 0) return;
  warnings->push_back("scanner '" + name + "': " + CountText(scanner.passed_over.apart.count) +
                      " passed over: time stamps that lie apart from all others, such as " +
                      FormatDate(scanner.passed_over.apart.first_ns) +
                      "; the clock was not set when they were taken");
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

ScanOrder OrderScanLines(const Rig& rig,
                         const std::vector<ScanStamp>& stamps,
                         const std::vector<std::string>& unusable_reasons) {
  std::vector<ScannerStamps> scanners(rig.scanners.size());
  for (size_t position = 0; position < stamps.size(); ++position) {
    ScannerStamps& scanner = scanners[static_cast<size_t>(stamps[position].scanner_index)];
    if (stamps[position].usable) {
      scanner.positions.push_back(position);
      scanner.stamps.push_back(stamps[position].stamp_ns);
    } else {
      scanner.passed_over.unusable.Add(stamps[position].stamp_ns);
    }
  }

  ScanOrder order;
  std::vector<double> periods_s;
  for (ScannerStamps& scanner : scanners) {
    KeepIncreasing(&scanner);
    PassOverUnconfirmed(stamps, &scanner);
  }
  PassOverFarAway(&scanners);
  for (ScannerStamps& scanner : scanners) {
    FindPeriod(&scanner, &periods_s);
    order.passed_over.push_back(scanner.passed_over);
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
    // There is no start to count from if nothing is left.
    const int64_t origin_ns = empty ? scanners[i].passed_over.unusable.first_ns : start_ns;
    WarnOfPassedOver(name,
                     scanners[i],
                     i < unusable_reasons.size() ? unusable_reasons[i] : "",
                     origin_ns,
                     &order.warnings);
    WarnOfAbsence(name, scanners[i], start_ns, end_ns, &order.warnings);
  }
  if (!empty) WarnOfGaps(stamps, &order);
  return order;
}

}  // namespace plumbline

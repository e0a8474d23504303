#include "core/result/symptoms.h"

#include <algorithm>
#include <cstdio>

namespace plumbline {

std::vector<SymptomGroup> GroupSymptoms(std::vector<DoubtfulInterval> intervals) {
  std::stable_sort(intervals.begin(), intervals.end(), [](const auto& a, const auto& b) {
    return a.start_s < b.start_s;
  });
  std::vector<SymptomGroup> groups;
  for (const DoubtfulInterval& interval : intervals) {
    if (groups.empty() || interval.start_s > groups.back().end_s) {
      groups.push_back({interval.start_s, interval.end_s, {}});
    }
    SymptomGroup& group = groups.back();
    group.end_s = std::max(group.end_s, interval.end_s);
    auto symptom =
        std::find_if(group.symptoms.begin(), group.symptoms.end(), [&](const Symptom& of) {
          return of.reason == interval.reason;
        });
    if (symptom == group.symptoms.end()) {
      symptom = group.symptoms.insert(symptom, {interval.reason, {}});
    }
    symptom->intervals_s.emplace_back(interval.start_s, interval.end_s);
  }
  return groups;
}

std::string SymptomText(const Symptom& symptom, const SymptomGroup& group) {
  const auto& intervals = symptom.intervals_s;
  if (intervals.size() == 1 && intervals.front() == std::pair(group.start_s, group.end_s)) {
    return symptom.reason;
  }
  std::string text = symptom.reason;
  for (size_t i = 0; i < intervals.size(); ++i) {
    char times[80];
    std::snprintf(times,
                  sizeof(times),
                  "%sfrom %.0f to %.0f s",
                  i == 0 ? " (" : ", ",
                  intervals[i].first,
                  intervals[i].second);
    text += times;
  }
  return text + ")";
}

}  // namespace plumbline

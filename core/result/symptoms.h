#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result/result_types.h"

namespace plumbline {

// Symptom is one reason to doubt a map, and when it shows: seconds since the recording's first
// scan line.
struct Symptom {
  std::string reason;
  std::vector<std::pair<double, double>> intervals_s;
};

// SymptomGroup is a stretch of the recording that is in doubt, with all reasons, each once.
struct SymptomGroup {
  double start_s = 0.0;
  double end_s = 0.0;
  std::vector<Symptom> symptoms;
};

// Joins intervals that overlap or touch. Groups are in the order of time, the symptoms of each
// in the order in which they show first.
std::vector<SymptomGroup> GroupSymptoms(std::vector<DoubtfulInterval> intervals);

// "it jumps (from 4 to 6 s, from 9 to 12 s)"; without the times where they are the group's.
std::string SymptomText(const Symptom& symptom, const SymptomGroup& group);

}  // namespace plumbline

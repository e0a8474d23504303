#include "core/check/recording_survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/consistency/scanner_agreement.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kWindow = 2.0;  // s, of a window of the sample
// The sample holds at most so many beams, which take a second or two to look at.
constexpr int64_t kMaxBeams = 2'500'000;

bool IsUsed(const TopicSurvey& topic, int64_t stamp_ns) {
  const auto found = std::lower_bound(
      topic.stamps.begin(), topic.stamps.end(), stamp_ns, [](const auto& one, int64_t ns) {
        return one.stamp_ns < ns;
      });
  return found != topic.stamps.end() && found->stamp_ns == stamp_ns;
}

// Keeps the scan lines of windows that are spread evenly: each time that they become too many,
// every second window is dropped.
class WindowSample {
 public:
  void Add(const ScanMessage& message, int64_t start_receipt_ns) {
    const double time_s = SecondsBetween(start_receipt_ns, message.receipt_ns);
    const auto window = static_cast<int64_t>(std::max(0.0, time_s) / kWindow);
    if (!message.usable || window % stride_ != 0) return;
    const uint64_t fingerprint = FingerprintOf(message.line.ranges);
    uint64_t& last = last_fingerprints_[message.line.scanner_index];
    const bool is_frozen = fingerprint != 0 && fingerprint == last;
    last = fingerprint;
    if (is_frozen) return;  // it says nothing new, and shows what is not there any more
    std::vector<ScanLine>& lines = windows_[window];
    lines.push_back(message.line);
    for (size_t beam = 0; beam < message.is_at_stated_limit.size(); ++beam) {
      if (!message.is_at_stated_limit[beam]) continue;
      lines.back().ranges[beam] = std::numeric_limits<float>::quiet_NaN();
    }
    num_beams_ += message.line.num_beams();
    while (num_beams_ > kMaxBeams && windows_.size() > 1) Thin();
  }

  std::vector<std::vector<ScanLine>> Take(const std::vector<TopicSurvey>& topics) {
    std::vector<std::vector<ScanLine>> lines(topics.size());
    for (auto& [window, of_window] : windows_) {
      for (ScanLine& line : of_window) {
        const auto index = static_cast<size_t>(line.scanner_index);
        const TopicSurvey& topic = topics[index];
        if (!IsUsed(topic, line.stamp_ns)) continue;
        for (float& range : line.ranges) {
          range = static_cast<float>(topic.metres_per_unit * static_cast<double>(range));
          if (!(range >= topic.limits.min_m && range <= topic.limits.max_m)) {
            range = std::numeric_limits<float>::quiet_NaN();
          }
        }
        lines[index].push_back(std::move(line));
      }
    }
    for (std::vector<ScanLine>& of_topic : lines) {
      std::stable_sort(of_topic.begin(), of_topic.end(), [](const auto& a, const auto& b) {
        return a.stamp_ns < b.stamp_ns;
      });
    }
    return lines;
  }

 private:
  void Thin() {
    stride_ *= 2;
    for (auto window = windows_.begin(); window != windows_.end();) {
      if (window->first % stride_ == 0) {
        ++window;
        continue;
      }
      for (const ScanLine& line : window->second) num_beams_ -= line.num_beams();
      window = windows_.erase(window);
    }
  }

  int64_t stride_ = 1;
  std::map<int, uint64_t> last_fingerprints_;  // by topic
  int64_t num_beams_ = 0;
  std::map<int64_t, std::vector<ScanLine>> windows_;
};

std::map<std::string, RangeLimits> LimitsOf(const Rig* rig) {
  std::map<std::string, RangeLimits> limits;
  if (rig == nullptr) return limits;
  for (const Scanner& scanner : rig->scanners) {
    limits[scanner.topic] = {scanner.min_range_m, scanner.max_range_m};
  }
  return limits;
}

}  // namespace

double RecordingSurvey::duration_s() const {
  return SecondsBetween(start_receipt_ns, end_receipt_ns);
}

RecordingSurvey SurveyRecording(const std::string& path, const Rig* rig) {
  const std::map<std::string, RangeLimits> limits = LimitsOf(rig);
  RecordingSurvey survey;
  survey.path = path;
  WindowSample sample;
  std::vector<TopicSurveyor> surveyors;
  int64_t first_receipt_ns = 0;  // of the recording, whatever it is worth
  const RecordedTopics recorded =
      ReadScans(path, rig, [&](const RecordedTopic& topic, const ScanMessage& message) {
        if (surveyors.empty()) first_receipt_ns = message.receipt_ns;
        const auto index = static_cast<size_t>(message.line.scanner_index);
        // Topics of which nothing can be decoded have one, too.
        while (surveyors.size() < index) surveyors.emplace_back(nullptr);
        if (surveyors.size() == index) {
          const auto stated = limits.find(topic.name);
          surveyors.emplace_back(stated == limits.end() ? nullptr : &stated->second);
        }
        surveyors[index].Add(message);
        sample.Add(message, first_receipt_ns);
      });
  survey.format = recorded.format;
  survey.warnings = recorded.warnings;
  survey.start_receipt_ns = std::numeric_limits<int64_t>::max();
  for (TopicSurveyor& surveyor : surveyors) {
    survey.start_receipt_ns = std::min(survey.start_receipt_ns, surveyor.Order());
  }
  survey.end_receipt_ns = survey.start_receipt_ns;
  for (size_t i = 0; i < recorded.topics.size(); ++i) {
    if (!recorded.topics[i].has_scan_lines || i >= surveyors.size()) {
      survey.other_topics.push_back(recorded.topics[i].name);
      continue;
    }
    survey.topics.push_back(surveyors[i].Finish(recorded.topics[i], survey.start_receipt_ns));
    for (const LineStamp& stamp : survey.topics.back().stamps) {
      survey.end_receipt_ns = std::max(survey.end_receipt_ns, stamp.receipt_ns);
    }
  }
  survey.sample = sample.Take(survey.topics);
  return survey;
}

}  // namespace plumbline

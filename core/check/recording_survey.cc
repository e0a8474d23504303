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
  bool is_first = true;
  const RecordedTopics recorded =
      ReadScans(path, rig, [&](const RecordedTopic& topic, const ScanMessage& message) {
        if (is_first) survey.start_receipt_ns = message.receipt_ns;
        survey.end_receipt_ns = is_first ? message.receipt_ns
                                         : std::max(survey.end_receipt_ns, message.receipt_ns);
        is_first = false;
        const auto index = static_cast<size_t>(message.line.scanner_index);
        while (surveyors.size() < index) {  // topics of which nothing can be decoded
          surveyors.emplace_back(nullptr, survey.start_receipt_ns);
        }
        if (surveyors.size() == index) {
          const auto stated = limits.find(topic.name);
          surveyors.emplace_back(stated == limits.end() ? nullptr : &stated->second,
                                 survey.start_receipt_ns);
        }
        surveyors[index].Add(message);
        sample.Add(message, survey.start_receipt_ns);
      });
  survey.format = recorded.format;
  survey.warnings = recorded.warnings;
  for (size_t i = 0; i < recorded.topics.size(); ++i) {
    if (recorded.topics[i].has_scan_lines && i < surveyors.size()) {
      survey.topics.push_back(surveyors[i].Finish(recorded.topics[i]));
    } else {
      survey.other_topics.push_back(recorded.topics[i].name);
    }
  }
  survey.sample = sample.Take(survey.topics);
  return survey;
}

}  // namespace plumbline

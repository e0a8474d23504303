#include "core/judging/recording_survey.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "core/judging/scanner_agreement.h"
#include "core/recording/recording_source.h"
#include "core/sensor/odometry_collector.h"
#include "core/util/time.h"

namespace plumbline {
namespace {

constexpr double kWindow = 2.0;  // s, of a window of the sample
// Largest number of beams in the sample: they take a second or two.
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

}  // namespace

double RecordingSurvey::duration_s() const {
  return SecondsBetween(start_receipt_ns, end_receipt_ns);
}

struct RecordingSurveyor::Impl {
  explicit Impl(const Rig* stated) : rig(stated) {}

  const Rig* rig;
  // With scan lines, also those of which nothing can be decoded; several publishers may share
  // a topic.
  std::vector<RecordedTopic> topics;
  std::vector<TopicSurveyor> surveyors;  // by topic
  std::vector<const Scanner*> scanners;  // by topic; nullptr: not in the rig file
  std::map<std::string, size_t> indices;
  WindowSample sample;
  bool is_started = false;
  int64_t first_receipt_ns = 0;  // of the recording, whatever it is worth
  ScanMessage message;

  size_t IndexOf(const RecordingTopic& topic);
};

size_t RecordingSurveyor::Impl::IndexOf(const RecordingTopic& topic) {
  const auto [known, is_new] = indices.emplace(topic.name, topics.size());
  if (!is_new) return known->second;
  topics.push_back({topic.name, topic.type, true, 0});
  const Scanner* scanner = nullptr;
  for (size_t i = 0; rig != nullptr && i < rig->scanners.size(); ++i) {
    if (rig->scanners[i].topic == topic.name) scanner = &rig->scanners[i];
  }
  scanners.push_back(scanner);
  if (scanner == nullptr) {
    surveyors.emplace_back(nullptr);
  } else {
    const RangeLimits limits = {scanner->min_range_m, scanner->max_range_m};
    surveyors.emplace_back(&limits);
  }
  return known->second;
}

RecordingSurveyor::RecordingSurveyor(const Rig* rig) : impl_(std::make_unique<Impl>(rig)) {}

RecordingSurveyor::~RecordingSurveyor() = default;

void RecordingSurveyor::Add(const RecordingTopic& topic,
                            const MessageRef& where,
                            const ScanLineMessage& as_sent) {
  const size_t index = impl_->IndexOf(topic);
  ScanMessage& message = impl_->message;
  TakeOver(where, as_sent, impl_->scanners[index], &message);
  message.line.scanner_index = static_cast<int>(index);
  if (!impl_->is_started) impl_->first_receipt_ns = message.receipt_ns;
  impl_->is_started = true;
  impl_->surveyors[index].Add(message);
  impl_->sample.Add(message, impl_->first_receipt_ns);
}

void RecordingSurveyor::AddUndecodable(const RecordingTopic& topic) {
  ++impl_->topics[impl_->IndexOf(topic)].num_undecodable;
}

RecordingSurvey RecordingSurveyor::Finish(const std::vector<RecordingTopic>& topics) {
  RecordingSurvey survey;
  std::set<std::string> other_topics;
  for (const RecordingTopic& topic : topics) {
    if (impl_->indices.count(topic.name) > 0) continue;
    if (other_topics.insert(topic.name).second) survey.other_topics.push_back(topic.name);
  }
  survey.start_receipt_ns = std::numeric_limits<int64_t>::max();
  for (TopicSurveyor& surveyor : impl_->surveyors) {
    survey.start_receipt_ns = std::min(survey.start_receipt_ns, surveyor.Order());
  }
  survey.end_receipt_ns = survey.start_receipt_ns;
  for (size_t i = 0; i < impl_->surveyors.size(); ++i) {
    survey.topics.push_back(
        impl_->surveyors[i].Finish(impl_->topics[i], survey.start_receipt_ns));
    for (const LineStamp& stamp : survey.topics.back().stamps) {
      survey.end_receipt_ns = std::max(survey.end_receipt_ns, stamp.receipt_ns);
    }
  }
  survey.sample = impl_->sample.Take(survey.topics);
  return survey;
}

namespace {

// /tf_static, also of a robot's namespace.
bool IsStatic(const RecordingTopic& topic) {
  constexpr char kName[] = "tf_static";
  const size_t length = sizeof(kName) - 1;
  return topic.HasTransforms() && topic.name.size() >= length &&
         topic.name.compare(topic.name.size() - length, length, kName) == 0;
}

// The first topic of odometry; that of scan lines which state it as well where there is no
// other.
std::string TopicOfWheels(const std::vector<RecordingTopic>& topics) {
  std::string name;
  for (const RecordingTopic& topic : topics) {
    if (!topic.HasOdometry() || topic.num_messages == 0) continue;
    if (!topic.HasScanLines()) return topic.name;
    if (name.empty()) name = topic.name;
  }
  return name;
}

}  // namespace

RecordingSurvey SurveyRecording(const std::string& path, const Rig* rig) {
  const std::unique_ptr<RecordingSource> source = OpenRecording(path);
  RecordingSurveyor surveyor(rig);
  RecordingVisitor visitor;
  visitor.wants = [rig](const RecordingTopic& topic) {
    return topic.HasScanLines() || IsStatic(topic) ||
           (topic.HasOdometry() && (rig == nullptr || topic.name == rig->odometry_topic));
  };
  const Rig no_rig;
  std::map<std::string, OdometryCollector> wheels;  // by topic
  visitor.odometry = [&](const MessageRef& where, const OdometryMessage& message) {
    const std::string& name = source->topics()[where.topic_index].name;
    if (rig != nullptr && name != rig->odometry_topic) return;
    wheels.try_emplace(name, rig == nullptr ? no_rig : *rig).first->second.Add(message);
  };
  std::vector<Transform> transforms;
  visitor.transforms = [&](const MessageRef&, const std::vector<Transform>& some) {
    transforms.insert(transforms.end(), some.begin(), some.end());
  };
  visitor.scan_line = [&](const MessageRef& where, const ScanLineMessage& as_sent) {
    surveyor.Add(source->topics()[where.topic_index], where, as_sent);
  };
  visitor.undecodable = [&](const MessageRef& where) {
    const RecordingTopic& topic = source->topics()[where.topic_index];
    if (topic.HasScanLines()) surveyor.AddUndecodable(topic);
  };
  source->Visit(visitor);
  RecordingSurvey survey = surveyor.Finish(source->topics());
  survey.path = path;
  survey.format = source->format();
  survey.warnings = source->warnings();
  std::vector<std::string> frames;
  for (const TopicSurvey& topic : survey.topics) {
    if (topic.frames.size() == 1) frames.push_back(topic.frames.front());
  }
  survey.frames = FindStaticFrames(transforms, frames);
  survey.wheels_topic = TopicOfWheels(source->topics());
  if (rig != nullptr) survey.wheels_topic = rig->odometry_topic;
  const auto used = wheels.find(survey.wheels_topic);
  if (used != wheels.end()) {
    survey.wheels_fault = used->second.Fault();
    survey.wheels = used->second.Finish(&survey.wheels_mended);
  }
  return survey;
}

}  // namespace plumbline

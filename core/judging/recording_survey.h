#pragma once

#include <string>
#include <vector>

#include "core/judging/static_frames.h"
#include "core/judging/topic_survey.h"
#include "core/sensor/imu.h"
#include "core/sensor/odometry.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

// RecordingSurvey is what a recording holds: figures of each topic with scan lines, and scan
// lines from windows of two seconds spread over the whole of it.
struct RecordingSurvey {
  std::string path;
  std::string format;                     // of the file, such as "ROS 1 bag"
  std::vector<TopicSurvey> topics;        // with scan lines
  std::vector<std::string> other_topics;  // names, without scan lines
  std::vector<std::string> warnings;      // what is damaged or missing
  StaticFrames frames;                    // of the topics, by /tf_static
  // Topic of the wheels: the rig file's; without a rig file the recording's, which may be that
  // of scan lines. Empty where there is none.
  std::string wheels_topic;
  // The odometry of that topic; nullptr where there is none, or where it is left out for
  // wheels_fault.
  std::shared_ptr<const Odometry> wheels;
  std::string wheels_fault;
  std::shared_ptr<const ImuReadings> imu;  // the rig file's; nullptr where none is read
  std::vector<std::string> wheels_mended;  // what was, in sentences
  int64_t start_receipt_ns = 0;            // of the first scan line
  int64_t end_receipt_ns = 0;              // of the last one
  // Sampled scan lines by topic, in the order of the recording; ranges in metres, those that
  // are no returns NaN. scanner_index is the topic's position above.
  std::vector<std::vector<ScanLine>> sample;

  double duration_s() const;
};

// RecordingSurveyor makes the survey of a recording, message by message, while another reads
// it: Add() for each scan line, AddUndecodable(), Finish().
class RecordingSurveyor {
 public:
  // rig: nullptr where there is none; has to outlive the surveyor.
  explicit RecordingSurveyor(const Rig* rig);
  ~RecordingSurveyor();

  // A scan line with its ranges, in the order of the file.
  void Add(const RecordingTopic& topic,
           const MessageRef& where,
           const ScanLineMessage& as_sent);
  void AddUndecodable(const RecordingTopic& topic);
  // topics: of the whole recording. Leaves the survey's path, format and warnings empty.
  RecordingSurvey Finish(const std::vector<RecordingTopic>& topics);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Reads a recording once. rig: nullptr where there is none. Throws Error where the file is
// missing or no recording.
RecordingSurvey SurveyRecording(const std::string& path, const Rig* rig);

}  // namespace plumbline

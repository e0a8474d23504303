#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/judging/scan_messages.h"
#include "core/sensor/scan_order.h"

namespace plumbline {

// The ranges that count as returns, m.
struct RangeLimits {
  double min_m = 0.05;
  double max_m = 1e9;
};

// The instants of one scan line.
struct LineStamp {
  int64_t stamp_ns = 0;  // as the message says
  // Instant of reception by the recorder's clock; where that was more than an hour off, the
  // stamp and the topic's usual delay.
  int64_t receipt_ns = 0;
};

// Counts of the returns at one beam angle over a whole recording.
struct BeamCounts {
  int num_lines = 0;
  int num_returns = 0;
  int num_near = 0;              // returns nearer than half a metre
  float farthest_near_m = 0.0F;  // of these
  int num_largest = 0;           // the topic's largest finite range
};

// Counts of one second of a topic.
struct SurveyedSecond {
  int num_lines = 0;
  int num_repeated = 0;  // lines that hold the very ranges of the one before
  int64_t num_beams = 0;
  int64_t num_returns = 0;
  // Neighbouring beams in threes, all with returns, and those that lie on a straight line.
  int64_t num_triples = 0;
  int64_t num_straight = 0;
  int64_t second = 0;  // since the recording's start
};

// TopicSurvey is what one topic with scan lines holds, in figures.
struct TopicSurvey {
  std::string name;
  std::string type;
  int num_undecodable = 0;
  int num_off_plane = 0;            // point clouds that do not lie in one scan plane
  std::vector<std::string> frames;  // of the messages, each once, in the order of their first
  std::string unusable_reason;      // of the first line that is not usable
  PassedOverLines passed_over;      // that the mapper passes over, too
  int num_out_of_turn = 0;          // lines that came after one with a later stamp
  int num_receipts_off = 0;         // lines whose receipts are more than an hour off
  std::vector<LineStamp> stamps;    // of the lines that are used, in their order

  // Layout that most of the first usable lines have, and how many lines differ from it.
  int num_beams = 0;
  double angle_min = 0.0;         // rad
  double angle_increment = 0.0;   // rad
  double time_increment_s = 0.0;  // between neighbouring beams
  int num_other_layouts = 0;
  double stated_min_range_m = 0.0;  // 0: not stated
  double stated_max_range_m = 0.0;

  // Factor that makes the ranges metres: 1, 0.01 or 0.001.
  double metres_per_unit = 1.0;
  RangeLimits limits;      // that decide what a return is
  int64_t num_ranges = 0;  // of all beams; the sum of the next seven
  int64_t num_returns = 0;
  int64_t num_nan = 0;
  int64_t num_infinite = 0;
  int64_t num_zero = 0;  // or negative
  int64_t num_too_near = 0;
  int64_t num_too_far = 0;
  int64_t num_at_limit = 0;  // the largest finite range, where many beams have the very same
  double largest_range_m = 0.0;    // finite
  int64_t num_largest = 0;         // beams with the very same
  std::vector<int64_t> histogram;  // of the finite positive ranges, by HistogramBin()

  std::vector<BeamCounts> beams;        // of the lines with the first layout
  std::vector<SurveyedSecond> seconds;  // that have lines that are used, in their order
  double period_s = 0.0;                // median time between lines; 0: fewer than two lines
  // Lines that are unlike the one before, but like the one before that; of these compared.
  int num_alternating = 0;
  int num_compared = 0;
  double noise_m = 0.0;  // of one range, from neighbouring beams; 0: could not be told

  double duration_s() const;  // from the first to the last stamp
  double field_of_view_rad() const;
  // The range below which `share` of the finite positive ranges lie, m; 0 without any.
  double RangeQuantile(double share) const;
};

// TopicSurveyor makes the survey of one topic, line by line: Add() for each, Order(),
// Finish().
class TopicSurveyor {
 public:
  // limits: those of the rig file, or null where there is none.
  explicit TopicSurveyor(const RangeLimits* limits);

  void Add(const ScanMessage& message);
  // Decides which lines are used, and in which order, as the mapper does
  // (core/sensor/scan_order.h). Returns when the first of them was received; the latest
  // instant there is where none is used.
  int64_t Order();
  // start_receipt_ns: of the recording, from which its seconds count.
  TopicSurvey Finish(const RecordedTopic& topic, int64_t start_receipt_ns);

 private:
  // A usable line, in the order of the recording.
  struct Line {
    LineStamp stamp;
    SurveyedSecond figures;
  };

  void DecideUnit();
  void Take(const ScanMessage& message);
  void TakeRanges(const ScanMessage& message, SurveyedSecond* figures);
  void CompareWithBefore(const ScanLine& line);
  void CorrectReceipts();
  void CountSeconds(int64_t start_receipt_ns);

  TopicSurvey survey_;
  bool has_limits_;
  bool is_started_ = false;
  std::vector<ScanMessage> first_;  // kept until the unit is known
  ScanLine layout_;                 // a line that has it
  std::vector<Line> lines_;
  size_t num_taken_ = 0;             // of lines_, whose ranges have been looked at
  std::vector<size_t> used_;         // in lines_, in the order of their stamps
  std::vector<ScanStamp> unusable_;  // lines
  uint64_t last_fingerprint_ = 0;
  std::vector<float> before_;  // ranges of the line before, and of the one before that
  std::vector<float> two_before_;
  std::vector<double> deviations_m_;  // of beams from the line through their neighbours
  uint64_t num_triples_ = 0;
};

}  // namespace plumbline

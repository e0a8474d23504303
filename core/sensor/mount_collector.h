#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/messages.h"
#include "core/sensor/recording_words.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_order.h"

namespace plumbline {

// MountCollector collects the angles of a rig's mounts while a recording is read, and says
// where these are missing.
class MountCollector {
 public:
  explicit MountCollector(const Rig& rig);

  // Whether a topic tells the angle of a mount.
  bool Wants(const RecordingTopic& topic) const { return !ScannersTurnedBy(topic).empty(); }
  void Add(const RecordingTopic& topic, const JointMessage& message);
  void AddLost(const RecordingTopic& topic, const MessageRef& message);
  // Ends the collection. Throws Error that names path and damage where a topic is missing, or
  // does not tell how a mount turns.
  void Finish(const std::string& path,
              const std::vector<RecordingTopic>& topics,
              const std::string& damage);

  // By scanner; nullptr where no topic tells the angle of its mount.
  const std::vector<std::shared_ptr<const JointAngles>>& angles() const { return angles_; }
  // Whether nothing tells the angle of a mount during a scan line, which is counted then;
  // scan_period_s: how long lines take at most.
  bool PassesOver(int scanner, int64_t stamp_ns, double scan_period_s);
  void AddWarnings(std::vector<std::string>* warnings) const;

 private:
  std::vector<size_t> ScannersTurnedBy(const RecordingTopic& topic) const;
  std::string Whose(size_t scanner) const;

  std::vector<Scanner> scanners_;
  std::vector<std::vector<JointSample>> samples_;  // by scanner, as are the others
  std::vector<LostMessages> lost_;
  std::vector<std::shared_ptr<const JointAngles>> angles_;
  std::vector<PassedOver> without_angle_;
};

}  // namespace plumbline

#include "core/sensor/mount_collector.h"

#include <algorithm>
#include <set>

#include "core/sensor/joint_samples.h"
#include "core/util/error.h"
#include "core/util/time.h"

namespace plumbline {

MountCollector::MountCollector(const Rig& rig)
    : scanners_(rig.scanners),
      samples_(rig.scanners.size()),
      lost_(rig.scanners.size()),
      angles_(rig.scanners.size()),
      without_angle_(rig.scanners.size()) {}

std::vector<size_t> MountCollector::ScannersTurnedBy(const RecordingTopic& topic) const {
  std::vector<size_t> scanners;
  for (size_t i = 0; topic.HasJoints() && i < scanners_.size(); ++i) {
    const auto& mount = scanners_[i].mount;
    if (mount && mount->IsRead() && mount->joint_topic == topic.name) scanners.push_back(i);
  }
  return scanners;
}

std::string MountCollector::Whose(size_t scanner) const {
  return "the mount of scanner " + Quoted(scanners_[scanner].name);
}

void MountCollector::Add(const RecordingTopic& topic, const JointMessage& message) {
  const size_t count = std::min(message.names.size(), message.positions.size());
  for (const size_t scanner : ScannersTurnedBy(topic)) {
    const Mount& mount = *scanners_[scanner].mount;
    for (size_t i = 0; i < count; ++i) {
      if (!mount.joint.empty() && message.names[i] != mount.joint) continue;
      samples_[scanner].push_back(
          {message.stamp_ns + NanosecondsFromSeconds(mount.time_offset_s),
           message.positions[i]});
      break;
    }
  }
}

void MountCollector::AddLost(const RecordingTopic& topic, const MessageRef& message) {
  for (const size_t scanner : ScannersTurnedBy(topic)) lost_[scanner].Add(message);
}

void MountCollector::Finish(const std::string& path,
                            const std::vector<RecordingTopic>& topics,
                            const std::string& damage) {
  std::set<std::string> with_angles;
  for (const RecordingTopic& topic : topics) {
    if (topic.HasJoints()) with_angles.insert(topic.name);
  }
  for (size_t i = 0; i < scanners_.size(); ++i) {
    const auto& mount = scanners_[i].mount;
    if (!mount || !mount->IsRead()) continue;
    if (with_angles.count(mount->joint_topic) == 0) {
      throw Error(
          path + ": has no angles in topic " + Shown(mount->joint_topic) + " of " + Whose(i) +
          "; topics with angles in this recording:" + TopicsText(with_angles) + damage);
    }
    SortAndUnwrap(&samples_[i]);
    Smooth(&samples_[i]);
    auto angles = std::make_shared<const JointAngles>(std::move(samples_[i]));
    const std::string fault = angles->Fault();
    if (!fault.empty()) {
      throw Error(path + ": topic " + Shown(mount->joint_topic) + " does not tell how " +
                  Whose(i) + " turns" +
                  (mount->joint.empty() ? "" : " by joint " + Quoted(mount->joint)) + ": " +
                  fault);
    }
    angles_[i] = std::move(angles);
  }
}

bool MountCollector::PassesOver(int scanner, int64_t stamp_ns, double scan_period_s) {
  const auto index = static_cast<size_t>(scanner);
  if (angles_[index] == nullptr) return false;
  const int64_t begin_ns = stamp_ns + NanosecondsFromSeconds(scanners_[index].time_offset_s);
  const int64_t end_ns = begin_ns + NanosecondsFromSeconds(scan_period_s);
  if (angles_[index]->Covers(begin_ns) && angles_[index]->Covers(end_ns)) return false;
  without_angle_[index].Add(stamp_ns);
  return true;
}

void MountCollector::AddWarnings(std::vector<std::string>* warnings) const {
  for (size_t i = 0; i < scanners_.size(); ++i) {
    lost_[i].WarnOf(Whose(i), "that can not be decoded", warnings);
    const auto& [count, first_ns] = without_angle_[i];
    if (count == 0) continue;
    warnings->push_back("scanner " + Quoted(scanners_[i].name) + ": " + std::to_string(count) +
                        (count == 1 ? " scan line is" : " scan lines are") +
                        " passed over as nothing tells the angle of the mount then, the first "
                        "stamped " +
                        ReceiptText(static_cast<uint64_t>(first_ns)) +
                        "; the longest gap between angles is " +
                        FormatSeconds(angles_[i]->longest_gap_s()));
  }
}

}  // namespace plumbline

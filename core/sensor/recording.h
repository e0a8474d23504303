#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/sensor/imu.h"
#include "core/sensor/odometry.h"
#include "core/sensor/rig.h"
#include "core/sensor/scan_line.h"

namespace plumbline {

struct MessageRef;
struct RecordingTopic;
struct ScanLineMessage;

// RecordingObserver sees the messages of a rig's scanners while a recording is opened, in the
// order of the file and as they were sent, so that it need not be read again for that.
struct RecordingObserver {
  // Valid during the call only; ranges included.
  std::function<void(const RecordingTopic&, const MessageRef&, const ScanLineMessage&)>
      scan_line;
  std::function<void(const RecordingTopic&)> undecodable;
};

// Reads the scan lines of a rig's scanners from a recording of any format that OpenRecording()
// knows, in the order of their header stamps; scan lines of the same stamp come in the order
// of the rig's scanners. Scan lines during which nothing tells the angle of their scanner's
// mount are passed over.
class RecordingReader {
 public:
  // Throws Error when the file is missing or unreadable, lacks a topic that the rig names, or
  // has no scan line at all. Of a damaged bag it reads what can be read; warnings() say what
  // is missing.
  RecordingReader(const std::string& path,
                  const Rig& rig,
                  const RecordingObserver& observer = {});
  ~RecordingReader();

  // Moves on to the next scan line; false at the end. Throws Error when the file has changed
  // since it was opened.
  bool Next(ScanLine* scan_line);

  // Starts again from the first scan line.
  void Rewind();

  int64_t start_ns() const;    // stamp of the first scan line
  int64_t end_ns() const;      // stamp of the last scan line
  const std::vector<RecordingTopic>& topics() const;  // of the whole recording
  int num_scan_lines() const;  // that Next() will deliver in all
  // Median time between scan lines of the same scanner; 0 if no scanner has two of them.
  double scan_period_s() const;
  // Returns the odometry of the rig file's topic; nullptr where the rig file names none, or
  // where its messages say nothing of the motion, of which a warning tells: no orientation, or
  // a pose that never changes while the velocities say otherwise.
  std::shared_ptr<const Odometry> odometry() const;
  // Returns the readings of the rig file's IMU; nullptr where it has none, or where they can
  // not be an IMU's, of which a warning tells.
  std::shared_ptr<const ImuReadings> imu() const;
  // Returns the angles of the rig file's mounts, by scanner; nullptr where a scanner has no
  // mount, or none whose angle comes from a topic.
  const std::vector<std::shared_ptr<const JointAngles>>& mount_angles() const;
  // Sets the models of a rig's depth cameras to those that the recording states.
  void PlaceCameras(Rig* rig) const;
  // Makes the odometry later by this time.
  void DelayOdometry(double seconds);
  // Sentences about what is damaged or missing and about scan lines that were passed over or
  // look wrong, for the user and summary.json.
  const std::vector<std::string>& warnings() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Gives the mounts of a rig their angles, and the rows of its depth cameras their places, in a
// recording.
void PlaceScanners(const RecordingReader& recording, Rig* rig);

}  // namespace plumbline

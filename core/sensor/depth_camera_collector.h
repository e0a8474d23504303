#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/recording/messages.h"
#include "core/recording/recording_source.h"
#include "core/sensor/recording_words.h"
#include "core/sensor/rig.h"

namespace plumbline {

// DepthCameraCollector takes the messages of a rig's depth cameras while a recording is read:
// how the cameras see, and the scan lines in the rows of their images.
class DepthCameraCollector {
 public:
  explicit DepthCameraCollector(const Rig& rig);

  // Whether a topic has images of a camera, or what says how the camera sees.
  bool Wants(const RecordingTopic& topic) const;
  void Add(const RecordingTopic& topic, const CameraInfoMessage& message);
  // Returns the scanners (positions in Rig::scanners) that each take a row of the image.
  std::vector<int> Add(const RecordingTopic& topic, const ImageMessage& image);
  void AddLost(const RecordingTopic& topic, const MessageRef& message);
  // Ends the collection. Throws Error that names path, topic and damage where a camera's topic
  // is missing, or its images hold no depths or are not of the size that its CameraInfo
  // states.
  void Finish(const std::string& path,
              const std::vector<RecordingTopic>& topics,
              const std::string& damage);
  void AddWarnings(std::vector<std::string>* warnings) const;

  // Sets the models of a rig's depth cameras to what the recording states.
  void Place(Rig* rig) const;

  // Whether a scanner takes the row of an image.
  bool IsRow(int scanner) const { return RowOf(scanner).has_value(); }
  // Reads a visited image again, once for all of its rows, and takes the row of a scanner.
  void ReadRow(int scanner,
               const MessageRef& where,
               RecordingSource* source,
               ScanLineMessage* scan_line);

 private:
  // What a camera has sent.
  struct Sent {
    std::optional<CameraInfoMessage> info;  // the first
    ImageMessage image;                     // the first, without its data
    std::string fault;                      // of the first image that can not be used
    LostMessages lost;
  };

  static size_t Index(int scanner) { return static_cast<size_t>(scanner); }
  const std::optional<CameraRow>& RowOf(int scanner) const {
    return rig_.scanners[Index(scanner)].camera_row;
  }
  std::vector<int> RowsOf(size_t camera) const;
  void CheckTopics(const DepthCamera& camera,
                   const std::vector<RecordingTopic>& topics,
                   const std::string& damage) const;
  PinholeModel ModelOf(size_t camera) const;

  Rig rig_;
  std::vector<Sent> sent_;                  // by camera
  std::vector<std::vector<float>> angles_;  // by scanner, as are the others
  std::vector<std::vector<float>> ranges_;
  MessageRef open_;  // the image of which ranges_ are, and its stamp
  int64_t stamp_ns_ = 0;
};

}  // namespace plumbline

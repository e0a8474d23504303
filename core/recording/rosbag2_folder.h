#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/message_file.h"

namespace plumbline {

// A recording that was split into files: rosbag2's folder with metadata.yaml, which names them
// in their order, and the files; or a folder of ROS 1 bags. They are read one after the other.
class Rosbag2Folder : public MessageFile {
 public:
  Rosbag2Folder(const std::string& path, std::vector<std::unique_ptr<MessageFile>> files);

  const std::string& path() const override { return path_; }
  std::string format() const override;
  void Scan(const Wants& wants, const Visit& visit) override;
  const std::vector<RecordingTopic>& topics() const override { return topics_; }
  ByteView Read(const MessageRef& message) override;
  const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  std::string path_;
  std::vector<std::unique_ptr<MessageFile>> files_;
  std::vector<uint32_t> first_topics_;  // of the files, in topics_
  std::vector<RecordingTopic> topics_;
  std::vector<std::string> warnings_;
};

// The files of a folder, in the order in which they were recorded.
struct FolderFiles {
  std::vector<std::string> files;
  std::vector<std::string> warnings;  // where metadata.yaml does not fit what is there
};

// Returns the files that the folder's metadata.yaml names, or all that look like recordings
// where there is no such file, it can not be read, or it names files that are not there.
// Throws Error where there are none.
FolderFiles FilesOfFolder(const std::string& path);

}  // namespace plumbline

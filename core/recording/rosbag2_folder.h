#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/recording/message_file.h"

namespace plumbline {

// A rosbag2 recording that was split into files: a folder with metadata.yaml, which names them
// in their order, and the files. They are read one after the other.
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

// The files of a rosbag2 folder, in the order in which they were recorded: those that its
// metadata.yaml names, or all that look like one where there is no such file. Throws Error
// where there are none.
std::vector<std::string> FilesOfRosbag2Folder(const std::string& path);

}  // namespace plumbline

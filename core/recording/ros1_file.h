#pragma once

#include <string>
#include <vector>

#include "core/recording/bag_reader.h"
#include "core/recording/message_file.h"

namespace plumbline {

// A ROS 1 bag as a sequence of messages; BagReader does the work.
class Ros1File : public MessageFile {
 public:
  // path: what the user knows the file by; file_path: where it is.
  Ros1File(const std::string& path, const std::string& file_path) : bag_(file_path, path) {}

  const std::string& path() const override { return bag_.name(); }
  std::string format() const override { return "ROS 1 bag"; }
  void Scan(const Wants& wants, const Visit& visit) override;
  const std::vector<RecordingTopic>& topics() const override { return topics_; }
  ByteView Read(const MessageRef& message) override;
  const std::vector<std::string>& warnings() const override { return bag_.warnings(); }

 private:
  BagReader bag_;
  std::vector<RecordingTopic> topics_;  // one for each of the bag's connections
};

}  // namespace plumbline

#include "core/recording/ros1_file.h"

#include "core/recording/decode.h"

namespace plumbline {

void Ros1File::Scan(const Wants& wants, const Visit& visit) {
  const auto wants_connection = [&](const BagConnection& connection) {
    RecordingTopic topic;
    topic.name = connection.topic;
    topic.type = connection.type;
    topic.definition = connection.md5sum;
    topic.encoding = MessageEncoding::kRos1;
    topic.kind = KindOf(topic);
    topics_.push_back(topic);
    return wants(topics_.back());
  };
  const auto visit_message = [&](const BagMessage& bag_message, ByteView data) {
    MessageRef message;
    message.receipt_ns = bag_message.receipt_ns;
    message.topic_index = bag_message.connection_index;
    message.size = bag_message.size;
    message.part = bag_message.chunk_index;
    message.begin = bag_message.begin;
    return visit(message, data);
  };
  bag_.Scan(wants_connection, visit_message);
  for (size_t i = 0; i < topics_.size(); ++i) topics_[i].num_messages = bag_.num_messages(i);
}

ByteView Ros1File::Read(const MessageRef& message) {
  BagMessage bag_message;
  bag_message.chunk_index = message.part;
  bag_message.begin = static_cast<uint32_t>(message.begin);
  bag_message.size = message.size;
  return bag_.Read(bag_message);
}

}  // namespace plumbline

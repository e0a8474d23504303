#pragma once

#include "core/recording/byte_source.h"
#include "core/recording/message_file.h"
#include "core/recording/messages.h"

namespace plumbline {

// Says what the messages of a topic are, from its encoding, type and definition: kOther where
// the type is none of those that are read, or ROS 1's definition of it is another.
MessageKind KindOf(const RecordingTopic& topic);

// Read a message of a topic, all of it: false where its lengths do not agree with the number
// of its bytes, or the topic has no such messages.
//   with_ranges   else the ranges stay empty
bool DecodeScanLine(const RecordingTopic& topic,
                    ByteView data,
                    bool with_ranges,
                    ScanLineMessage* message);
bool DecodeOdometry(const RecordingTopic& topic, ByteView data, OdometryMessage* message);
bool DecodeImu(const RecordingTopic& topic, ByteView data, ImuMessage* message);
// receipt_ns: the stamp of a message that has none.
bool DecodeJoints(const RecordingTopic& topic,
                  ByteView data,
                  uint64_t receipt_ns,
                  JointMessage* message);
bool DecodeImage(const RecordingTopic& topic, ByteView data, ImageMessage* message);
bool DecodeCameraInfo(const RecordingTopic& topic, ByteView data, CameraInfoMessage* message);
bool DecodeTransforms(const RecordingTopic& topic,
                      ByteView data,
                      std::vector<Transform>* transforms);

}  // namespace plumbline

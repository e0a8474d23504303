#pragma once

#include "core/bag/byte_source.h"
#include "core/recording/message_file.h"
#include "core/recording/messages.h"

namespace plumbline {

// Read messages as ROS 1 serialises them: numbers little endian without gaps, lists and texts
// as their length (uint32) and their elements. False where the lengths do not agree with the
// number of bytes.
bool ReadRos1ScanLine(ByteView data,
                      MessageKind kind,
                      bool with_ranges,
                      ScanLineMessage* message);
bool ReadRos1Odometry(ByteView data, OdometryMessage* message);

}  // namespace plumbline

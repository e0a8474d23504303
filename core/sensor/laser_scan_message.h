#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/bag/bag_record.h"
#include "core/bag/byte_source.h"

namespace plumbline {

// LaserScanMessage is what the mapper takes of a sensor_msgs/LaserScan, or of the first echoes
// of a sensor_msgs/MultiEchoLaserScan.
struct LaserScanMessage {
  int64_t stamp_ns = 0;          // instant of the first beam, since 1970
  float angle_min = 0.0f;        // rad
  float angle_increment = 0.0f;  // rad
  float time_increment = 0.0f;   // s
  uint32_t num_beams = 0;

  // False where angles or times make no sense, or there are no beams.
  bool IsUsable() const;
};

// Whether the connection's messages are of one of the two types, in the definition that is
// read here.
bool IsLaserScan(const BagConnection& connection);
bool IsMultiEchoLaserScan(const BagConnection& connection);

// Reads a serialised message of either type, all of it: false where its lengths do not agree
// with the number of its bytes. ranges: in metres, NaN where a beam has no echo; may be null.
bool ReadLaserScan(ByteView data,
                   bool multi_echo,
                   LaserScanMessage* message,
                   std::vector<float>* ranges);

}  // namespace plumbline

#pragma once

#include <string>

#include "core/recording/byte_source.h"
#include "core/recording/message_file.h"
#include "core/recording/messages.h"

namespace plumbline {

// Returns the kind of a line of a CARMEN log that begins with this word; kOther where it is
// not read.
//   FLASER, RLASER           number of ranges, ranges, pose of the laser, odometry
//   RAWLASER1 .. 5           type, first angle, field of view, angle from beam to beam,
//   largest
//                            range, accuracy, remission mode, number of ranges, ranges, ...
//   ROBOTLASER1, 2           as RAWLASER, then poses of the laser and of the robot, the
//                            robot's velocity and turn rate, and what it keeps clear
//   ODOM                     x, y, heading, velocity, turn rate, acceleration
// Each ends with the time of the message, the name of the computer, and the time of the
// recorder since its start.
MessageKind CarmenKindOf(const std::string& word);

// Whether scan lines that begin with this word state the robot's pose by odometry, too.
bool CarmenScanLineHasOdometry(const std::string& word);

// The time at the end of a line, ns; false where the line does not end so.
bool ReadCarmenReceipt(ByteView line, int64_t* receipt_ns);

// Read a line: false where it has not the fields of its kind. Of FLASER and RLASER the angles
// are not in the log: 180 and 360 (181, 361) ranges are 1 and 0.5 degrees apart, as SICK's
// scanners measure, 541 and 1081 ranges 0.5 and 0.25 degrees, and other numbers cover half a
// turn; the first of 180 degrees points to the right. All beams count as taken at once. FLASER
// and RLASER state no velocity: that of their odometry is 0.
bool ReadCarmenScanLine(ByteView line, bool with_ranges, ScanLineMessage* message);
bool ReadCarmenOdometry(ByteView line, OdometryMessage* message);

}  // namespace plumbline

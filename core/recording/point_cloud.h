#pragma once

#include "core/recording/messages.h"
#include "core/recording/serial_reader.h"

namespace plumbline {

// Reads a sensor_msgs/PointCloud2 of one planar scanner as a scan line; false where its
// lengths do not agree with the number of its bytes, or it has no fields x, y, z.
//
// Points lie in the scanner's plane, z = 0 (is_planar). A field of one of the names time, t,
// timestamp, time_offset, offset_time says when each was measured: integers count ns, floating
// point numbers s, after the stamp or, where they are that large, since 1970. Times that lie
// more than a scan line's longest duration from the stamp are of the scanner's own clock: the
// first of them counts as the stamp. Without it all count as measured at the stamp.
//
// Beams come in the order of their times, else of their angles. Clouds lack the beams without
// a return: where the others are regular in angle, or else in time, beams without a return are
// put in their places. Of several points in one direction the first counts.
bool ReadPointCloud2(SerialReader reader, bool with_ranges, ScanLineMessage* message);

}  // namespace plumbline

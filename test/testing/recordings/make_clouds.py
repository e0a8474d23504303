#!/usr/bin/python3
"""Makes point clouds of scan lines: make_clouds.py SCAN_LINES.bag CLOUDS.bag SAME_SCAN_LINES.bag

Of every four beams one is kept, in the middle or a beam off it, so that the beams of the clouds
have odd angles. CLOUDS.bag has each scan line as a sensor_msgs/PointCloud2 of those beams that
have a return, SAME_SCAN_LINES.bag has it with the other beams' ranges blotted out.
"""

import math
import struct
import sys

import rosbag
from sensor_msgs.msg import PointCloud2, PointField

NAN = float("nan")


def is_kept(beam):
    group = beam // 4
    return beam % 4 == 1 + (group * 2654435761 >> 16) % 3 - (group % 2)


def cloud_of(scan):
    cloud = PointCloud2(header=scan.header)
    cloud.fields = [PointField(name, offset, PointField.FLOAT64, 1)
                    for name, offset in (("x", 0), ("y", 8), ("z", 16), ("time", 24))]
    cloud.point_step = 32
    for beam, distance in enumerate(scan.ranges):
        if not is_kept(beam) or not 0.0 < distance < math.inf:
            continue
        angle = scan.angle_min + beam * scan.angle_increment
        cloud.data += struct.pack("<4d", distance * math.cos(angle), distance * math.sin(angle),
                                  0.0, beam * scan.time_increment)
    cloud.height = 1
    cloud.width = len(cloud.data) // cloud.point_step
    cloud.row_step = len(cloud.data)
    return cloud


def main(source, clouds, scan_lines):
    with rosbag.Bag(source) as bag, rosbag.Bag(clouds, "w") as cloud_bag, \
            rosbag.Bag(scan_lines, "w") as scan_bag:
        for topic, scan, time in bag.read_messages():
            cloud_bag.write(topic, cloud_of(scan), time)
            scan.ranges = [distance if is_kept(beam) else NAN
                           for beam, distance in enumerate(scan.ranges)]
            scan_bag.write(topic, scan, time)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        print(__doc__)
        sys.exit(0 if "--help" in sys.argv else 2)
    main(*sys.argv[1:])

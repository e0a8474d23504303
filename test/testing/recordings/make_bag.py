#!/usr/bin/python3
"""Writes a small ROS 1 bag with ROS' own library: make_bag.py OUTPUT.bag

Six messages of each topic, 0.1 s apart; beam b of message i has the range 1 + 0.25 b + 0.5 i.
  /top_scan   sensor_msgs/LaserScan, 8 beams from -0.5 rad, 0.25 rad apart
  /echoes     sensor_msgs/MultiEchoLaserScan, the same; beam b has b % 3 echoes
  /cloud      sensor_msgs/PointCloud2, the same with times; beam 3 has no return and no point
  /odd_cloud  the same, but beam b points to -0.5 + 0.25 b + 0.01 b^2 rad
  /odom       nav_msgs/Odometry, on a circle
  /talk       std_msgs/String
"""

import math
import struct
import sys

import genpy
import rosbag
from nav_msgs.msg import Odometry
from sensor_msgs.msg import LaserEcho, LaserScan, MultiEchoLaserScan, PointCloud2, PointField
from std_msgs.msg import String

START_S = 1600000000
NUM_MESSAGES = 6
NUM_BEAMS = 8


def set_header(message, i):
    message.header.stamp = genpy.Time(START_S, 100000000 * i)
    message.header.frame_id = "laser"
    return message


def range_of(i, beam):
    return 1.0 + 0.25 * beam + 0.5 * i


def set_angles(message, i):
    set_header(message, i)
    message.angle_min = -0.5
    message.angle_max = -0.5 + 0.25 * (NUM_BEAMS - 1)
    message.angle_increment = 0.25
    message.time_increment = 0.001
    message.range_min = 0.125
    message.range_max = 30.0
    return message


def laser_scan(i):
    message = set_angles(LaserScan(), i)
    message.ranges = [range_of(i, beam) for beam in range(NUM_BEAMS)]
    message.intensities = [0.5] * NUM_BEAMS
    return message


def echoes(i):
    message = set_angles(MultiEchoLaserScan(), i)
    for beam in range(NUM_BEAMS):
        message.ranges.append(
            LaserEcho(echoes=[range_of(i, beam) + echo for echo in range(beam % 3)]))
    return message


def cloud(i, angle_of):
    message = set_header(PointCloud2(), i)
    message.fields = [PointField("x", 0, PointField.FLOAT32, 1),
                      PointField("y", 4, PointField.FLOAT32, 1),
                      PointField("z", 8, PointField.FLOAT32, 1),
                      PointField("intensity", 12, PointField.UINT16, 1),
                      PointField("time", 16, PointField.FLOAT32, 1)]
    message.point_step = 20
    points = [struct.pack("<3fH2xf", range_of(i, beam) * math.cos(angle_of(beam)),
                          range_of(i, beam) * math.sin(angle_of(beam)), 0.0, 100, 0.001 * beam)
              for beam in range(NUM_BEAMS) if beam != 3]
    message.height = 1
    message.width = len(points)
    message.row_step = message.point_step * message.width
    message.data = b"".join(points)
    message.is_dense = True
    return message


def odometry(i):
    message = set_header(Odometry(), i)
    message.header.frame_id = "odom"
    message.child_frame_id = "base_link"
    heading = 0.1 * i
    message.pose.pose.position.x = math.sin(heading)
    message.pose.pose.position.y = 1.0 - math.cos(heading)
    message.pose.pose.orientation.z = math.sin(0.5 * heading)
    message.pose.pose.orientation.w = math.cos(0.5 * heading)
    message.twist.twist.linear.x = 1.0
    message.twist.twist.angular.z = 1.0
    return message


def main(path):
    topics = [("/top_scan", laser_scan),
              ("/echoes", echoes),
              ("/cloud", lambda i: cloud(i, lambda beam: -0.5 + 0.25 * beam)),
              ("/odd_cloud", lambda i: cloud(i, lambda beam: -0.5 + 0.25 * beam + 0.01 * beam**2)),
              ("/odom", odometry),
              ("/talk", lambda i: String(data=f"message {i}"))]
    with rosbag.Bag(path, "w", compression="bz2") as bag:
        for i in range(NUM_MESSAGES):
            for number, (topic, make) in enumerate(topics):
                receipt = genpy.Time(START_S, 100000000 * i + 50000000 + number)
                bag.write(topic, make(i), receipt)


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] == "--help":
        print(__doc__)
        sys.exit(0 if "--help" in sys.argv else 2)
    main(sys.argv[1])

#!/usr/bin/python3
"""Changes a ROS 1 bag with scan lines as faulty drivers, clocks and wheels would have written it.

What the rig file says of the scanners stays true; faults of the scanners themselves and of their
mounting are the simulator's. The scanner that is at fault is the second one of the rig file, if
it has two; what all scanners of a driver have in common is wrong of all. Needs Debian's packages
python3-rosbag, python3-sensor-msgs and python3-yaml.
"""

import argparse
import copy
import math
import pathlib
import random
import struct
import sys

import yaml

NANOSECONDS = 10**9
FAULTS = {}


def fault(change):
    """Registers a function that changes a Recording as a fault of its name."""
    FAULTS[change.__name__] = change
    return change


class Recording:
    """Messages of a bag, as [topic, message, receipt in ns], and what the rig file says."""

    def __init__(self, items, rig):
        self.items = items
        self.rig = rig
        self.topics = [scanner["topic"] for scanner in rig["scanners"]]
        self.wheels = rig.get("odometry", {}).get("topic", "/odom")

    @property
    def one(self):
        """Topic of the scanner that is at fault."""
        return self.topics[min(1, len(self.topics) - 1)]

    def of(self, *topics):
        return [message for topic, message, _ in self.items if topic in topics]

    def scans(self):
        return self.of(*self.topics)

    def middle(self):
        stamps = [stamp_of(message) for message in self.scans()]
        return (min(stamps) + max(stamps)) // 2


def stamp_of(message):
    return message.header.stamp.secs * NANOSECONDS + message.header.stamp.nsecs


def set_stamp(message, stamp_ns):
    message.header.stamp.secs, message.header.stamp.nsecs = divmod(stamp_ns, NANOSECONDS)


def move(messages, by_ns):
    for message in messages:
        set_stamp(message, stamp_of(message) + int(by_ns))


def line_s(scan):
    """Time from the first beam to the last one."""
    return (len(scan.ranges) - 1) * scan.time_increment


# Clocks.

@fault
def other_clock(recording):
    """One scanner counts leap seconds."""
    move(recording.of(recording.one), 37 * NANOSECONDS)


@fault
def uptime_clock(recording):
    """One scanner stamps with the time since it was switched on."""
    first = min(map(stamp_of, recording.scans()))
    move(recording.of(recording.one), 40 * NANOSECONDS - first)


@fault
def no_clock(recording):
    for scan in recording.scans():
        set_stamp(scan, 0)


@fault
def clock_steps(recording):
    """The clock of one scanner is set amid the recording."""
    middle = recording.middle()
    move([scan for scan in recording.of(recording.one) if stamp_of(scan) > middle],
         1.5 * NANOSECONDS)


@fault
def first_stamps_of_1970(recording):
    """The clock of one scanner is set half a second after it has begun."""
    first = min(map(stamp_of, recording.scans()))
    move([scan for scan in recording.of(recording.one)
          if stamp_of(scan) - first < 0.5 * NANOSECONDS], 40 * NANOSECONDS - first)


@fault
def stamped_at_the_end(recording):
    """The driver of one scanner stamps with the last beam."""
    for scan in recording.of(recording.one):
        move([scan], line_s(scan) * NANOSECONDS)


# Headers.

@fault
def beam_times_zero(recording):
    for scan in recording.scans():
        scan.time_increment = scan.scan_time = 0.0


@fault
def beam_times_in_ns(recording):
    for scan in recording.scans():
        scan.time_increment *= 1e9


@fault
def beam_times_too_small(recording):
    for scan in recording.scans():
        scan.time_increment /= 20.0


@fault
def angles_too_far_apart(recording):
    """The span divided by the number of beams, not by that of the angles between them."""
    for scan in recording.scans():
        beams = len(scan.ranges)
        scan.angle_increment *= beams / (beams - 1.0)


@fault
def beams_turned_round(recording):
    """The driver reverses the beams, but not their times."""
    for scan in recording.scans():
        last = scan.angle_min + (len(scan.ranges) - 1) * scan.angle_increment
        scan.angle_min, scan.angle_max = last, scan.angle_min
        scan.angle_increment = -scan.angle_increment
        scan.ranges = scan.ranges[::-1]


@fault
def millimetres(recording):
    for scan in recording.scans():
        scan.ranges = [1000.0 * value for value in scan.ranges]
        scan.range_min, scan.range_max = 1000.0 * scan.range_min, 1000.0 * scan.range_max


def point_cloud(scan, place):
    """The scan as sensor_msgs/PointCloud2; place: of a point in the scan plane."""
    from sensor_msgs.msg import PointCloud2, PointField
    start_s = stamp_of(scan) / NANOSECONDS
    points = []
    for number, value in enumerate(scan.ranges):
        if not math.isfinite(value):
            continue
        angle = scan.angle_min + number * scan.angle_increment
        point = place((value * math.cos(angle), value * math.sin(angle), 0.0))
        points.append(struct.pack("<fffxxxxd", *point, start_s + number * scan.time_increment))
    cloud = PointCloud2(header=copy.deepcopy(scan.header), height=1, width=len(points),
                        point_step=24, row_step=24 * len(points), is_dense=True,
                        data=b"".join(points))
    cloud.fields = [PointField(name, offset, kind, 1)
                    for name, offset, kind in (("x", 0, 7), ("y", 4, 7), ("z", 8, 7),
                                               ("timestamp", 16, 8))]
    return cloud


def rotation(roll_pitch_yaw_deg):
    roll, pitch, yaw = (math.radians(angle) for angle in roll_pitch_yaw_deg)
    cos, sin = math.cos, math.sin
    return ((cos(yaw) * cos(pitch),
             cos(yaw) * sin(pitch) * sin(roll) - sin(yaw) * cos(roll),
             cos(yaw) * sin(pitch) * cos(roll) + sin(yaw) * sin(roll)),
            (sin(yaw) * cos(pitch),
             sin(yaw) * sin(pitch) * sin(roll) + cos(yaw) * cos(roll),
             sin(yaw) * sin(pitch) * cos(roll) - cos(yaw) * sin(roll)),
            (-sin(pitch), cos(pitch) * sin(roll), cos(pitch) * cos(roll)))


@fault
def points_in_the_body_frame(recording):
    """Point clouds that somebody has already moved to where the scanners sit."""
    places = {}
    for scanner in recording.rig["scanners"]:
        pose = scanner["body_from_scanner"]
        rows = rotation(pose["rotation_rpy_deg"])
        shift = pose["translation"]
        places[scanner["topic"]] = lambda point, rows=rows, shift=shift: tuple(
            sum(a * b for a, b in zip(row, point)) + s for row, s in zip(rows, shift))
    for item in recording.items:
        if item[0] in places:
            item[1] = point_cloud(item[1], places[item[0]])
            item[1].header.frame_id = "base_link"


# Topics.

@fault
def two_on_one_topic(recording):
    """The last two scanners publish under one name."""
    first, second = recording.topics[-2:]
    for item in recording.items:
        if item[0] == second:
            item[0] = first
    recording.rig["scanners"].pop()


@fault
def filtered_copy(recording):
    """What a filter node publishes of the first scanner's lines stands for the second one."""
    first = recording.topics[0]
    copies = []
    for topic, message, receipt_ns in recording.items:
        if topic == first:
            filtered = copy.deepcopy(message)
            filtered.ranges = [value if number % 10 else math.inf
                               for number, value in enumerate(message.ranges)]
            copies.append([recording.one, filtered, receipt_ns + 1000000])
    recording.items = [item for item in recording.items if item[0] != recording.one] + copies


@fault
def lines_lost(recording):
    """The network loses a third of the lines of one scanner."""
    chance = random.Random(1)
    lost = {id(scan) for scan in recording.of(recording.one) if chance.random() < 1.0 / 3.0}
    recording.items = [item for item in recording.items if id(item[1]) not in lost]


@fault
def dead(recording):
    for scan in recording.of(recording.one):
        scan.ranges = [math.inf] * len(scan.ranges)


# Wheels.

@fault
def wheels_frozen(recording):
    """The driver fills in the velocities alone."""
    for message in recording.of(recording.wheels):
        pose = message.pose.pose
        pose.position.x = pose.position.y = 0.0
        pose.orientation.z, pose.orientation.w = 0.0, 1.0


@fault
def wheels_without_attitude(recording):
    for message in recording.of(recording.wheels):
        orientation = message.pose.pose.orientation
        orientation.x = orientation.y = orientation.z = orientation.w = 0.0


@fault
def wheels_mirrored(recording):
    """The driver takes the left wheel for the right one."""
    for message in recording.of(recording.wheels):
        message.pose.pose.position.y *= -1.0
        message.pose.pose.orientation.z *= -1.0
        message.twist.twist.angular.z *= -1.0


@fault
def wheels_late(recording):
    move(recording.of(recording.wheels), 0.5 * NANOSECONDS)


@fault
def wheels_of_another_clock(recording):
    move(recording.of(recording.wheels), 3600 * NANOSECONDS)


# The rig file.

@fault
def rig_not_filled_in(recording):
    for scanner in recording.rig["scanners"]:
        scanner["body_from_scanner"] = {"translation": [0.0, 0.0, 0.0],
                                        "rotation_rpy_deg": [0.0, 0.0, 0.0]}


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("fault", choices=FAULTS, metavar="FAULT",
                        help=f"one of {', '.join(FAULTS)}")
    parser.add_argument("--recording", type=pathlib.Path, required=True, metavar="BAG")
    parser.add_argument("--rig", type=pathlib.Path, required=True, metavar="FILE")
    parser.add_argument("--output", type=pathlib.Path, required=True, metavar="DIR",
                        help="gets recording.bag and rig.yaml")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        import genpy
        import rosbag
    except ImportError as error:
        sys.exit(f"driver_faults.py: needs Debian's python3-rosbag and python3-sensor-msgs: {error}")
    try:
        rig = yaml.safe_load(arguments.rig.read_text(encoding="utf-8"))
        with rosbag.Bag(str(arguments.recording)) as bag:
            recording = Recording([[topic, message, receipt.to_nsec()]
                                   for topic, message, receipt in bag.read_messages()], rig)
        FAULTS[arguments.fault](recording)
        arguments.output.mkdir(exist_ok=True)
        with rosbag.Bag(str(arguments.output / "recording.bag"), "w") as bag:
            for topic, message, receipt_ns in sorted(recording.items, key=lambda item: item[2]):
                bag.write(topic, message, genpy.Time(*divmod(receipt_ns, NANOSECONDS)))
        (arguments.output / "rig.yaml").write_text(yaml.safe_dump(recording.rig),
                                                   encoding="utf-8")
    except (OSError, KeyError, rosbag.ROSBagException, yaml.YAMLError) as error:
        sys.exit(f"driver_faults.py: {arguments.recording}: {error!r}")


if __name__ == "__main__":
    main()

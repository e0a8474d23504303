#!/usr/bin/python3
"""Tests scripts/recordings/driver_faults.py: each fault changes what it says, and nothing else."""

import copy
import math
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts" / "recordings"))
import driver_faults  # noqa: E402  pylint: disable=wrong-import-position

try:
    from nav_msgs.msg import Odometry
    from sensor_msgs.msg import LaserScan, PointCloud2
    import sensor_msgs.point_cloud2 as point_cloud2
    MISSING = None
except ImportError as error:
    MISSING = f"python3-sensor-msgs or python3-nav-msgs is absent: {error}"

START_NS = 1_400_000_000_000_000_000
PERIOD_NS = 25_000_000
TOPICS = ("/top", "/left", "/right")
NUM_LINES = 60


def scan_at(stamp_ns):
    scan = LaserScan(angle_min=-1.0, angle_max=1.0, angle_increment=0.02, time_increment=1e-4,
                     range_min=0.1, range_max=30.0, ranges=[2.0 + 0.01 * i for i in range(101)])
    driver_faults.set_stamp(scan, stamp_ns)
    scan.header.frame_id = "laser"
    return scan


def recording():
    items = []
    for number in range(NUM_LINES):
        stamp_ns = START_NS + number * PERIOD_NS
        items += [[topic, scan_at(stamp_ns), stamp_ns + 1000] for topic in TOPICS]
        wheels = Odometry()
        driver_faults.set_stamp(wheels, stamp_ns)
        wheels.pose.pose.position.x = 0.01 * number
        wheels.pose.pose.position.y = 0.02 * number
        wheels.pose.pose.orientation.z = math.sin(0.005 * number)
        wheels.pose.pose.orientation.w = math.cos(0.005 * number)
        items.append(["/odom", wheels, stamp_ns + 1000])
    rig = {"scanners": [{"topic": topic, "body_from_scanner": {
        "translation": [0.0, 0.0, 0.5], "rotation_rpy_deg": [90.0, 0.0, 0.0]}}
        for topic in TOPICS], "odometry": {"topic": "/odom"}}
    return driver_faults.Recording(items, rig)


@unittest.skipIf(MISSING is not None, f"skipped: {MISSING}")
class DriverFaultsTest(unittest.TestCase):
    def make(self, name):
        """The recording as it was, and with the fault."""
        right = recording()
        wrong = copy.deepcopy(right)
        driver_faults.FAULTS[name](wrong)
        return right, wrong

    def stamps(self, of, topic):
        return [driver_faults.stamp_of(message) for message in of.of(topic)]

    def test_every_fault_changes_something(self):
        for name in driver_faults.FAULTS:
            right, wrong = self.make(name)
            self.assertTrue(right.items != wrong.items or right.rig != wrong.rig, name)

    def test_clocks_of_one_scanner(self):
        for name, late_s in (("other_clock", 37.0), ("stamped_at_the_end", 0.01)):
            right, wrong = self.make(name)
            for before, after in zip(self.stamps(right, "/left"), self.stamps(wrong, "/left")):
                self.assertAlmostEqual((after - before) * 1e-9, late_s, 6)
            self.assertEqual(self.stamps(right, "/top"), self.stamps(wrong, "/top"))
        self.assertEqual(self.stamps(self.make("uptime_clock")[1], "/left")[0], 40 * 10**9)
        _, wrong = self.make("first_stamps_of_1970")
        self.assertEqual(sum(stamp < START_NS for stamp in self.stamps(wrong, "/left")), 20)
        right, wrong = self.make("clock_steps")
        steps = [after - before for before, after in zip(self.stamps(right, "/left"),
                                                         self.stamps(wrong, "/left"))]
        self.assertEqual({steps[0], steps[-1]}, {0, 1_500_000_000})

    def test_headers(self):
        _, wrong = self.make("angles_too_far_apart")
        self.assertAlmostEqual(wrong.of("/top")[0].angle_increment, 0.02 * 101 / 100)
        _, wrong = self.make("beams_turned_round")
        scan = wrong.of("/right")[0]
        self.assertAlmostEqual(scan.angle_min, 1.0)
        self.assertAlmostEqual(scan.ranges[0], 3.0)
        self.assertAlmostEqual(scan.angle_increment, -0.02)
        self.assertAlmostEqual(self.make("beam_times_in_ns")[1].of("/top")[0].time_increment, 1e5)
        self.assertAlmostEqual(self.make("millimetres")[1].of("/top")[0].ranges[0], 2000.0)

    def test_points_lie_where_the_rig_file_says(self):
        _, wrong = self.make("points_in_the_body_frame")
        cloud = wrong.of("/top")[0]
        self.assertIsInstance(cloud, PointCloud2)
        x, y, z, time_s = next(point_cloud2.read_points(cloud, ("x", "y", "z", "timestamp")))
        # The scan plane stands upright; the first beam points to the right, -1 rad: down.
        self.assertAlmostEqual(x, 2.0 * math.cos(1.0), 5)
        self.assertAlmostEqual(y, 0.0, 5)
        self.assertAlmostEqual(z, 0.5 - 2.0 * math.sin(1.0), 5)
        self.assertAlmostEqual(time_s, START_NS * 1e-9, 5)

    def test_topics(self):
        _, wrong = self.make("two_on_one_topic")
        self.assertEqual(len(wrong.of("/left")), 2 * NUM_LINES)
        self.assertEqual(len(wrong.rig["scanners"]), 2)
        right, wrong = self.make("filtered_copy")
        self.assertEqual(wrong.of("/left")[3].ranges[1], right.of("/top")[3].ranges[1])
        self.assertLess(len(self.make("lines_lost")[1].of("/left")), 0.8 * NUM_LINES)
        self.assertEqual(len(self.make("lines_lost")[1].of("/top")), NUM_LINES)

    def test_wheels(self):
        right, wrong = self.make("wheels_mirrored")
        self.assertEqual(wrong.of("/odom")[9].pose.pose.position.y,
                         -right.of("/odom")[9].pose.pose.position.y)
        _, wrong = self.make("wheels_frozen")
        self.assertEqual({message.pose.pose.position.x for message in wrong.of("/odom")}, {0.0})
        right, wrong = self.make("wheels_late")
        self.assertEqual(self.stamps(wrong, "/odom")[0] - self.stamps(right, "/odom")[0],
                         500_000_000)


if __name__ == "__main__":
    unittest.main()

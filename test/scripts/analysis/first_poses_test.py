#!/usr/bin/python3
"""Tests scripts/analysis/first_poses.py with trajectories whose errors are known."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts/analysis/first_poses.py"


def turn(yaw):
    return np.array([[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1.0]])


def pose_row(time_s, yaw, position):
    return [time_s, *position, 0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2)]


class FirstPosesTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.output = pathlib.Path(directory.name)
        self.times = 0.1 * np.arange(101)
        self.yaws = 0.3 * self.times
        self.positions = np.column_stack(
            [np.cos(self.times), np.sin(2 * self.times), np.zeros(len(self.times))])
        np.savetxt(self.output / "truth.tum",
                   [pose_row(*row) for row in zip(self.times, self.yaws, self.positions)])

    def write_map(self, yaw_off, off):
        """A map that begins at 2 s in a frame of its own, its first pose off by these."""
        path = self.output / "map"
        path.mkdir()
        rows = []
        for i in range(20, 101):
            is_first = i == 20
            position = turn(0.7) @ self.positions[i] + [3, -2, 0] + (off if is_first else 0.0)
            rows.append(pose_row(self.times[i],
                                 self.yaws[i] + 0.7 + (yaw_off if is_first else 0.0), position))
        np.savetxt(path / "trajectory.tum", rows)
        # x, y, z, rx, ry, rz: 1 mm, nothing in z, 0.01 rad about the vertical.
        upper = np.triu_indices(6)
        covariance = np.diag([1e-6, 1e-6, 0, 0, 0, 1e-4])[upper]
        np.savetxt(path / "trajectory_covariance.csv",
                   [[row[0], *covariance] for row in rows], delimiter=",", header="t,...",
                   comments="")
        (path / "summary.json").write_text(json.dumps({"consistency": {"verdict": "doubtful"}}))
        return path

    def run_script(self, path):
        return subprocess.run([sys.executable, SCRIPT, path, "--reference",
                               self.output / "truth.tum"],
                              capture_output=True, text=True, check=True).stdout

    def test_a_right_first_pose_is_right_in_any_frame(self):
        line, count = self.run_script(self.write_map(0.0, np.zeros(3))).splitlines()
        self.assertIn("largest 0.0 of its deviations; doubtful", line)
        self.assertEqual(count, "within three deviations: 1 of 1")

    def test_the_largest_ratio_counts(self):
        line, count = self.run_script(
            self.write_map(0.02, np.array([0.0, 0.004, 0.0]))).splitlines()
        self.assertIn("largest 4.0 of its deviations", line)
        self.assertIn("1.146] deg", line)
        self.assertEqual(count, "within three deviations: 0 of 1")


if __name__ == "__main__":
    unittest.main()

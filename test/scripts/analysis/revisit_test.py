#!/usr/bin/python3
"""Tests scripts/analysis/revisit.py on small maps made here."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "analysis" / "revisit.py"
POINT = np.dtype([("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("time", "<f8")])
HEADER = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
          "property float y\nproperty float z\nproperty double time\nend_header\n")
NOISE_M = 0.01
DURATION_S = 40.0


def wall(start, end, generator):
    """Points of a wall in plan, with noise."""
    share = generator.uniform(size=(3000, 1))
    points = np.array(start) + share * (np.array(end) - np.array(start))
    return points + generator.normal(0.0, NOISE_M, points.shape)


def room(generator, partition_face_y):
    """A room with a partition, of which only one face is seen, and posts that are no lines."""
    posts = generator.normal(0.0, 0.1, (2000, 2)) + [1.0, 1.0]
    return np.vstack([wall((-3, -2), (-3, 2), generator), wall((3, -2), (3, 2), generator),
                      wall((-3, -2), (3, -2), generator), wall((-3, 2), (3, 2), generator),
                      wall((-1, partition_face_y), (1, partition_face_y), generator), posts])


class RevisitTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        # Along the one side of the partition at first, along the other one in the end.
        np.savetxt(self.directory / "trajectory.tum", [
            [1e9, 0, -1, 0, 0, 0, 0, 1], [1e9 + 20.0, 0, -1, 0, 0, 0, 0, 1],
            [1e9 + 21.0, 0, 1, 0, 0, 0, 0, 1], [1e9 + DURATION_S, 0, 1, 0, 0, 0, 0, 1]],
            fmt="%.3f")

    def write_map(self, first, last):
        generator = np.random.default_rng(2)
        points = np.zeros(len(first) + len(last), POINT)
        points["x"], points["y"] = np.vstack([first, last]).T
        points["time"][:len(first)] = generator.uniform(0.0, 15.0, len(first))
        points["time"][len(first):] = generator.uniform(
            DURATION_S - 8.0, DURATION_S, len(last))
        points["time"][-1] = DURATION_S
        with open(self.directory / "map.ply", "wb") as file:
            file.write(HEADER.format(len(points)).encode())
            points.tofile(file)

    def run_script(self):
        return subprocess.run([sys.executable, SCRIPT, self.directory],
                              capture_output=True, text=True, check=False)

    def figures(self):
        """Median distance (mm), offset (mm) and turn (deg)."""
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        median, offset = (line.split(":")[1].split() for line in result.stdout.splitlines()[1:])
        return float(median[0]), float(offset[0]), float(offset[2])

    def test_a_map_that_holds_has_no_offset(self):
        generator = np.random.default_rng(1)
        self.write_map(room(generator, -0.05), room(generator, 0.05))
        median, offset, turn = self.figures()
        # Of the two faces of the partition, 10 cm apart, neither is taken for the other one.
        self.assertLess(median, 2.0)
        self.assertLess(offset, 1.0)
        self.assertLess(abs(turn), 0.03)

    def test_shift_and_turn_are_found(self):
        generator = np.random.default_rng(1)
        last = room(generator, 0.05)
        angle = np.radians(-0.5)
        rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        self.write_map(room(generator, -0.05), last @ rotation.T + [0.03, -0.04])
        median, offset, turn = self.figures()
        self.assertGreater(median, 20.0)
        self.assertAlmostEqual(offset, 50.0, delta=1.5)
        self.assertAlmostEqual(turn, 0.5, delta=0.03)

    def test_errors_are_one_line(self):
        generator = np.random.default_rng(1)
        self.write_map(room(generator, -0.05), room(generator, 0.05) + [50.0, 0.0])
        result = self.run_script()
        self.assertEqual(result.returncode, 1)
        self.assertIn("show too little", result.stderr)
        (self.directory / "map.ply").unlink()
        result = self.run_script()
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)


if __name__ == "__main__":
    unittest.main()

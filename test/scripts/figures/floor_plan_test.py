#!/usr/bin/python3
"""Tests scripts/figures/floor_plan.py on a small result made here."""

import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

import numpy

SCRIPT = str(pathlib.Path(__file__).resolve().parents[3] / "scripts" / "figures" / "floor_plan.py")
sys.path.insert(0, os.path.dirname(SCRIPT))
import floor_plan  # pylint: disable=wrong-import-position

PLY_HEADER = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
              "property float y\nproperty float z\nproperty double time\n"
              "property uchar scanner\nend_header\n")


def wall(x, normal_x):
    return {"id": 1, "normal": [normal_x, 0, 0], "centre": [x, 0, 1], "num_points": 100,
            "outline": [[x, -2, 0], [x, 2, 0], [x, 2, 2], [x, -2, 2]]}


class FloorPlanTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        self.output = self.path("plan.png")
        planes = [wall(-3, 1), wall(3, -1)]
        trajectory = "0.0 0 0 0 0 0 0 1\n1.0 1 0 0 0 0 0 1\n"
        self.write("planes.json", json.dumps(planes))
        self.write("truth_planes.json", json.dumps(planes))
        self.write("trajectory.tum", trajectory)
        self.write("truth_trajectory.tum", trajectory)
        self.write("summary.json", json.dumps(
            {"scans": 2, "points": 2, "planes": 2, "residual_rms_m": 0.02}))
        self.write_map(PLY_HEADER.format(2))
        errors = {"rmse": 0.001}
        self.write("evaluation.json", json.dumps({
            "model_from_truth": {"translation": [0, 0, 0], "rotation_xyzw": [0, 0, 0, 1]},
            "trajectory": {"unaligned": {"position_m": errors, "rotation_deg": errors}},
            "planes": {"distance_m": errors, "angle_deg": errors}}))

    def path(self, name):
        return os.path.join(self.directory, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def write_map(self, header):
        with open(self.path("map.ply"), "wb") as file:
            file.write(header.encode())
            file.write(struct.pack("<fffdBfffdB", 3, 1, 1, 0.5, 0, -3, 1, 1, 0.6, 1))

    def run_script(self, *arguments):
        return subprocess.run(
            [sys.executable, SCRIPT, self.directory, "--output", self.output, *arguments],
            capture_output=True, text=True, check=False)

    def test_draws_a_picture_twice_the_same(self):
        pictures = []
        for _ in range(2):
            result = self.run_script("--truth", self.directory)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(self.output, "rb") as file:
                pictures.append(file.read())
        self.assertTrue(pictures[0].startswith(b"\x89PNG"))
        self.assertEqual(pictures[0], pictures[1])

    def test_draws_cylinders_along_their_arcs(self):
        steps = [math.pi * i / 20 for i in range(21)]
        rim = [[2 * math.cos(angle), 2 * math.sin(angle)] for angle in steps]
        column = {"id": 3, "type": "cylinder", "normal": [0, 1, 0], "centre": [0, 2, 1],
                  "axis_point": [0, 0, 1], "radius": 2, "num_points": 2,
                  "outline": [p + [0] for p in rim] + [p + [2] for p in rim[::-1]]}
        traces = floor_plan.wall_traces([column])
        self.assertEqual(len(traces), 20)
        for trace in traces:
            for end in trace:
                self.assertAlmostEqual(math.hypot(*end), 2.0)
        # Points at 40 and 100 degrees, each on one piece of nine degrees.
        points = numpy.zeros(2, [("x", float), ("y", float), ("plane_id", int)])
        points["x"] = [2 * math.cos(math.radians(angle)) for angle in (40, 100)]
        points["y"] = [2 * math.sin(math.radians(angle)) for angle in (40, 100)]
        points["plane_id"] = 3
        pieces = floor_plan.seen_parts([column], points)
        self.assertEqual(len(pieces), 2)
        self.write("planes.json", json.dumps([column]))
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_draws_without_truth_and_without_walls(self):
        os.remove(self.path("evaluation.json"))
        self.write("planes.json", "[]")
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(os.path.exists(self.output))

    def test_truth_needs_an_evaluation(self):
        os.remove(self.path("evaluation.json"))
        self.assertEqual(self.run_script("--truth", self.directory).returncode, 2)

    def check_error(self, name):
        result = self.run_script()
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(name, result.stderr)
        self.assertFalse(os.path.exists(self.output))

    def test_errors(self):
        self.write_map(PLY_HEADER.format(3))
        self.check_error("map.ply")
        self.write_map("ply\nformat ascii 1.0\nend_header\n")
        self.check_error("map.ply")
        self.write("trajectory.tum", "1 2 3\n")
        self.check_error("trajectory.tum")
        self.write("planes.json", "[")
        self.check_error("planes.json")
        os.remove(self.path("planes.json"))
        self.check_error("planes.json")


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests scripts/buildings/import_floorplan.py on small floor plans made here."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import yaml

SCRIPT = str(pathlib.Path(__file__).resolve().parents[3] / "scripts" / "buildings" / "import_floorplan.py")


def floor_plan():
    # Two walls that should meet at x = 4.2 but were drawn 2 mm apart.
    return {
        "floor": {"7": {}, "8": {}},
        "slab": {"1": {"floorID": 7, "x": [0, 6, 6, 3, 0], "y": [0, 0, 5, 5, 5]}},
        "rect": {
            "1": {"floorID": 7, "x": [1.0, 1.0, 4.2, 4.2], "y": [2.0, 2.2, 2.2, 2.0]},
            "2": {"floorID": 7, "x": [4.198, 4.4, 4.4, 4.198], "y": [1.0, 1.0, 4.0, 4.0]},
            "3": {"floorID": 8, "x": [1.0, 1.0, 4.0, 4.0], "y": [2.0, 2.2, 2.2, 2.0]},
            "4": {"floorID": 8, "x": [5.0, 5.2, 5.2, 5.0], "y": [0.0, 0.0, 4.0, 4.0]},
        },
    }


class ImportFloorplanTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.input = os.path.join(directory.name, "fp.json")
        self.output = os.path.join(directory.name, "building.yaml")

    def run_script(self, data, *arguments):
        with open(self.input, "w", encoding="utf-8") as file:
            file.write(data if isinstance(data, str) else json.dumps(data))
        return subprocess.run([sys.executable, SCRIPT, self.input, *arguments],
                              capture_output=True, text=True, check=False)

    def import_floor(self, data, floor):
        result = self.run_script(data, "--floor", floor, "--output", self.output)
        self.assertEqual(result.returncode, 0, result.stderr)
        with open(self.output, encoding="utf-8") as file:
            return yaml.safe_load(file)

    def test_walls_and_slab(self):
        building = self.import_floor(floor_plan(), "7")
        self.assertEqual(building["floor_height_m"], 0.0)
        self.assertEqual(building["ceiling_height_m"], 2.5)
        self.assertEqual(building["outlines"],
                         [{"corners": [[0, 0], [6, 0], [6, 5], [0, 5]]}])
        first, second = building["walls"]
        self.assertEqual(first["thickness_m"], 0.2)
        self.assertEqual(sorted([first["from"], first["to"]]), [[1.0, 2.1], [4.199, 2.1]])
        # The two coordinates have become one, so the walls meet.
        left = second["from"][0] - second["thickness_m"] / 2
        self.assertAlmostEqual(left, 4.199, places=9)

    def test_rectangle_without_slab(self):
        building = self.import_floor(floor_plan(), "8")
        self.assertEqual(building["outlines"],
                         [{"corners": [[1.0, 0.0], [5.2, 0.0], [5.2, 4.0], [1.0, 4.0]]}])

    def test_rectangle_for_crossing_slab(self):
        data = floor_plan()
        data["slab"]["1"].update({"x": [0, 6, 0, 6], "y": [0, 5, 5, 0]})
        building = self.import_floor(data, "7")
        self.assertEqual(building["outlines"][0]["corners"][0], [1.0, 1.0])

    def test_slanted_walls_end_inside_others(self):
        data = floor_plan()
        data["rect"]["1"].update({"x": [1.0, 4.0, 3.88, 0.88], "y": [1.0, 5.0, 5.09, 1.09]})
        building = self.import_floor(data, "7")
        wall = building["walls"][0]
        self.assertAlmostEqual(wall["thickness_m"], 0.15, places=6)
        ends = sorted([wall["from"], wall["to"]])
        # 3 cm from either end of the line from (0.94, 1.045) to (3.94, 5.045).
        for end, expected in zip(ends, ([0.958, 1.069], [3.922, 5.021])):
            self.assertAlmostEqual(end[0], expected[0], places=3)
            self.assertAlmostEqual(end[1], expected[1], places=3)
        self.assertEqual(building["outlines"][0]["corners"],
                         [[0.02, 0.02], [5.98, 0.02], [5.98, 4.98], [0.02, 4.98]])

    def test_ceiling_height(self):
        result = self.run_script(floor_plan(), "--floor", "7", "--output", self.output,
                                 "--ceiling-height", "3.1")
        self.assertEqual(result.returncode, 0)
        with open(self.output, encoding="utf-8") as file:
            self.assertEqual(yaml.safe_load(file)["ceiling_height_m"], 3.1)

    def test_list(self):
        result = self.run_script(floor_plan(), "--list")
        self.assertEqual(result.returncode, 0)
        self.assertIn("6.0 x 5.0", result.stdout)

    def test_errors(self):
        for data, floor in ((floor_plan(), "9"), ("{", "7"), ("[]", "7"), ({"floor": {}}, "7")):
            result = self.run_script(data, "--floor", floor, "--output", self.output)
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            self.assertIn("fp.json", result.stderr)
            self.assertFalse(os.path.exists(self.output))
        self.assertEqual(self.run_script(floor_plan(), "--floor", "7").returncode, 2)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests scripts/buildings/large_building.py."""

import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
SCRIPT = ROOT / "scripts" / "buildings" / "large_building.py"
NAMES = ("buildings/large_building.yaml", "experiments/large_building.yaml")


class LargeBuildingTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.output = pathlib.Path(directory.name)

    def run_script(self, output):
        return subprocess.run([sys.executable, SCRIPT, "--output", output], capture_output=True,
                              text=True, check=False)

    def test_the_shipped_files_are_what_it_makes(self):
        result = self.run_script(self.output)
        self.assertEqual(result.returncode, 0, result.stderr)
        for name in NAMES:
            self.assertEqual((self.output / name).read_text(),
                             (ROOT / "configs" / name).read_text(), name)
        self.assertEqual(len([path for path in self.output.rglob("*") if path.is_file()]), 2)

    def test_walls_have_length_and_openings_fit(self):
        building = yaml.safe_load((ROOT / "configs" / NAMES[0]).read_text())
        self.assertGreater(len(building["walls"]), 200)
        for wall in building["walls"]:
            length = math.dist(wall["from"], wall["to"])
            end = 0.0
            for opening in wall.get("openings", []):
                self.assertGreater(opening["position_m"] - opening["width_m"] / 2, end, wall)
                end = opening["position_m"] + opening["width_m"] / 2
            self.assertGreater(length, end, wall)

    def test_the_walk_lasts_an_hour_and_comes_back(self):
        experiment = yaml.safe_load((ROOT / "configs" / NAMES[1]).read_text())
        path = experiment["path"]
        duration_s = path["length_m"] / experiment["speed_m_s"]
        self.assertEqual(duration_s, 3600.0)
        points = path["way_points"]
        lap = sum(math.dist(a, b) for a, b in zip(points, points[1:] + points[:1]))
        self.assertTrue(path["closed"])
        self.assertLess(lap, 0.75 * path["length_m"])

    def test_errors_are_one_line(self):
        (self.output / "buildings").write_text("a file")
        result = self.run_script(self.output)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests scripts/analysis/scanner_agreement.py on a small result made here."""

import json
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import unittest

SCRIPT = str(pathlib.Path(__file__).resolve().parents[3] / "scripts" / "analysis" / "scanner_agreement.py")
PROPERTIES = ("property float x\nproperty float y\nproperty float z\n"
              "property uchar scanner\nproperty int plane_id\nproperty float residual\n")


class ScannerAgreementTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        # Plane 7: scanner 0 at +2 and +4 mm, scanner 1 at -5 mm; -1: on no plane.
        self.write_map([(0, 7, 0.002), (0, 7, 0.004), (1, 7, -0.005), (1, 7, -0.005),
                        (1, -1, 9.0), (0, 8, 0.001), (0, 8, 0.001)])
        self.write_planes([7, 8])

    def path(self, name):
        return os.path.join(self.directory, name)

    def write_planes(self, ids):
        with open(self.path("planes.json"), "w", encoding="utf-8") as file:
            json.dump([{"id": i, "normal": [0, 1, 0], "centre": [1, 2, 0]} for i in ids], file)

    def write_map(self, points, properties=PROPERTIES):
        with open(self.path("map.ply"), "wb") as file:
            file.write((f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
                        f"{properties}end_header\n").encode())
            for scanner, plane_id, residual in points:
                file.write(struct.pack("<fffBif", 0, 0, 0, scanner, plane_id, residual))

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, self.directory, *arguments],
                              capture_output=True, text=True, check=False)

    def test_means_and_differences(self):
        result = self.run_script("--min-points", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.splitlines()
        plane = [line.split() for line in lines if line.split()[:1] == ["7"]]
        self.assertEqual(plane, [["7", "90.0", "1.00", "2.00", "2", "+3.0", "2", "-5.0",
                                  "8.0"]])
        # One scanner alone sees plane 8.
        self.assertFalse([line for line in lines if line.split()[:1] == ["8"]])
        self.assertEqual(lines[-1].split(),
                         ["scanner", "0,", "scanner", "1", "1", "+8.0", "8.0"])

    def test_scanners_have_the_names_of_the_rig_file(self):
        with open(self.path("summary.json"), "w", encoding="utf-8") as file:
            json.dump({"scanners": ["left", "right"]}, file)
        result = self.run_script("--min-points", "2")
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = result.stdout.splitlines()
        self.assertIn("left: points mean/mm", lines[0])
        self.assertEqual(lines[-1].split(), ["left,", "right", "1", "+8.0", "8.0"])

    def check_error(self, text, *arguments):
        result = self.run_script(*arguments)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(text, result.stderr)
        self.assertEqual(result.stdout, "")

    def test_errors(self):
        self.check_error("two scanners", "--min-points", "3")
        self.write_planes([8])
        self.check_error("plane 7", "--min-points", "2")
        self.write_map([(0, 7, 0.0)], PROPERTIES.replace("residual", "error"))
        self.check_error("residual")
        os.remove(self.path("map.ply"))
        self.check_error("map.ply")

    def test_usage(self):
        self.assertEqual(self.run_script("--min-points", "0").returncode, 2)
        self.assertEqual(self.run_script("--help").returncode, 0)


if __name__ == "__main__":
    unittest.main()

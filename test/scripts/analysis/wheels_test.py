#!/usr/bin/python3
"""Tests scripts/analysis/wheels.py on small runs made here."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "analysis" / "wheels.py"


class WheelsTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.folder = pathlib.Path(directory.name)

    def write_experiment(self, text):
        (self.folder / "setup.json").write_text(json.dumps(
            {"experiment": {"name": "hall", "files": {"hall.yaml": text}}}))

    def write_run(self, name, odometry):
        (self.folder / name).mkdir()
        (self.folder / name / "summary.json").write_text(json.dumps(
            {"odometry": odometry} if odometry else {}))

    def run_script(self):
        return subprocess.run([sys.executable, SCRIPT, self.folder], capture_output=True,
                              text=True, check=False)

    def test_errors_over_what_is_stated(self):
        self.write_experiment("odometry: {length_scale: 1.25}\n")
        turn = {"turn_scale": 1.1, "turn_scale_stddev": 0.05, "turn_noise": 0.1}
        self.write_run("run_0001", {"length_scale": 0.81, "length_scale_stddev": 0.01,
                                    "length_noise": 0.02, **turn})
        self.write_run("run_0002", {"length_scale": 0.73, "length_scale_stddev": 0.01,
                                    "length_noise": 0.03, **turn})
        self.write_run("run_0003", None)  # a map without odometry
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = [[cell.strip() for cell in line.split("|")[1:-1]]
                for line in result.stdout.splitlines()[2:]]
        self.assertEqual(rows, [
            ["run_0001", "0.8100 ± 0.0100", "1.0", "0.020", "1.1000 ± 0.0500", "2.0", "0.100"],
            ["run_0002", "0.7300 ± 0.0100", "-7.0", "0.030", "1.1000 ± 0.0500", "2.0", "0.100"],
            ["truth, RMS", "0.8000", "5.0", "", "1.0000", "2.0", ""]])

    def test_runs_without_odometry_are_an_error(self):
        for text, expected in (("odometry: {}\n", "no map there was made with odometry"),
                               ("rig: rig.yaml\n", "the experiment has no odometry")):
            self.write_experiment(text)
            result = self.run_script()
            self.assertEqual(result.returncode, 1)
            self.assertIn(expected, result.stderr)
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)


if __name__ == "__main__":
    unittest.main()

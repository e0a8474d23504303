#!/usr/bin/python3
"""Tests scripts/experiments/data_sheets.py with stand-ins for the programs."""

import pathlib
import sys
import unittest

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import data_sheets  # noqa: E402


class DataSheetsTest(ScriptTest):
    script = "experiments/data_sheets.py"

    def test_scanners_are_those_of_the_data_sheets(self):
        self.run_script("LD06", "--seeds", "1")
        folder = self.output / "experiments"
        rig = yaml.safe_load((folder / "LD06_office_rig.yaml").read_text())
        self.assertEqual(len(rig["scanners"]), 3)
        for scanner in rig["scanners"]:
            self.assertEqual({key: scanner[key] for key in data_sheets.SCANNERS["LD06"]},
                             data_sheets.SCANNERS["LD06"])
        self.assertEqual(yaml.safe_load((folder / "LD06_office.yaml").read_text())
                         ["path"]["length_m"], 20.0)

    def test_unknown_scanner(self):
        result = self.run_script("LMS999")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no scanner LMS999", result.stderr)


class CellTest(unittest.TestCase):
    GOOD = {"verdict": "consistent", "position_rms_m": 0.001, "position_max_m": 0.004,
            "plane_distance_rms_m": 0.002, "times_real_time": 5.0}

    def test_figures_are_those_of_consistent_maps(self):
        bad = {**self.GOOD, "verdict": "contradictory", "position_rms_m": 9.0}
        lost = {"verdict": "error", "error": "no start"}
        better = {**self.GOOD, "position_rms_m": 0.002, "position_max_m": 0.003}
        self.assertEqual(data_sheets.cell_of([self.GOOD, better, bad, lost]),
                         "2 of 4 | 1.5 (4.0) | 2.0 | 5.0")
        self.assertEqual(data_sheets.cell_of([bad, lost]), "0 of 2 | | | ")


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests the arithmetic of scripts/experiments/log_starts.py."""

import pathlib
import sys
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts/experiments"))

import log_starts  # noqa: E402

LOG = ["# CARMEN log",
       "PARAM robot_frontlaser_offset 0.0 nohost 0",
       "ODOM 0 0 0 0 0 0 99.5 host 0.0",
       "FLASER 2 1.0 1.0 0 0 0 0 0 0 100.0 host 0.5",
       "ODOM 0 0 0 0 0 0 149.9 host 50.4",
       "FLASER 2 1.0 1.0 0 0 0 0 0 0 150.0 host 50.5"]


class LogStartsTest(unittest.TestCase):
    def test_a_log_is_cut_by_its_own_stamps_after_the_first_scan(self):
        self.assertEqual(log_starts.cut(LOG, 50.0), LOG[:2] + LOG[5:])

    def test_from_its_start_a_log_is_whole(self):
        self.assertEqual(log_starts.cut(LOG, 0.0), LOG)

    def test_statistics_are_of_what_is_covered(self):
        errors = np.array([[0.3, np.radians(3.0)], [np.nan, np.nan], [0.4, np.radians(4.0)]])
        row = log_starts.statistics(errors)
        self.assertEqual((row["relations"], row["covered"]), (3, 2))
        self.assertAlmostEqual(row["translation_m"]["rms"], np.sqrt(0.125))
        self.assertAlmostEqual(row["translation_m"]["mean"], 0.35)
        self.assertAlmostEqual(row["rotation_deg"]["max"], 4.0)

    def test_a_wrong_map_that_says_nothing_is_silently_wrong(self):
        row = log_starts.statistics(np.array([[0.3, 0.001]]))
        self.assertEqual(log_starts.judgement({**row, "verdict": "consistent"}), "silently wrong")
        self.assertEqual(log_starts.judgement({**row, "verdict": "doubtful"}), "flagged")
        row = log_starts.statistics(np.array([[0.03, 0.001]]))
        self.assertEqual(log_starts.judgement({**row, "verdict": "consistent"}), "right")


if __name__ == "__main__":
    unittest.main()

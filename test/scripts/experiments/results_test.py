#!/usr/bin/python3
"""Tests scripts/experiments/results.py with stand-ins for the programs."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import ScriptTest


class ResultsTest(ScriptTest):
    script = "experiments/results.py"

    def run_room(self, seeds):
        return self.run_script("--case", "room", "--seeds", str(seeds))

    def test_keeps_what_is_done_and_lists_what_failed(self):
        self.set_control("fail_2")
        result = self.run_room(3)
        self.assertEqual(result.returncode, 1)
        self.assertIn("| room | 2 of 3 | 1.00 to 3.00 |", result.stdout)
        self.assertIn("failed: room, seed 2: plumbline_map: lost in 2", result.stdout)
        names = sorted(path.name for path in (self.output / "room" / "seed_1").iterdir())
        self.assertEqual(names, ["evaluation.json", "summary.json"])
        self.unset_control("fail_2")
        result = self.run_room(3)
        self.check_done(result)
        self.assertIn("| room | 3 of 3 | 1.00 to 3.00 |", result.stdout)
        self.assertEqual(self.seeds(), ["1", "2", "2", "3"])

    def test_a_run_without_evaluation_is_done_again(self):
        self.check_done(self.run_room(1))
        evaluation = self.output / "room" / "seed_1" / "evaluation.json"
        evaluation.unlink()
        self.check_done(self.run_room(1))
        self.assertTrue(evaluation.exists())

    def test_a_damaged_run_is_done_again(self):
        self.check_done(self.run_room(2))
        (self.output / "room" / "seed_1" / "evaluation.json").write_text('{"trajectory": 1}')
        (self.output / "room" / "seed_2" / "summary.json").write_text("{")
        result = self.run_room(2)
        self.check_done(result)
        self.assertEqual(result.stderr.count("is damaged; done again"), 2)
        self.assertIn("| room | 2 of 2 |", result.stdout)
        self.assertEqual(self.seeds(), ["1", "1", "2", "2"])

    def test_another_build_is_accepted_only_on_demand(self):
        self.check_done(self.run_room(1))
        self.set_control("version", "plumbline 2.0")
        self.check_error("another build", "--case", "room", "--seeds", "2")
        self.check_done(self.run_script("--case", "room", "--seeds", "2", "--accept-other-build"))
        self.assertEqual(self.seeds(), ["1", "2"])

    def test_missing_programs(self):
        (self.binaries / "plumbline_map").unlink()
        self.check_error("no plumbline_map")


if __name__ == "__main__":
    unittest.main()

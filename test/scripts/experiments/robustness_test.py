#!/usr/bin/python3
"""Tests scripts/experiments/robustness.py with stand-ins for the programs."""

import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import experiment_files  # noqa: E402
import robustness  # noqa: E402


class RobustnessTest(ScriptTest):
    script = "experiments/robustness.py"

    def rows(self):
        return json.loads((self.output / "robustness.json").read_text())

    def test_says_how_each_run_ended(self):
        # The stand-in's largest error is 1 cm times the seed.
        self.set_control("contradict_6")
        self.set_control("fail_7")
        result = self.run_script("plain", "--first-seed", "5", "--seeds", "4")
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = self.rows()
        self.assertEqual([row["outcome"] for row in rows],
                         ["right", "flagged", "flagged", "silent"])
        self.assertEqual([row["exit_code"] for row in rows], [0, 3, 1, 0])
        self.assertEqual(rows[2]["error"], "plumbline_map: lost in 7")
        self.assertIn("1 right, 2 flagged, 1 silent", result.stdout)
        self.assertIn("| plain | 8 | 0 |  | 0 | 8.0 | 80.0 |", result.stdout)
        self.assertEqual((self.output / "robustness.md").read_text(), result.stdout)

    def test_finished_runs_are_not_done_again(self):
        for cases in (("plain",), ("plain", "furniture")):
            result = self.run_script(*cases, "--seeds", "2")
            self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(self.rows()), 4)
        attempts = (self.control / "attempts").read_text().splitlines()
        self.assertEqual(sorted(line.split()[0] for line in attempts), ["1", "1", "2", "2"])

    def test_results_of_another_world_are_not_mixed_in(self):
        self.assertEqual(self.run_script("plain", "--seeds", "1").returncode, 0)
        path = self.output / "experiments.json"
        self.assertEqual(list(json.loads(path.read_text())), ["plain"])
        path.write_text(json.dumps({"plain": "something else"}))
        result = self.run_script("plain", "--seeds", "1")
        self.assertEqual(result.returncode, 1)
        self.assertIn("holds results of another plain; choose another --output", result.stderr)
        self.assertEqual(self.run_script("furniture", "--seeds", "1").returncode, 0)

    def test_damaged_files_of_earlier_runs(self):
        self.set_control("fail_2")
        self.run_script("plain", "--seeds", "4")
        self.unset_control("fail_2")
        (self.output / "failed_plain_0002.json").write_text("null")
        (self.output / "plain_0003" / "trajectory.tum").write_text("")
        (self.output / "plain_0004" / "evaluation.json").write_text("{")
        result = self.run_script("plain", "--seeds", "4")
        self.assertEqual(result.returncode, 1)
        self.assertNotIn("Traceback", result.stderr)
        self.assertEqual([row["seed"] for row in self.rows()], [1, 2])
        for text in ("failed_plain_0002.json", "plain_0003 is damaged", "plain_0004 is damaged"):
            lines = [line for line in result.stderr.splitlines() if text in line]
            self.assertEqual(len(lines), 1, result.stderr)

    def test_unknown_case(self):
        result = self.run_script("no_such_case")
        self.assertEqual(result.returncode, 1)
        self.assertIn("no case no_such_case in", result.stderr)


class OutcomeTest(unittest.TestCase):
    GOOD = {"position_max_m": 0.01, "rotation_max_deg": 0.1, "missing_s": 0.0,
            "exit_code": 0, "verdict": None, "warnings": []}

    def outcome(self, **changes):
        return robustness.outcome_of({**self.GOOD, **changes})

    def test_right_needs_both_errors_and_the_whole_way(self):
        self.assertEqual(self.outcome(), "right")
        self.assertEqual(self.outcome(position_max_m=0.051), "silent")
        self.assertEqual(self.outcome(rotation_max_deg=0.51), "silent")
        self.assertEqual(self.outcome(missing_s=3.0), "silent")

    def test_a_map_that_lacks_a_part_needs_a_warning(self):
        self.assertEqual(self.outcome(missing_s=3.0, warnings=["ends"]), "flagged")
        self.assertEqual(self.outcome(position_max_m=1.0, warnings=["noise"]), "silent")

    def test_verdicts(self):
        self.assertEqual(self.outcome(position_max_m=1.0, verdict="doubtful"), "flagged")
        self.assertEqual(self.outcome(position_max_m=1.0, verdict="contradictory"), "flagged")
        self.assertEqual(self.outcome(position_max_m=1.0, verdict="consistent"), "silent")

    def test_false_planes_are_those_of_some_extent(self):
        def plane(number, width):
            return {"id": number, "outline": [[0, 0, 0], [width, 0, 0], [width, 0.5, 0]]}

        evaluation = {"planes": {"list": [{"id": 1, "status": "wrong"},
                                          {"id": 2, "status": "wrong"},
                                          {"id": 3, "status": "matched"}]}}
        planes = [plane(1, 2.0), plane(2, 0.9), plane(3, 5.0)]
        self.assertEqual(robustness.count_false_planes(evaluation, planes), 1)


class MissingTimeTest(unittest.TestCase):
    def test_both_ends_count_from_a_second_on(self):
        with tempfile.TemporaryDirectory() as name:
            directory = pathlib.Path(name)
            (directory / "truth_trajectory.tum").write_text("# truth\n10.0 0\n15.0 0\n20.0 0\n")
            for first, last, missing in ((10.5, 19.5, 0.0), (12.0, 19.5, 2.0), (13.0, 16.0, 7.0)):
                (directory / "trajectory.tum").write_text(f"{first} 0\n{last} 0\n")
                self.assertAlmostEqual(robustness.missing_time(directory), missing)


class ExperimentFilesTest(unittest.TestCase):
    def test_meshes_and_paths_count(self):
        files = experiment_files.read(robustness.FOLDER / "fzk_ground.yaml")
        self.assertEqual(len(files), 4)
        self.assertTrue(files["../../buildings/AC20-FZK-Haus.ply"].startswith("sha256 "))
        self.assertIn("drop", files["../../buildings/fzk_ground.path"])


if __name__ == "__main__":
    unittest.main()

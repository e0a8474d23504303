#!/usr/bin/python3
"""Tests scripts/evaluate_relations.py with made-up trajectories and relations."""

import json
import math
import pathlib
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "evaluate_relations.py"


def pose_line(time, x, y, yaw):
    return f"{time} {x} {y} 0 0 0 {math.sin(yaw / 2)} {math.cos(yaw / 2)}"


class EvaluateRelationsTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def evaluate(self, poses, relations, *flags):
        """Exit code, figures, and what was printed."""
        (self.path / "trajectory.tum").write_text("\n".join(poses) + "\n")
        (self.path / "relations").write_text("\n".join(relations) + "\n")
        output = self.path / "figures.json"
        output.unlink(missing_ok=True)
        run = subprocess.run(
            [SCRIPT, self.path, "--relations", self.path / "relations", "--output", output,
             *flags],
            capture_output=True, text=True, check=False)
        figures = json.loads(output.read_text()) if output.exists() else None
        return run.returncode, figures, run.stdout + run.stderr

    def test_true_motion_in_another_frame_has_no_error(self):
        # The rig looks along y, drives 2 m ahead and 1 m to its left and turns by 0.5 rad.
        poses = [pose_line(10.0, 3.0, 4.0, math.pi / 2),
                 pose_line(10.4, 2.0, 6.0, math.pi / 2 + 0.5)]
        code, figures, _ = self.evaluate(poses, ["10 10.4 2 1 0 0 0 0.5"])
        self.assertEqual(code, 0)
        self.assertEqual(figures["covered"], 1)
        self.assertLess(figures["translation_m"]["mean"], 1e-9)
        self.assertLess(figures["rotation_deg"]["mean"], 1e-5)

    def test_errors_by_hand(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(1.0, 1.0, 0, 0), pose_line(2.0, 2.0, 0, 0)]
        relations = ["0 1 1.3 0.4 0 0 0 0", "# a comment", "1 2 1 0 0 0 0 0.1"]
        code, figures, text = self.evaluate(poses, relations)
        self.assertEqual(code, 0, text)
        # 0.5 m and 0; 0 and 0.1 rad: means of half, standard deviations of half.
        self.assertAlmostEqual(figures["translation_m"]["mean"], 0.25)
        self.assertAlmostEqual(figures["translation_m"]["std"], 0.25)
        self.assertAlmostEqual(figures["translation_m"]["max"], 0.5)
        self.assertAlmostEqual(figures["rotation_deg"]["mean"], math.degrees(0.05))
        self.assertAlmostEqual(figures["rotation_deg"]["std"], math.degrees(0.05))

    def test_angles_turn_the_short_way_round(self):
        poses = [pose_line(0.0, 0, 0, 3.1), pose_line(1.0, 0, 0, -3.1)]
        _, figures, _ = self.evaluate(poses, ["0 1 0 0 0 0 0 0"])
        self.assertAlmostEqual(figures["rotation_deg"]["mean"],
                               math.degrees(2 * math.pi - 6.2))

    def test_poses_are_interpolated(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(0.5, 1.0, 0, 0.2)]
        _, figures, _ = self.evaluate(poses, ["0 0.25 0.5 0 0 0 0 0.1"])
        self.assertLess(figures["translation_m"]["max"], 1e-9)
        self.assertLess(figures["rotation_deg"]["max"], 1e-6)

    def test_gaps_are_not_bridged(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(0.5, 1, 0, 0), pose_line(9.0, 2, 0, 0)]
        relations = ["0 0.5 1 0 0 0 0 0", "0.5 5 1 0 0 0 0 0", "0 10 1 0 0 0 0 0"]
        code, figures, _ = self.evaluate(poses, relations)
        self.assertEqual(code, 0)
        self.assertEqual((figures["covered"], figures["relations"]), (1, 3))

    def test_time_offset(self):
        poses = [pose_line(100.0, 0, 0, 0), pose_line(101.0, 1, 0, 0)]
        _, figures, _ = self.evaluate(poses, ["0 1 1 0 0 0 0 0"], "--time_offset=100")
        self.assertEqual(figures["covered"], 1)

    def test_spans_choose_relations(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(1.0, 1, 0, 0), pose_line(2.0, 2, 0, 0)]
        relations = ["0 1 1 0 0 0 0 0", "0 2 2.5 0 0 0 0 0"]
        _, near, _ = self.evaluate(poses, relations, "--max_span=1.5")
        self.assertEqual((near["relations"], near["translation_m"]["max"]), (1, 0.0))
        _, far, _ = self.evaluate(poses, relations, "--min_span=1.5")
        self.assertAlmostEqual(far["translation_m"]["mean"], 0.5)
        code, _, text = self.evaluate(poses, relations, "--min_span=9")
        self.assertEqual(code, 1)
        self.assertIn("no relations of such a time", text)

    def test_worst_come_first(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(1.0, 1.0, 0, 0), pose_line(2.0, 2.0, 0, 0)]
        _, _, text = self.evaluate(
            poses, ["0 1 1.1 0 0 0 0 0", "1 2 1.7 0 0 0 0 0"], "--worst=1")
        self.assertIn("1.000 to        2.000 s: 0.700 m", text)
        self.assertNotIn("0.100 m", text)

    def test_nothing_covered_is_an_error(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(1.0, 1, 0, 0)]
        code, _, text = self.evaluate(poses, ["50 51 1 0 0 0 0 0"])
        self.assertEqual(code, 1)
        self.assertIn("none of 1 relations lies within", text)

    def test_bad_files_are_named(self):
        poses = [pose_line(0.0, 0, 0, 0), pose_line(1.0, 1, 0, 0)]
        for line, why in (("0 1 2", "not 8 finite numbers"), ("0 x 0 0 0 0 0 0", "x")):
            code, _, text = self.evaluate(poses, ["0 1 1 0 0 0 0 0", line])
            self.assertEqual(code, 1)
            self.assertIn("relations:2: ", text)
            self.assertIn(why, text)
        code, _, text = self.evaluate(poses[::-1], ["0 1 1 0 0 0 0 0"])
        self.assertEqual(code, 1)
        self.assertIn("do not increase", text)


if __name__ == "__main__":
    unittest.main()

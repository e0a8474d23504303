#!/usr/bin/python3
"""plumbline_calibrate on two short walks of one rig whose file is not exact.

    plumbline_calibrate_test.py BIN
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

BIN = pathlib.Path(sys.argv.pop(1))
CONFIGS = pathlib.Path(__file__).resolve().parents[2] / "configs"
SCRIPTS = pathlib.Path(__file__).resolve().parents[2] / "scripts"
EXACT = "uncertainty: {rotation_deg: 0, translation_m: 0, time_s: 0, range_m: 0, range_scale: 0}"


def run(program, *arguments):
    return subprocess.run([BIN / program, *arguments], capture_output=True, text=True, check=False)


class Calibrate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = pathlib.Path(cls.scratch.name)
        for walk in ("1", "2"):
            done = run("plumbline_simulate", f"--experiment={CONFIGS}/experiments/room.yaml",
                       f"--seed={walk}", f"--output={cls.folder / walk}")
            assert done.returncode == 0, done.stderr
        # 3 ms off in its clock, of a rig measured by hand.
        rig = (cls.folder / "1/rig.yaml").read_text(encoding="utf-8")
        before, rest = rig.replace(EXACT, "").split('name: "right"')
        rest = rest.replace("time_offset_s: 0\n", "time_offset_s: 0.003\n", 1)
        cls.rig = cls.folder / "rig.yaml"
        cls.rig.write_text(before + 'name: "right"' + rest, encoding="utf-8")

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def calibrate(self, output, *recordings):
        return run("plumbline_calibrate", *recordings, f"--rig={self.rig}",
                   f"--output={self.folder / output}", "--threads=2")

    def clock_of_right(self, output):
        found = json.loads((self.folder / output / "calibration.json").read_text(encoding="utf-8"))
        right = next(s for s in found["scanners"] if s["name"] == "right")
        return next(p for p in right["parameters"] if p["name"] == "time_s")

    def test_two_walks_say_more_than_one(self):
        walks = [self.folder / walk / "recording.bag" for walk in ("1", "2")]
        done = self.calibrate("both", *walks)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("Scanners off the rig file", done.stdout)
        one = self.clock_of_right("both/map_1")
        both = self.clock_of_right("both")
        self.assertLess(both["sigma"], 0.8 * one["sigma"])
        self.assertLess(abs(both["value"] + 0.003), 5.0 * both["sigma"])
        self.assertTrue((self.folder / "both/rig_calibrated.yaml").is_file())
        # What is mapped already is not mapped again.
        again = self.calibrate("again", self.folder / "both/map_1", self.folder / "both/map_2")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.folder / "again/rig_calibrated.yaml").read_bytes(),
                         (self.folder / "both/rig_calibrated.yaml").read_bytes())
        self.assertFalse((self.folder / "again/map_1").exists())

    def test_recordings_that_were_mapped_side_by_side(self):
        maps = self.folder / "maps"
        walks = self.folder / "walks"
        walks.mkdir()
        for walk in ("1", "2"):
            (walks / f"{walk}.bag").symlink_to(self.folder / walk / "recording.bag")
        done = subprocess.run(
            [sys.executable, SCRIPTS / "experiments/map_all.py", walks, f"--rig={self.rig}",
             f"--output={maps}", f"--binaries={BIN}", "--jobs=2"],
            capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.calibrate("side_by_side", maps / "1", maps / "2")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertLess(self.clock_of_right("side_by_side")["sigma"],
                        0.8 * self.clock_of_right("maps/1")["sigma"])
        # A map that contradicts its scans is no witness.
        summary = json.loads((maps / "2/summary.json").read_text(encoding="utf-8"))
        summary["consistency"]["verdict"] = "contradictory"
        (maps / "2/summary.json").write_text(json.dumps(summary), encoding="utf-8")
        refused = self.calibrate("refused", maps / "1", maps / "2")
        self.assertEqual(refused.returncode, 1)
        self.assertIn("maps/2: its map contradicts its scans", refused.stderr)
        self.assertFalse((self.folder / "refused").exists())

    def test_an_exact_rig_leaves_nothing_to_calibrate(self):
        done = run("plumbline_calibrate", self.folder / "1/recording.bag",
                   f"--rig={self.folder / '1/rig.yaml'}", f"--output={self.folder / 'exact'}")
        self.assertEqual(done.returncode, 1)
        self.assertIn("there is nothing to calibrate", done.stderr)

    def test_no_recording_is_wrong_usage(self):
        done = run("plumbline_calibrate", f"--rig={self.rig}", "--output=x")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--recordings is missing", done.stderr)


if __name__ == "__main__":
    unittest.main()

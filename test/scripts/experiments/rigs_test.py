#!/usr/bin/python3
"""Tests scripts/experiments/rigs.py: its experiments, its arithmetic, and its runs with stand-ins
for the programs."""

import json
import math
import pathlib
import sys
import tempfile
import unittest

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import rigs  # noqa: E402

CELL = ("paper", "corridor", "cart")
BOUND = '''#!/usr/bin/python3 -ES
import pathlib, sys
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:] if "=" in argument)
if flags:
    output = pathlib.Path(flags["output"])
    output.mkdir()
    (output / "planes.json").write_text(\'\'\'[
        {"id": 4, "type": "vertical", "sigma_distance_m": 0.002},
        {"id": 5, "type": "horizontal", "sigma_distance_m": 9.0}]\'\'\')
    (output / "faces.csv").write_text("plane,face\\n4,17\\n5,1\\n")
    (output / "trajectory_covariance.csv").write_text(
        "t,px_px,py_py,pz_pz,rx_rx,ry_ry,rz_rz\\n0,0,0,0,0,0,0\\n1,1e-6,1e-6,0.01,0,0,0.0001\\n")
'''


def experiment(name, world="corridor", carriage="cart"):
    return rigs.experiment_of(name, rigs.read_rig(name), world, carriage)


def run(outcome="right", **changes):
    return {"outcome": outcome, "seed": 1, "exit_code": 0, "position_max_m": 0.2,
            "position_rms_m": 0.001,
            "rotation_max_deg": 0.1, "missing_s": 0.0, "position_unaligned_m": 0.003, "cause": "",
            "walls_m": {"17": 0.004, "3": 1.0}, "weak_share": 0.5, **changes}


class ExperimentTest(unittest.TestCase):
    def test_a_cart_is_level_and_a_person_swings(self):
        self.assertEqual(experiment("paper")["motion"], {})
        self.assertEqual(set(experiment("paper", carriage="carried")["motion"]),
                         {"height", "roll", "pitch"})
        self.assertEqual(experiment("paper")["path"]["length_m"], 46.0)
        self.assertNotIn("laps", experiment("paper")["path"])

    def test_what_else_measures(self):
        self.assertNotIn("imu", experiment("paper"))
        self.assertIn("imu", experiment("paper_imu"))
        self.assertIn("length_scale", experiment("trimble_timms")["odometry"])
        self.assertNotIn("odometry", experiment("paper"))

    def test_the_head_nods_and_the_robot_stops(self):
        self.assertEqual(experiment("zebedee", carriage="carried")["motion"]["pitch"],
                         {"amplitude_deg": 30.0, "frequency_hz": 1.0})
        pauses = experiment("borrmann", "office")["path"]["pauses"]
        self.assertEqual([pause["at_m"] for pause in pauses], [3.0 * n for n in range(1, 14)])

    def test_rigs_are_those_of_their_sources(self):
        for name in rigs.RIGS:
            for scanner in rigs.read_rig(name)["scanners"]:
                self.assertEqual(set(scanner["uncertainty"].values()), {0}, name)
        timms = rigs.read_rig("trimble_timms")["scanners"]
        self.assertEqual([(one["scan_rate_hz"], one["max_range_m"], one["range_noise_m"])
                          for one in timms], [(75.0, 16.0, 0.01)] * 2)
        self.assertEqual(rigs.read_rig("viametris_imms")["scanners"],
                         rigs.read_rig("viametris_imms_3d")["scanners"][:1])


class ArithmeticTest(unittest.TestCase):
    BOUND = {"position_m": 0.0015, "walls_m": {"17": 0.002, "9": 1.0}, "open": ["height"]}

    def test_figures_are_those_of_right_maps_and_of_walls_that_the_bound_knows(self):
        bad = run("flagged", position_unaligned_m=9.0, cause="slip")
        summary = rigs.summary_of(CELL, [run(), bad, run("crash", error="signal 11")], self.BOUND)
        self.assertEqual(rigs.outcome_text(summary), "1/1/0, 1 crash")
        self.assertEqual(rigs.figure_text(summary, "position"), "3, 1.5, 2.00")
        self.assertEqual(rigs.figure_text(summary, "wall"), "4, 2, 2.00")
        self.assertEqual(summary["reasons"], {"slip": 1, "signal 11": 1})

    def test_figures_without_a_right_map_or_bound_stand_apart(self):
        summary = rigs.summary_of(CELL, [run("silent", seed=7)], None)
        self.assertEqual(rigs.figure_text(summary, "position"), "(3)")
        self.assertEqual(summary["aligned_m"], 0.001)
        self.assertEqual(rigs.open_text(summary), "no bound")
        self.assertEqual(list(summary["reasons"]), ["silent, seed 7: off by 0.2 m, 0.1 deg"])

    def test_a_signal_is_a_crash(self):
        failure = {"error": "ended", "exit_code": -11, "command": ["/bin/plumbline_map"]}
        self.assertEqual(rigs.failure_row(failure, {})["outcome"], "crash")
        self.assertEqual(rigs.failure_row({**failure, "exit_code": 1}, {})["outcome"], "flagged")

    def test_a_bound_is_read(self):
        with tempfile.TemporaryDirectory() as name:
            flags = ["plumbline_bound", f"--output={name}/bound"]
            script = pathlib.Path(name) / "bound.py"
            script.write_text(BOUND, encoding="utf-8")
            rigs.job_runner.subprocess.run([sys.executable, script, *flags[1:]], check=True)
            bound = rigs.bound_row(pathlib.Path(name) / "bound", {})
        self.assertAlmostEqual(bound["position_m"], math.sqrt(0.010002 / 2))
        self.assertEqual(bound["walls_m"], {"17": 0.002})
        self.assertEqual(bound["open"], ["height", "heading"])


class RunTest(ScriptTest):
    script = "experiments/rigs.py"

    def setUp(self):
        super().setUp()
        program = self.binaries / "plumbline_bound"
        program.write_text(BOUND, encoding="utf-8")
        program.chmod(0o755)

    def test_each_rig_in_each_world(self):
        # The stand-in's largest error is 1 cm times the seed.
        self.set_control("fail_6")
        result = self.run_script("paper", "zebedee", "--worlds", "corridor", "duplex_a_stairs",
                                 "--first-seed", "5")
        self.check_done(result)
        table = json.loads((self.output / "rigs.json").read_text())
        self.assertEqual(len(table["cells"]), 6)
        self.assertEqual(len(table["runs"]), 12)
        # The stand-in of plumbline_bound does not say that it knows the IMU.
        self.assertEqual([row["rig"] for row in table["bounds"]], ["paper"] * 3)
        self.assertIn("6 right, 6 flagged", result.stdout)
        self.assertIn("| `paper` | 1/1/0 | 5, ", result.stdout)
        self.assertIn("| no bound | 0 % | lost in 6 |", result.stdout)
        rig = yaml.safe_load((self.output / "experiments" / "corridor_cart_zebedee_rig.yaml")
                             .read_text(encoding="utf-8"))
        self.assertEqual(rig, rigs.read_rig("zebedee"))

    def test_another_rig_of_the_folder_and_no_further_bound(self):
        arguments = ("spinning", "--worlds", "ramp", "--carriages", "cart", "--no-bounds")
        self.check_done(self.run_script(*arguments))
        self.assertNotIn("ramp_cart_spinning_bound", self.entries())
        self.check_done(self.run_script(*arguments[:-1]))
        result = self.run_script(*arguments, "--seeds", "3")
        self.assertIn("| height, heading | 0 % |", result.stdout)

    def test_unknown_rig(self):
        self.check_error("no rig none in", "none")


if __name__ == "__main__":
    unittest.main()

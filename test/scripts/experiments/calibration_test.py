#!/usr/bin/python3
"""Tests scripts/experiments/calibration.py: its arithmetic, and its runs with stand-ins for the
programs."""

import json
import math
import pathlib
import sys
import unittest

import numpy as np
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import calibration  # noqa: E402

RIG = {"scanners": [
    {"name": name, "body_from_scanner": {"translation": [0.1, 0.2, 0.3],
                                         "rotation_rpy_deg": [10.0, -20.0, 30.0]},
     "time_offset_s": 0.5, "uncertainty": {"rotation_deg": 0}} for name in ("top", "left")]}


def parameter(name, value, sigma, prior=1.0, observed=True):
    return {"name": name, "value": value, "sigma": sigma, "prior_sigma": prior,
            "observed": observed}


def two_scanners(parameters, covariance):
    return {"scanners": [{"name": "top", "parameters": [parameter("roll_deg", 0.0, 0.0, 0.0)]},
                         {"name": "left", "parameters": parameters}], "covariance": covariance}


class WrongRigTest(unittest.TestCase):
    def test_the_correction_makes_it_right(self):
        text, truth = calibration.wrong_rig(RIG, (5.0, 0.05, 0.02, 0.03), None, 7)
        top, left = yaml.safe_load(text)["scanners"]
        self.assertNotIn("uncertainty", left)
        for was, scanner in zip(RIG["scanners"], (top, left)):
            off = truth[scanner["name"]]
            turn = calibration.turn_of(np.radians([off[key] for key in calibration.KINDS["deg"]]))
            pose = scanner["body_from_scanner"]
            np.testing.assert_allclose(
                turn @ calibration.rotation_of(pose["rotation_rpy_deg"]),
                calibration.rotation_of(was["body_from_scanner"]["rotation_rpy_deg"]), atol=1e-12)
            shift = [off[key] for key in calibration.KINDS["m"]]
            np.testing.assert_allclose(np.array(pose["translation"]) + shift,
                                       was["body_from_scanner"]["translation"])
            self.assertAlmostEqual(scanner["time_offset_s"] + off["time_s"], 0.5)
            self.assertAlmostEqual(scanner["range_bias_m"] + off["range_m"], 0.0)
            self.assertAlmostEqual(abs(off["range_m"]), 0.03)
        self.assertEqual(truth["top"]["roll_deg"], 0.0)
        turned = [truth["left"][key] for key in calibration.KINDS["deg"]]
        self.assertAlmostEqual(math.hypot(*turned), 5.0)
        self.assertEqual(RIG["scanners"][1]["uncertainty"], {"rotation_deg": 0})

    def test_states_what_it_is_told_to(self):
        text, _ = calibration.wrong_rig(RIG, (1, 1, 1, 1), (5, 0.05, 0.02, 0.03), 7)
        for scanner in yaml.safe_load(text)["scanners"]:
            self.assertEqual(scanner["uncertainty"], {"rotation_deg": 5.0, "translation_m": 0.05,
                                                      "time_s": 0.02, "range_m": 0.03})


class FiguresTest(unittest.TestCase):
    TRUTH = {"left": {"roll_deg": 1.0, "z_m": 0.5, "time_s": 0.02}}
    BOUND = two_scanners([parameter("roll_deg", 0, 0.03), parameter("z_m", 0, 0.9, observed=False),
                          parameter("time_s", 0, 0.001)], np.eye(3).tolist())

    def test_errors_of_what_the_bound_shows(self):
        found = two_scanners([parameter("roll_deg", 1.06, 0.02),
                              parameter("z_m", 0.0, 0.9, observed=False),
                              parameter("time_s", 0.017, 0.002)],
                             [[4e-4, 0.0, 2e-5], [0.0, 0.81, 0.0], [2e-5, 0.0, 4e-6]])
        figures = calibration.figures_of(found, self.BOUND, self.TRUTH)
        self.assertAlmostEqual(figures["deg"], 0.06)
        self.assertAlmostEqual(figures["deg_normalised"], 3.0)
        self.assertAlmostEqual(figures["s_normalised"], 1.5)
        self.assertEqual(figures["m"], 0.0)  # the height is open
        self.assertEqual(figures["freedom"], 2)
        # 3 and -1.5 standard deviations, correlated by 0.5:
        # (9 + 2.25 - 2 * 0.5 * 3 * -1.5) / (1 - 0.25)
        self.assertAlmostEqual(figures["nees"], 21.0)
        self.assertEqual(figures["open"], "z_m of left")
        found["scanners"][1]["parameters"][2]["observed"] = False
        self.assertEqual(calibration.figures_of(found, self.BOUND, self.TRUTH)["open"],
                         "z_m, time_s of left")

    def test_bound_of_a_kind(self):
        bound = two_scanners([parameter("roll_deg", 0, 0.03), parameter("yaw_deg", 0, 0.04)],
                             np.eye(2).tolist())
        self.assertAlmostEqual(calibration.bound_of_kind(bound, "deg"), math.sqrt(0.00125))
        self.assertEqual(calibration.bound_of_kind(bound, "s"), 0.0)

    def test_intervals_are_those_of_chi_square(self):
        # From tables: 2.5 % and 97.5 % of 10 degrees of freedom lie at 3.247 and 20.483, of 100 at
        # 74.222 and 129.561.
        for freedom, low, high, digits in ((10, 0.3247, 2.0483, 2), (100, 0.74222, 1.29561, 3)):
            found = calibration.chi_square_interval(freedom)
            self.assertAlmostEqual(found[0], low, digits)
            self.assertAlmostEqual(found[1], high, digits)

    def row(self, factor, **more):
        return {"experiment": "hall", "right": True, "verdict": "consistent", "nees": 2.0 * factor,
                "freedom": 2, "open": "z_m of left" if factor < 2 else "nothing",
                "errors": dict.fromkeys(calibration.MAP_ERRORS, 0.001 * factor),
                "right_errors": {"exact": dict.fromkeys(calibration.MAP_ERRORS, 0.001)},
                **{kind: 0.0 for kind in calibration.KINDS},
                **{f"{kind}_normalised": 0.0 for kind in calibration.KINDS},
                "deg": 0.03 * factor, "deg_normalised": factor, **more}

    def test_summary_over_runs(self):
        rows = [self.row(1), self.row(7), {"experiment": "hall", "seed": 3, "error": "lost"}]
        text = calibration.summary_of("hall", rows, self.BOUND)
        self.assertIn("hall: 2 of 3 right, 2 consistent, 5.00 mm rms", text)
        self.assertIn("open: z_m of left; named: nothing (1 of 2); z_m of left (1 of 2)", text)
        self.assertIn("0.1500 deg, 5.00 stated standard deviations, 5.00 of the bound 0.0300",
                      text)
        self.assertIn("NEES 4.000, OUTSIDE ", text)
        self.assertIn("(4 degrees of freedom)", text)
        self.assertIn("known exactly: positions 5.00, rotations 5.00", text)
        self.assertNotIn("as uncertain", text)
        self.assertNotIn("mm of range,", text)  # the bound has none
        self.assertEqual(calibration.summary_of("hall", rows[2:], self.BOUND),
                         "hall: 0 of 1 right, 0 consistent")


class CalibrationTest(ScriptTest):
    script = "experiments/calibration.py"

    def setUp(self):
        super().setUp()
        # Writes what stands below as the bound of any experiment.
        program = self.binaries / "plumbline_bound"
        program.write_text("#!/usr/bin/python3 -ES\nimport pathlib, sys\n"
                           "output = pathlib.Path(sys.argv[-1].split('=')[1])\n"
                           f"output.mkdir()\n(output / 'calibration.json').write_text("
                           f"{json.dumps(FiguresTest.BOUND)!r})\n")
        program.chmod(0o755)

    def test_a_run_without_calibration_is_an_error_and_named(self):
        result = self.run_script("plain", "--seeds", "2", "--stated", "5", "0.05", "0.02", "0.02")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("Traceback"), 0, result.stderr)
        self.assertIn("plain 1: the programs did not write result/calibration.json", result.stdout)
        self.assertIn("plain: 0 of 2 right", result.stdout)
        rig = yaml.safe_load((self.output / "experiments" / "plain_rig.yaml").read_text())
        self.assertEqual({scanner["uncertainty"]["time_s"] for scanner in rig["scanners"]}, {0.02})

    def test_unknown_experiment(self):
        self.check_error("no case none in", "none")


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests scripts/experiments/design_rig.py: its rigs, its arithmetic, and its runs with stand-ins for the
programs."""

import csv
import json
import math
import pathlib
import sys
import tempfile
import unittest

import numpy as np
import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import calibration  # noqa: E402
import design_rig  # noqa: E402
import job_runner  # noqa: E402

PAPER_RIG = job_runner.ROOT / "configs" / "rigs" / "paper.yaml"


def rotation(scanner):
    return calibration.rotation_of(scanner["body_from_scanner"]["rotation_rpy_deg"])


def row(rig, wall_mm, experiment="corridor", **design):
    return {"rig": rig, "experiment": experiment, "design": {**design_rig.PAPER, **design},
            "wall_mm": wall_mm, "position_mm": 2.0, "rotation_deg": 0.1, "wall_deg": 0.1,
            "worst_mm": 3.0, "translation_mm": 1.0, "open": []}


class RigTest(unittest.TestCase):
    def test_the_papers_design_is_the_papers_rig(self):
        shipped = yaml.safe_load(PAPER_RIG.read_text(encoding="utf-8"))["scanners"]
        made = design_rig.rig_of(design_rig.PAPER, (0, 0, 0, 0))["scanners"]
        for a, b in zip(shipped, made):
            self.assertEqual(a["name"], b["name"])
            np.testing.assert_allclose(rotation(a), rotation(b), atol=1e-12)
            for key in ("beams", "field_of_view_deg", "scan_rate_hz", "range_noise_m"):
                self.assertEqual(a[key], b[key], key)
            self.assertEqual(a["body_from_scanner"]["translation"],
                             b["body_from_scanner"]["translation"])

    def test_scan_planes_are_tilted_as_asked(self):
        design = {**design_rig.PAPER, "tilt": 60.0, "azimuth": 30.0, "level_tilt": 20.0}
        normals = [rotation(scanner)[:, 2]
                   for scanner in design_rig.rig_of(design, (0, 0, 0, 0))["scanners"]]
        tilts = [math.degrees(math.acos(abs(normal[2]))) for normal in normals]
        np.testing.assert_allclose(tilts, [20.0, 60.0, 60.0], atol=1e-9)
        np.testing.assert_allclose(normals[0][1], 0.0, atol=1e-12)
        for normal, azimuth in zip(normals[1:], (30.0, -30.0)):
            self.assertAlmostEqual(math.degrees(math.atan2(normal[1], normal[0])), azimuth)

    def test_numbers_of_scanners(self):
        for number, names in ((2, ["left", "right"]), (3, ["top", "left", "right"]),
                              (5, ["top", "left", "right", "back", "front"])):
            design = {**design_rig.PAPER, "number": number}
            self.assertEqual([mounting[0] for mounting in design_rig.mountings(design)], names)

    def test_the_gap_turns_in_the_scan_plane(self):
        a, b = (design_rig.rig_of({**design_rig.PAPER, "gap": gap}, (0, 0, 0, 0))["scanners"][1]
                for gap in (0.0, 90.0))
        np.testing.assert_allclose(rotation(a)[:, 2], rotation(b)[:, 2], atol=1e-12)
        np.testing.assert_allclose(rotation(a)[:, 1], rotation(b)[:, 0], atol=1e-12)

    def test_designs_differ_and_the_papers_is_first(self):
        designs = design_rig.designs()
        self.assertEqual(next(iter(designs)), "paper")
        self.assertEqual(len({json.dumps(design) for design in designs.values()}), len(designs))


class ArithmeticTest(unittest.TestCase):
    def test_best_rigs_are_the_most_exact_ones_in_all_experiments(self):
        rows = [row("paper", 2.0), row("paper", 4.0, "office"),
                row("a", 1.0), row("a", 8.0, "office"),     # 0.5 and 2 times
                row("b", 1.0), row("b", 4.0, "office"),     # 0.5 and 1
                row("c", 0.1),                              # not in the office
                row("e", 0.1, rate=80.0), row("e", 0.1, "office", rate=80.0),
                {"rig": "d", "experiment": "corridor", "design": {}, "error": "no"}]
        self.assertEqual(design_rig.best_rigs(rows), ["b", "a"])

    def test_ratios_stand_by_tilt_and_azimuth(self):
        rows = [row("paper", 2.0), row("x", 3.0, tilt=60.0, azimuth=30.0),
                row("y", 9.0, tilt=60.0, azimuth=30.0, rate=10.0)]
        ratios = design_rig.ratios_of(rows, "corridor", "wall_mm")
        at = design_rig.TILTS.index(60.0), design_rig.AZIMUTHS.index(30.0)
        self.assertEqual(ratios[at], 1.5)
        self.assertEqual(np.isfinite(ratios).sum(), 2)

    def test_figures_are_read_from_a_bound(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder)
            planes = [{"type": "vertical", "sigma_angle_deg": 0.0, "sigma_distance_m": 1.0},
                      {"type": "vertical", "sigma_angle_deg": 0.2, "sigma_distance_m": 0.001},
                      {"type": "horizontal", "sigma_angle_deg": 0.0, "sigma_distance_m": 9.0}]
            (path / "planes.json").write_text(json.dumps(planes), encoding="utf-8")
            parameter = {"prior_sigma": 1.0, "value": 0.0, "observed": True}
            described = {"unobserved": ["height of scanner top"], "covariance": [], "scanners": [
                {"name": "top", "parameters": [{**parameter, "name": "roll_deg", "sigma": 0.3},
                                               {**parameter, "name": "yaw_deg", "sigma": 0.4},
                                               {**parameter, "name": "pitch_deg", "sigma": 9.0,
                                                "observed": False},
                                               {**parameter, "name": "x_m", "sigma": 0.002}]}]}
            (path / "calibration.json").write_text(json.dumps(described), encoding="utf-8")
            with open(path / "trajectory_covariance.csv", "w", encoding="utf-8",
                      newline="") as file:
                writer = csv.writer(file)
                writer.writerow(["t", "px_px", "py_py", "pz_pz"])
                writer.writerows([[0, 0, 0, 0], [1, 1e-6, 4e-6, 4e-6], [2, 16e-6, 0, 0]])
            figures = design_rig.row_of(path, {"rig": "paper"})
        self.assertAlmostEqual(figures["wall_mm"], 1.0)
        self.assertAlmostEqual(figures["wall_deg"], 0.2)
        self.assertAlmostEqual(figures["position_mm"], 3.5)
        self.assertAlmostEqual(figures["worst_mm"], 4.0)
        self.assertAlmostEqual(figures["rotation_deg"], math.sqrt(0.125))
        self.assertAlmostEqual(figures["translation_mm"], 2.0)
        self.assertEqual(figures["open"], ["height of scanner top"])


class RunTest(ScriptTest):
    script = "experiments/design_rig.py"

    def test_bounds_that_fail_are_named(self):
        program = self.binaries / "plumbline_bound"
        program.write_text("#!/bin/sh\nexit 1\n", encoding="utf-8")
        program.chmod(0o755)
        result = self.run_script("corridor")
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stderr.count("Traceback"), 0, result.stderr)
        self.assertIn("| tilt 30 deg, azimuth 0 deg |", result.stdout)
        self.assertTrue((self.output / "design_rig.png").exists())

    def test_unknown_experiment(self):
        self.check_error("no case none in", "none")


if __name__ == "__main__":
    unittest.main()

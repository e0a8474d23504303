#!/usr/bin/python3
"""Tests scripts/analysis/precision.py on runs whose errors are drawn here."""

import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "scripts" / "analysis" / "precision.py"
SIGMA_RAD = 2e-4
SIGMA_M = 1e-3
# Walls of a square, seen from inside on a way round it: normal, distance.
WALLS = [([0.0, 1.0, 0.0], -5.0), ([-1.0, 0.0, 0.0], -5.0),
         ([0.0, -1.0, 0.0], -5.0), ([1.0, 0.0, 0.0], -5.0)]


def plane(number, normal, distance, first_time, points=10000):
    normal = np.array(normal)
    along = np.cross([0, 0, 1.0], normal)
    corners = [distance * normal + a * along + [0, 0, z]
               for a, z in ((-5, 0), (5, 0), (5, 3), (-5, 3))]
    return {"id": number, "type": "vertical", "normal": list(normal), "distance": distance,
            "centre": list(np.mean(corners, axis=0)), "outline": [list(c) for c in corners],
            "num_points": points, "first_time": first_time, "last_time": first_time + 8}


def trajectory():
    """Eight sides of a square of 8 m, 10 s each, heading along the side."""
    lines = []
    for step in range(81):
        time, side = float(step), min(step // 10, 7)
        yaw = side * np.pi / 2
        lines.append(f"{time:.1f} {step % 10} 0 0 0 0 {np.sin(yaw / 2):.9f} {np.cos(yaw / 2):.9f}")
    return "\n".join(lines) + "\n"


def covariance_text(num_planes):
    names = [f"{i}:{name}" for i in range(num_planes) for name in ("angle", "d")]
    lines = ["plane,parameter," + ",".join(names)]
    for row, name in enumerate(names):
        values = np.zeros(len(names))
        values[row] = SIGMA_RAD ** 2 if name.endswith("angle") else SIGMA_M ** 2
        lines.append(name.replace(":", ",") + "," + ",".join(map(str, values)))
    return "\n".join(lines) + "\n"


def pose_covariances():
    upper = [1e-6 if i == j else 0.0 for i in range(6) for j in range(i, 6)]
    row = ",".join(map(str, upper))
    return "t\n" + "".join(f"{float(step)},{row}\n" for step in range(81))


class PrecisionTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        self.random = np.random.default_rng(1)

    def write_planes(self, directory, errors):
        """Two rounds past the four walls."""
        directory.mkdir(parents=True)
        planes = []
        for number in range(8):
            normal, distance = WALLS[number % 4]
            angle = np.arctan2(normal[1], normal[0]) + errors[number, 0]
            planes.append(plane(number, [np.cos(angle), np.sin(angle), 0.0],
                                distance + errors[number, 1], 10.0 * number))
        (directory / "planes.json").write_text(json.dumps(planes))
        (directory / "plane_covariance.csv").write_text(covariance_text(8))

    def write_run(self, number, scale, bias_rad=0.0):
        """bias_rad: of the first wall's angle."""
        directory = self.directory / "runs" / f"run_{number:04d}"
        errors = scale * self.random.normal(size=(8, 2)) * [SIGMA_RAD, SIGMA_M]
        errors[0, 0] += bias_rad
        self.write_planes(directory, errors)
        truth = [plane(number, normal, distance, 0.0)
                 for number, (normal, distance) in enumerate(WALLS)]
        (directory / "truth_planes.json").write_text(json.dumps(truth))
        (directory / "truth_trajectory.tum").write_text(trajectory())
        (directory / "trajectory.tum").write_text(trajectory())
        (directory / "trajectory_covariance.csv").write_text(pose_covariances())
        (directory / "evaluation.json").write_text(json.dumps({
            "model_from_truth": {"translation": [0, 0, 0], "rotation_xyzw": [0, 0, 0, 1]},
            "planes": {"list": [{"id": i, "status": "matched", "true_faces": [i % 4]}
                                for i in range(8)]}}))

    def write_bound(self):
        directory = self.directory / "bound"
        self.write_planes(directory, np.zeros((8, 2)))
        (directory / "faces.csv").write_text(
            "plane,face\n" + "".join(f"{i},{i % 4}\n" for i in range(8)))

    def write_ideal(self, number, share):
        """The best estimate of a run: its planes, off by a share of the run's errors."""
        planes = json.loads(
            (self.directory / "runs" / f"run_{number:04d}" / "planes.json").read_text())
        errors = []
        for entry, (normal, distance) in zip(planes, WALLS + WALLS):
            turn = np.arctan2(entry["normal"][1], entry["normal"][0])
            angle = (turn - np.arctan2(normal[1], normal[0]) + np.pi) % (2 * np.pi) - np.pi
            errors.append((share * angle, share * (entry["distance"] - distance)))
        directory = self.directory / "ideal" / f"run_{number:04d}"
        self.write_planes(directory, np.array(errors))
        (directory / "faces.csv").write_text(
            "plane,face\n" + "".join(f"{i},{i % 4}\n" for i in range(8)))

    def run_script(self, *more):
        return subprocess.run(
            [sys.executable, SCRIPT, self.directory / "runs", "--bound", self.directory / "bound",
             "--output", self.directory / "precision.json", *more],
            capture_output=True, text=True, check=False)

    def figures(self, scale):
        for number in range(100):
            self.write_run(number, scale)
        self.write_bound()
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads((self.directory / "precision.json").read_text())

    def test_errors_as_stated_have_ratio_and_nees_one(self):
        figures = self.figures(1.0)
        neighbours = figures["pairs"]["angle, outer, 1 corners"]
        self.assertAlmostEqual(neighbours["bound"], np.sqrt(2) * SIGMA_RAD, places=9)
        self.assertEqual(neighbours["pairs"], 7)
        for name in ("angle, outer, 1 corners", "distance, outer, 1 loops, centre"):
            pair = figures["pairs"][name]
            self.assertLess(abs(pair["ratio"] - 1), 4 * pair["ratio_error"], name)
            self.assertLess(abs(pair["nees"] - 1), 4 * pair["nees_error"], name)
        self.assertLess(abs(figures["nees"][0]["mean"] - 1), 0.15)

    def test_faces_by_themselves(self):
        for number in range(100):
            self.write_run(number, 1.0)
        self.write_bound()
        result = self.run_script("--faces")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("of 4 faces", result.stdout)
        figures = json.loads((self.directory / "precision.json").read_text())["pairs"]
        self.assertEqual(sorted(figures),
                         ["angle, walls from 2 m", "distance, walls from 2 m"])
        for name, bound in zip(sorted(figures), (SIGMA_RAD, SIGMA_M)):
            self.assertAlmostEqual(figures[name]["bound"], bound, places=9)
            self.assertLess(abs(figures[name]["ratio"] - 1), 4 * figures[name]["ratio_error"])
            self.assertLess(abs(figures[name]["nees"] - 1), 4 * figures[name]["nees_error"])

    def test_larger_errors_show(self):
        figures = self.figures(2.0)
        pair = figures["pairs"]["angle, outer, 1 corners"]
        self.assertLess(abs(pair["ratio"] - 2), 4 * pair["ratio_error"])
        self.assertFalse(figures["nees"][0]["inside"])

    def test_a_bias_is_told_from_chance(self):
        for bias_rad in (0.0, SIGMA_RAD):
            shutil.rmtree(self.directory / "runs", ignore_errors=True)
            for number in range(40):
                self.write_run(number, 1.0, bias_rad)
            if not (self.directory / "bound").exists():
                self.write_bound()
            result = self.run_script()
            self.assertEqual(result.returncode, 0, result.stderr)
            bias = json.loads((self.directory / "precision.json").read_text())["bias"]
            self.assertEqual(bias["quantities"], 40)  # 28 angles, 12 distances
            # For 40 independent ones it would be 3.4.
            self.assertGreater(bias["limit"], 2.5)
            self.assertLess(bias["limit"], 3.6)
            self.assertEqual(bias["largest"] > bias["limit"], bias_rad > 0.0, bias)
            self.assertEqual(bias["chance"] < 0.05, bias_rad > 0.0)
            self.assertIn("of all 40 quantities", result.stdout)

    def test_best_estimate_of_the_same_seeds(self):
        for number in range(10):
            self.write_run(number, 1.0)
        for number in range(8):
            self.write_ideal(number, 0.8)
        self.write_bound()
        result = self.run_script("--ideal", self.directory / "ideal")
        self.assertEqual(result.returncode, 0, result.stderr)
        figures = json.loads((self.directory / "precision.json").read_text())
        pair = figures["pairs"]["angle, outer, 1 corners"]
        self.assertEqual(pair["ideal_runs"], 8)
        self.assertAlmostEqual(pair["ideal_ratio"], 1 / 0.8, places=5)
        self.assertLess(pair["ideal_ratio_error"], 1e-4)
        self.assertIn("1.250 +- 0.000", result.stdout)
        result = self.run_script("--ideal", self.directory)
        self.assertIn("at least two of the runs' seeds", result.stderr)

    def test_window_is_judged_where_it_was_kept(self):
        for number in range(100):
            self.write_run(number, 1.0)
            run = self.directory / "runs" / f"run_{number:04d}"
            planes = json.loads((run / "planes.json").read_text())
            (run / "window_planes.json").write_text(json.dumps(planes[6:]))
            rows = (run / "plane_covariance.csv").read_text().splitlines()
            keep = [0, 1] + list(range(14, 18))
            (run / "window_plane_covariance.csv").write_text("".join(
                ",".join(line.split(",")[i] for i in keep) + "\n"
                for line in [rows[0]] + rows[13:]))
            # Between the instants of the truth, half as good as stated.
            error = 2e-3 * self.random.normal(size=(70, 3))
            (run / "window_trajectory.tum").write_text("".join(
                f"{step + 0.5} {step + 0.5 + x} {y} {z} 0 0 0 1\n" if step < 9 else ""
                for step, (x, y, z) in enumerate(error)))
            (run / "window_trajectory_covariance.csv").write_text(
                "\n".join(pose_covariances().splitlines()[:10]) + "\n")
        self.write_bound()
        result = self.run_script()
        self.assertEqual(result.returncode, 0, result.stderr)
        nees = json.loads((self.directory / "precision.json").read_text())["nees"]
        window = {entry["what"]: entry["mean"] for entry in nees if "window" in entry["what"]}
        planes, poses = (window[name] for name in sorted(window))
        self.assertLess(abs(planes - 1), 0.3)
        self.assertLess(abs(poses - 2), 0.3)  # positions 4, rotations 0

    def test_missing_file_is_named(self):
        for number in range(2):
            self.write_run(number, 1.0)
        self.write_bound()
        (self.directory / "bound" / "faces.csv").unlink()
        result = self.run_script()
        self.assertEqual(result.returncode, 1)
        self.assertIn("faces.csv", result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1)
        self.assertFalse((self.directory / "precision.json").exists())

    def test_too_few_runs_is_an_error(self):
        self.write_run(1, 1.0)
        self.assertIn("at least two runs", self.run_script().stderr)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests scripts/figures/figures.py on small inputs made here."""

import contextlib
import io
import json
import os
import pathlib
import shutil
import struct
import sys
import tempfile
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts" / "figures"))
# pylint: disable=wrong-import-position
import figures
import matplotlib.pyplot as plt
from normal_matrix_figure import control_point_runs

PLY_HEADER = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\n"
              "property float y\nproperty float z\nproperty double time\n"
              "property uchar scanner\nproperty int plane_id\nproperty float residual\n"
              "end_header\n")
CONFIG = "trajectory:\n  knot_interval_s: 0.1\n  min_scans_per_knot: 1.5\n"
# x, y, z, time, scanner, plane: a wall seen throughout, one at the end, floor, and a stray.
POINTS = [(3, 0.1 * i - 1, 1, 0.05 * i, i % 3, 1) for i in range(20)]
POINTS += [(-3, 0, 1, 0.95, 0, 2), (0, 0, 0, 0.45, 1, 3), (1, 1, 1, 0.5, 2, -1)]


def plane(number, kind, normal, outline):
    return {"id": number, "type": kind, "normal": normal, "outline": outline}


PLANES = [
    plane(1, "vertical", [-1, 0, 0], [[3, -2, 0], [3, 2, 0], [3, 2, 2], [3, -2, 2]]),
    plane(2, "vertical", [1, 0, 0], [[-3, 2, 0], [-3, -2, 0], [-3, -2, 2], [-3, 2, 2]]),
    plane(3, "horizontal", [0, 0, 1], [[-3, -2, 0], [3, -2, 0], [3, 2, 0], [-3, 2, 0]]),
]


def precision(runs):
    """As scripts/analysis/precision.py writes it; the error of one run's standard deviation is NaN."""
    error = 0.05 if runs > 1 else float("nan")
    pairs = {}
    for side in ("outer", "inner"):
        for number in (1, 2, 3):
            names = [f"angle, {side}, {number} corners",
                     f"distance, {side}, {number} loops, centre",
                     f"distance, {side}, {number} loops, corners"]
            for name in names:
                pairs[name] = {"runs": runs, "stddev": 2e-4 * number, "bound": 1.9e-4 * number,
                               "ratio_error": error}
    return {"pairs": pairs}


class FiguresTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = directory.name
        self.output = self.path("figures")
        for name in ("planes.json", "truth_planes.json"):
            self.write(name, json.dumps(PLANES))
        for name in ("trajectory.tum", "truth_trajectory.tum"):
            self.write(name, "0.0 0 0 0 0 0 0 1\n1.0 1 0 0 0 0 0 1\n")
        self.write("config_used.yaml", CONFIG)
        self.write("summary.json", json.dumps(
            {"scans": 5, "duration_s": 1.0, "control_points": 13, "motion": "spatial",
             "reference_plane_id": 1}))
        self.write("evaluation.json", json.dumps({
            "model_from_truth": {"translation": [0, 0, 0], "rotation_xyzw": [0, 0, 0, 1]}}))
        self.write("precision.json", json.dumps(precision(10)))
        self.write_map(POINTS)

    def path(self, name):
        return os.path.join(self.directory, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def write_map(self, points, count=None):
        with open(self.path("map.ply"), "wb") as file:
            file.write(PLY_HEADER.format(len(points) if count is None else count).encode())
            for point in points:
                file.write(struct.pack("<fffdBif", *point, 0.0))

    def arguments(self, figure):
        if figure in ("angles", "distances"):
            return [figure, self.path("precision.json")]
        return [figure, self.directory] + [self.directory] * (figure == "corridor")

    def run_script(self, *arguments):
        """Exit code and stderr; in this process, for matplotlib takes long to start."""
        command = ["figures.py", *arguments, "--output", self.output]
        stderr = io.StringIO()
        with mock.patch.object(sys, "argv", command), contextlib.redirect_stderr(stderr), \
                contextlib.redirect_stdout(io.StringIO()):
            try:
                code = figures.main()
            except SystemExit as error:
                code = error.code
        plt.close("all")
        return code, stderr.getvalue()

    def check_figure(self, figure):
        code, stderr = self.run_script(*self.arguments(figure))
        self.assertEqual((code, stderr), (0, ""))
        self.assertEqual(sorted(os.listdir(self.output)), [f"{figure}.pdf", f"{figure}.png"])
        for suffix, start in (("png", b"\x89PNG"), ("pdf", b"%PDF")):
            with open(os.path.join(self.output, f"{figure}.{suffix}"), "rb") as file:
                self.assertTrue(file.read().startswith(start))
        shutil.rmtree(self.output)

    def check_error(self, figure, name):
        code, stderr = self.run_script(*self.arguments(figure))
        self.assertEqual(code, 1, stderr)
        self.assertEqual(stderr.count("\n"), 1, stderr)
        self.assertIn(self.path(name), stderr)
        self.assertFalse(os.path.exists(self.output))

    def test_normal_matrix(self):
        self.check_figure("normal_matrix")

    def test_corridor(self):
        self.check_figure("corridor")

    def test_office(self):
        self.check_figure("office")

    def test_angles(self):
        self.check_figure("angles")

    def test_distances_of_one_run(self):
        self.write("precision.json", json.dumps(precision(1)))
        self.check_figure("distances")

    def test_truncated_map(self):
        self.write_map(POINTS, len(POINTS) + 1)
        self.check_error("office", "map.ply")

    def test_map_without_points_on_walls(self):
        self.write_map(POINTS[-2:])
        self.check_error("office", "map.ply")

    def test_settings_without_knot_interval(self):
        self.write("config_used.yaml", "trajectory: {}\n")
        self.check_error("normal_matrix", "config_used.yaml")

    def test_missing_evaluation(self):
        os.remove(self.path("evaluation.json"))
        self.check_error("corridor", "evaluation.json")

    def test_precision_without_the_quantity(self):
        self.write("precision.json", '{"pairs": {}}')
        self.check_error("angles", "precision.json")

    def test_half_a_figure_is_removed(self):
        save = plt.Figure.savefig

        def only_png(figure, path, **options):
            if options["format"] == "pdf":
                raise OSError(28, "No space left on device", path)
            save(figure, path, **options)

        with mock.patch.object(plt.Figure, "savefig", only_png):
            code, stderr = self.run_script(*self.arguments("angles"))
        self.assertEqual(code, 1)
        self.assertIn("angles.pdf", stderr)
        self.assertEqual(os.listdir(self.output), [])

    def test_output_that_is_a_file(self):
        self.write("figures", "")
        code, stderr = self.run_script(*self.arguments("angles"))
        self.assertEqual(code, 1)
        self.assertIn(self.output, stderr)

    def test_wrong_usage(self):
        self.assertEqual(self.run_script("poster", self.directory)[0], 2)
        self.assertEqual(self.run_script("corridor", self.directory)[0], 2)


class NormalMatrixTest(unittest.TestCase):
    def test_runs_of_control_points(self):
        runs = control_point_runs
        self.assertEqual(runs([]), [])
        self.assertEqual(runs([2]), [(2, 5)])
        # Intervals 0 and 4 touch control points 0 to 7, intervals 0 and 5 leave 4 out.
        self.assertEqual(runs([0, 4]), [(0, 7)])
        self.assertEqual(runs([0, 5]), [(0, 3), (5, 8)])


if __name__ == "__main__":
    unittest.main()

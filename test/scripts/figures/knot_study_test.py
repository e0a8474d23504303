#!/usr/bin/python3
"""Tests the splines and fits of scripts/figures/knot_study.py, and the script on few cases."""

import contextlib
import csv
import io
import math
import os
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts" / "figures"))
# pylint: disable=wrong-import-position
import knot_study
import matplotlib.pyplot as plt
from knot_study import (CUBIC, DEGREES, DURATION_S, FINE_STEP_S, Fits, Spline, basis,
                        densities, evaluated_instants, measurement_times)


def fit(degree, num_intervals, times, measured, weight=0.0):
    spline = Spline(degree, num_intervals)
    return spline, Fits(spline, times, measured, [weight], evaluated_instants())


def dense_rows(spline, times):
    """The rows of the spline as one matrix."""
    return spline.evaluate(np.eye(spline.num_control_points), times)


class SplineTest(unittest.TestCase):
    def test_basis_sums_to_one(self):
        u = np.linspace(0, 1, 20, endpoint=False)
        for degree in DEGREES:
            values = basis(degree, u)
            self.assertEqual(values.shape, (20, degree + 1))
            self.assertTrue(np.all(values >= 0))
            np.testing.assert_allclose(values.sum(axis=1), 1, atol=1e-14)

    def test_basis_of_a_cubic_spline_at_a_knot(self):
        np.testing.assert_allclose(basis(CUBIC, 0.0), [1 / 6, 4 / 6, 1 / 6, 0], atol=1e-15)

    def test_second_differences_are_accelerations_at_knots(self):
        spline = Spline(CUBIC, 16)
        control_points = np.random.default_rng(1).standard_normal((spline.num_control_points, 1))
        step, knot = 1e-3, 5
        before, at, after = spline.evaluate(
            control_points, knot * spline.spacing_s + step * np.array([-1, 0, 1]))
        acceleration = (before - 2 * at + after) / step**2
        expected = np.diff(control_points, n=2, axis=0)[knot] / spline.spacing_s**2
        np.testing.assert_allclose(acceleration, expected, atol=0.05)

    def test_determined_where_every_control_point_has_its_measurement(self):
        spline = Spline(CUBIC, 4)  # 7 control points, knots every 2 s
        self.assertTrue(spline.is_determined([0.5, 1.0, 1.5, 3.0, 5.0, 7.0, 7.5]))
        self.assertFalse(spline.is_determined([0.5, 1.0, 1.5, 3.0, 5.0, 7.0]))
        # As many measurements as control points, but none in the last interval.
        self.assertFalse(spline.is_determined([0.5, 1.0, 1.5, 3.0, 4.0, 5.0, 5.5]))


class FitsTest(unittest.TestCase):
    def test_cubic_polynomial_is_reproduced(self):
        times = measurement_times(10)
        instants = np.linspace(0, DURATION_S, 500, endpoint=False)

        def polynomial(t):
            return np.polyval([0.03, -0.2, 0.5, 1.0], t)[:, None]
        spline, fits = fit(CUBIC, 40, times, polynomial(times))
        error = spline.evaluate(fits.control_points[0], instants) - polynomial(instants)
        self.assertLess(np.abs(error).max(), 1e-10)
        spline, fits = fit(2, 40, times, polynomial(times))
        error = spline.evaluate(fits.control_points[0], instants) - polynomial(instants)
        self.assertGreater(np.abs(error).max(), 1e-6)

    def test_fit_is_that_of_dense_matrices(self):
        times = measurement_times(5)
        measured = np.sin(times)[:, None]
        weight = 3.0
        spline, fits = fit(4, 30, times, measured, weight)
        rows = dense_rows(spline, times)
        differences = np.diff(np.eye(spline.num_control_points), n=2, axis=0)
        gain = np.linalg.solve(rows.T @ rows + weight * differences.T @ differences, rows.T)
        np.testing.assert_allclose(fits.control_points[0], gain @ measured, atol=1e-10)
        hat = dense_rows(spline, evaluated_instants()) @ gain
        self.assertAlmostEqual(fits.stddev[0], math.sqrt(np.mean(np.sum(hat**2, axis=1))))

    def test_standard_deviation_falls_with_the_root_of_the_spacing(self):
        times = measurement_times(20)
        for degree in DEGREES:
            stddevs = [fit(degree, count, times, times[:, None])[1].stddev[0]
                       for count in (80, 40, 20)]  # knots every 0.1, 0.2, 0.4 s
            for dense, wide in zip(stddevs, stddevs[1:]):
                self.assertAlmostEqual(dense / wide, math.sqrt(2), delta=0.05)

    def test_prior_makes_the_standard_deviation_smaller(self):
        times = measurement_times(20)
        weights = [0.0, 1.0, 100.0]
        fits = Fits(Spline(CUBIC, 80), times, times[:, None], weights, evaluated_instants())
        self.assertTrue(np.all(np.diff(fits.stddev) < 0))

    def test_undetermined_without_prior(self):
        times = measurement_times(5)  # every 33 ms
        weights = [0.0, 1e-3]
        fits = Fits(Spline(CUBIC, 320), times, times[:, None], weights, evaluated_instants())
        self.assertTrue(np.all(np.isnan(fits.control_points[0])))
        self.assertTrue(np.isnan(fits.stddev[0]))
        self.assertTrue(np.all(np.isfinite(fits.control_points[1])))
        self.assertTrue(np.isfinite(fits.stddev[1]))
        self.assertEqual(knot_study.error_text(fits.stddev[0]), "undetermined")


class MotionTest(unittest.TestCase):
    def test_density_of_white_noise(self):
        # Accelerations of density q, constant over steps of a millisecond.
        q, step = 0.3, round(1e-3 / FINE_STEP_S)
        draws = np.random.default_rng(1).standard_normal((20000, 6)) * q / math.sqrt(1e-3)
        velocity = np.cumsum(np.repeat(draws, step, axis=0), axis=0) * FINE_STEP_S
        motion = np.cumsum(velocity, axis=0) * FINE_STEP_S
        np.testing.assert_allclose(densities(motion), q, rtol=0.1)

    def test_motions_are_as_described(self):
        fast = knot_study.fast_turn()
        rate = np.degrees(np.abs(np.diff(fast[:, 5]))) / FINE_STEP_S
        self.assertAlmostEqual(rate.max(), 200.0, delta=1e-6)
        speed = np.hypot(*np.diff(knot_study.walk()[:, :2], axis=0).T) / FINE_STEP_S
        np.testing.assert_allclose(speed, 1.0, atol=1e-6)


class ScriptTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.output = os.path.join(directory.name, "figures", "knots.png")
        self.csv = os.path.join(directory.name, "knots.csv")

    def run_script(self, *arguments):
        stdout, stderr = io.StringIO(), io.StringIO()
        few = {"SCAN_RATES_HZ": (5,), "DEGREES": (2, 3), "SPACINGS_PER_OCTAVE": 0.4}
        with mock.patch.multiple(knot_study, **few), \
                mock.patch.object(sys, "argv", ["knot_study.py", *arguments]), \
                contextlib.redirect_stdout(stdout), contextlib.redirect_stderr(stderr):
            code = knot_study.main()
        plt.close("all")
        return code, stdout.getvalue(), stderr.getvalue()

    def test_table_figure_and_numbers(self):
        code, stdout, stderr = self.run_script("--output", self.output, "--csv", self.csv)
        self.assertEqual((code, stderr), (0, ""))
        lines = stdout.splitlines()
        self.assertEqual(len(lines), 2 + 2 * 3)
        self.assertEqual({line.count("|") for line in lines}, {12})
        # 25 ms is less than the measurements' 33 ms.
        self.assertTrue(lines[2].startswith("| cart | 5 | none |"))
        self.assertIn("| undetermined |", lines[2])
        self.assertNotIn("undetermined", lines[3])
        with open(self.output, "rb") as file:
            self.assertTrue(file.read().startswith(b"\x89PNG"))
        with open(self.csv, encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        unit = [row for row in rows if row["order"] == "4" and row["spacing_s"] == "0.125"]
        self.assertEqual({row["relative_work"] for row in unit}, {"1"})
        for row in rows:
            if row["error_point_mm"] != "undetermined":
                self.assertAlmostEqual(
                    math.hypot(float(row["bias_point_mm"]), float(row["stddev_point_mm"]))
                    / float(row["error_point_mm"]), 1, delta=1e-3)

    def test_output_that_can_not_be_written(self):
        with open(os.path.dirname(self.output), "w", encoding="utf-8"):
            pass
        code, _, stderr = self.run_script("--output", self.output)
        self.assertEqual(code, 1)
        self.assertEqual(stderr.count("\n"), 1, stderr)
        self.assertIn("knot_study.py: ", stderr)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Studies how the order and the knot spacing of the trajectory's spline change the error of poses.

Fits uniform B-splines to simulated pose measurements of three motions by linear algebra alone,
with and without a prior on the motion. Prints a table in Markdown and draws a figure.
docs/knots.md says what is modelled and what follows.
"""

import argparse
import csv
import dataclasses
import itertools
import math
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from figure_files import BLACK, BLUE, GREEN, ORANGE, VERMILION

DURATION_S = 8.0  # of the stretch that a spline is fitted to; every spacing divides it
MARGIN_S = 1.0    # at both ends of it, where errors are larger: not evaluated

DEGREES = (2, 3, 4, 5)
CUBIC = 3
SCAN_RATES_HZ = (5, 10, 20, 40)
SPACINGS_SCANS = (1 / 8, 40)  # shortest and longest spacing, scan periods
SPACINGS_PER_OCTAVE = 3
TABLE_SPACINGS_S = (0.025, 0.05, 0.125)
REFERENCE_SPACING_S = 0.125   # of the cubic spline that is the unit of the relative work

MEASUREMENTS_PER_SCAN = 6
# Standard deviation of a pose from one scan by axis, for range noise of 3 cm. The axes of a pose
# are x, y, z / m and roll, pitch, yaw / rad.
SCAN_STDDEV = np.array([0.0015] * 3 + [math.radians(0.05)] * 3)
MEASUREMENT_STDDEV = math.sqrt(MEASUREMENTS_PER_SCAN) * SCAN_STDDEV
NOISE_FACTORS = {"3 cm": 1.0, "1 cm": 1 / 3}

# Axes whose accelerations share a density: horizontal, vertical, tilt, yaw.
MOTION_KINDS = ((0, 1), (2,), (3, 4), (5,))
DENSITY_LAG_S = 0.05  # of the second differences that a density is estimated from

# Distance to the point whose displacement sums up the error of a pose.
POINT_DISTANCE_M = 3.0

# Errors are averaged over shifts of the motion against the knots, since a turn that begins at a
# knot is followed better than others. The shifts reach over a spacing, or over MAX_SHIFT_S.
NUM_SHIFTS = 3
MAX_SHIFT_S = 0.5
FINE_STEP_S = 1e-4   # of the samples of a motion, which is linear between them
DENSE_STEP_S = 2e-3  # of the instants at which the bias is evaluated
NUM_INSTANTS = 100   # at which the standard deviation is evaluated
FINE_TIMES = FINE_STEP_S * np.arange(round((DURATION_S + MAX_SHIFT_S) / FINE_STEP_S) + 1)

# Ratio of a pivot to its diagonal element below which the pivot is rounding error.
SINGULAR_PIVOT = 1e-12

NEAR_BEST = 1.05       # ratio to the least error up to which an error counts as the best
BIAS_SPACING_S = 0.05  # of the table's largest bias

COLOURS = {2: ORANGE, 3: BLUE, 4: GREEN, 5: VERMILION}
FIGURE_DPI = 110
FIGURE_SPACINGS_MS = (3, 400)
FIGURE_TICKS_MS = (5, 10, 25, 50, 125, 250)
FIGURE_ERRORS_MM = (2, 60)
FIGURE_TICKS_MM = (2, 5, 10, 20, 50)


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--output", metavar="PNG", default="docs/images/knot_study.png",
                        help="the figure (default: %(default)s)")
    parser.add_argument("--csv", metavar="FILE",
                        help="also write bias, standard deviation and error of every case")
    return parser.parse_args()


# Motions: the true poses. Turns begin at instants that are no multiples of knot spacings.

def steps(changes):
    """A piecewise constant function, from its changes (instant, amount)."""
    return sum(amount * (FINE_TIMES >= instant) for instant, amount in changes)


def smoothed(values, duration_s):
    """Turns steps into raised cosines of this duration."""
    half = round(0.5 * duration_s / FINE_STEP_S)
    window = 1 + np.cos(np.pi * np.arange(-half, half + 1) / (half + 1))
    return np.convolve(np.pad(values, half, mode="edge"), window / window.sum(), mode="valid")


def integral(values):
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]))]) * FINE_STEP_S


def poses(speed_m_s, yaw_rate_deg_s, swings):
    """Poses of a rig that looks where it goes."""
    yaw = integral(np.radians(yaw_rate_deg_s))
    z, roll, pitch = (amplitude * np.sin(2 * np.pi * frequency * FINE_TIMES)
                      for amplitude, frequency in swings)
    return np.column_stack([integral(speed_m_s * np.cos(yaw)), integral(speed_m_s * np.sin(yaw)),
                            z, np.radians(roll), np.radians(pitch), yaw])


def turns(starts, duration_s, rate):
    """Changes of the yaw rate for turns that go to the left and to the right by turns."""
    changes = []
    for number, start in enumerate(starts):
        signed = rate * (-1) ** number
        changes += [(start, signed), (start + duration_s, -signed)]
    return changes


# Amplitude and frequency / Hz of z / m, roll / deg and pitch / deg.
VIBRATION = ((0.0002, 12.0), (0.02, 9.0), (0.02, 13.0))
WALKING = ((0.02, 1.8), (3.0, 0.9), (3.0, 1.1))


def cart():
    speed = steps([(0, 0.5), (1.7321, 0.4), (3.4632, -0.6), (5.9161, 0.5)])
    rate = steps(turns([1.3178, 3.1627, 5.0991, 7.0711], 1.0137, 60.0))
    return poses(smoothed(speed, 0.2), smoothed(rate, 0.2), VIBRATION)


def walk():
    rate = steps(turns([1.3137, 2.8719, 4.4356, 5.9971, 7.5498], math.pi / 4, 115.0))
    return poses(np.ones_like(FINE_TIMES), rate, WALKING)


def fast_turn():
    rate = steps(turns([1.3784, 2.5981, 3.7417, 4.8989, 6.0828, 7.2801], 0.4472, 200.0)
                 + turns([2.2361, 3.3166, 4.5826, 5.7446, 6.7823], 0.035, 3.6 / 0.035))
    return poses(np.ones_like(FINE_TIMES), rate, VIBRATION)


MOTIONS = {"cart": cart, "walk": walk, "fast turn": fast_turn}


def densities(motion):
    """Amplitude spectral densities of the accelerations by axis, m/s^2/sqrt(Hz) and
    rad/s^2/sqrt(Hz): those of white noise with the motion's second differences.

    A second difference over its squared lag is the mean acceleration under a triangle of twice
    the lag: of white noise, its variance is 2/3 density^2 / lag.
    """
    lag = round(DENSITY_LAG_S / FINE_STEP_S)
    second = (motion[2 * lag:] - 2 * motion[lag:-lag] + motion[:-2 * lag]) / DENSITY_LAG_S**2
    density = np.empty(motion.shape[1])
    for axes in MOTION_KINDS:
        density[list(axes)] = np.sqrt(1.5 * DENSITY_LAG_S * np.mean(second[:, axes]**2))
    return density


class Truth:
    """The true poses of all motions, and the densities of their accelerations."""

    def __init__(self):
        self.motions = [motion() for motion in MOTIONS.values()]
        self.densities = np.array([densities(motion) for motion in self.motions])

    def poses(self, times, spacing_s):
        """Poses by instant, shift against the knots, motion and axis."""
        shifts = min(spacing_s, MAX_SHIFT_S) * np.arange(NUM_SHIFTS) / NUM_SHIFTS
        instants = np.add.outer(times, shifts)
        return np.stack([np.stack([np.interp(instants, FINE_TIMES, axis) for axis in motion.T],
                                  axis=-1) for motion in self.motions], axis=2)

    def prior_weights(self, spacing_s):
        """Weights of squared second differences of control points, by motion and axis.

        Accelerations at knots, the second differences over the spacing squared, have the
        standard deviation density / sqrt(spacing). Measurements have the weight 1.
        """
        return (MEASUREMENT_STDDEV / self.densities)**2 / spacing_s**3


# Splines, and least squares with symmetric band matrices: bands[i, j] is the element (i, i + j).

def basis(degree, u):
    """The degree + 1 B-splines that are not zero at the place u of a knot interval, u in [0, 1)."""
    values = np.ones(np.shape(u) + (1,))
    u = np.expand_dims(u, -1)
    for d in range(1, degree + 1):
        number = np.arange(d + 1)
        before = np.pad(values, [(0, 0)] * (u.ndim - 1) + [(1, 0)])
        here = np.pad(values, [(0, 0)] * (u.ndim - 1) + [(0, 1)])
        values = ((u + d - number) * before + (1 - u + number) * here) / d
    return values


class Spline:
    """A uniform B-spline over the stretch: values at instants as rows times control points."""

    def __init__(self, degree, num_intervals):
        self.degree = degree
        self.num_intervals = num_intervals
        self.spacing_s = DURATION_S / num_intervals
        self.num_control_points = num_intervals + degree

    def rows(self, times):
        """First control point of each instant, and the values of its B-splines."""
        place = np.asarray(times) / self.spacing_s
        first = np.clip(np.floor(place).astype(int), 0, self.num_intervals - 1)
        return first, basis(self.degree, place - first)

    def evaluate(self, control_points, times):
        first, values = self.rows(times)
        values = values.reshape(values.shape + (1,) * (control_points.ndim - 1))
        return sum(values[:, j] * control_points[first + j] for j in range(self.degree + 1))

    def right_side(self, times, measured):
        """Rows transposed times measurements, one column of them per axis."""
        first, values = self.rows(times)
        return np.column_stack([
            sum(np.bincount(first + j, values[:, j] * axis, self.num_control_points)
                for j in range(self.degree + 1)) for axis in measured.T])

    def unit_rows(self, times):
        """The row of each instant as a column."""
        first, values = self.rows(times)
        columns = np.zeros((self.num_control_points, len(first)))
        for j in range(self.degree + 1):
            columns[first + j, np.arange(len(first))] = values[:, j]
        return columns

    def normal_matrix(self, times):
        """Of measurements with the weight 1."""
        return bands_of(*self.rows(times), self.num_control_points, self.degree + 1)

    def prior_matrix(self):
        """Of second differences of neighbouring control points."""
        first = np.arange(self.num_control_points - 2)
        differences = np.tile([1.0, -2.0, 1.0], (len(first), 1))
        return bands_of(first, differences, self.num_control_points, self.degree + 1)

    def is_determined(self, times):
        """Whether every control point has a measurement of its own in its support, in ascending
        order: Schoenberg and Whitney's condition. The times ascend."""
        first, values = self.rows(times)
        # The last B-spline is zero at the knot where it begins.
        last = first + self.degree - (values[:, -1] == 0)
        own = 0
        for control_point in range(self.num_control_points):
            while own < len(first) and last[own] < control_point:
                own += 1
            if own == len(first) or first[own] > control_point:
                return False
            own += 1
        return True


def bands_of(first, values, size, width):
    """The normal matrix of rows that hold `values` from column `first` on."""
    bands = np.zeros((size, width))
    for j in range(values.shape[1]):
        for k in range(j, values.shape[1]):
            bands[:, k - j] += np.bincount(first + j, values[:, j] * values[:, k], size)
    return bands


def band_product(bands, columns):
    """The symmetric band matrix times columns."""
    product = bands[:, :1] * columns
    for j in range(1, bands.shape[1]):
        product[:-j] += bands[:-j, [j]] * columns[j:]
        product[j:] += bands[:-j, [j]] * columns[:-j]
    return product


def solve_bands(bands, right):
    """Solves band systems (systems, size, width) with the same right sides (size, columns).

    The solution of a system that is singular to double precision is NaN. All systems are
    eliminated at once, since numpy's calls take the time, not their arithmetic.
    """
    systems, size, width = bands.shape
    upper = np.concatenate([bands, np.zeros((systems, width, width))], axis=1)
    solution = np.zeros((systems, size + width, right.shape[1]))
    solution[:, :size] = right
    singular = np.zeros(systems, dtype=bool)
    for i in range(size):
        pivots = upper[:, i, 0]
        bad = ~(pivots > SINGULAR_PIVOT * bands[:, i, 0])
        singular |= bad
        pivots[bad] = np.inf  # takes the row out, so that nothing overflows
        factors = upper[:, i, 1:] / pivots[:, None]
        for j in range(1, width):
            upper[:, i + j, :width - j] -= factors[:, [j - 1]] * upper[:, i, j:]
        solution[:, i + 1:i + width] -= factors[:, :, None] * solution[:, [i]]
        upper[:, i, 1:] = factors
    for i in reversed(range(size)):
        solution[:, i] /= upper[:, i, [0]]
        solution[:, i] -= np.einsum("sj,sjc->sc", upper[:, i, 1:], solution[:, i + 1:i + width])
    solution[singular] = np.nan
    return solution[:, :size]


class Fits:
    """Least squares fits of a spline to measurements, one for each weight of the prior.

    Measurements have a standard deviation of 1; the weight multiplies the squared second
    differences of control points. The weight 0 is no prior: where it leaves the spline
    undetermined, the fit is NaN.
    """

    def __init__(self, spline, times, measured, weights, instants):
        normal = spline.normal_matrix(times)
        bands = normal + np.multiply.outer(np.asarray(weights), spline.prior_matrix())
        right = np.concatenate([spline.right_side(times, measured), spline.unit_rows(instants)],
                               axis=1)
        solution = solve_bands(bands, right)
        if not spline.is_determined(times):
            solution[np.asarray(weights) == 0] = np.nan
        # Control points of each fit, (fits, control points, columns of measurements).
        self.control_points = solution[:, :, :measured.shape[1]]
        # Standard deviation of each fit, root mean square over the instants. The hat matrix has
        # the row r N^-1 A^T where the spline has r, so the variance is r N^-1 A^T A N^-1 r^T; N
        # holds the prior, A^T A does not.
        self.stddev = np.sqrt([np.mean(np.sum(rows * band_product(normal, rows), axis=0))
                               for rows in solution[:, :, measured.shape[1]:]])


# The study.

@dataclasses.dataclass(frozen=True)
class Case:
    """One spline, motion and noise."""
    motion: str
    scan_rate_hz: int
    noise: str
    with_prior: bool
    degree: int
    num_intervals: int

    def spacing_s(self):
        return DURATION_S / self.num_intervals

    def relative_work(self):
        """Operations of a banded Cholesky factorization per second of the recording, the
        unknowns times the square of the band's width, over those of the reference."""
        return REFERENCE_SPACING_S / self.spacing_s() * ((self.degree + 1) / (CUBIC + 1))**2


@dataclasses.dataclass(frozen=True)
class Errors:
    """Of position / mm, rotation / deg and the point / mm; NaN where undetermined.

    The bias is the error of the fit to measurements without noise; the error is the root of
    the squares of bias and standard deviation, both root mean squares over time.
    """
    bias: np.ndarray
    largest_bias: np.ndarray
    stddev: np.ndarray
    error: np.ndarray


POINT = 2  # the last of an Errors' elements
UNITS = ("position_mm", "rotation_deg", "point_mm")


def lengths(squares):
    """Errors of position, rotation and the point from squared errors by axis, in the last
    dimension."""
    position, rotation = squares[..., :3].sum(axis=-1), squares[..., 3:].sum(axis=-1)
    # Averaged over the directions of a point, two thirds of the squared rotation move it.
    point = position + 2 / 3 * POINT_DISTANCE_M**2 * rotation
    return np.stack([1e3 * np.sqrt(position), np.degrees(np.sqrt(rotation)),
                     1e3 * np.sqrt(point)], axis=-1)


def measurement_times(scan_rate_hz):
    step = 1 / (scan_rate_hz * MEASUREMENTS_PER_SCAN)
    return step * (0.5 + np.arange(round(DURATION_S / step)))


def evaluated_instants():
    """Instants all over the stretch, at random so that they do not keep step with knots."""
    places = np.arange(NUM_INSTANTS) + np.random.default_rng(1).random(NUM_INSTANTS)
    return MARGIN_S + (DURATION_S - 2 * MARGIN_S) * places / NUM_INSTANTS


def interval_counts(scan_rate_hz):
    """Numbers of knot intervals of the stretch, for spacings from the shortest to the longest."""
    counts = {round(DURATION_S / spacing) for spacing in TABLE_SPACINGS_S}
    shortest, longest = (scans / scan_rate_hz for scans in SPACINGS_SCANS)
    number = round(math.log2(longest / shortest) * SPACINGS_PER_OCTAVE) + 1
    for count in np.rint(DURATION_S / np.geomspace(shortest, longest, number)).astype(int):
        if min(abs(math.log(count / other)) for other in counts) > 0.1:
            counts.add(int(count))
    return sorted(counts, reverse=True)


def fit_motions(truth, scan_rate_hz, spline, weights):
    """Control points (control points, shifts, settings, motions, axes) and standard deviations
    of the spline (settings, motions, axes), from the prior's weights (settings, motions, axes)."""
    times = measurement_times(scan_rate_hz)
    measured = truth.poses(times, spline.spacing_s)
    # Axes with the same weight share their normal matrix.
    fitted, numbers = np.unique(weights, return_inverse=True)
    numbers = numbers.reshape(weights.shape)
    fits = Fits(spline, times, measured.reshape(len(times), -1), fitted, evaluated_instants())
    control_points = fits.control_points.reshape(len(fitted), -1, *measured.shape[1:])
    _, motion, axis = np.indices(weights.shape)
    chosen = control_points[numbers, :, :, motion, axis]
    return np.moveaxis(chosen, (3, 4), (0, 1)), fits.stddev[numbers]


def errors_of_spline(truth, scan_rate_hz, spline):
    """Errors by case of all motions, with both noises and with and without prior."""
    settings = list(itertools.product(NOISE_FACTORS, (False, True)))
    factors = np.array([NOISE_FACTORS[noise] for noise, _ in settings])[:, None, None]
    with_prior = np.array([prior for _, prior in settings])[:, None, None]
    control_points, stddev = fit_motions(
        truth, scan_rate_hz, spline,
        with_prior * factors**2 * truth.prior_weights(spline.spacing_s))
    dense = np.arange(MARGIN_S, DURATION_S - MARGIN_S, DENSE_STEP_S)
    bias2 = (spline.evaluate(control_points, dense)
             - truth.poses(dense, spline.spacing_s)[:, :, None])**2
    mean2, variance = bias2.mean(axis=(0, 1)), (factors * MEASUREMENT_STDDEV * stddev)**2
    parts = (lengths(mean2), lengths(bias2).max(axis=(0, 1)), lengths(variance),
             lengths(mean2 + variance))
    return {Case(name, scan_rate_hz, *setting, spline.degree, spline.num_intervals):
            Errors(*(part[i, k] for part in parts))
            for i, setting in enumerate(settings) for k, name in enumerate(MOTIONS)}


def study():
    """Errors by case."""
    truth = Truth()
    errors = {}
    for rate, degree in itertools.product(SCAN_RATES_HZ, DEGREES):
        for count in interval_counts(rate):
            errors.update(errors_of_spline(truth, rate, Spline(degree, count)))
    return errors


# What is written.

def curve(errors, **wanted):
    """The cases that are as wanted, by ascending spacing, and their errors of the point."""
    cases = [case for case in errors
             if all(getattr(case, name) == value for name, value in wanted.items())]
    cases.sort(key=Case.spacing_s)
    return cases, np.array([errors[case].error[POINT] for case in cases])


def best(errors, **wanted):
    """The case of the longest spacing whose error is within NEAR_BEST of the least."""
    cases, values = curve(errors, **wanted)
    return cases[np.flatnonzero(values <= NEAR_BEST * np.nanmin(values))[-1]]


def error_text(value):
    return "undetermined" if np.isnan(value) else f"{value:.1f}"


def table_row(errors, motion, rate, with_prior):
    wanted = {"motion": motion, "scan_rate_hz": rate, "with_prior": with_prior}
    cubic = best(errors, **wanted, noise="3 cm", degree=CUBIC)
    at = {spacing: errors[dataclasses.replace(cubic, num_intervals=round(DURATION_S / spacing))]
          for spacing in TABLE_SPACINGS_S}
    least = [np.nanmin(curve(errors, **wanted, noise="3 cm", degree=degree)[1])
             for degree in DEGREES]
    precise = best(errors, **wanted, noise="1 cm", degree=CUBIC)
    return [motion, str(rate), "the motion's" if with_prior else "none",
            f"{1e3 * cubic.spacing_s():.0f}", f"{cubic.relative_work():.1f}",
            *(error_text(of_spacing.error[POINT]) for of_spacing in at.values()),
            " / ".join(map(error_text, least)),
            error_text(at[BIAS_SPACING_S].largest_bias[POINT]),
            f"{1e3 * precise.spacing_s():.0f}"]


def table(errors):
    heading = ["motion", "scans / s", "prior", "best spacing / ms", "relative work",
               *(f"error at {1e3 * spacing:.0f} ms / mm" for spacing in TABLE_SPACINGS_S),
               "least error / mm, orders " + " / ".join(str(degree + 1) for degree in DEGREES),
               f"largest bias at {1e3 * BIAS_SPACING_S:.0f} ms / mm",
               "best spacing / ms, 1 cm"]
    rows = [table_row(errors, *what)
            for what in itertools.product(MOTIONS, SCAN_RATES_HZ, (False, True))]
    lines = ["| " + " | ".join(row) + " |" for row in [heading] + rows]
    return "\n".join([lines[0], "|" + "---|" * len(heading)] + lines[1:]) + "\n"


def write_csv(errors, path):
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        parts = [part.name for part in dataclasses.fields(Errors)]
        writer.writerow(["motion", "scans_per_s", "range_noise", "prior", "degree", "order",
                         "spacing_s", "relative_work"]
                        + [f"{part}_{unit}" for part in parts for unit in UNITS])
        for case, of_case in errors.items():
            values = np.concatenate([getattr(of_case, part) for part in parts])
            writer.writerow([case.motion, case.scan_rate_hz, case.noise, int(case.with_prior),
                             case.degree, case.degree + 1, f"{case.spacing_s():.6g}",
                             f"{case.relative_work():.4g}"]
                            + ["undetermined" if np.isnan(value) else f"{value:.5g}"
                               for value in values])


def draw_panel(axes, errors, motion, rate):
    for degree in DEGREES:
        for with_prior in (False, True):
            cases, values = curve(errors, motion=motion, scan_rate_hz=rate, noise="3 cm",
                                  with_prior=with_prior, degree=degree)
            axes.plot([1e3 * case.spacing_s() for case in cases], values,
                      linestyle="-" if with_prior else "--", color=COLOURS[degree],
                      linewidth=1.8 if degree == CUBIC else 1.2,
                      zorder=3 if degree == CUBIC else 2)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(*FIGURE_SPACINGS_MS)
    axes.set_ylim(*FIGURE_ERRORS_MM)
    for axis, ticks in ((axes.xaxis, FIGURE_TICKS_MS), (axes.yaxis, FIGURE_TICKS_MM)):
        axis.set_major_locator(FixedLocator(ticks))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_locator(NullLocator())
    axes.grid(color="#e1e5ea", linewidth=0.6)
    axes.set_axisbelow(True)


def draw(errors):
    figure, panels = plt.subplots(len(SCAN_RATES_HZ), len(MOTIONS), figsize=(9.5, 9.5),
                                  sharex=True, sharey=True, squeeze=False,
                                  layout="constrained")
    for row, rate in zip(panels, SCAN_RATES_HZ):
        for axes, motion in zip(row, MOTIONS):
            draw_panel(axes, errors, motion, rate)
            axes.set_title(f"{motion}, {rate} scans/s", fontsize=11)
        row[0].set_ylabel("rms error / mm")
    for axes in panels[-1]:
        axes.set_xlabel("knot spacing / ms")
    lines = [Line2D([], [], color=COLOURS[degree], linewidth=1.8,
                    label=f"order {degree + 1} (degree {degree})") for degree in DEGREES]
    lines += [Line2D([], [], color=BLACK, linestyle="--", label="no prior"),
              Line2D([], [], color=BLACK, label="prior as strong as the motion")]
    figure.legend(handles=lines, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3,
                  frameon=False)
    return figure


def main():
    arguments = parse_arguments()
    errors = study()
    try:
        for path in filter(None, (arguments.output, arguments.csv)):
            os.makedirs(os.path.dirname(path) or ".", exist_ok=True)
        if arguments.csv:
            write_csv(errors, arguments.csv)
        # Without the version of matplotlib, the same figure gives the same bytes.
        draw(errors).savefig(arguments.output, format="png", dpi=FIGURE_DPI, bbox_inches="tight",
                             metadata={"Software": None})
    except OSError as error:
        print(f"knot_study.py: {error}", file=sys.stderr)
        return 1
    print(table(errors), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""Figures 4 and 5 of the paper: precision of angles and distances between walls."""

import re

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from figure_files import BLACK, BLUE, VERMILION, contents_of
from floor_plan import InputError, read_json

SIDE_STYLES = {"outer": (BLUE, "o", "-"), "inner": (VERMILION, "s", "--")}

# The paper's values: side -> number of corners or loops -> standard deviation. It prints the
# curves of Figures 4 and 5 without numbers; these are the ones that its text states.
PAPER_ANGLES_DEG = {"outer": {1: 0.008}, "inner": {1: 0.016}}  # section 5, corner angles
PAPER_ANGLE_LIMIT_DEG = (12, 0.1)                              # section 5, after three loops
PAPER_DISTANCES_MM = {                                         # section 5, with Figure 5
    "centre": {"outer": {1: 1.0}, "inner": {1: 1.0}},
    "corners": {"outer": {1: 5.3}, "inner": {1: 3.6}},
}
PAPER_DISTANCE_LIMIT_MM = (3, 15.0)                            # abstract, after three loops


def read_series(path, pattern, scale):
    """Number of corners or loops, standard deviation, half width of its 95 % interval, bound.

    A row for each quantity whose name matches; the pattern's group is the number.
    """
    rows = []
    with contents_of(path):
        for name, figures in read_json(path)["pairs"].items():
            match = re.fullmatch(pattern, name)
            if match:
                half_width = 1.96 * figures["ratio_error"] * figures["bound"]
                rows.append([float(match[1]), scale * figures["stddev"], scale * half_width,
                             scale * figures["bound"]])
        return np.array(sorted(rows), dtype=float).reshape(-1, 4)


def read_num_runs(path):
    with contents_of(path):
        return max(figures["runs"] for figures in read_json(path)["pairs"].values())


def draw_series(axes, series, side, shift):
    """Runs with their confidence interval and the bound; log axes, so the shift is a factor."""
    colour, marker, line = SIDE_STYLES[side]
    number, stddev, half_width, bound = series.T
    axes.plot(number, bound, line, color=colour, linewidth=1.5, label=f"bound, {side} walls")
    axes.errorbar(number * shift, stddev, np.nan_to_num(half_width), fmt=marker, color=colour,
                  markersize=5, capsize=3, linewidth=1.2, label=f"simulated runs, {side} walls")


def draw_paper(axes, values, limit, unit):
    """What the paper states: values of both sides, and the limit that it stays below."""
    for side, of_side in values.items():
        colour, marker, _ = SIDE_STYLES[side]
        axes.plot(list(of_side), list(of_side.values()), marker, color=colour, markersize=9,
                  markerfacecolor="none", markeredgewidth=1.6, linestyle="",
                  label=f"paper, {side} walls", zorder=3)
    axes.errorbar(*limit, yerr=[[0.35 * limit[1]], [0]], uplims=True, fmt="_", color=BLACK,
                  markersize=14, linewidth=1.5)
    axes.annotate(f"paper: below {limit[1]:g} {unit}", limit, xytext=(-12, 0),
                  textcoords="offset points", ha="right", va="center", fontsize=9)


def style_series_axes(axes, numbers, what, ticks):
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(min(numbers) / 1.15, max(numbers) * 1.15)
    axes.set_xticks([tick for tick in ticks if tick <= max(numbers)])
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.set_xlabel(what)
    axes.grid(color="#e1e5ea", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_series_legend(figure, axes, num_runs):
    """Below the figure, a column each for the runs, the bound and the paper."""
    entries = dict(zip(*reversed(axes.get_legend_handles_labels())))
    labels = [f"{what}, {side} walls" for what in ("simulated runs", "bound", "paper")
              for side in SIDE_STYLES]
    figure.legend([entries[label] for label in labels], labels, loc="upper center",
                  bbox_to_anchor=(0.5, 0.0), ncol=3, frameon=False,
                  title=f"{num_runs} simulated runs, with 95 % confidence intervals")


def draw_angles(arguments):
    series = {side: read_series(arguments.precision, rf"angle, {side}, (\d+) corners",
                                180 / np.pi) for side in SIDE_STYLES}
    if not any(map(len, series.values())):
        raise InputError(f"{arguments.precision}: has no angles between walls")
    figure, axes = plt.subplots(figsize=(7.5, 5), layout="constrained")
    for side, shift in (("outer", 0.985), ("inner", 1.015)):
        draw_series(axes, series[side], side, shift)
    draw_paper(axes, PAPER_ANGLES_DEG, PAPER_ANGLE_LIMIT_DEG, "deg")
    numbers = np.concatenate([each[:, 0] for each in series.values()] +
                             [[PAPER_ANGLE_LIMIT_DEG[0]]])
    style_series_axes(axes, numbers, "corners between the walls",
                      (1, 2, 3, 4, 6, 8, 10, 12, 15, 20))
    axes.set_ylabel("standard deviation of the angle / deg")
    draw_series_legend(figure, axes, read_num_runs(arguments.precision))
    return figure


def draw_distances(arguments):
    figure, panels = plt.subplots(1, 2, figsize=(9.5, 4.8), sharey=True, layout="constrained")
    found = False
    for axes, where, title in zip(panels, PAPER_DISTANCES_MM,
                                  ("(a) at the walls' centres", "(b) at the walls' corners")):
        numbers = [1, PAPER_DISTANCE_LIMIT_MM[0]]
        for side, shift in (("outer", 0.985), ("inner", 1.015)):
            series = read_series(arguments.precision,
                                 rf"distance, {side}, (\d+) loops, {where}", 1e3)
            found = found or len(series) > 0
            numbers += list(series[:, 0])
            draw_series(axes, series, side, shift)
        draw_paper(axes, PAPER_DISTANCES_MM[where], PAPER_DISTANCE_LIMIT_MM, "mm")
        style_series_axes(axes, numbers, "loops between the walls", range(1, 20))
        axes.set_title(title)
    if not found:
        raise InputError(f"{arguments.precision}: has no distances between walls")
    panels[0].set_ylabel("standard deviation of the distance / mm")
    draw_series_legend(figure, panels[0], read_num_runs(arguments.precision))
    return figure

#!/usr/bin/python3
"""Draws the figures of the paper from results of this program, each as PNG and as PDF.

The paper: G. Vosselman, Design of an indoor mapping system using three 2D laser scanners and
6 DOF SLAM, ISPRS Annals II-3, 2014.
"""

import argparse
import contextlib
import os
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import yaml
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, MultipleLocator, NullLocator

from floor_plan import InputError, model_from_truth, read_json, read_ply_vertices, wall_traces

PNG_DPI = 150
SPLINE_ORDER = 4            # control points of an interval
UNKNOWNS_OF_POSE = {"spatial": 6, "planar": 3}
UNKNOWNS_OF_PLANE = {"horizontal": 1, "vertical": 2, "general": 3}
ZOOM_BORDERS = 3            # the enlarged corner, in widths of the border
MIN_ZOOM = 150              # unknowns
CLOUD_CELL = 0.07           # m, of which one point is drawn
MAX_CLOUD_POINTS = 90000
MAX_STRAY_POINTS = 8000     # on no plane
ELEVATION = np.radians(38)  # of the eye over oblique views
GRID_STEP = 5.0             # m, on the ground of oblique views

# Okabe and Ito's colours, which colour-blind readers can tell apart.
BLACK, ORANGE, SKY, GREEN = "#000000", "#e69f00", "#56b4e9", "#009e73"
BLUE, VERMILION, PURPLE = "#0072b2", "#d55e00", "#cc79a7"
PLANE_COLOURS = (BLUE, ORANGE, GREEN, SKY, PURPLE, "#8c6d31", "#332288")
SCANNER_COLOURS = (GREEN, ORANGE, PURPLE, SKY, VERMILION)
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


@contextlib.contextmanager
def contents_of(path):
    """Names the file when what it holds is not what is expected."""
    try:
        yield
    except KeyError as error:
        raise InputError(f"{path}: has no {error}") from error
    except (AttributeError, IndexError, TypeError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error


def join(directory, name):
    return os.path.join(directory, name)


def read_map(directory, fields):
    """The map's points, as a structured array that has these fields."""
    path = join(directory, "map.ply")
    with contents_of(path):
        points = read_ply_vertices(path)
    for field in fields:
        if field not in points.dtype.names:
            raise InputError(f"{path}: its vertices have no {field}")
    return points


def coordinates(points):
    return np.column_stack([points["x"], points["y"], points["z"]]).astype(float)


def read_positions(path):
    """Positions of a trajectory, one row per pose, metres."""
    with contents_of(path):
        return np.loadtxt(path, ndmin=2)[:, [1, 2, 3]]


def read_scan_period(directory):
    path = join(directory, "summary.json")
    with contents_of(path):
        summary = read_json(path)
        return summary["duration_s"] / max(1, summary["scans"] - 1)


def save(figure, directory, name):
    """Both files or none; the same input gives the same files."""
    os.makedirs(directory, exist_ok=True)
    formats = {"png": {"Software": None}, "pdf": {"CreationDate": None}}
    paths = {suffix: join(directory, f"{name}.{suffix}") for suffix in formats}
    try:
        for suffix, metadata in formats.items():
            figure.savefig(paths[suffix] + ".partial", format=suffix, dpi=PNG_DPI,
                           bbox_inches="tight", metadata=metadata)
        for path in paths.values():
            os.replace(path + ".partial", path)
    finally:
        for path in paths.values():
            if os.path.exists(path + ".partial"):
                os.remove(path + ".partial")
    for path in paths.values():
        print(path)


# Figure 2

class NormalMatrix:
    """Where the final normal matrix is not zero: control points first, then planes.

    A point couples the four control points of its knot interval with its plane. Planes meet
    each other nowhere, for a point lies on one only.
    """

    def __init__(self, directory):
        summary_path = join(directory, "summary.json")
        with contents_of(summary_path):
            summary = read_json(summary_path)
            self.pose_unknowns = UNKNOWNS_OF_POSE[summary["motion"]]
            self.num_control_points = int(summary["control_points"])
            reference = summary["reference_plane_id"]
        planes_path = join(directory, "planes.json")
        with contents_of(planes_path):
            # The reference plane's angle is given.
            sizes = {plane["id"]: UNKNOWNS_OF_PLANE[plane["type"]] - (plane["id"] == reference)
                     for plane in read_json(planes_path)}
        self.num_band = self.pose_unknowns * self.num_control_points
        self.plane_ids = sorted(sizes)
        self.plane_starts = self.num_band + np.cumsum(
            [0] + [sizes[plane] for plane in self.plane_ids])
        self.size = int(self.plane_starts[-1])
        self.seen = self.intervals_of_planes(directory)

    def intervals_of_planes(self, directory):
        """Plane id -> the knot intervals in which it was seen, ascending."""
        path = join(directory, "config_used.yaml")
        with contents_of(path), open(path, encoding="utf-8") as file:
            try:
                settings = yaml.safe_load(file)["trajectory"]
            except yaml.YAMLError as error:
                raise InputError(f"{path}: {' '.join(str(error).split())}") from error
            interval = max(float(settings["knot_interval_s"]),
                           settings["min_scans_per_knot"] * read_scan_period(directory))
        points = read_map(directory, ("time", "plane_id"))
        points = points[points["plane_id"] >= 0]
        last = self.num_control_points - SPLINE_ORDER
        intervals = np.clip(np.floor(points["time"] / interval), 0, last).astype(int)
        pairs = np.unique(np.column_stack([points["plane_id"], intervals]), axis=0)
        return {plane: pairs[pairs[:, 0] == plane, 1] for plane in self.plane_ids}

    def rectangles(self):
        """The filled blocks as (first row, end row, first column, end column)."""
        blocks = [(first, first + SPLINE_ORDER * self.pose_unknowns) * 2 for first in
                  self.pose_unknowns * np.arange(self.num_control_points - SPLINE_ORDER + 1)]
        for plane, start, end in zip(self.plane_ids, self.plane_starts, self.plane_starts[1:]):
            blocks.append((start, end, start, end))
            for first, last in control_point_runs(self.seen[plane]):
                rows = (self.pose_unknowns * first, self.pose_unknowns * (last + 1))
                blocks += [rows + (start, end), (start, end) + rows]
        return blocks


def control_point_runs(intervals):
    """First and last control point of each run that these knot intervals touch."""
    if len(intervals) == 0:
        return []
    runs = np.split(intervals, np.flatnonzero(np.diff(intervals) > SPLINE_ORDER) + 1)
    return [(run[0], run[-1] + SPLINE_ORDER - 1) for run in runs]


def draw_normal_matrix(arguments):
    matrix = NormalMatrix(arguments.result)
    blocks = [[(left, top), (right, top), (right, bottom), (left, bottom)]
              for top, bottom, left, right in matrix.rectangles()]
    border = matrix.size - matrix.num_band
    zoom = min(matrix.size, max(MIN_ZOOM, ZOOM_BORDERS * border))
    figure, (whole, corner) = plt.subplots(1, 2, figsize=(10, 5), layout="constrained")
    for axes, first in ((whole, 0), (corner, matrix.size - zoom)):
        # An outline keeps blocks visible that are thinner than a pixel.
        axes.add_collection(PolyCollection(blocks, facecolors=BLACK, edgecolors=BLACK,
                                           linewidths=0.3 if axes is whole else 0.0,
                                           antialiased=axes is whole))
        axes.set_xlim(first, matrix.size)
        axes.set_ylim(matrix.size, first)
        axes.set_aspect("equal")
        axes.set_facecolor("#e9edf1")
        axes.set_xlabel("number of the unknown")
        axes.set_ylabel("number of the unknown")
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    first = matrix.size - zoom
    whole.add_patch(Rectangle((first, first), zoom, zoom, fill=False, edgecolor=VERMILION,
                              linewidth=1.5, clip_on=False, zorder=3))
    for spine in corner.spines.values():
        spine.set(color=VERMILION, linewidth=1.5)
    for line in (corner.axhline, corner.axvline):
        line(matrix.num_band, color=SKY, linewidth=1.0)
    whole.set_title(f"(a) {matrix.num_control_points} control points: {matrix.num_band} unknowns,"
                    f"\n{len(matrix.plane_ids)} planes: {border} unknowns")
    corner.set_title(f"(b) the last {zoom} unknowns;\nbeyond the blue lines: planes")
    return figure


# Figures 3 and 7

def project(points, azimuth):
    """Oblique view from above: right and up in the picture in metres, and the depth."""
    points = np.asarray(points, dtype=float)
    right = np.cos(azimuth) * points[..., 0] + np.sin(azimuth) * points[..., 1]
    away = np.cos(azimuth) * points[..., 1] - np.sin(azimuth) * points[..., 0]
    up = np.sin(ELEVATION) * away + np.cos(ELEVATION) * points[..., 2]
    return np.stack([right, up], axis=-1), away


def draw_ground(axes, low, high, azimuth):
    """A grid on the ground with its coordinates, in place of axes."""
    floor = low[2]
    ticks = [GRID_STEP * np.arange(np.floor(low[i] / GRID_STEP), np.ceil(high[i] / GRID_STEP) + 1)
             for i in range(2)]
    (left, right), (front, back) = ticks[0][[0, -1]], ticks[1][[0, -1]]
    lines = [[(x, front, floor), (x, back, floor)] for x in ticks[0]]
    lines += [[(left, y, floor), (right, y, floor)] for y in ticks[1]]
    axes.add_collection(LineCollection(project(lines, azimuth)[0], colors="#ccd2d9",
                                       linewidths=0.6, zorder=0))
    corners = [(left, front, floor), (right, front, floor), (right, back, floor),
               (left, back, floor)]
    axes.update_datalim(project(corners, azimuth)[0])
    near_y = front if np.cos(azimuth) > 0 else back
    near_x = left if np.sin(azimuth) < 0 else right
    label_edge(axes, [(x, near_y, floor) for x in ticks[0]], 0, "x", azimuth)
    label_edge(axes, [(near_x, y, floor) for y in ticks[1]], 1, "y", azimuth)
    axes.set_aspect("equal", anchor="N")
    axes.axis("off")


def label_edge(axes, ticks, index, name, azimuth):
    """Coordinates along one edge of the ground, below it."""
    places = project(ticks, azimuth)[0]
    side = np.sign(places[:, 0].mean() - np.mean(axes.dataLim.intervalx)) if index else 0
    shift = {0: (0, -6), 1: (12, 0), -1: (-12, 0)}[int(side)]
    align = {0: "center", 1: "left", -1: "right"}[int(side)]
    for tick, place in zip(ticks, places):
        axes.annotate(f"{tick[index]:.0f}", place, xytext=shift, textcoords="offset points",
                      ha=align, va="top", fontsize=8, color="#404850")
    axes.annotate(f"{name} / m", places.mean(axis=0), xytext=(3 * shift[0], -22),
                  textcoords="offset points", ha=align, va="top", fontsize=9)


def read_scan(directory):
    """The points of one scan of all scanners, from the middle of the recording."""
    points = read_map(directory, ("time", "scanner"))
    period = read_scan_period(directory)
    with contents_of(join(directory, "map.ply")):
        middle = period * np.floor(points["time"].max() / 2 / period)
    scan = points[(points["time"] >= middle) & (points["time"] < middle + period)]
    return scan, middle


def to_truth(points, path):
    """From the model frame into the building's frame."""
    with contents_of(path):
        rotation, translation = model_from_truth(read_json(path))
    return (points - translation) @ rotation


def scanner_legend(axes, scanners, **options):
    axes.legend(handles=[
        Line2D([], [], color=BLACK, linewidth=2, label="walls"),
        Line2D([], [], color=BLUE, linewidth=1.5, label="path")] + [
        Line2D([], [], color=SCANNER_COLOURS[scanner % len(SCANNER_COLOURS)], marker="o",
               linestyle="", markersize=5, label=f"scanner {scanner + 1}")
        for scanner in scanners], frameon=False, **options)


def draw_plan(axes, traces, path, points, colours):
    axes.add_collection(LineCollection(traces, colors=BLACK, linewidths=2, capstyle="round"))
    axes.plot(path[:, 0], path[:, 1], color=BLUE, linewidth=1.5)
    axes.plot(path[0, 0], path[0, 1], "o", color=BLUE, markersize=6)
    axes.annotate("start", path[0, :2], xytext=(0, 6), textcoords="offset points", ha="center",
                  color=BLUE)
    axes.scatter(points[:, 0], points[:, 1], s=5, c=colours, linewidths=0, zorder=3)
    axes.set_aspect("equal", anchor="N")
    axes.margins(0.03)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MultipleLocator(GRID_STEP))
    axes.set_xlabel("x / m")
    axes.set_ylabel("y / m")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def draw_walls_obliquely(axes, walls, path, points, colours, azimuth):
    outlines = [project(wall["outline"], azimuth)[0] for wall in walls]
    axes.add_collection(PolyCollection(outlines, facecolors=(0.3, 0.35, 0.4, 0.08),
                                       edgecolors=BLACK, linewidths=0.8))
    axes.plot(*project(path, azimuth)[0].T, color=BLUE, linewidth=1.5)
    axes.scatter(*project(points, azimuth)[0].T, s=5, c=colours, linewidths=0, zorder=3)


def draw_corridor(arguments):
    truth_path = join(arguments.truth, "truth_planes.json")
    with contents_of(truth_path):
        walls = [face for face in read_json(truth_path)
                 if face["type"] == "vertical" and face["outline"]]
        traces = wall_traces(walls)
        corners = np.concatenate([wall["outline"] for wall in walls])
    path = read_positions(join(arguments.truth, "truth_trajectory.tum"))
    scan, middle = read_scan(arguments.result)
    evaluation = arguments.evaluation or join(arguments.result, "evaluation.json")
    points = to_truth(coordinates(scan), evaluation)
    colours = [SCANNER_COLOURS[scanner % len(SCANNER_COLOURS)] for scanner in scan["scanner"]]
    figure, (plan, view) = plt.subplots(
        1, 2, figsize=(12, 4.1), layout="constrained", width_ratios=(1, 1.1))
    draw_plan(plan, traces, path, points, colours)
    azimuth = np.radians(-25)
    draw_ground(view, corners.min(axis=0), corners.max(axis=0), azimuth)
    draw_walls_obliquely(view, walls, path, points, colours, azimuth)
    plan.set_title(f"(a) from above, with the scan at {middle:.1f} s")
    view.set_title("(b) the same scan obliquely")
    scanners = np.unique(scan["scanner"])
    scanner_legend(figure, scanners, loc="upper center", bbox_to_anchor=(0.5, 0.0),
                   ncol=2 + len(scanners))
    return figure


def read_horizontal_planes(directory):
    """Ids of floors and ceilings."""
    path = join(directory, "planes.json")
    with contents_of(path):
        return [plane["id"] for plane in read_json(path) if plane["type"] == "horizontal"]


def thin(points, count):
    """One point of each cell, so that near walls are no denser than far ones."""
    # A fixed seed: the same result gives the same picture.
    points = np.random.default_rng(1).permutation(points)
    cells = np.floor(coordinates(points) / CLOUD_CELL).astype(np.int64)
    cells -= cells.min(axis=0, initial=0)
    _, first = np.unique(cells @ [1, 1 << 21, 1 << 42], return_index=True)
    return points[np.sort(first)[:count]]


def draw_office(arguments):
    horizontal = read_horizontal_planes(arguments.result)
    points = read_map(arguments.result, ("plane_id",))
    points = points[~np.isin(points["plane_id"], horizontal)]
    on_wall = thin(points[points["plane_id"] >= 0], MAX_CLOUD_POINTS)
    stray = thin(points[points["plane_id"] < 0], MAX_STRAY_POINTS)
    if len(on_wall) == 0:
        raise InputError(f"{join(arguments.result, 'map.ply')}: has no points on walls")
    path = read_positions(join(arguments.result, "trajectory.tum"))
    azimuth = np.radians(-30)
    walls = coordinates(on_wall)
    places, depth = project(walls, azimuth)
    order = np.argsort(-depth, kind="stable")
    colours = np.array(PLANE_COLOURS)[on_wall["plane_id"] % len(PLANE_COLOURS)]
    figure, axes = plt.subplots(figsize=(9, 6.3), layout="constrained")
    draw_ground(axes, walls.min(axis=0), walls.max(axis=0), azimuth)
    axes.scatter(*project(coordinates(stray), azimuth)[0].T, s=1.0, c="#9aa3ac", linewidths=0,
                 antialiased=False, rasterized=True, zorder=1)
    axes.scatter(*places[order].T, s=1.0, c=colours[order], linewidths=0, antialiased=False,
                 rasterized=True, zorder=2)
    axes.plot(*project(path, azimuth)[0].T, color="white", linewidth=3.5, zorder=3)
    axes.plot(*project(path, azimuth)[0].T, color=BLACK, linewidth=1.6, zorder=3)
    axes.legend(handles=[
        Line2D([], [], color=BLACK, linewidth=1.6),
        Line2D([], [], color="#9aa3ac", marker="o", linestyle="", markersize=4),
        tuple(Line2D([], [], color=colour, marker="o", linestyle="", markersize=4)
              for colour in PLANE_COLOURS[:3])],
        labels=["path", "points on no plane", "points on walls, coloured by plane"],
        handler_map={tuple: HandlerTuple(ndivide=None)}, frameon=False, loc="lower center",
        bbox_to_anchor=(0.5, -0.08), ncol=3)
    return figure


# Figures 4 and 5

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


FIGURES = {
    "normal_matrix": (draw_normal_matrix, "Figure 2: where the final normal matrix is filled"),
    "corridor": (draw_corridor, "Figure 3: building, path and one scan"),
    "angles": (draw_angles, "Figure 4: precision of angles between walls"),
    "distances": (draw_distances, "Figure 5: precision of distances between walls"),
    "office": (draw_office, "Figure 7: the point cloud without floor and ceiling"),
}


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    subparsers = parser.add_subparsers(dest="figure", required=True, metavar="FIGURE")
    for name, (_, description) in FIGURES.items():
        subparser = subparsers.add_parser(name, help=description, description=description)
        if name in ("angles", "distances"):
            subparser.add_argument("precision", metavar="PRECISION_JSON",
                                   help="file that scripts/analysis/precision.py --output wrote")
        else:
            subparser.add_argument("result", metavar="RESULT_DIR",
                                   help="directory that plumbline_map wrote")
        if name == "corridor":
            subparser.add_argument("truth", metavar="TRUTH_DIR",
                                   help="directory that plumbline_simulate wrote")
            subparser.add_argument("--evaluation", metavar="FILE",
                                   help="JSON file of plumbline_evaluate (default: "
                                   "evaluation.json in RESULT_DIR)")
        subparser.add_argument("--output", metavar="DIR", default="out/figures",
                               help="where to write the PNG and the PDF (default: %(default)s)")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        draw, _ = FIGURES[arguments.figure]
        save(draw(arguments), arguments.output, arguments.figure)
    except (InputError, OSError) as error:
        print(f"figures.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

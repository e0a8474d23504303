"""Figures 3 and 7 of the paper: maps from above and obliquely."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.ticker import MultipleLocator

from figure_files import (BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, contents_of,
                          coordinates, join, read_map, read_positions, read_scan_period)
from floor_plan import InputError, model_from_truth, read_json, wall_traces

CLOUD_CELL = 0.07           # m, of which one point is drawn
MAX_CLOUD_POINTS = 90000
MAX_STRAY_POINTS = 8000     # on no plane
ELEVATION = np.radians(38)  # of the eye over oblique views
GRID_STEP = 5.0             # m, on the ground of oblique views
PLANE_COLOURS = (BLUE, ORANGE, GREEN, SKY, PURPLE, "#8c6d31", "#332288")
SCANNER_COLOURS = (GREEN, ORANGE, PURPLE, SKY, VERMILION)


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

"""Figure 2 of the paper: where the final normal matrix is filled."""

import matplotlib.pyplot as plt
import numpy as np
import yaml
from matplotlib.collections import PolyCollection
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from figure_files import (BLACK, SKY, VERMILION, contents_of, join, read_map,
                          read_scan_period)
from floor_plan import InputError, read_json

SPLINE_ORDER = 4            # control points of an interval
UNKNOWNS_OF_POSE = {"spatial": 6, "planar": 3}
UNKNOWNS_OF_PLANE = {"horizontal": 1, "vertical": 2, "general": 3}
ZOOM_BORDERS = 3            # the enlarged corner, in widths of the border
MIN_ZOOM = 150              # unknowns


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

#!/usr/bin/python3
"""Compares what a level rig saw of a place at the end of a recording with what it saw at its start.

Takes all points of the map, on planes or not, of the first seconds and of the last ones, in
plan, and fits short lines to both: what lies within 15 cm and was seen from the same side.
Prints the median distance of the last lines from the first ones of the same direction, and
the shift and turn that take the last lines onto the first (robust least squares). A map that
has slipped in between shows the place beside itself.

Lines, not points, are compared: the nearest point of a wall is another one of the wall, and a
wall as thick as its noise gives single points no direction. Both sides of a partition are
lines of their own, since the end of a recording may see the one and its start the other.
"""

import argparse
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "figures"))
# pylint: disable=wrong-import-position
from floor_plan import InputError, read_ply_vertices

CELL_M = 0.05          # one line each
RADIUS_M = 0.15        # of the points that give it
MIN_POINTS = 30
MAX_FLATNESS = 0.05    # of their variances across and along: they lie on a line
NUM_SECTORS = 4        # of the directions from which points were seen
REACH_M = 0.2          # farther lines have no counterpart
MIN_COSINE = np.cos(np.radians(15.0))  # of the normals of counterparts
MIN_LINES = 50
ROBUST_WIDTH_M = 0.02


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="directory that plumbline_map wrote")
    parser.add_argument("--first", type=float, default=15.0, metavar="S",
                        help="seconds at the start of the map (default: 15)")
    parser.add_argument("--last", type=float, default=8.0, metavar="S",
                        help="seconds at its end (default: 8)")
    return parser.parse_args()


def read_points(result):
    """Points in plan (n, 2), their times (s), and the unit vectors from them to the rig."""
    points = read_ply_vertices(result / "map.ply")
    if len(points) == 0:
        raise InputError(f"{result}: the map has no points")
    poses = np.loadtxt(result / "trajectory.tum", ndmin=2)
    plan = np.column_stack([points["x"], points["y"]]).astype(float)
    # Of the points, times count from the map's first pose on.
    rig = np.column_stack([np.interp(points["time"], poses[:, 0] - poses[0, 0], poses[:, axis])
                           for axis in (1, 2)])
    to_rig = rig - plan
    return plan, points["time"], to_rig / np.linalg.norm(to_rig, axis=1, keepdims=True)


class Lines:
    """Short lines through points in plan: their middles and the normals towards the rig."""

    def __init__(self, plan, to_rig):
        sector = np.floor(np.arctan2(to_rig[:, 1], to_rig[:, 0]) / (2.0 * np.pi) * NUM_SECTORS)
        keys = np.column_stack([np.floor(plan / CELL_M), sector]).astype(np.int64)
        cells, index = np.unique(keys, axis=0, return_inverse=True)
        # Number, sums and products about the cell's corner, which keeps the digits.
        local = plan - cells[index.ravel(), :2] * CELL_M
        moments = np.zeros((len(cells), 8))
        np.add.at(moments, index.ravel(), np.column_stack(
            [np.ones(len(plan)), local, local[:, 0] ** 2, local[:, 0] * local[:, 1],
             local[:, 1] ** 2, to_rig]))
        self._fit(cells, self._with_neighbours(cells, moments))

    @staticmethod
    def _with_neighbours(cells, moments):
        """The moments of all points around each cell, about its corner."""
        place = {tuple(cell): i for i, cell in enumerate(cells)}
        around = np.zeros_like(moments)
        reach = int(RADIUS_M / CELL_M)
        for dx in range(-reach, reach + 1):
            for dy in range(-reach, reach + 1):
                if np.hypot(dx, dy) * CELL_M > RADIUS_M:
                    continue
                pairs = np.array([(i, place[(x + dx, y + dy, s)])
                                  for i, (x, y, s) in enumerate(cells)
                                  if (x + dx, y + dy, s) in place]).reshape(-1, 2)
                n, sx, sy, xx, xy, yy, ux, uy = moments[pairs[:, 1]].T
                a, b = dx * CELL_M, dy * CELL_M
                around[pairs[:, 0]] += np.column_stack(
                    [n, sx + n * a, sy + n * b, xx + 2 * a * sx + n * a * a,
                     xy + a * sy + b * sx + n * a * b, yy + 2 * b * sy + n * b * b, ux, uy])
        return around

    def _fit(self, cells, moments):
        enough = moments[:, 0] >= MIN_POINTS
        cells, moments = cells[enough], moments[enough]
        mean = moments[:, 1:3] / moments[:, :1]
        products = moments[:, [3, 4, 4, 5]].reshape(-1, 2, 2) / moments[:, 0, None, None]
        spread, axes = np.linalg.eigh(products - np.einsum("ni,nj->nij", mean, mean))
        across = axes[:, :, 0]
        across *= np.where((across * moments[:, 6:8]).sum(axis=1) < 0.0, -1.0, 1.0)[:, None]
        on_line = spread[:, 0] < MAX_FLATNESS * spread[:, 1]
        self.middles = (cells[:, :2] * CELL_M + mean)[on_line]
        self.normals = across[on_line]


def counterparts(middles, normals, first):
    """Of each line the nearest first one with its normal; whether there is one."""
    squares = ((middles ** 2).sum(axis=1)[:, None] + (first.middles ** 2).sum(axis=1)
               - 2.0 * middles @ first.middles.T)
    squares[normals @ first.normals.T < MIN_COSINE] = np.inf
    index = squares.argmin(axis=1)
    return index, squares[np.arange(len(middles)), index] < REACH_M ** 2


def compare(last, first):
    """Distances between counterparts (m) as they lie, and the shift (m) and the turn (rad),
    about the middle of the last lines, that take these onto the first ones."""
    centre = last.middles.mean(axis=0)
    shift, turn = np.zeros(2), 0.0
    as_they_lie = None
    for _ in range(30):
        rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        arms = (last.middles - centre) @ rotation.T
        index, used = counterparts(arms + centre + shift, last.normals @ rotation.T, first)
        if used.sum() < MIN_LINES:
            raise InputError("the last seconds show too little of what the first ones do")
        normal = first.normals[index[used]]
        error = ((arms[used] + centre + shift - first.middles[index[used]]) * normal).sum(axis=1)
        if as_they_lie is None:
            as_they_lie = np.abs(error)
        jacobian = np.column_stack(
            [normal, normal[:, 1] * arms[used, 0] - normal[:, 0] * arms[used, 1]])
        weight = np.sqrt(1.0 / (1.0 + (error / ROBUST_WIDTH_M) ** 2))
        step = np.linalg.lstsq(jacobian * weight[:, None], -error * weight, rcond=None)[0]
        shift, turn = shift + step[:2], turn + step[2]
        if np.abs(step).max() < 1e-6:
            break
    return as_they_lie, shift, turn


def main():
    arguments = parse_arguments()
    try:
        plan, time_s, to_rig = read_points(pathlib.Path(arguments.result))
        is_first = time_s < time_s.min() + arguments.first
        is_last = time_s > time_s.max() - arguments.last
        first = Lines(plan[is_first], to_rig[is_first])
        last = Lines(plan[is_last], to_rig[is_last])
        if min(len(first.middles), len(last.middles)) < MIN_LINES:
            raise InputError("the points show too few straight surfaces")
        distance, shift, turn = compare(last, first)
    except (InputError, OSError) as error:
        sys.exit(f"revisit.py: {error}")
    print(f"lines seen again: {len(distance)} of {len(last.middles)}")
    print(f"median distance:  {1e3 * np.median(distance):.1f} mm")
    print(f"offset:           {1e3 * np.hypot(*shift):.1f} mm, {np.degrees(turn):.2f} deg")


if __name__ == "__main__":
    main()

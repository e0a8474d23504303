#!/usr/bin/python3
"""Compares what a level rig saw of a place at the end of a recording with what it saw at its start.

Takes all points of the map, on planes or not, of the first seconds and of the last ones, in
plan. Prints the median distance of the last points to their nearest first ones, of those that
have any within reach, and the shift and turn that take the last points onto the first
(point to line, robust). A map that has slipped in between shows the place beside itself.
"""

import argparse
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "figures"))
# pylint: disable=wrong-import-position
from floor_plan import InputError, read_ply_vertices

REACH_M = 0.3          # farther points have no counterpart
NEIGHBOURS = 12        # that give a first point its normal
MAX_FLATNESS = 0.1     # of their spreads across and along: they lie on a line
ROBUST_WIDTH_M = 0.02
CHUNK = 500


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="directory that plumbline_map wrote")
    parser.add_argument("--first", type=float, default=15.0, metavar="S",
                        help="seconds at the start of the map (default: 15)")
    parser.add_argument("--last", type=float, default=8.0, metavar="S",
                        help="seconds at its end (default: 8)")
    return parser.parse_args()


def thin(points, cell_m):
    """One point of each cell."""
    _, index = np.unique(np.floor(points / cell_m).astype(np.int64), axis=0, return_index=True)
    return points[index]


def squared_distances(points, of):
    """Between all pairs; points (n, 2), of (m, 2)."""
    squares = (points ** 2).sum(axis=1)[:, None] + (of ** 2).sum(axis=1) - 2.0 * points @ of.T
    return np.maximum(squares, 0.0)


def nearest(points, of):
    """Distance to the nearest point, and which."""
    distances, indices = [], []
    for start in range(0, len(points), CHUNK):
        squares = squared_distances(points[start:start + CHUNK], of)
        indices.append(squares.argmin(axis=1))
        distances.append(np.sqrt(squares.min(axis=1)))
    return np.concatenate(distances), np.concatenate(indices)


def normals(points):
    """Normal of the line on which a point and its neighbours lie, and whether they do."""
    result = np.zeros_like(points)
    on_line = np.zeros(len(points), dtype=bool)
    for start in range(0, len(points), CHUNK):
        chunk = points[start:start + CHUNK]
        squares = squared_distances(chunk, points)
        near = np.argpartition(squares, NEIGHBOURS, axis=1)[:, :NEIGHBOURS]
        deviations = points[near] - points[near].mean(axis=1, keepdims=True)
        spread, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", deviations, deviations))
        result[start:start + CHUNK] = axes[:, :, 0]
        on_line[start:start + CHUNK] = spread[:, 0] < MAX_FLATNESS * spread[:, 1]
    return result, on_line


def offset(last, first):
    """Shift (m) and turn (rad) about their centre that take the last points onto the first."""
    across, on_line = normals(first)
    centre = last.mean(axis=0)
    shift, turn = np.zeros(2), 0.0
    for _ in range(15):
        cosine, sine = np.cos(turn), np.sin(turn)
        arms = (last - centre) @ np.array([[cosine, -sine], [sine, cosine]]).T
        distance, index = nearest(arms + centre + shift, first)
        used = (distance < REACH_M) & on_line[index]
        if used.sum() < 50:
            raise InputError("the last seconds show too little of what the first ones do")
        normal = across[index[used]]
        error = ((arms[used] + centre + shift - first[index[used]]) * normal).sum(axis=1)
        jacobian = np.column_stack(
            [normal, normal[:, 1] * arms[used, 0] - normal[:, 0] * arms[used, 1]])
        weight = np.sqrt(1.0 / (1.0 + (error / ROBUST_WIDTH_M) ** 2))
        step = np.linalg.lstsq(jacobian * weight[:, None], -error * weight, rcond=None)[0]
        shift, turn = shift + step[:2], turn + step[2]
        if np.abs(step).max() < 1e-5:
            break
    return shift, turn


def main():
    arguments = parse_arguments()
    try:
        points = read_ply_vertices(pathlib.Path(arguments.result) / "map.ply")
        plan = np.column_stack([points["x"], points["y"]]).astype(float)
        time_s = points["time"]
        first = thin(plan[time_s < time_s.min() + arguments.first], 0.04)
        last = thin(plan[time_s > time_s.max() - arguments.last], 0.04)
        distance, _ = nearest(last, first)
        near = distance < REACH_M
        if not near.any():
            raise InputError("nothing of what the last seconds saw was seen in the first ones")
        shift, turn = offset(last, first)
    except InputError as error:
        sys.exit(f"revisit.py: {error}")
    print(f"points seen again: {100.0 * near.mean():.0f} %")
    print(f"median distance:   {1e3 * np.median(distance[near]):.1f} mm")
    print(f"offset:            {1e3 * np.hypot(*shift):.1f} mm, {np.degrees(turn):.2f} deg")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Draws the floor plan of a result: walls, points and path from above, with the truth beneath."""

import argparse
import json
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

MAX_POINTS = 60000
CELL = 0.1            # m along a wall
MIN_CELL_POINTS = 3   # fewer are strays
MAX_GAP_CELLS = 4     # a longer gap in a wall is drawn as one
PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
    "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4",
    "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8",
}


class InputError(Exception):
    """Bad input; the message is one line and names the file."""


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", help="directory that plumbline_map wrote")
    parser.add_argument("--truth", help="directory that plumbline_simulate wrote")
    parser.add_argument(
        "--evaluation",
        help="JSON file of plumbline_evaluate; needed with --truth (default: "
        "evaluation.json in the result directory)")
    parser.add_argument("--output", required=True, help="PNG file to write")
    arguments = parser.parse_args()
    default = os.path.join(arguments.result, "evaluation.json")
    if arguments.evaluation is None and os.path.exists(default):
        arguments.evaluation = default
    if arguments.truth and arguments.evaluation is None:
        parser.error("--truth needs --evaluation, which says where the truth lies")
    return arguments


def read_json(path):
    with open(path, encoding="utf-8") as file:
        try:
            return json.load(file)
        except ValueError as error:
            raise InputError(f"{path}: {error}") from error


def read_trajectory(path):
    """Positions, one row per pose, metres."""
    try:
        rows = np.loadtxt(path, ndmin=2)
    except ValueError as error:
        raise InputError(f"{path}: {error}") from error
    if rows.shape[1] != 8:
        raise InputError(f"{path}: a line has {rows.shape[1]} numbers, not 8")
    return rows[:, 1:4]


def read_ply_vertices(path):
    """The vertices of a binary little-endian PLY file, as a structured array."""
    with open(path, "rb") as file:
        header = []
        while not header or header[-1] != "end_header":
            line = file.readline()
            if not line or len(header) > 1000:
                raise InputError(f"{path}: has no complete PLY header")
            header.append(line.decode("ascii", "replace").strip())
        if header[0] != "ply" or "format binary_little_endian 1.0" not in header:
            raise InputError(f"{path}: is not a binary little-endian PLY file")
        count, fields, in_vertex = None, [], False
        for words in (line.split() for line in header):
            if words[:1] == ["element"]:
                in_vertex = words[1] == "vertex"
                if in_vertex:
                    count = int(words[2])
                elif count is None:
                    raise InputError(f"{path}: vertices are not the first element")
            elif words[:1] == ["property"] and in_vertex:
                if words[1] not in PLY_TYPES:
                    raise InputError(f"{path}: unknown property type {words[1]}")
                fields.append((words[2], PLY_TYPES[words[1]]))
        if count is None or not {"x", "y", "z"} <= {name for name, _ in fields}:
            raise InputError(f"{path}: has no vertices with x, y and z")
        vertices = np.fromfile(file, dtype=np.dtype(fields), count=count)
    if len(vertices) != count:
        raise InputError(f"{path}: ends after {len(vertices)} of {count} vertices")
    return vertices


def rim(plane):
    """A cylinder from above: the corners of its rim, (N, 2)."""
    return np.array(plane["outline"])[:len(plane["outline"]) // 2, :2]


def wall_traces(planes):
    """The vertical planes from above, as (N, 2, 2) end points; cylinders piece by piece."""
    traces = []
    for plane in planes:
        normal = np.array(plane["normal"])
        outline = np.array(plane["outline"])
        if abs(normal[2]) > 0.3 or len(outline) == 0:
            continue
        if plane.get("type") == "cylinder":
            corners = rim(plane)
            traces.extend(np.stack([corners[:-1], corners[1:]], axis=1))
            continue
        along = np.array([-normal[1], normal[0]]) / np.hypot(normal[0], normal[1])
        steps = outline[:, :2] @ along
        traces.append(outline[[steps.argmin(), steps.argmax()], :2])
    return np.array(traces).reshape(-1, 2, 2)


def seen_pieces(cylinder, vertices):
    """The pieces of a cylinder's rim that points lie on, as (N, 2, 2) end points."""
    pieces = wall_traces([cylinder])
    on_cylinder = vertices[vertices["plane_id"] == cylinder["id"]]
    axis = np.array(cylinder["axis_point"][:2])

    def angles(points):
        first = pieces[0, 0] - axis
        from_axis = points - axis
        across = first[0] * from_axis[:, 1] - first[1] * from_axis[:, 0]
        return np.arctan2(across, from_axis @ first)

    if len(pieces) == 0 or len(on_cylinder) == 0:
        return np.zeros((0, 2, 2))
    middles = angles(pieces.mean(axis=1))
    points = angles(np.column_stack([on_cylinder["x"], on_cylinder["y"]]))
    order = np.argsort(middles)
    at = np.clip(np.searchsorted(middles[order], points), 0, len(order) - 1)
    counts = np.bincount(order[at], minlength=len(pieces))
    return pieces[counts > 0]


def seen_parts(planes, vertices):
    """The vertical planes from above, only where points lie on them: doors and gaps stay open."""
    parts = []
    for plane in planes:
        if plane.get("type") == "cylinder":
            parts.extend(seen_pieces(plane, vertices))
            continue
        for start, end in wall_traces([plane]):
            on_plane = vertices[vertices["plane_id"] == plane["id"]]
            length = np.hypot(*(end - start))
            if len(on_plane) == 0 or length == 0.0:
                continue
            along = (end - start) / length
            steps = (on_plane["x"] - start[0]) * along[0] + (on_plane["y"] - start[1]) * along[1]
            counts = np.bincount(np.clip(steps / CELL, 0, None).astype(int))
            cells = np.flatnonzero(counts >= MIN_CELL_POINTS)
            for run in np.split(cells, np.flatnonzero(np.diff(cells) > MAX_GAP_CELLS) + 1):
                if len(run) > 0:
                    ends = [CELL * run[0], min(CELL * (run[-1] + 1), length)]
                    parts.append([start + step * along for step in ends])
    return np.array(parts).reshape(-1, 2, 2)


def heights(planes):
    """Between which heights points count as lying on walls: floor + 0.3 m, ceiling - 0.3 m."""
    levels = {1: [], -1: []}
    for plane in planes:
        if abs(plane["normal"][2]) > 0.9:
            side = 1 if plane["normal"][2] > 0 else -1
            levels[side].append((plane["num_points"], plane["centre"][2]))
    low = max(levels[1])[1] + 0.3 if levels[1] else -np.inf
    high = max(levels[-1])[1] - 0.3 if levels[-1] else np.inf
    return low, high


def model_from_truth(evaluation):
    """Rotation matrix and translation."""
    transform = evaluation["model_from_truth"]
    x, y, z, w = transform["rotation_xyzw"]
    rotation = np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])
    return rotation, np.array(transform["translation"])


def draw_truth(axes, directory, evaluation, columns):
    rotation, translation = model_from_truth(evaluation)
    faces = read_json(os.path.join(directory, "truth_planes.json"))
    faces = [
        dict(face,
             normal=(rotation @ np.array(face["normal"])).tolist(),
             outline=(np.array(face["outline"]) @ rotation.T + translation).tolist())
        for face in faces if len(face["outline"]) > 0
    ]
    traces = wall_traces(faces)
    axes.add_collection(LineCollection(
        traces[:, :, columns], colors="#f2a33a", linewidths=6.0, alpha=0.6, capstyle="round", zorder=2,
        label="true walls"))
    path = read_trajectory(os.path.join(directory, "truth_trajectory.tum"))
    path = path @ rotation.T + translation
    axes.plot(*path[:, columns].T, color="#f2a33a", linewidth=2.8, alpha=0.65, zorder=3,
              label="true path")


def draw_points(axes, vertices, planes, columns):
    low, high = heights(planes)
    chosen = vertices[(vertices["z"] > low) & (vertices["z"] < high)]
    # A fixed seed: the same result gives the same picture.
    if len(chosen) > MAX_POINTS:
        chosen = chosen[np.sort(np.random.default_rng(1).choice(len(chosen), MAX_POINTS, False))]
    points = np.column_stack([chosen["x"], chosen["y"]])[:, columns]
    axes.plot(*points.T, ",", color="#7d8a97", alpha=0.6, zorder=3)
    axes.plot([], [], ".", color="#7d8a97", label="points at wall height")


def make_title(summary, evaluation, num_walls):
    lines = [f"{summary['scans']} scans, {summary['points']:,} points, "
             f"{summary['planes']} planes ({num_walls} walls), "
             f"residual rms {1000 * summary['residual_rms_m']:.1f} mm"]
    if evaluation:
        trajectory = evaluation["trajectory"]["unaligned"]
        planes = evaluation["planes"]
        lines.append(
            f"rmse: path {1000 * trajectory['position_m']['rmse']:.2f} mm, "
            f"{trajectory['rotation_deg']['rmse']:.4f}°;  planes "
            f"{1000 * planes['distance_m']['rmse']:.2f} mm, {planes['angle_deg']['rmse']:.4f}°")
    return "\n".join(lines)


def draw(arguments):
    planes = read_json(os.path.join(arguments.result, "planes.json"))
    summary = read_json(os.path.join(arguments.result, "summary.json"))
    evaluation = read_json(arguments.evaluation) if arguments.evaluation else None
    path = read_trajectory(os.path.join(arguments.result, "trajectory.tum"))
    vertices = read_ply_vertices(os.path.join(arguments.result, "map.ply"))
    traces = wall_traces(planes)
    num_walls = sum(len(wall_traces([plane])) > 0 for plane in planes)
    walls = seen_parts(planes, vertices) if "plane_id" in vertices.dtype.names else traces

    extent = np.vstack([traces.reshape(-1, 2), path[:, :2]])
    # A plan that is taller than wide lies better on its side: x upwards, y to the left.
    on_side = np.ptp(extent[:, 1]) > np.ptp(extent[:, 0])
    columns = [1, 0] if on_side else [0, 1]
    extent = extent[:, columns]
    width, height = np.maximum(np.ptp(extent, axis=0), 1.0) + 2.0
    scale = min(11.0 / width, 9.0 / height)
    figure, axes = plt.subplots(
        figsize=(max(6.0, scale * width) + 1.0, max(3.0, scale * height) + 2.0), dpi=150)
    draw_points(axes, vertices, planes, columns)
    if arguments.truth:
        draw_truth(axes, arguments.truth, evaluation, columns)
    axes.add_collection(LineCollection(
        walls[:, :, columns], colors="#1c3d5a", linewidths=1.4, capstyle="round", zorder=4,
        label="walls"))
    axes.plot(*path[:, columns].T, color="#c0392b", linewidth=0.9, zorder=5, label="path")
    axes.plot(*path[0, columns], "o", color="#c0392b", markersize=4, zorder=6, label="start")
    axes.set_aspect("equal")
    margin = 0.04 * max(width, height) + 0.3
    axes.set_xlim(extent[:, 0].min() - margin, extent[:, 0].max() + margin)
    axes.set_ylim(extent[:, 1].min() - margin, extent[:, 1].max() + margin)
    axes.set_xlabel("y / m" if on_side else "x / m")
    axes.set_ylabel("x / m" if on_side else "y / m")
    if on_side:
        axes.invert_xaxis()
    axes.grid(color="#e6e9ed", linewidth=0.6, zorder=0)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.set_title(make_title(summary, evaluation, num_walls), fontsize=9, loc="left")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, 0.0), borderaxespad=5.0, ncol=6,
                frameon=False, fontsize=8)
    partial = arguments.output + ".partial"
    figure.savefig(partial, format="png", bbox_inches="tight", metadata={"Software": None})
    os.replace(partial, arguments.output)


def main():
    try:
        draw(parse_arguments())
    except (InputError, OSError) as error:
        print(f"floor_plan.py: {error}", file=sys.stderr)
        return 1
    except KeyError as error:
        print(f"floor_plan.py: an input file has no field {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""Holds a map's trajectory against relative poses that people made by hand.

The metric of Kümmerle et al. 2009, "On measuring the accuracy of SLAM algorithms", without a
weight for any relation: a relation says where the rig was at a second instant, seen from where
it was at a first one. The error of a trajectory is what has to be added to the relative motion
that it states, (p1^-1 p2) (-) relation: the length of its translation and the angle of its
rotation. Mean and standard deviation over all relations are printed; since only relative poses
count, the frame of the map does not matter.

A relation is a line `t1 t2 x y z roll pitch yaw` (s, m, rad). Poses between two of the
trajectory are interpolated; relations with an instant in no such interval are counted as not
covered. The exit code is 1 when no relation is covered.
"""

import argparse
import bisect
import json
import pathlib
import sys

import numpy as np


class InputError(Exception):
    """A file that is not what it has to be; one sentence says where and why."""


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="directory that plumbline_map wrote, or a TUM file")
    parser.add_argument("--relations", required=True, metavar="FILE")
    parser.add_argument("--time_offset", type=float, default=0.0, metavar="S",
                        help="added to the relations' times (default: 0)")
    parser.add_argument("--max_gap", type=float, default=1.0, metavar="S",
                        help="poses farther apart are not interpolated between (default: 1)")
    parser.add_argument("--min_span", type=float, default=0.0, metavar="S",
                        help="leave out relations of a shorter time (default: 0)")
    parser.add_argument("--max_span", type=float, default=float("inf"), metavar="S",
                        help="leave out relations of a longer time (default: none)")
    parser.add_argument("--worst", type=int, default=0, metavar="N",
                        help="also list the N relations of the largest translation errors")
    parser.add_argument("--output", metavar="FILE.json", help="write the figures there, too")
    return parser.parse_args()


def read_numbers(path, columns):
    """Lines of so many numbers; comments and empty lines are passed over."""
    rows = []
    try:
        text = pathlib.Path(path).read_text()
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from error
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split("#")[0].split()
        if not words:
            continue
        try:
            rows.append([float(word) for word in words])
        except ValueError as error:
            raise InputError(f"{path}:{number}: {error}") from error
        if len(words) != columns or not np.all(np.isfinite(rows[-1])):
            raise InputError(f"{path}:{number}: not {columns} finite numbers")
    if not rows:
        raise InputError(f"{path}: empty")
    return np.array(rows)


def rotation_of_quaternion(q):
    """Of (x, y, z, w), of any length but zero."""
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rotation_of_euler(roll, pitch, yaw):
    """Rz(yaw) Ry(pitch) Rx(roll)."""
    def turn(axis, angle):
        cosine, sine = np.cos(angle), np.sin(angle)
        matrix = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        matrix[i, i] = matrix[j, j] = cosine
        matrix[i, j], matrix[j, i] = -sine, sine
        return matrix
    return turn(2, yaw) @ turn(1, pitch) @ turn(0, roll)


def angle_of(rotation):
    """From its sine and its cosine: arccos of the trace alone loses small angles."""
    sine = 0.5 * np.linalg.norm([rotation[2, 1] - rotation[1, 2],
                                 rotation[0, 2] - rotation[2, 0],
                                 rotation[1, 0] - rotation[0, 1]])
    return np.arctan2(sine, 0.5 * (np.trace(rotation) - 1.0))


def interpolate(first, second, share):
    """Between two rows of a TUM file."""
    q_first, q_second = first[4:8], second[4:8]
    if q_first @ q_second < 0.0:
        q_second = -q_second
    # Scans follow each other closely: the chord between the quaternions is the arc.
    rotation = rotation_of_quaternion((1.0 - share) * q_first + share * q_second)
    return rotation, (1.0 - share) * first[1:4] + share * second[1:4]


class Trajectory:
    """Poses by time."""

    # Instants this near to a pose are its own: files round their times.
    SAME_S = 1e-4

    def __init__(self, path, max_gap_s):
        self.rows = read_numbers(path, 8)
        self.times = self.rows[:, 0].tolist()
        if any(b <= a for a, b in zip(self.times, self.times[1:])):
            raise InputError(f"{path}: the times do not increase")
        self.max_gap_s = max_gap_s

    def at(self, time):
        """Rotation and position; None where there is no pose near enough."""
        after = bisect.bisect_left(self.times, time)
        for i in (after - 1, after):
            if 0 <= i < len(self.times) and abs(self.times[i] - time) <= self.SAME_S:
                return interpolate(self.rows[i], self.rows[i], 0.0)
        if after in (0, len(self.times)):
            return None
        before = after - 1
        gap = self.times[after] - self.times[before]
        if gap > self.max_gap_s:
            return None
        share = (time - self.times[before]) / gap
        return interpolate(self.rows[before], self.rows[after], share)


def errors_of(trajectory, relations, time_offset):
    """Translation (m) and rotation (rad) error of each relation; NaN where not covered."""
    errors = np.full((len(relations), 2), np.nan)
    for row, relation in zip(errors, relations):
        first = trajectory.at(relation[0] + time_offset)
        second = trajectory.at(relation[1] + time_offset)
        if first is None or second is None:
            continue
        rotation = first[0].T @ second[0]
        translation = first[0].T @ (second[1] - first[1])
        true_rotation = rotation_of_euler(*relation[5:8])
        row[0] = np.linalg.norm(true_rotation.T @ (translation - relation[2:5]))
        row[1] = angle_of(true_rotation.T @ rotation)
    return errors


def figures_of(errors):
    covered = errors[~np.isnan(errors[:, 0])]
    figures = {"relations": len(errors), "covered": len(covered)}
    if len(covered) == 0:
        return figures
    for name, values in (("translation_m", covered[:, 0]),
                         ("rotation_deg", np.degrees(covered[:, 1]))):
        figures[name] = {"mean": float(values.mean()),
                         "std": float(values.std()),
                         "median": float(np.median(values)),
                         "max": float(values.max())}
    return figures


def print_figures(figures):
    print(f"relations covered: {figures['covered']} of {figures['relations']}")
    for name, text in (("translation_m", "translation, m"), ("rotation_deg", "rotation, deg")):
        of = figures[name]
        print(f"{text:15} {of['mean']:8.4f} +- {of['std']:.4f}, "
              f"median {of['median']:.4f}, largest {of['max']:.3f}")


def print_worst(errors, relations, count):
    order = np.argsort(-np.nan_to_num(errors[:, 0]))[:count]
    for index in order:
        first, second = relations[index, :2]
        print(f"{first:12.3f} to {second:12.3f} s: {errors[index, 0]:.3f} m, "
              f"{np.degrees(errors[index, 1]):.2f} deg")


def main():
    arguments = parse_arguments()
    path = pathlib.Path(arguments.result)
    try:
        relations = read_numbers(arguments.relations, 8)
        spans = np.abs(relations[:, 1] - relations[:, 0])
        relations = relations[(spans >= arguments.min_span) & (spans <= arguments.max_span)]
        if len(relations) == 0:
            raise InputError(f"{arguments.relations}: has no relations of such a time")
        trajectory = Trajectory(path / "trajectory.tum" if path.is_dir() else path,
                                arguments.max_gap)
    except InputError as error:
        sys.exit(f"evaluate_relations.py: {error}")
    errors = errors_of(trajectory, relations, arguments.time_offset)
    figures = figures_of(errors)
    if arguments.output:
        pathlib.Path(arguments.output).write_text(json.dumps(figures, indent=2) + "\n")
    if figures["covered"] == 0:
        sys.exit(f"evaluate_relations.py: none of {len(errors)} relations lies within the "
                 f"trajectory's {trajectory.times[0]:.3f} to {trajectory.times[-1]:.3f} s")
    print_figures(figures)
    print_worst(errors, relations, arguments.worst)


if __name__ == "__main__":
    main()

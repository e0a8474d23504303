#!/usr/bin/python3
"""Holds the first pose of maps against the truth, or against a longer map, by stated deviations.

A map is moved rigidly onto the reference by its poses after --settled seconds, so that what is
left of the first pose is its own error: the frame and every surface hang on it. Of each result a
line is printed: errors of position (mm) and rotation (deg) about x, y, z of the model frame, the
largest of them over its stated standard deviation, and the verdict. The rotation's deviations are
those of the first pose; the position's, which is the frame's origin, the medians of the later
poses'. What is stated as zero, such as heights of a level rig, is left out.
"""

import argparse
import json
import pathlib
import sys

import numpy as np

from evaluated_planes import rotation_matrix, rotation_vector
from nees import pose_covariances


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", nargs="+", type=pathlib.Path, metavar="RESULT",
                        help="directories that plumbline_map wrote")
    parser.add_argument("--reference", required=True, type=pathlib.Path, metavar="TUM",
                        help="trajectory of the truth, or of a map")
    parser.add_argument("--settled", type=float, default=3.0, metavar="S",
                        help="seconds after which poses show where the map lies (default: 3)")
    return parser.parse_args()


def reference_poses(reference, times):
    """Rotations (n, 3, 3) and positions (n, 3) at times, between the poses before and after."""
    after = np.clip(np.searchsorted(reference[:, 0], times), 1, len(reference) - 1)
    before = reference[after - 1]
    share = (times - before[:, 0]) / (reference[after, 0] - before[:, 0])
    # Between poses a turn is small: the quaternions' chord is as good as their arc.
    to_next = reference[after, 4:8]
    to_next = to_next * np.sign(np.sum(before[:, 4:8] * to_next, axis=1))[:, None]
    quaternions = (1 - share)[:, None] * before[:, 4:8] + share[:, None] * to_next
    quaternions /= np.linalg.norm(quaternions, axis=1)[:, None]
    positions = np.column_stack([np.interp(times, reference[:, 0], reference[:, axis])
                                 for axis in (1, 2, 3)])
    return np.array([rotation_matrix(xyzw) for xyzw in quaternions]), positions


def mean_rotation(rotations):
    """The rotation nearest to several (n, 3, 3)."""
    left, _, right = np.linalg.svd(np.sum(rotations, axis=0))
    return left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right


def first_pose(result, reference, settled_s):
    """Errors of the first pose, m and rad, and their stated standard deviations."""
    poses = np.loadtxt(result / "trajectory.tum", ndmin=2)
    inside = (poses[:, 0] > poses[0, 0] + settled_s) & (poses[:, 0] <= reference[-1, 0])
    index = np.concatenate([[0], np.flatnonzero(inside)])
    true_rotations, true_positions = reference_poses(reference, poses[index, 0])
    rotations = np.array([rotation_matrix(xyzw) for xyzw in poses[index, 4:8]])
    turn = mean_rotation(rotations[1:] @ np.transpose(true_rotations[1:], (0, 2, 1)))
    shift = np.mean(poses[index[1:], 1:4] - true_positions[1:] @ turn.T, axis=0)
    error = np.concatenate([poses[0, 1:4] - turn @ true_positions[0] - shift,
                            rotation_vector(rotations[0] @ (turn @ true_rotations[0]).T)])
    deviations = np.sqrt([np.diag(covariance) for covariance in pose_covariances(result)])
    stated = np.concatenate([np.median(deviations[index[1:], :3], axis=0), deviations[0, 3:]])
    return error, stated


def main():
    arguments = parse_arguments()
    reference = np.loadtxt(arguments.reference)
    within = 0
    for result in arguments.results:
        error, stated = first_pose(result, reference, arguments.settled)
        ratios = np.abs(error[stated > 0]) / stated[stated > 0]
        verdict = json.loads((result / "summary.json").read_text())["consistency"]["verdict"]
        within += ratios.max() <= 3.0
        print(f"{result}: {np.round(1e3 * error[:3], 1)} mm, "
              f"{np.round(np.degrees(error[3:]), 3)} deg, largest {ratios.max():.1f} "
              f"of its deviations; {verdict}")
    print(f"within three deviations: {within} of {len(arguments.results)}")


if __name__ == "__main__":
    sys.exit(main())

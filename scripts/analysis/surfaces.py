#!/usr/bin/python3
"""Holds the surfaces of right maps against the true faces: phantoms, directions, covariances.

Each DIR is what scripts/experiments/robustness.py or monte_carlo.py wrote. A map is right if its
trajectory is within 5 cm and 0.5 degrees after rigid alignment; the others are left out. Per case,
over all of its right maps:

    surfaces    estimated surfaces of a map (mean)
    phantoms    those over 1 m long that match no true face
    beyond 5    upright planes whose heading is off by more than 5 stated standard deviations
    NEES        normalised error squared of all planes of 2000 points and more together, per degree
                of freedom; median over the maps, and the largest
    arcs        cylinders of maps whose true faces are all plane
"""

import argparse
import collections
import json
import pathlib
import sys

import numpy as np

from evaluated_planes import Planes, Truth, model_frame, read_json
from nees import plane_nees

RIGHT_M, RIGHT_DEG = 0.05, 0.5
PHANTOM_M = 1.0
BEYOND_SIGMAS = 5.0


class Counts:
    """What the maps of a case add up to."""

    def __init__(self):
        self.maps = self.surfaces = self.phantoms = self.headings = self.beyond = self.arcs = 0
        self.nees = []


def is_right(evaluation):
    aligned = evaluation["trajectory"]["aligned"]
    return (aligned["position_m"]["max"] <= RIGHT_M
            and aligned["rotation_deg"]["max"] <= RIGHT_DEG)


def size(outline):
    """The longest distance between two corners, m."""
    corners = np.array(outline)
    return np.max(np.linalg.norm(corners[:, None] - corners[None], axis=2))


def add_map(directory, counts):
    evaluation = read_json(directory / "evaluation.json")
    if not is_right(evaluation):
        return
    truth, frame = Truth(directory), model_frame(evaluation)
    judged = {entry["id"]: entry for entry in evaluation["planes"]["list"]}
    counts.maps += 1
    all_plane = all(face["type"] != "cylinder" for face in truth.faces.values())
    for plane in read_json(directory / "planes.json"):
        entry = judged.get(plane["id"])
        if entry is None:
            continue
        counts.surfaces += 1
        wrong = entry["status"] == "wrong"
        counts.phantoms += wrong and size(plane["outline"]) > PHANTOM_M
        counts.arcs += all_plane and plane["type"] == "cylinder"
        if plane["type"] != "vertical" or wrong:
            continue
        counts.headings += 1
        counts.beyond += (entry["sigma_angle_deg"] > 0 and
                          entry["angle_deg"] > BEYOND_SIGMAS * entry["sigma_angle_deg"])
    if not (directory / "plane_covariance.csv").exists():
        return
    faces = {plane: entry["true_faces"][0] for plane, entry in judged.items()
             if entry["true_faces"]}
    squares, freedom = plane_nees(Planes(directory, faces), truth, frame)
    counts.nees.append(squares / freedom)


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directories", metavar="DIR", nargs="+", type=pathlib.Path)
    parser.add_argument("--output", metavar="FILE.json", type=pathlib.Path,
                        help="also write the figures here")
    arguments = parser.parse_args()
    cases = collections.defaultdict(Counts)
    for directory in arguments.directories:
        runs = sorted(path.parent for path in directory.glob("*/evaluation.json"))
        if not runs:
            sys.exit(f"surfaces.py: {directory}: holds no run with an evaluation.json")
        for run in runs:
            add_map(run, cases[run.name.rsplit("_", 1)[0]])
    print("| case | right maps | surfaces | phantoms | beyond 5 | NEES (largest) | "
          "arcs |\n|---|---|---|---|---|---|---|")
    figures = {}
    for case, found in sorted(cases.items()):
        if found.maps == 0:
            continue
        figures[case] = {key: value for key, value in vars(found).items() if key != "nees"}
        nees = "-"
        if found.nees:
            figures[case]["nees_median"] = float(np.median(found.nees))
            figures[case]["nees_max"] = float(np.max(found.nees))
            nees = f"{np.median(found.nees):.2f} ({np.max(found.nees):.2f})"
        print(f"| `{case}` | {found.maps} | {found.surfaces / found.maps:.0f} | "
              f"{percent(found.phantoms, found.surfaces)} | "
              f"{percent(found.beyond, found.headings)} | "
              f"{nees} | {found.arcs} |")
    if arguments.output:
        arguments.output.write_text(json.dumps(figures, indent=2, default=float) + "\n")


if __name__ == "__main__":
    main()

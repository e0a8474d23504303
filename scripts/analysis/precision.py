#!/usr/bin/python3
"""Holds the runs of scripts/experiments/monte_carlo.py against the bound of plumbline_bound and
against the covariances that the runs state themselves.

Quantities that do not depend on the model frame: angles between walls, distances between what
different loops saw of one wall. For a building whose walls follow each other round a corridor,
walls are counted by the corners between them. For any other, with --faces, each face by itself
in the model frame (first pose, normal of the reference wall). With --ideal, also against the best
estimate that the same noise allows. Prints Markdown tables and writes precision.json.
"""

import argparse
import json
import pathlib
import sys

import numpy as np

from evaluated_planes import Planes, Truth, azimuth, model_frame, read_json
from nees import nees_line, nees_of_runs, plane_nees, pose_nees
from plane_quantities import face_quantities, pair_quantities
from run_statistics import compare_with_ideal, growth_exponent, judge_largest_bias, summarise_pairs


def read_run(directory, quantities=pair_quantities):
    """All that one run says: quantities, NEES of planes, of poses, the truth, and NEES of planes
    and poses of the window where the run kept the window's estimates."""
    evaluation = read_json(directory / "evaluation.json")
    truth = Truth(directory)
    face_of_plane = {entry["id"]: min(entry["true_faces"])
                     for entry in evaluation["planes"]["list"] if entry["status"] != "wrong"}
    planes = Planes(directory, face_of_plane)
    frame = model_frame(evaluation)
    window = None
    if (directory / "window_trajectory.tum").exists():
        in_view = Planes(directory, face_of_plane, "window_")
        window = (plane_nees(in_view, truth, frame),
                  pose_nees(directory, truth, frame, "window_"))
    return (quantities(planes, truth, frame), plane_nees(planes, truth, frame),
            pose_nees(directory, truth, frame), truth, window)


def read_bound(directory, truth, quantities=pair_quantities):
    """What plumbline_bound wrote: quantities, NEES of planes (of a seed's best estimate)."""
    lines = (directory / "faces.csv").read_text().splitlines()[1:]
    face_of_plane = dict(tuple(map(int, line.split(","))) for line in lines)
    # A face that no noisy beam hit is not in the truth.
    face_of_plane = {plane: face for plane, face in face_of_plane.items()
                     if face in truth.faces}
    planes = Planes(directory, face_of_plane)
    # The frame from the reference wall's normal and the first pose, which is its origin.
    plane = next(p for p in planes.planes.values() if p["type"] == "vertical")
    turn = azimuth(plane["normal"]) - azimuth(truth.faces[face_of_plane[plane["id"]]]["normal"])
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0],
                         [0, 0, 1.0]])
    frame = (rotation, -rotation @ truth.poses[0, 1:4])
    return quantities(planes, truth, frame), plane_nees(planes, truth, frame)


def bound_variances(bound_directory, truth, quantities=pair_quantities):
    """Quantity -> variance, as the bound has it."""
    values, _ = read_bound(bound_directory, truth, quantities)
    return {key: variance for key, (_, variance) in values.items()}


def read_ideals(directory, run_directories, runs, quantities=pair_quantities):
    """What the best estimate makes of each run's noise; None for runs that have none."""
    ideals = [read_bound(directory / run_directory.name, run[3], quantities)
              if (directory / run_directory.name).is_dir() else None
              for run_directory, run in zip(run_directories, runs)]
    if sum(ideal is not None for ideal in ideals) < 2:
        raise ValueError(f"{directory}: at least two of the runs' seeds (run_*) expected")
    return ideals


def natural(name):
    """Sorts numbers within names as numbers."""
    return [part.rjust(6, "0") if part.isdigit() else part for part in name.split(" ")]


def table(summary, noun="pairs"):
    has_ideal = any("ideal_ratio" in figures for figures in summary.values())
    lines = ["| quantity | runs | empirical | bound | empirical / bound | NEES "
             "| largest bias, in standard errors |" +
             (" empirical / best, same seeds |" if has_ideal else ""),
             "|---|---|---|---|---|---|---|" + ("---|" if has_ideal else "")]
    for name in sorted(summary, key=natural):
        figures = summary[name]
        scale, unit = (180 / np.pi, "deg") if name.startswith("angle") else (1e3, "mm")
        lines.append(
            "| {} | {} | {:.4f} {} | {:.4f} {} | {:.3f} +- {:.3f} | {:.2f} +- {:.2f} "
            "| {} |".format(
                name, figures["runs"], scale * figures["stddev"], unit,
                scale * figures["bound"], unit, figures["ratio"], figures["ratio_error"],
                figures["nees"], figures["nees_error"],
                "" if figures["largest_bias"] is None else
                "{:.1f} of {} {}".format(figures["largest_bias"], figures["pairs"], noun)))
        if has_ideal:
            lines[-1] += (" {ideal_ratio:.3f} +- {ideal_ratio_error:.3f} |".format(**figures)
                          if "ideal_ratio" in figures else " |")
    return "\n".join(lines)


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=pathlib.Path,
                        help="directory of scripts/experiments/monte_carlo.py")
    parser.add_argument("--bound", type=pathlib.Path, required=True,
                        help="directory of plumbline_bound for the same experiment")
    parser.add_argument("--ideal", type=pathlib.Path,
                        help="directory of run_0001, ...: plumbline_bound --seed=1, ...")
    parser.add_argument("--faces", action="store_true",
                        help="each face by itself, not pairs of a corridor's walls")
    parser.add_argument("--output", type=pathlib.Path, help="file for the figures (JSON)")
    return parser.parse_args()


def nees_of_maps(runs):
    """NEES of the maps, and of the windows where at least two runs kept the window's estimates."""
    plane_values = np.array([run[1] for run in runs])
    nees = [nees_line("all planes of a run", plane_values[:, 0], plane_values[:, 1]),
            nees_of_runs("poses, each of its own", np.array([run[2] for run in runs]), 6)]
    windows = [run[4] for run in runs if run[4] is not None]
    if len(windows) >= 2:
        values = np.array([window[0] for window in windows])
        nees.append(nees_line("planes in view, as the window left them",
                              values[:, 0], values[:, 1]))
        nees.append(nees_of_runs("poses, as the window stated each when it was the newest",
                                 np.array([window[1] for window in windows]), 6))
    return nees


def nees_of_ideals(compared):
    """NEES of the best estimates and of the maps of the same seeds."""
    of_ideals = np.array([ideal[1] for _, ideal in compared])
    of_maps = np.array([run[1] for run, _ in compared])
    return [nees_line("all planes of the best estimate", of_ideals[:, 0], of_ideals[:, 1]),
            nees_line("all planes of these seeds' runs", of_maps[:, 0], of_maps[:, 1])]


def compute_figures(runs, bound, ideals):
    """What precision.json holds. ideals: None, or the best estimate of each run or None."""
    pairs = [run[0] for run in runs]
    summary = summarise_pairs(pairs, bound)
    bias = judge_largest_bias(pairs, bound)
    nees = nees_of_maps(runs)
    if ideals is not None:
        compared = [(run, ideal) for run, ideal in zip(runs, ideals) if ideal is not None]
        compare_with_ideal([(run[0], ideal[0]) for run, ideal in compared], summary)
        nees += nees_of_ideals(compared)
    growth = {prefix + suffix: growth_exponent(summary, prefix, suffix)
              for prefix, suffix in (("angle, outer, ", "corners"),
                                     ("distance, outer, ", "centre"),
                                     ("distance, outer, ", "corners"))}
    return {"pairs": summary, "nees": nees, "bias": bias, "growth": growth}


def print_figures(figures, noun):
    print(table(figures["pairs"], noun))
    print()
    for line in figures["nees"]:
        print("NEES of {what}: {mean:.3f} per degree of freedom, 95 % interval "
              "{low:.3f} to {high:.3f}".format(**line))
    bias = figures["bias"]
    if bias is not None:
        print("largest mean error of all {quantities} quantities: {largest:.1f} standard errors; "
              "by chance, over {limit:.1f} in 5 % of such series, over this in {percent:.0f} %"
              .format(percent=100 * bias["chance"], **bias))
    for what, exponent in figures["growth"].items():
        if exponent is not None:
            print(f"growth of {what}: exponent {exponent:.2f}")


def main():
    arguments = parse_arguments()
    quantities = face_quantities if arguments.faces else pair_quantities
    directories = sorted(arguments.runs.glob("run_*"))
    if len(directories) < 2:
        sys.exit(f"precision.py: {arguments.runs}: at least two runs (run_*) expected")
    try:
        runs = [read_run(directory, quantities) for directory in directories]
        bound = bound_variances(arguments.bound, runs[0][3], quantities)
        ideals = arguments.ideal and read_ideals(arguments.ideal, directories, runs, quantities)
    except (OSError, ValueError) as error:
        sys.exit(f"precision.py: {error}")
    except KeyError as error:
        sys.exit(f"precision.py: an input file has no {error}")
    figures = compute_figures(runs, bound, ideals)
    print_figures(figures, "faces" if arguments.faces else "pairs")
    if arguments.output:
        temporary = arguments.output.with_name(arguments.output.name + ".part")
        temporary.write_text(json.dumps(figures, indent=1) + "\n")
        temporary.rename(arguments.output)


if __name__ == "__main__":
    main()

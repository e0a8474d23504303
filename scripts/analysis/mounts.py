#!/usr/bin/python3
"""Holds what the runs of scripts/experiments/monte_carlo.py find of the mounts of scanners against
the truth, against the bound of plumbline_bound and against what the runs state themselves.

For each parameter of each mount: the root mean square of its errors, the standard deviation that
the bound allows, their ratio, and the mean of the squared errors over the stated variances (NEES)
with its 95 % interval about 1. With the positions of the trajectories beside them.
"""

import argparse
import json
import pathlib

import numpy as np

from evaluated_planes import read_json

SIGMAS_95 = 1.96  # half width of the 95 % interval of a normal variable


def found_of(calibration):
    """By scanner and name of the parameter: value, standard deviation."""
    return {(scanner["name"], parameter["name"]): (parameter["value"], parameter["sigma"])
            for scanner in calibration["scanners"] for parameter in scanner["parameters"]
            if parameter["prior_sigma"] > 0}


def read_run(directory):
    """By scanner and name of the parameter: error, stated standard deviation."""
    found = found_of(read_json(directory / "calibration.json"))
    errors = {}
    for scanner in read_json(directory / "truth_mounts.json")["scanners"]:
        for name, true_value in scanner.items():
            key = (scanner["name"], name)
            if key in found:
                errors[key] = (found[key][0] - true_value, found[key][1])
    return errors


def position_bound(directory):
    """Root mean square over the bound's poses of the standard deviation of the position, m."""
    rows = np.loadtxt(directory / "trajectory_covariance.csv", delimiter=",", skiprows=1)
    # The upper triangle by rows: xx, xy, xz, ..., yy, ..., zz.
    return np.sqrt(np.mean(rows[:, 1] + rows[:, 7] + rows[:, 12]))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=pathlib.Path, metavar="RUNS",
                        help="the --output of scripts/experiments/monte_carlo.py")
    parser.add_argument("--bound", type=pathlib.Path, required=True, metavar="DIR",
                        help="the --output of plumbline_bound")
    parser.add_argument("--output", type=pathlib.Path, metavar="FILE", help="writes JSON")
    arguments = parser.parse_args()
    directories = sorted(path for path in arguments.runs.glob("run_*") if path.is_dir())
    runs = [read_run(directory) for directory in directories]
    if not runs:
        parser.error(f"{arguments.runs} has no runs")
    bound = found_of(read_json(arguments.bound / "calibration.json"))
    half = SIGMAS_95 * np.sqrt(2.0 / len(runs))
    table = []
    print(f"{len(runs)} runs; NEES has to lie in {1 - half:.2f} .. {1 + half:.2f}")
    print(f"{'scanner':12}{'parameter':20}{'RMS error':>12}{'bound':>12}{'ratio':>8}{'NEES':>8}")
    for scanner, name in runs[0]:
        errors, sigmas = np.array([run[scanner, name] for run in runs]).T
        rms, sigma = np.sqrt(np.mean(errors**2)), bound[scanner, name][1]
        nees = np.mean((errors / sigmas)**2)
        table.append({"scanner": scanner, "parameter": name, "rms": rms, "bound": sigma,
                      "ratio": rms / sigma, "nees": nees, "largest": np.abs(errors).max(),
                      "inside": bool(abs(nees - 1) <= half)})
        print(f"{scanner:12}{name:20}{rms:12.6f}{sigma:12.6f}{rms / sigma:8.2f}{nees:8.2f}")
    positions = [read_json(directory / "evaluation.json")["trajectory"]["unaligned"]["position_m"]
                 ["rmse"] for directory in directories]
    rms, sigma = np.sqrt(np.mean(np.square(positions))), position_bound(arguments.bound)
    print(f"positions: RMS {1e3 * rms:.2f} mm, bound {1e3 * sigma:.2f} mm, ratio {rms / sigma:.2f}")
    if arguments.output:
        arguments.output.write_text(json.dumps(
            {"runs": len(runs), "parameters": table,
             "positions": {"rms_m": rms, "bound_m": sigma, "ratio": rms / sigma}}, indent=1))


if __name__ == "__main__":
    main()

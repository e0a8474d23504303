#!/usr/bin/python3
"""Holds the scales of odometry that maps found against those that the experiment's wheels had.

The folder is one of scripts/experiments/monte_carlo.py. A scale is true over counted: where the
experiment's wheels count 1.03 m a metre, it is 1 / 1.03.
"""

import argparse
import json
import math
import pathlib
import sys

import yaml

QUANTITIES = ("length", "turn")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, metavar="DIR",
                        help="runs of an experiment with a section odometry")
    return parser.parse_args()


def true_scales(folder):
    """By quantity, of the experiment that setup.json holds."""
    experiment = json.loads((folder / "setup.json").read_text(encoding="utf-8"))["experiment"]
    wheels = yaml.safe_load(experiment["files"][experiment["name"] + ".yaml"]).get("odometry")
    if wheels is None:
        raise LookupError("the experiment has no odometry")
    return {quantity: 1.0 / wheels.get(f"{quantity}_scale", 1.0) for quantity in QUANTITIES}


def found_scales(folder):
    """What the summaries say of the odometry, by the runs' names."""
    found = {}
    for path in sorted(folder.glob("run_*/summary.json")):
        odometry = json.loads(path.read_text(encoding="utf-8")).get("odometry")
        if odometry is not None:
            found[path.parent.name] = odometry
    if not found:
        raise LookupError("no map there was made with odometry")
    return found


def deviations(found, truth, quantity):
    """By run, the error of the scale over its stated standard deviation."""
    return {run: (odometry[f"{quantity}_scale"] - truth[quantity])
            / odometry[f"{quantity}_scale_stddev"] for run, odometry in found.items()}


def table_of(truth, found):
    lines = ["| run | length: scale | error / stated | noise | turn: scale | error / stated | noise |",
             "|---|---|---|---|---|---|---|"]
    of_runs = {quantity: deviations(found, truth, quantity) for quantity in QUANTITIES}
    for run, odometry in found.items():
        cells = [run]
        for quantity in QUANTITIES:
            scale, stddev, noise = (odometry[f"{quantity}_{key}"]
                                    for key in ("scale", "scale_stddev", "noise"))
            cells += [f"{scale:.4f} ± {stddev:.4f}", f"{of_runs[quantity][run]:.1f}",
                      f"{noise:.3f}"]
        lines.append("| " + " | ".join(cells) + " |")
    cells = ["truth, RMS"]
    for quantity in QUANTITIES:
        values = of_runs[quantity].values()
        rms = math.sqrt(sum(value * value for value in values) / len(values))
        cells += [f"{truth[quantity]:.4f}", f"{rms:.1f}", ""]
    return "\n".join([*lines, "| " + " | ".join(cells) + " |"])


def main():
    arguments = parse_arguments()
    try:
        print(table_of(true_scales(arguments.folder), found_scales(arguments.folder)))
    except (OSError, LookupError, ValueError, TypeError, yaml.YAMLError) as error:
        print(f"wheels.py: {arguments.folder}: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

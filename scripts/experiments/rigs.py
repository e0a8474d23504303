#!/usr/bin/python3
"""Compares the paper's rig with the other systems of its section 2: simulates each in several
worlds, on a cart and carried, maps it, and holds the map against the truth and the bound.

    cart      level, without any swing
    carried   it swings as a person swings it (configs/experiments/robustness/carried.yaml)

A rig is a file of configs/rigs. An IMU measures where the rig file has one; the wheels of
trimble_timms count (as in wheels_corridor.yaml), the head of zebedee nods by 30 degrees at 1 Hz,
borrmann stands still for 3.5 s every 3 m.

Outcomes, as of robustness.py, and one more:

    right     the whole trajectory within 5 cm and 0.5 degrees after rigid alignment
    flagged   it is not, and the mapper says so
    silent    it is not, and nobody says so
    crash     the mapper was ended by a signal

Figures are those of the right maps, in brackets those of all maps where none is right: root mean
squares over the runs of positions (from the first pose on, and after rigid alignment) and of the
distances of walls from the true ones, unaligned, beside the Cramer-Rao bound (plumbline_bound),
where it knows all that measures: wheels it does not know. Map and bound take the heading from the
wall that each sees best at first, which may be another one. Of rigs that are followed in the plane
(motion: planar) heights, roll and pitch count nowhere. "open": what has a bound beyond 5 cm or 0.5
degrees somewhere on the way. "weak": the share of time in which a second's scans alone leave a
direction of the position worse than 2 cm, planes known (degenerate_intervals).

Each run and each bound is one directory below --output; those that are there already are not done
again. The tables go to rigs.md and rigs.json there, and are printed.
"""

import argparse
import collections
import csv
import math
import re
import sys

import experiment_files
import job_runner
import robustness
import series

PROGRAMS = (*robustness.PROGRAMS, "plumbline_bound")
FOLDER = job_runner.ROOT / "configs" / "rigs"
RIGS = {
    "paper": "the paper's: one level, two tilted",
    "paper_imu": "the same with a cheap IMU",
    "viametris_imms": "Viametris i-MMS: one level, in the plane",
    "viametris_imms_3d": "all its scanners, in 3D",
    "trimble_timms": "Trimble TIMMS",
    "zebedee": "Zebedee",
    "nodding": "one nodding, one tilted",
    "orthogonal": "Naikal, Chen: three at right angles",
    "orthogonal_imu": "the same with a cheap IMU",
    "thrun": "Thrun 2006",
    "elseberg": "Elseberg: one level, one spinning",
    "borrmann": "Borrmann: one spinning, stop and go",
    "cartographer": "Cartographer: one level, one upright",
    "cartographer_imu": "the same with a cheap IMU",
}
WHEELS = ("trimble_timms",)
HEADS = {"zebedee": {"pitch": {"amplitude_deg": 30.0, "frequency_hz": 1.0}}}
STOPS = {"borrmann": {"every_m": 3.0, "duration_s": 3.5}}
CARRIAGES = ("cart", "carried")
# Length of the way, m, and how the rig is moved there.
WORLDS = {"corridor": (46.0, CARRIAGES), "office": (40.0, CARRIAGES), "ramp": (50.0, CARRIAGES),
          "duplex_a_stairs": (74.0, ("carried",))}
IMU_RATE_HZ = 200.0
OUTCOMES = ("right", "flagged", "silent", "crash", "no recording")
AXES = {"px": "across the first wall", "py": "along the first wall", "pz": "height",
        "rx": "tilt across", "ry": "tilt along", "rz": "heading"}
PLACE = re.compile(  # how an error begins
    r"^plumbline_\w+: (\S*recording\.bag: (a wrong map would come of it: \S+: )?)?")
LONGEST_REASON = 90  # characters in the table


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rigs", nargs="*", metavar="RIG",
                        help=f"names of files in configs/rigs (default: {' '.join(RIGS)})")
    parser.add_argument("--worlds", nargs="+", choices=WORLDS, default=list(WORLDS),
                        metavar="WORLD", help=f"of {', '.join(WORLDS)} (default: all)")
    parser.add_argument("--carriages", nargs="+", choices=CARRIAGES, default=CARRIAGES,
                        metavar="HOW", help=f"of {', '.join(CARRIAGES)} (default: both)")
    parser.add_argument("--no-bounds", action="store_true",
                        help="compute no bound that is not there already: in a furnished house one "
                        "takes longer than a map")
    job_runner.add_seed_arguments(parser, "rig, world and carriage", 2)
    job_runner.add_arguments(parser)
    arguments = parser.parse_args()
    arguments.rigs = list(dict.fromkeys(arguments.rigs)) or list(RIGS)
    return arguments


def read_rig(name):
    path = FOLDER / f"{name}.yaml"
    if not path.exists():
        raise job_runner.InputError(f"no rig {name} in {FOLDER}")
    return experiment_files.load_rig(path)


def experiment_of(name, rig, world, carriage):
    """The experiment of a rig (a dictionary) in a world, as a dictionary."""
    length_m, _ = WORLDS[world]
    experiment = experiment_files.load(world)
    way = {key: value for key, value in experiment["path"].items() if key != "laps"}
    way["length_m"] = length_m
    if name in STOPS:
        every_m = STOPS[name]["every_m"]
        way["pauses"] = [{"at_m": number * every_m, "duration_s": STOPS[name]["duration_s"]}
                         for number in range(1, math.ceil(length_m / every_m))]
    swings = experiment_files.load("carried")["motion"] if carriage == "carried" else {}
    experiment.update(path=way, motion={**swings, **HEADS.get(name, {})})
    if "imu" in rig:
        experiment["imu"] = {"rate_hz": IMU_RATE_HZ}
    if name in WHEELS:
        experiment["odometry"] = experiment_files.load("wheels_corridor")["odometry"]
    return experiment


def cells_of(arguments):
    """(rig, world, carriage) of each cell of the table, and its experiment's file."""
    cells = {}
    for name in arguments.rigs:
        rig = read_rig(name)
        for world in arguments.worlds:
            for carriage in WORLDS[world][1]:
                if carriage in arguments.carriages:
                    file = (arguments.output / "experiments" / f"{world}_{carriage}_{name}.yaml")
                    experiment_files.write(file, experiment_of(name, rig, world, carriage), rig)
                    cells[name, world, carriage] = file
    return cells


def info_of(cell):
    return dict(zip(("rig", "world", "carriage"), cell))


def bound_job(cell, file, arguments):
    return job_runner.Job(
        destination=arguments.output / f"{file.stem}_bound",
        commands=((arguments.binaries / "plumbline_bound", f"--experiment={file}",
                   "--output=bound"),),
        required=("bound/planes.json", "bound/faces.csv", "bound/trajectory_covariance.csv"),
        optional=("bound/calibration.json",),
        failure_file=f"failed_{file.stem}_bound.json", info=info_of(cell))


def run_job(cell, file, seed, arguments):
    run = f"{file.stem}_{seed:04d}"
    return job_runner.Job(
        destination=arguments.output / run,
        commands=job_runner.simulated_run(file, file, seed, arguments.binaries),
        required=robustness.REQUIRED, failure_file=f"failed_{run}.json",
        done_codes=(0, job_runner.NOT_TRUSTED), info={**info_of(cell), "seed": seed})


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values)) if values else math.nan


def read_csv(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def bound_row(directory, info):
    poses = read_csv(directory / "trajectory_covariance.csv")
    deviations = {axis: [math.sqrt(max(0.0, float(pose[f"{axis}_{axis}"]))) for pose in poses]
                  for axis in AXES}
    limits = {"p": robustness.MAX_POSITION_M, "r": math.radians(robustness.MAX_ROTATION_DEG)}
    sigmas = {plane["id"]: plane["sigma_distance_m"]
              for plane in job_runner.read_json(directory / "planes.json")
              if plane["type"] == "vertical"}
    walls = {entry["face"]: sigmas[int(entry["plane"])]
             for entry in read_csv(directory / "faces.csv") if int(entry["plane"]) in sigmas}
    calibration = directory / "calibration.json"
    knows_imu = calibration.exists() and "imu" in job_runner.read_json(calibration)
    positions = [rms(values) for axis, values in deviations.items() if axis.startswith("p")]
    return {**info, "knows_imu": knows_imu, "position_m": math.hypot(*positions),
            "open": [words for axis, words in AXES.items()
                     if max(deviations[axis]) > limits[axis[0]]],
            "walls_m": walls}


def failed_bound(failure, info):
    return {**info, "knows_imu": False, "error": failure["error"]}


def wall_errors(directory, evaluation):
    """{true face: distance of the wall from it, m}, of the face that has the name in the bound."""
    vertical = {plane["id"] for plane in job_runner.read_json(directory / "planes.json")
                if plane["type"] == "vertical"}
    return {str(min(match["true_faces"])): match["distance_m"]
            for match in evaluation["planes"]["list"]
            if match["id"] in vertical and match["status"] == "matched"}


def run_row(directory, info):
    row = robustness.row_of(directory, info)
    evaluation, summary = (job_runner.read_json(directory / name)
                           for name in ("evaluation.json", "summary.json"))
    weak = (summary.get("consistency") or {}).get("degenerate_intervals", [])
    cause = summary.get("cause") or {}
    words = [part for part in (cause.get("name"), cause.get("scanner")) if part]
    unaligned = evaluation["trajectory"]["unaligned"]
    return {**row, "position_unaligned_m": unaligned["position_m"]["rmse"],
            "walls_m": wall_errors(directory, evaluation),
            "weak_share": sum(interval["end_s"] - interval["start_s"] for interval in weak)
            / summary["duration_s"],
            "weak_directions": sorted({interval["direction"] for interval in weak}),
            "cause": " of ".join(words)}


def failure_row(failure, info):
    row = robustness.failure_row(failure, info)
    crashed = row["outcome"] == "flagged" and (row["exit_code"] or 0) < 0
    return {**row, "outcome": "crash"} if crashed else row


def reasons_of(rows):
    """Why runs are not right, each reason once, with their number."""
    reasons = collections.Counter()
    for row in rows:
        if row["outcome"] == "right":
            continue
        reason = PLACE.sub("", row.get("error", "")) or row["cause"]
        reason = reason or f"off by {row['position_max_m']:.2g} m"
        if row.get("missing_s"):
            reason += f", {row['missing_s']:.0f} s missing"
        if row["outcome"] == "silent":
            reason = f"silent, seed {row['seed']}: {reason}, {row['rotation_max_deg']:.2g} deg"
        reasons[reason] += 1
    return reasons


def summary_of(cell, rows, bound):
    """What the runs of a cell come to. bound: its row; None where there is none."""
    counts = collections.Counter(row["outcome"] for row in rows)
    maps = [row for row in rows if "error" not in row]
    shown = [row for row in maps if row["outcome"] == "right"] or maps
    limits = (bound or {}).get("walls_m", {})
    errors = [(error, limits.get(face)) for row in shown for face, error in row["walls_m"].items()
              if not limits or face in limits]
    return {**info_of(cell), "runs": len(rows), **{name: counts[name] for name in OUTCOMES},
            "is_right": counts["right"] > 0,
            "position_m": rms([row["position_unaligned_m"] for row in shown]) if shown else None,
            "position_bound_m": (bound or {}).get("position_m"),
            "aligned_m": rms([row["position_rms_m"] for row in shown]) if shown else None,
            "wall_m": rms([error for error, _ in errors]) if errors else None,
            "wall_bound_m": rms([limit for _, limit in errors]) if errors and limits else None,
            "open": (bound or {}).get("open"), "bound_error": (bound or {}).get("error"),
            "weak_share": sum(row["weak_share"] for row in maps) / len(maps) if maps else None,
            "reasons": dict(reasons_of(rows))}


def summaries_of(cells, rows, bounds):
    """What each cell that has runs comes to."""
    def of_cell(table, cell):
        return [row for row in table if info_of(cell).items() <= row.items()]
    return [summary_of(cell, of_cell(rows, cell), next(iter(of_cell(bounds, cell)), None))
            for cell in cells if of_cell(rows, cell)]


def outcome_text(summary):
    text = "/".join(str(summary[name]) for name in OUTCOMES[:3])
    return text + "".join(f", {summary[name]} {name}" for name in OUTCOMES[3:] if summary[name])


def figure_text(summary, key):
    """"map, bound, ratio" in mm; of maps none of which is right "(map), bound"."""
    value, limit = summary[f"{key}_m"], summary[f"{key}_bound_m"]
    if value is None:
        return ""
    text = f"{1e3 * value:.3g}" if summary["is_right"] else f"({1e3 * value:.3g})"
    if limit:
        text += f", {1e3 * limit:.3g}"
    return f"{text}, {value / limit:.2f}" if limit and summary["is_right"] else text


def open_text(summary):
    if summary["bound_error"]:
        return shortened(summary["bound_error"])
    if summary["open"] is None:
        return "no bound"
    return ", ".join(summary["open"]) or "nothing"


def shortened(text):
    text = text.replace("|", "/")
    return text if len(text) <= LONGEST_REASON else text[:LONGEST_REASON - 3] + "..."


def overview_of(summaries):
    """A line a rig: right/flagged/silent in each world."""
    places = list(dict.fromkeys((one["world"], one["carriage"]) for one in summaries))
    by_cell = {(one["rig"], one["world"], one["carriage"]): one for one in summaries}
    lines = ["| right/flagged/silent | " + " | ".join(f"{world}, {carriage}"
                                                      for world, carriage in places) + " |",
             "|---" * (1 + len(places)) + "|"]
    for rig in dict.fromkeys(one["rig"] for one in summaries):
        cells = [outcome_text(by_cell[rig, *place]) if (rig, *place) in by_cell else ""
                 for place in places]
        lines.append(f"| {RIGS.get(rig, rig)} (`{rig}`) | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def details_of(summaries):
    text = ""
    for place in dict.fromkeys((one["world"], one["carriage"]) for one in summaries):
        text += (f"\n## {place[0]}, {place[1]}\n\n| rig | right/flagged/silent | positions, mm: "
                 "map, bound, ratio | aligned | walls, mm | open | weak | where it breaks |\n"
                 + "|---" * 8 + "|\n")
        for one in summaries:
            if (one["world"], one["carriage"]) != place:
                continue
            reasons = "; ".join(shortened(reason) + (f" ({number} times)" if number > 1 else "")
                                for reason, number in one["reasons"].items())
            weak = "" if one["weak_share"] is None else f"{100 * one['weak_share']:.0f} %"
            aligned = "" if one["aligned_m"] is None else f"{1e3 * one['aligned_m']:.3g}"
            text += (f"| `{one['rig']}` | {outcome_text(one)} | {figure_text(one, 'position')} | "
                     f"{aligned} | {figure_text(one, 'wall')} | {open_text(one)} | {weak} | "
                     f"{reasons} |\n")
    return text


def table_of(summaries):
    counts = {name: sum(one[name] for one in summaries) for name in OUTCOMES}
    return (overview_of(summaries) + "\n"
            + ", ".join(f"{number} {name}" for name, number in counts.items() if number) + "\n"
            + details_of(summaries))


def main():
    arguments = parse_arguments()
    for name in arguments.rigs:
        read_rig(name)
    setup = {"program": "rigs.py", **series.build_of(arguments.binaries, PROGRAMS)}
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        cells = cells_of(arguments)
        robustness.check_experiments(output, {file.stem: file for file in cells.values()})
        limits = [bound_job(cell, file, arguments) for cell, file in cells.items()
                  if cell[0] not in WHEELS]
        jobs = [run_job(cell, file, seed, arguments)
                for cell, file in cells.items() for seed in job_runner.seeds_of(arguments)]
        missing = jobs if arguments.no_bounds else limits + jobs
        output.run(missing, executor, arguments.retry_failed, "runs and bounds")
        bounds = [row for row in output.rows(limits, bound_row, failed_bound)
                  if row["knows_imu"] or "imu" not in read_rig(row["rig"])]
        rows = output.rows(jobs, run_row, failure_row)
        summaries = summaries_of(cells, rows, bounds)
        output.write_table("rigs", {"cells": summaries, "runs": rows, "bounds": bounds},
                           table_of(summaries))
    print(table_of(summaries), end="")
    failed = len(rows) < len(jobs) or any(row["outcome"] in ("crash", "no recording")
                                          for row in rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

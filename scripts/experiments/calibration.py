#!/usr/bin/python3
"""Maps simulated recordings with rig files that are wrong, and holds map and calibration against
the truth.

Every scanner but the first is turned and shifted in a random direction and stamped early or late,
and every scanner's ranges are too long or short, each by the size that is asked for; the rig file
does not say how well it knows itself, or says it by --stated. The first scanner's pose and clock
are the body's.

One row a run: the map's errors after rigid alignment, verdict, and how far the calibrated rig is
from the true one (rotation, translation, clock, range bias: root mean square over scanners and
axes). Below, per experiment: how many are right (5 cm and 0.5 deg at most) and consistent, and the
root mean squares over the runs, of the errors and in stated standard deviations.
"""

import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import subprocess
import sys

import numpy as np
import yaml

import experiment_files
import job_runner

KINDS = {"deg": ("roll_deg", "pitch_deg", "yaw_deg"), "m": ("x_m", "y_m", "z_m"),
         "s": ("time_s",), "range_m": ("range_m",)}
UNITS = {"deg": ("deg", 1.0), "m": ("mm", 1e3), "s": ("ms", 1e3), "range_m": ("mm of range", 1e3)}


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="+", metavar="EXPERIMENT",
                        help="names in configs/experiments or its folder robustness")
    parser.add_argument("--off", nargs=4, type=float, default=(1.0, 0.01, 0.002, 0.01),
                        metavar=("DEG", "M", "S", "RANGE_M"), help="how far the rig file is off")
    parser.add_argument("--stated", nargs=4, type=float, metavar=("DEG", "M", "S", "RANGE_M"),
                        help="uncertainty that it states (default: none)")
    job_runner.add_seed_arguments(parser, "experiment", 4)
    job_runner.add_arguments(parser)
    return parser.parse_args()


def experiment_file(name):
    for folder in (experiment_files.FOLDER, experiment_files.FOLDER / "robustness"):
        if (folder / f"{name}.yaml").is_file():
            return folder / f"{name}.yaml"
    raise job_runner.InputError(f"no experiment {name} in {experiment_files.FOLDER}")


def turn_of(vector):
    """The rotation matrix of a rotation vector."""
    angle = np.linalg.norm(vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def rotation_of(roll_pitch_yaw_deg):
    roll, pitch, yaw = np.radians(roll_pitch_yaw_deg)
    return (turn_of([0.0, 0.0, yaw]) @ turn_of([0.0, pitch, 0.0]) @ turn_of([roll, 0.0, 0.0]))


def roll_pitch_yaw_of(rotation):
    return [float(angle) for angle in np.degrees([
        math.atan2(rotation[2, 1], rotation[2, 2]), -math.asin(rotation[2, 0]),
        math.atan2(rotation[1, 0], rotation[0, 0])])]


def write_wrong_rig(true_file, wrong_file, off, stated, seed):
    """Writes a rig file that is off; returns by how much, {scanner: {parameter: value}}, of what
    has to be found."""
    rig = yaml.safe_load(true_file.read_text(encoding="utf-8"))
    random = np.random.default_rng(seed)
    truth = {}
    for number, scanner in enumerate(rig["scanners"]):
        direction, way = random.normal(size=(2, 3))
        turn = math.radians(off[0]) * direction / np.linalg.norm(direction)
        shift = off[1] * way / np.linalg.norm(way)
        late, too_long = random.choice([-1.0, 1.0], size=2) * off[2:]
        if number == 0:
            turn, shift, late = np.zeros(3), np.zeros(3), 0.0
        pose = scanner["body_from_scanner"]
        pose["rotation_rpy_deg"] = roll_pitch_yaw_of(
            turn_of(turn) @ rotation_of(pose["rotation_rpy_deg"]))
        pose["translation"] = [float(x) for x in np.array(pose["translation"]) + shift]
        scanner["time_offset_s"] = float(scanner.get("time_offset_s", 0.0) + late)
        scanner["range_bias_m"] = float(scanner.get("range_bias_m", 0.0) + too_long)
        scanner.pop("uncertainty", None)
        if stated:
            scanner["uncertainty"] = dict(zip(
                ("rotation_deg", "translation_m", "time_s", "range_m"), map(float, stated)))
        turned, shifted = -np.degrees(turn), -shift
        truth[scanner["name"]] = {
            **dict(zip(KINDS["deg"], turned)), **dict(zip(KINDS["m"], shifted)),
            "time_s": -late, "range_m": -too_long}
    wrong_file.write_text(yaml.safe_dump(rig), encoding="utf-8")
    return truth


def run(experiment, seed, arguments):
    """Simulates, spoils, maps and evaluates; returns the row."""
    folder = arguments.output / f"{experiment}_{seed:04d}"
    folder.mkdir(parents=True, exist_ok=True)
    row = {"experiment": experiment, "seed": seed}

    def call(program, *flags):
        return subprocess.run([arguments.binaries / program, *flags], capture_output=True,
                              text=True, check=False)

    done = call("plumbline_simulate", f"--experiment={experiment_file(experiment)}",
                f"--seed={seed}", f"--output={folder / 'truth'}")
    if done.returncode != 0:
        return {**row, "error": done.stderr.strip().splitlines()[-1]}
    truth = write_wrong_rig(folder / "truth/rig.yaml", folder / "rig.yaml", arguments.off,
                            arguments.stated, seed)
    done = call("plumbline_map", f"--recording={folder / 'truth/recording.bag'}",
                f"--rig={folder / 'rig.yaml'}", "--threads=1", f"--output={folder / 'result'}")
    if done.returncode not in (0, job_runner.NOT_TRUSTED):
        return {**row, "error": done.stderr.strip().splitlines()[-1]}
    done = call("plumbline_evaluate", f"--result={folder / 'result'}",
                f"--truth={folder / 'truth'}", f"--output={folder / 'evaluation.json'}")
    if done.returncode != 0:
        return {**row, "error": done.stderr.strip().splitlines()[-1]}
    aligned = job_runner.read_json(folder / "evaluation.json")["trajectory"]["aligned"]
    summary = job_runner.read_json(folder / "result/summary.json")
    row.update(position_rms_m=aligned["position_m"]["rmse"],
               position_max_m=aligned["position_m"]["max"],
               rotation_rms_deg=aligned["rotation_deg"]["rmse"],
               rotation_max_deg=aligned["rotation_deg"]["max"],
               verdict=summary["consistency"]["verdict"])
    row["right"] = row["position_max_m"] <= 0.05 and row["rotation_max_deg"] <= 0.5
    found = job_runner.read_json(folder / "result/calibration.json")
    for kind, names in KINDS.items():
        errors, sigmas = [], []
        for scanner in found["scanners"]:
            for parameter in scanner["parameters"]:
                if parameter["name"] in names and parameter["prior_sigma"] > 0.0:
                    errors.append(parameter["value"] - truth[scanner["name"]][parameter["name"]])
                    sigmas.append(parameter["sigma"])
        row[kind] = rms(errors)
        row[f"{kind}_normalised"] = rms(np.array(errors) / np.array(sigmas))
    return row


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def line_of(row):
    if "error" in row:
        return f"{row['experiment']} {row['seed']}: {row['error']}"
    parts = [f"{row['experiment']} {row['seed']}: {'right' if row['right'] else 'WRONG'}, "
             f"{row['verdict']}, {1e3 * row['position_rms_m']:.2f} mm rms, "
             f"{1e3 * row['position_max_m']:.1f} mm, {row['rotation_rms_deg']:.3f} deg rms, "
             f"{row['rotation_max_deg']:.2f} deg; rig"]
    parts += [f"{factor * row[kind]:.4f} {unit}" for kind, (unit, factor) in UNITS.items()]
    return " ".join(parts)


def summary_of(experiment, rows):
    mapped = [row for row in rows if "error" not in row]
    lines = [f"{experiment}: {sum(row['right'] for row in mapped)} of {len(rows)} right, "
             f"{sum(row['verdict'] == 'consistent' for row in mapped)} consistent"]
    if mapped:
        lines[0] += f", {1e3 * rms([row['position_rms_m'] for row in mapped]):.2f} mm rms"
    for kind, (unit, factor) in UNITS.items():
        if mapped:
            error = factor * rms([row[kind] for row in mapped])
            ratio = rms([row[f"{kind}_normalised"] for row in mapped])
            lines.append(f"  {error:.4f} {unit}, {ratio:.2f} stated standard deviations")
    return "\n".join(lines)


def main():
    arguments = parse_arguments()
    for experiment in arguments.experiments:
        experiment_file(experiment)
    rows = []
    with concurrent.futures.ThreadPoolExecutor(
            arguments.jobs or len(os.sched_getaffinity(0))) as executor:
        runs = [executor.submit(run, experiment, seed, arguments)
                for experiment in arguments.experiments
                for seed in job_runner.seeds_of(arguments)]
        for done in runs:
            rows.append(done.result())
            print(line_of(rows[-1]), flush=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    pathlib.Path(arguments.output / "calibration.json").write_text(
        json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    for experiment in arguments.experiments:
        print(summary_of(experiment, [r for r in rows if r["experiment"] == experiment]))
    return 1 if any("error" in row for row in rows) else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

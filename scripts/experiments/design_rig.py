#!/usr/bin/python3
"""Which rig to build: the Cramer-Rao bound (plumbline_bound) of rigs that differ from the paper's in
one respect each, and of all pairs of tilt and azimuth of its tilted scanners.

The paper's rig has a level scanner and two that are tilted by 45 degrees towards azimuths of +-45
degrees (configs/rigs/paper.yaml). All scanners are as uncertain as those measured by hand: their
calibration is among the unknowns. No run is simulated: a bound takes seconds.

Figures: medians over the walls of the standard deviations of distance (mm) and angle (deg), median and
largest over the trajectory of the position's (mm), and root mean squares over the scanners of those of
their rotations (deg) and translations (mm), as far as they are observable. "open": what is not.

--confirm maps the paper's rig and the three with the most exact walls and positions that need no other
hardware, each with --seeds simulated runs. Results: design_rig.json and design_rig.md below --output, and a picture of tilts and azimuths,
design_rig.png.
"""

import argparse
import collections
import csv
import math
import statistics
import sys

import numpy as np

import calibration
import experiment_files
import job_runner
import robustness
import series

PROGRAMS = ("plumbline_bound", "plumbline_simulate", "plumbline_map", "plumbline_evaluate")
TILTS = (15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
AZIMUTHS = (0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0)
PAPER = {"tilt": 45.0, "azimuth": 45.0, "level_tilt": 0.0, "number": 3, "field_of_view": 270.0,
         "gap": 0.0, "rate": 40.0}
VARIANTS = {
    "level_tilt": (10.0, 20.0, 30.0),      # of the first scanner, forward
    "number": (2, 4, 5),                   # 2: the tilted ones; 4: one more, backward; 5: two more
    "field_of_view": (180.0, 240.0, 360.0),
    "gap": (90.0, 180.0, 270.0),           # each scanner turned in its own plane
    "rate": (10.0, 20.0, 80.0)}
UNITS = {"tilt": "deg", "azimuth": "deg", "level_tilt": "deg", "number": "", "gap": "deg",
         "field_of_view": "deg", "rate": "Hz"}
FIGURES = {"wall_mm": "walls, mm", "wall_deg": "walls, deg", "position_mm": "positions, mm",
           "worst_mm": "worst, mm", "rotation_deg": "rig, deg", "translation_mm": "rig, mm"}
NUM_BEST = 3


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="*", metavar="EXPERIMENT",
                        help="names in configs/experiments or its folder robustness "
                        "(default: corridor office)")
    parser.add_argument("--confirm", action="store_true",
                        help="also simulate and map the best rigs")
    job_runner.add_seed_arguments(parser, "rig that is confirmed", 20)
    job_runner.add_arguments(parser)
    arguments = parser.parse_args()
    arguments.experiments = list(dict.fromkeys(arguments.experiments)) or ["corridor", "office"]
    return arguments


def designs():
    """{name: the design}, the paper's first."""
    found = {"paper": PAPER}
    for tilt in TILTS:
        for azimuth in AZIMUTHS:
            design = {**PAPER, "tilt": tilt, "azimuth": azimuth}
            if design != PAPER:
                found[f"tilt_{tilt:.0f}_azimuth_{azimuth:.0f}"] = design
    for key, values in VARIANTS.items():
        for value in values:
            found[f"{key}_{value:.0f}"] = {**PAPER, key: value}
    return found


def mountings(design):
    """(name, roll, pitch, yaw in deg, translation) of each scanner, with the paper's conventions: the
    gap of the level one points to the left, that of the left one to the ceiling, that of the
    right one to the floor."""
    tilt, azimuth = design["tilt"], design["azimuth"]
    all_of_them = [
        ("top", 0.0, design["level_tilt"], -90.0, [0.0, 0.0, 0.12]),
        ("left", 0.0, tilt, azimuth, [0.0, 0.1, 0.0]),
        ("right", 0.0, -tilt, 180.0 - azimuth, [0.0, -0.1, 0.0]),
        ("back", 0.0, tilt, 180.0, [-0.1, 0.0, 0.0]),
        ("front", 0.0, tilt, 0.0, [0.1, 0.0, 0.0])]
    return all_of_them[1:3] if design["number"] == 2 else all_of_them[:design["number"]]


def rig_of(design, uncertainty):
    """The rig file of a design, as a dictionary."""
    scanners = []
    for name, roll, pitch, yaw, translation in mountings(design):
        if name == "top":  # it pitches about the body's y axis, not about its own
            rotation = calibration.rotation_of([0.0, pitch, 0.0]) @ calibration.rotation_of(
                [0.0, 0.0, yaw])
        else:
            rotation = calibration.rotation_of([roll, pitch, yaw])
        turned = rotation @ calibration.rotation_of([0.0, 0.0, design["gap"]])
        scanners.append({
            "name": name, "topic": f"/{name}_scan",
            "body_from_scanner": {"translation": translation,
                                  "rotation_rpy_deg": calibration.roll_pitch_yaw_of(turned)},
            "range_noise_m": 0.03, "uncertainty": calibration.uncertainty_of(uncertainty),
            "min_range_m": 0.1, "max_range_m": 30.0, "beams": round(design["field_of_view"]),
            "field_of_view_deg": design["field_of_view"], "scan_rate_hz": design["rate"]})
    return {"scanners": scanners}


def write_experiment(name, design, experiment, arguments):
    """The experiment with this rig; returns its path."""
    file = arguments.output / "experiments" / f"{experiment}_{name}.yaml"
    experiment_files.write(file, experiment_files.load(experiment),
                           rig_of(design, calibration.BY_HAND))
    return file


def bound_job(name, design, experiment, arguments):
    file = write_experiment(name, design, experiment, arguments)
    run = f"{experiment}_{name}"
    return job_runner.Job(
        destination=arguments.output / run,
        commands=((arguments.binaries / "plumbline_bound", f"--experiment={file}",
                   "--output=bound"),),
        required=("bound/calibration.json", "bound/planes.json",
                  "bound/trajectory_covariance.csv"),
        failure_file=f"failed_{run}.json",
        info={"rig": name, "experiment": experiment, "design": design})


def confirming_job(name, design, experiment, seed, arguments):
    file = write_experiment(name, design, experiment, arguments)
    run = f"{experiment}_{name}_{seed:04d}"
    return job_runner.Job(
        destination=arguments.output / run,
        commands=job_runner.simulated_run(file, file, seed, arguments.binaries),
        required=("result/evaluation.json", "result/summary.json"),
        failure_file=f"failed_{run}.json", done_codes=(0, job_runner.NOT_TRUSTED),
        info={"rig": name, "experiment": experiment, "seed": seed})


def positions_mm(path):
    """Standard deviations of the trajectory's positions; the first is the frame's."""
    with open(path, encoding="utf-8", newline="") as file:
        return [1e3 * math.sqrt(sum(float(row[key]) for key in ("px_px", "py_py", "pz_pz")))
                for row in csv.DictReader(file)][1:]


def row_of(directory, info):
    walls = [plane for plane in job_runner.read_json(directory / "planes.json")
             if plane["type"] == "vertical" and plane["sigma_angle_deg"] > 0.0]  # else the frame's
    described = job_runner.read_json(directory / "calibration.json")
    free = calibration.free_parameters(described)
    sigmas = {kind: [entry["sigma"] for (_, parameter), entry in free.items()
                     if parameter in calibration.KINDS[kind] and entry["observed"]]
              for kind in ("deg", "m")}
    positions = positions_mm(directory / "trajectory_covariance.csv")
    return {**info, "open": described["unobserved"],
            "wall_mm": 1e3 * statistics.median(plane["sigma_distance_m"] for plane in walls),
            "wall_deg": statistics.median(plane["sigma_angle_deg"] for plane in walls),
            "position_mm": statistics.median(positions), "worst_mm": max(positions),
            "rotation_deg": calibration.rms(sigmas["deg"]),
            "translation_mm": 1e3 * calibration.rms(sigmas["m"])}


def failure_row(failure, info):
    return {**info, "error": failure["error"]}


def confirmed_row(directory, info):
    evaluation = job_runner.read_json(directory / "evaluation.json")
    aligned = evaluation["trajectory"]["aligned"]
    position, rotation = aligned["position_m"], aligned["rotation_deg"]
    return {**info, "position_rms_mm": 1e3 * position["rmse"],
            "wall_rms_mm": 1e3 * evaluation["planes_aligned"]["distance_m"]["rmse"],
            "right": position["max"] <= robustness.MAX_POSITION_M
            and rotation["max"] <= robustness.MAX_ROTATION_DEG,
            "verdict": job_runner.read_json(directory / "summary.json")["consistency"]["verdict"]}


def needs_other_hardware(design):
    return any(design[key] > PAPER[key] for key in ("number", "field_of_view", "rate"))


def best_rigs(rows):
    """The names of the rigs with the most exact walls and positions, by the geometric mean over both and
    the experiments of the ratios to the paper's, of those that need no other hardware."""
    paper = {row["experiment"]: row for row in rows if row["rig"] == "paper" and "error" not in row}
    ratios = {}
    for row in rows:
        if "error" in row or needs_other_hardware(row["design"]):
            continue
        if row["experiment"] in paper and row["rig"] != "paper":
            ratios.setdefault(row["rig"], []).append(sum(
                math.log(row[key] / paper[row["experiment"]][key])
                for key in ("wall_mm", "position_mm")))
    complete = {rig: statistics.fmean(values) for rig, values in ratios.items()
                if len(values) == len(paper)}
    return sorted(complete, key=complete.get)[:NUM_BEST]


def words_of(design):
    changed = [f"{key.replace('_', ' ')} {value:g} {UNITS[key]}".strip()
               for key, value in design.items() if value != PAPER[key]]
    return ", ".join(changed) or "the paper's"


def line_of(row):
    if "error" in row:
        return f"| {words_of(row['design'])} | {row['error']}" + " |" * len(FIGURES)
    figures = " | ".join(f"{row[key]:.3g}" for key in FIGURES)
    return f"| {words_of(row['design'])} | {figures} | {', '.join(row['open']) or 'nothing'} |"


def table_of(rows):
    text = ""
    for experiment in dict.fromkeys(row["experiment"] for row in rows):
        text += (f"\n## {experiment}\n\n| rig | " + " | ".join(FIGURES.values()) + " | open |\n"
                 + "|---" * (2 + len(FIGURES)) + "|\n")
        text += "".join(line_of(row) + "\n" for row in rows if row["experiment"] == experiment)
    return text


def confirmed_table(rows):
    text = "\n## Mapped\n\n| rig, experiment | right | consistent | positions, mm | walls, mm |\n" \
           "|---|---|---|---|---|\n"
    for key in dict.fromkeys((row["rig"], row["experiment"]) for row in rows):
        of_rig = [row for row in rows if (row["rig"], row["experiment"]) == key]
        maps = [row for row in of_rig if "error" not in row]
        text += (f"| {key[0]}, {key[1]} | {sum(row['right'] for row in maps)} of {len(of_rig)} | "
                 f"{sum(row['verdict'] == 'consistent' for row in maps)} | "
                 f"{rms_text(maps, 'position_rms_mm')} | {rms_text(maps, 'wall_rms_mm')} |\n")
    reasons = collections.Counter(
        (row["rig"], row["experiment"], row["error"]) for row in rows if "error" in row)
    return text + "".join(f"\n{rig}, {experiment}, {number} times: {error}\n"
                          for (rig, experiment, error), number in reasons.items())


def rms_text(maps, figure):
    return f"{calibration.rms([row[figure] for row in maps]):.2f}" if maps else "no map"


def ratios_of(rows, experiment, figure):
    """Of tilts (rows) and azimuths (columns), to the paper's; NaN where there is none."""
    found = {(row["design"]["tilt"], row["design"]["azimuth"]): row[figure] for row in rows
             if row["experiment"] == experiment and "error" not in row
             and {**row["design"], "tilt": 0, "azimuth": 0} == {**PAPER, "tilt": 0, "azimuth": 0}}
    paper = found.get((PAPER["tilt"], PAPER["azimuth"]), math.nan)
    return np.array([[found.get((tilt, azimuth), math.nan) / paper for azimuth in AZIMUTHS]
                     for tilt in TILTS])


def draw(rows, experiments, path):
    """The picture: ratios to the paper's of walls, positions and calibration by tilt and azimuth."""
    # pylint: disable=import-outside-toplevel
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    shown = {"wall_mm": "walls", "position_mm": "positions", "rotation_deg": "calibration"}
    figure, axes = pyplot.subplots(len(experiments), len(shown), squeeze=False,
                                   figsize=(4.2 * len(shown), 3.6 * len(experiments)))
    for line, experiment in zip(axes, experiments):
        for ax, (key, name) in zip(line, shown.items()):
            ratios = ratios_of(rows, experiment, key)
            ax.imshow(np.log2(ratios), cmap="RdYlGn_r", vmin=-1.5, vmax=1.5, origin="lower")
            for (y, x), ratio in np.ndenumerate(ratios):
                if math.isfinite(ratio):
                    ax.text(x, y, f"{ratio:.2f}", ha="center", va="center", fontsize=8)
            ax.set_xticks(range(len(AZIMUTHS)), [f"{azimuth:.0f}" for azimuth in AZIMUTHS])
            ax.set_yticks(range(len(TILTS)), [f"{tilt:.0f}" for tilt in TILTS])
            ax.set(title=f"{experiment}: {name}", xlabel="azimuth, deg", ylabel="tilt, deg")
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={"Software": None})
    pyplot.close(figure)


def main():
    arguments = parse_arguments()
    for experiment in arguments.experiments:
        experiment_files.of_case(experiment)
    setup = {"program": "design_rig.py", "experiments": arguments.experiments,
             **series.build_of(arguments.binaries, PROGRAMS)}
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        jobs = [bound_job(name, design, experiment, arguments)
                for experiment in arguments.experiments for name, design in designs().items()]
        output.run(jobs, executor, arguments.retry_failed, "bounds")
        rows = output.rows(jobs, row_of, failure_row)
        table = table_of(rows)
        draw(rows, arguments.experiments, arguments.output / "design_rig.png")
        if arguments.confirm:
            runs = [confirming_job(name, designs()[name], experiment, seed, arguments)
                    for name in ("paper", *best_rigs(rows))
                    for experiment in arguments.experiments
                    for seed in job_runner.seeds_of(arguments)]
            output.run(runs, executor, arguments.retry_failed, "runs")
            confirmed = output.rows(runs, confirmed_row, failure_row)
            table += confirmed_table(confirmed)
            output.write_json("confirmed.json", confirmed)
        output.write_table("design_rig", rows, table)
    print(table, end="")
    print(f"\nmost exact walls and positions: {', '.join(best_rigs(rows))}; picture: "
          f"{arguments.output / 'design_rig.png'}")
    return 1 if len(rows) < len(jobs) or any("error" in row for row in rows) else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

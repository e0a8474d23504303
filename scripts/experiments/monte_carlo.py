#!/usr/bin/python3
"""Simulates, maps and evaluates an experiment many times, each time with another seed, and prints
the spread of the main figures over all runs.

Each run is one directory below --output, named by its seed (run_0001, run_0002, ...). Runs that
are there already are not done again, so the same command goes on after an interruption, and one
with more runs or another first seed adds to them. A run that fails is listed with its error and
counted.
"""

import argparse
import pathlib
import statistics
import sys

import experiment_files
import job_runner
import series

EXPERIMENTS = experiment_files.FOLDER
PROGRAMS = ("plumbline_simulate", "plumbline_map", "plumbline_evaluate")
REQUIRED = ("result/evaluation.json", "result/summary.json", "result/planes.json",
            "result/trajectory.tum", "truth/truth_planes.json", "truth/truth_trajectory.tum")
OPTIONAL = ("result/trajectory_covariance.csv", "result/plane_covariance.csv",
            "result/window_trajectory.tum", "result/window_trajectory_covariance.csv",
            "result/window_planes.json", "result/window_plane_covariance.csv",
            "result/calibration.json", "truth/truth_mounts.json", "truth/truth_imu.json",
            "truth/rig.yaml", "exit_codes.json")

# Key in summary.json, name in the table, its unit, value in that unit per value in the file,
# decimals, file and keys in it.
FIGURES = (
    ("position_rmse_unaligned_m", "position RMSE, unaligned", "mm", 1e3, 2,
     "evaluation.json", ("trajectory", "unaligned", "position_m", "rmse")),
    ("position_rmse_aligned_m", "position RMSE, aligned", "mm", 1e3, 2,
     "evaluation.json", ("trajectory", "aligned", "position_m", "rmse")),
    ("rotation_rmse_unaligned_deg", "rotation RMSE, unaligned", "deg", 1, 3,
     "evaluation.json", ("trajectory", "unaligned", "rotation_deg", "rmse")),
    ("rotation_rmse_aligned_deg", "rotation RMSE, aligned", "deg", 1, 3,
     "evaluation.json", ("trajectory", "aligned", "rotation_deg", "rmse")),
    ("planes_matched", "planes matched", "", 1, 1, "evaluation.json", ("planes", "matched")),
    ("planes_wrong", "planes wrong", "", 1, 1, "evaluation.json", ("planes", "wrong")),
    ("planes_doubled", "planes doubled", "", 1, 1, "evaluation.json", ("planes", "doubled")),
    ("planes_missed", "planes missed", "", 1, 1, "evaluation.json", ("planes", "missed")),
    ("residual_rms_m", "residual RMS", "mm", 1e3, 2, "summary.json", ("residual_rms_m",)),
    ("real_time_factor", "times real time", "", 1, 1, "summary.json", ("real_time_factor",)),
)


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiment", metavar="EXPERIMENT",
                        help="YAML file, or the name of one in configs/experiments")
    parser.add_argument("--runs", type=job_runner.positive, default=50, metavar="N",
                        help="number of runs (default 50)")
    parser.add_argument("--first-seed", type=job_runner.positive, default=1, metavar="N",
                        help="seed of the first run; the others count up (default 1)")
    parser.add_argument("--config", type=job_runner.resolved, metavar="FILE",
                        help="mapper settings (default: the experiment's own)")
    job_runner.add_arguments(parser)
    return parser.parse_args()


def find_experiment(name):
    for path in (pathlib.Path(name), EXPERIMENTS / f"{name}.yaml"):
        if path.is_file():
            return path.resolve()
    raise job_runner.InputError(
        f"no experiment {name}: neither a file nor a name in configs/experiments")


def make_jobs(arguments, experiment, config):
    seeds = range(arguments.first_seed, arguments.first_seed + arguments.runs)
    return [
        job_runner.Job(
            destination=arguments.output / f"run_{seed:04d}",
            commands=job_runner.simulated_run(experiment, config, seed, arguments.binaries),
            required=REQUIRED,
            optional=OPTIONAL,
            failure_file=f"failed_{seed:04d}.json",
            done_codes=(0, job_runner.NOT_TRUSTED),
            info={"seed": seed})
        for seed in seeds]


def figures_of(directory):
    """The main figures of one run, in the files' units; None where a file does not have one. With
    them, whether the map is one that must not be trusted."""
    files = {name: job_runner.read_object(directory / name)
             for name in ("evaluation.json", "summary.json")}
    figures = {}
    for key, _, _, _, _, name, path in FIGURES:
        value = files[name]
        for part in path:
            value = value.get(part) if isinstance(value, dict) else None
        figures[key] = value
    exit_codes = directory / "exit_codes.json"
    is_trusted = not exit_codes.exists() or (
        job_runner.NOT_TRUSTED not in job_runner.read_json(exit_codes))
    return {**figures, "is_trusted": is_trusted}


def spread(values):
    """Over the runs that have a value."""
    known = [value for value in values if value is not None]
    if not known:
        return {"runs": 0}
    return {"runs": len(known), "min": min(known), "median": statistics.median(known),
            "max": max(known)}


def summarise(output, experiment):
    """What all runs in the output directory say together."""
    done = {directory.name: job_runner.readable(figures_of, directory)
            for directory in sorted(output.path.glob("run_*")) if directory.is_dir()}
    runs = [figures for figures in done.values() if figures]
    failures = [{"seed": failure["seed"], "error": failure["error"]}
                for failure in output.failures("seed")]
    return {"experiment": experiment.stem, "runs": len(runs), "failed": len(failures),
            "failures": failures,
            "not_trusted": sum(not run["is_trusted"] for run in runs),
            "damaged": [name for name, figures in done.items() if not figures],
            "figures": {key: spread([run[key] for run in runs]) for key, *_ in FIGURES}}


def print_table(summary):
    print(f"{summary['experiment']}: {summary['runs']} runs done, {summary['failed']} failed")
    if summary["not_trusted"]:
        print(f"{summary['not_trusted']} of the maps contradict their scans (exit code "
              f"{job_runner.NOT_TRUSTED})")
    print(f"{'':32}{'runs':>6}{'min':>10}{'median':>10}{'max':>10}")
    for key, name, unit, factor, digits, *_ in FIGURES:
        figure = summary["figures"][key]
        cells = "".join(f"{factor * figure[end]:10.{digits}f}" if end in figure else f"{'-':>10}"
                        for end in ("min", "median", "max"))
        print(f"{name:26}{unit:>6}{figure['runs']:6}{cells}")
    for failure in summary["failures"]:
        print(f"failed: seed {failure['seed']}: {failure['error']}")


def main():
    arguments = parse_arguments()
    experiment = find_experiment(arguments.experiment)
    config = arguments.config or experiment
    setup = {
        "program": "monte_carlo.py",
        "experiment": {"name": experiment.stem, "files": experiment_files.read(experiment)},
        "config": {"name": config.stem, "text": job_runner.read_text(config)},
        **series.build_of(arguments.binaries, PROGRAMS),
    }
    jobs = make_jobs(arguments, experiment, config)
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        output.run(jobs, executor, arguments.retry_failed, "runs")
        summary = summarise(output, experiment)
        output.write_json("summary.json", summary)
    print_table(summary)
    return 1 if summary["failed"] or summary["damaged"] else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

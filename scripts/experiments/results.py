#!/usr/bin/python3
"""Simulates, maps and evaluates the shipped experiments over several seeds and prints the figures
of docs/results.md as a Markdown table.

Every run keeps its evaluation.json and summary.json below --output; a run that is already there
is not done again, unless it is damaged or failed. A run that fails is listed with its error.
"""

import argparse
import sys

import experiment_files
import job_runner
import series

ROOT = job_runner.ROOT
EXPERIMENTS = experiment_files.FOLDER
PROGRAMS = ("plumbline_simulate", "plumbline_map", "plumbline_evaluate")

# Name of the case: experiment that is simulated, file with the mapper's settings.
CASES = {
    "corridor": ("corridor", "corridor"),
    "corridor, wobble and fast turns": ("corridor_wobble", "corridor_wobble"),
    "three loops, closure off": ("corridor_three_loops", "corridor_three_loops"),
    "three loops, closure on": ("corridor_three_loops", "corridor"),
    "office": ("office", "office"),
    "office, wobble": ("office_wobble", "office_wobble"),
    "room": ("room", "room"),
}


def make_job(case, seed, arguments):
    experiment, config = CASES[case]
    case_directory = arguments.output / case.replace(", ", "-").replace(" ", "_")
    return job_runner.Job(
        destination=case_directory / f"seed_{seed}",
        commands=job_runner.simulated_run(EXPERIMENTS / f"{experiment}.yaml",
                                          EXPERIMENTS / f"{config}.yaml", seed,
                                          arguments.binaries),
        required=("result/evaluation.json", "result/summary.json"))


def is_done(job):
    return job.destination.is_dir() and read_result(job) is not None


def run_missing(jobs, arguments):
    """Error messages by the destination of the jobs that failed."""
    missing = [job for job in jobs if not is_done(job)]
    errors = {}
    progress = job_runner.Progress(len(jobs), len(missing), "runs")
    with job_runner.LocalExecutor(arguments.jobs) as executor, \
            job_runner.WorkDirectory(arguments.output) as work:
        for job in missing:
            if job.destination.exists():  # damaged, or without an evaluation
                job_runner.discard(job.destination)
        for job, failure in executor.run(missing, work):
            if failure is not None:
                errors[job.destination] = failure["error"]
            progress.count(failure is not None)
    return errors


def read_result(job):
    """Evaluation and summary of a run; None, after one line, where the row lacks any of them."""
    try:
        result = tuple(job_runner.read_object(job.destination / name)
                       for name in ("evaluation.json", "summary.json"))
        row("", [result], 1)
        return result
    except (job_runner.InputError, LookupError, TypeError, ValueError) as error:
        job_runner.warn(f"{job.destination} is damaged; done again: {error}")
        return None


def span(values, digits):
    return f"{min(values):.{digits}f} to {max(values):.{digits}f}"


def row(case, good, num_runs):
    cells = [case, f"{len(good)} of {num_runs}"]
    if good:
        trajectories = [e["trajectory"]["unaligned"] for e, _ in good]
        planes = [e["planes"] for e, _ in good]
        cells += [
            span([1e3 * t["position_m"]["rmse"] for t in trajectories], 2),
            span([1e3 * e["trajectory"]["aligned"]["position_m"]["rmse"] for e, _ in good], 2),
            span([t["rotation_deg"]["rmse"] for t in trajectories], 3),
            span([p["matched"] + p["doubled"] for p in planes], 0),
            span([p["wrong"] for p in planes], 0),
            span([p["doubled"] for p in planes], 0),
            span([p["missed"] for p in planes], 0),
            span([p["angle_deg"]["max"] for p in planes], 3),
            span([1e3 * p["distance_m"]["max"] for p in planes], 2),
            span([1e3 * e["planes_aligned"]["distance_m"]["max"] for e, _ in good], 2),
            span([1e3 * s["residual_rms_m"] for _, s in good], 2),
            span([s["real_time_factor"] for _, s in good], 1),
            span([s["peak_memory_mb"] for _, s in good], 0),
        ]
    return "| " + " | ".join(cells) + " |"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--seeds", type=int, default=10, help="runs of each case (default 10)")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time (default 1)")
    parser.add_argument("--case", action="append", choices=sorted(CASES),
                        help="only this case; may be repeated")
    parser.add_argument("--binaries", type=job_runner.resolved, default=ROOT / "build" / "bin")
    parser.add_argument("--output", type=job_runner.resolved, default=ROOT / "out" / "results")
    job_runner.add_build_argument(parser)
    return parser.parse_args()


def setup_of(arguments):
    """Of all cases, since those that are chosen may change from run to run."""
    files = {name: experiment_files.checksum(EXPERIMENTS / f"{name}.yaml")
             for names in CASES.values() for name in names}
    return {"program": "results.py", "experiments": files,
            **series.build_of(arguments.binaries, PROGRAMS)}


def print_tables(cases, jobs, errors, num_seeds):
    print("| case | mapped | position RMSE / mm | the same, aligned / mm | "
          "rotation RMSE / deg | planes on true faces | "
          "wrong | doubled | missed | largest angle error / deg | largest distance error / mm | "
          "the same, aligned / mm | residual RMS / mm | times real time | memory / MB |")
    print("|" + "---|" * 15)
    for case in cases:
        case_jobs = [jobs[case, seed] for seed in range(1, num_seeds + 1)]
        results = [read_result(job) for job in case_jobs if job.destination.is_dir()]
        print(row(case, [result for result in results if result], len(case_jobs)))
    for (case, seed), job in jobs.items():
        if job.destination in errors:
            print(f"\nfailed: {case}, seed {seed}: {errors[job.destination]}")


def main():
    arguments = parse_arguments()
    cases = arguments.case or list(CASES)
    jobs = {(case, seed): make_job(case, seed, arguments)
            for seed in range(1, arguments.seeds + 1) for case in cases}
    with series.Output(arguments.output, setup_of(arguments), arguments.accept_other_build):
        errors = run_missing(list(jobs.values()), arguments)
    print_tables(cases, jobs, errors, arguments.seeds)
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

#!/usr/bin/python3
"""Maps the worlds of configs/experiments/robustness, which are hard or have something wrong, and
says of each run whether the map is right, or wrong with a warning, or wrong in silence.

    right     the whole trajectory within 5 cm and 0.5 degrees after rigid alignment
    flagged   it is not, and the mapper says so: an error, exit code 3, a verdict other than
              consistent, or a trajectory that lacks a part of the recording, with a warning
    silent    it is not, and nobody says so

Each run is one directory below --output, named by case and seed. Runs that are there already are
not done again. The table goes to robustness.md and robustness.json there, and is printed.
"""

import argparse
import collections
import sys

import experiment_files
import job_runner
import series

FOLDER = experiment_files.FOLDER / "robustness"
PROGRAMS = ("plumbline_simulate", "plumbline_map", "plumbline_evaluate")
REQUIRED = ("result/evaluation.json", "result/summary.json", "result/planes.json",
            "result/trajectory.tum", "truth/truth_planes.json", "truth/truth_trajectory.tum",
            "exit_codes.json")
OPTIONAL = ("result/trajectory_covariance.csv", "result/plane_covariance.csv")
MAX_POSITION_M = 0.05       # of the largest error of a map that is right
MAX_ROTATION_DEG = 0.5
MAX_MISSING_S = 1.0         # of the recording, at its begin or its end
MIN_FALSE_PLANE_M = 1.0     # extent of a plane without a true face that is worth counting
FLAGGING_VERDICTS = ("doubtful", "contradictory")
OUTCOMES = ("right", "flagged", "silent", "no recording")

HEADINGS = ("case", "seed", "exit", "verdict", "warnings", "position RMS (mm)", "largest (mm)",
            "rotation RMS (deg)", "largest (deg)", "planes of true", "false planes over 1 m",
            "times real time", "outcome")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE",
                        help="names of experiments (default: all of the folder)")
    parser.add_argument("--experiments", type=job_runner.resolved, default=FOLDER, metavar="DIR",
                        help="folder of the experiments, such as that of "
                        "scripts/buildings/random_building.py (configs/experiments/robustness)")
    job_runner.add_seed_arguments(parser, "case", 2)
    parser.add_argument("--config", type=job_runner.resolved, metavar="FILE",
                        help="mapper settings (default: the experiments' own)")
    job_runner.add_arguments(parser)
    parser.set_defaults(jobs=1)
    return parser.parse_args()


def chosen_cases(folder, names):
    cases = {path.stem: path for path in sorted(folder.glob("*.yaml"))}
    if not cases:
        raise job_runner.InputError(f"no experiments in {folder}")
    for name in names:
        if name not in cases:
            raise job_runner.InputError(f"no case {name} in {folder}; there are "
                                        f"{', '.join(cases)}")
    return {name: cases[name] for name in names or cases}


def run_name(case, seed):
    return f"{case}_{seed:04d}"


def check_experiments(output, cases):
    """Keeps in experiments.json what each case was when it was run first. An error when one of
    the chosen cases has changed since."""
    path = output.path / "experiments.json"
    stored = job_runner.read_object(path) if path.exists() else {}
    checksums = {case: experiment_files.checksum(file) for case, file in cases.items()}
    changed = [case for case in checksums if stored.get(case, checksums[case]) != checksums[case]]
    if changed:
        raise job_runner.InputError(f"{output.path} holds results of another {changed[0]}; "
                                    "choose another --output")
    output.write_json("experiments.json", {**stored, **checksums})


def make_jobs(arguments, cases):
    seeds = job_runner.seeds_of(arguments)
    return [
        job_runner.Job(
            destination=arguments.output / run_name(case, seed),
            commands=job_runner.simulated_run(experiment, arguments.config or experiment, seed,
                                              arguments.binaries),
            required=REQUIRED,
            optional=OPTIONAL,
            failure_file=f"failed_{run_name(case, seed)}.json",
            done_codes=(0, job_runner.NOT_TRUSTED),
            info={"case": case, "seed": seed})
        for case, experiment in cases.items() for seed in seeds]


def time_span(path):
    """First and last stamp of a trajectory file, in seconds."""
    lines = [line for line in job_runner.read_text(path).splitlines()
             if line and not line.startswith("#")]
    return float(lines[0].split()[0]), float(lines[-1].split()[0])


def missing_time(directory):
    """Seconds of the recording that the trajectory lacks at its begin and its end."""
    begin, end = time_span(directory / "trajectory.tum")
    true_begin, true_end = time_span(directory / "truth_trajectory.tum")
    return sum(lack for lack in (begin - true_begin, true_end - end) if lack > MAX_MISSING_S)


def extent(plane):
    """The longer side of the box about a plane's outline, m."""
    return max((max(axis) - min(axis) for axis in zip(*plane["outline"])), default=0.0)


def count_false_planes(evaluation, planes):
    wrong = {match["id"] for match in evaluation["planes"]["list"] if match["status"] == "wrong"}
    return sum(plane["id"] in wrong and extent(plane) > MIN_FALSE_PLANE_M for plane in planes)


def row_of(directory, info):
    """One row of the table, of a run that gave a map."""
    evaluation, summary, planes, exit_codes = (
        job_runner.read_json(directory / name)
        for name in ("evaluation.json", "summary.json", "planes.json", "exit_codes.json"))
    aligned = evaluation["trajectory"]["aligned"]
    found = evaluation["planes"]
    row = {
        **info, "exit_code": exit_codes[1],
        "verdict": (summary.get("consistency") or {}).get("verdict"),
        "warnings": summary["warnings"],
        "position_rms_m": aligned["position_m"]["rmse"],
        "position_max_m": aligned["position_m"]["max"],
        "rotation_rms_deg": aligned["rotation_deg"]["rmse"],
        "rotation_max_deg": aligned["rotation_deg"]["max"],
        "planes_matched": found["matched"],
        "planes_true": found["matched"] + found["missed"],
        "planes_wrong": found["wrong"],
        "false_planes": count_false_planes(evaluation, planes),
        "real_time_factor": summary["real_time_factor"],
        "parts": len(summary.get("parts", ())) or 1,
        "missing_s": missing_time(directory),
    }
    return {**row, "outcome": outcome_of(row)}


def outcome_of(row):
    if (row["position_max_m"] <= MAX_POSITION_M and row["rotation_max_deg"] <= MAX_ROTATION_DEG
            and row["missing_s"] == 0.0):
        return "right"
    if row["exit_code"] == job_runner.NOT_TRUSTED or row["verdict"] in FLAGGING_VERDICTS:
        return "flagged"
    return "flagged" if row["missing_s"] > 0.0 and row["warnings"] else "silent"


def failure_row(failure, info):
    """One row of the table, of a run that ended with an error."""
    program = str((failure.get("command") or [""])[0]).rsplit("/", 1)[-1]
    return {**info, "exit_code": failure.get("exit_code"), "error": failure["error"],
            "outcome": "flagged" if program == "plumbline_map" else "no recording"}


def cells_of(row):
    def number(key, factor, digits):
        return f"{factor * row[key]:.{digits}f}" if key in row else ""

    planes = f"{row['planes_matched']} of {row['planes_true']}" if "planes_true" in row else ""
    outcome = row["outcome"]
    if row.get("missing_s"):
        outcome += f", {row['missing_s']:.0f} s missing"
    if row.get("parts", 1) > 1:
        outcome += f", the longest of {row['parts']} parts"
    if "error" in row:
        outcome += f": {row['error']}"
    return (row["case"], str(row["seed"]), str(row["exit_code"]), row.get("verdict") or "",
            str(len(row.get("warnings", ()))), number("position_rms_m", 1e3, 1),
            number("position_max_m", 1e3, 1), number("rotation_rms_deg", 1, 2),
            number("rotation_max_deg", 1, 2), planes, str(row.get("false_planes", "")),
            number("real_time_factor", 1, 1), outcome)


def table_of(rows):
    lines = ["| " + " | ".join(HEADINGS) + " |", "|" + "---|" * len(HEADINGS)]
    lines += ["| " + " | ".join(cell.replace("|", "/") for cell in cells_of(row)) + " |"
              for row in rows]
    counts = collections.Counter(row["outcome"] for row in rows)
    lines += ["", ", ".join(f"{counts[outcome]} {outcome}" for outcome in OUTCOMES
                            if counts[outcome])]
    return "\n".join(lines) + "\n"


def main():
    arguments = parse_arguments()
    cases = chosen_cases(arguments.experiments, arguments.cases)
    setup = {
        "program": "robustness.py",
        "config": arguments.config and job_runner.read_text(arguments.config),
        **series.build_of(arguments.binaries, PROGRAMS),
    }
    jobs = make_jobs(arguments, cases)
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        check_experiments(output, cases)
        output.run(jobs, executor, arguments.retry_failed, "runs")
        rows = output.rows(jobs, row_of, failure_row)
        output.write_table("robustness", rows, table_of(rows))
    print(table_of(rows), end="")
    failed = len(rows) < len(jobs) or any(row["outcome"] == "no recording" for row in rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

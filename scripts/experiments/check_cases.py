#!/usr/bin/python3
"""Simulates recordings that have something wrong, and good ones, and says of each what
plumbline_check tells about it.

    told       the fault is named, and no other
    not told   it is not
    in doubt   it is named, but so is something else
    clear      nothing is wrong, and nothing is told
    alarm      nothing is wrong, but plumbline_check says so

Notes do not count, only warnings and stops. Each run is one directory below --output, named by
case and seed; runs that are there already are not done again. The table goes to check_cases.md and
check_cases.json there, and is printed.
"""

import argparse
import collections
import re
import sys

import experiment_files
import job_runner
import series

PROGRAMS = ("plumbline_simulate", "plumbline_check")
REQUIRED = ("check/check.json", "exit_codes.json")
# What has to be told of the cases that have something wrong: the exit code, the subject and a
# pattern of the sentence.
FAULTS = {
    "mirrored": (3, "", r"scanner top is mirrored"),
    "swapped": (3, "", r"scanners left and right are exchanged"),
    "turned_10_deg": (3, "/left_scan", r"turned by (9\.[5-9]|10\.[0-5]) deg about the vertical"),
    "feet": (3, "", r"scanner right gives its ranges in feet"),
    "clock_50_ms": (0, "/left_scan", r"stamped (4[5-9]|5[0-5]) ms too late"),
    "extrinsics_half_deg": (0, "/left_scan", r"turned by 0\.[4-6] deg"),
    "range_bias_1_cm": (0, "/left_scan", r"measure (7|8|9|10|11|12|13) mm too long"),
    "frozen": (0, "/top_scan", r"frozen.* from 25 to 33 s"),
    "no_returns": (0, "/top_scan", r"next to nothing from 25 to 33 s"),
    "random_ranges": (0, "/right_scan", r"nothing that continues .* from 25 to 33 s"),
    "gone": (0, "/left_scan", r"sends nothing for 8\.0 s"),
    "all_gone": (0, "", r"no scanner sends anything from 20\.0 to 22\.0 s"),
}
GOOD = ("room", "corridor", "office", "plain", "furniture", "glass", "people_and_doors",
        "fzk_ground", "attic_35_deg", "curved_corridor", "orthogonal_scanners", "carried",
        "strong_swings", "scattered_ranges", "uneven_4_mm", "hall", "round_room", "fzk_stairs",
        "duplex_a_stairs", "smooth_corridor")
OUTCOMES = ("told", "in doubt", "not told", "clear", "alarm", "no recording")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE",
                        help="names in configs/experiments and its folder robustness (default: "
                        f"{', '.join((*FAULTS, *GOOD))})")
    parser.add_argument("--seeds", type=job_runner.positive, default=2, metavar="N",
                        help="runs of each case (default 2)")
    parser.add_argument("--first-seed", type=job_runner.positive, default=601, metavar="N",
                        help="seed of the first run; the others count up (default 601)")
    job_runner.add_arguments(parser)
    return parser.parse_args()


def make_jobs(arguments):
    seeds = range(arguments.first_seed, arguments.first_seed + arguments.seeds)
    jobs = []
    for case in arguments.cases or (*FAULTS, *GOOD):
        experiment = experiment_files.of_case(case)
        for seed in seeds:
            name = f"{case}_{seed:04d}"
            jobs.append(job_runner.Job(
                destination=arguments.output / name,
                commands=(
                    (arguments.binaries / "plumbline_simulate", f"--experiment={experiment}",
                     f"--seed={seed}", "--output=truth"),
                    (arguments.binaries / "plumbline_check", "--recording=truth/recording.bag",
                     "--rig=truth/rig.yaml", "--output=check")),
                required=REQUIRED, failure_file=f"failed_{name}.json",
                done_codes=(0, job_runner.NOT_TRUSTED), info={"case": case, "seed": seed}))
    return jobs


def names_fault(finding, case):
    _, subject, pattern = FAULTS[case]
    return finding["subject"] == subject and re.search(pattern, finding["sentence"]) is not None


def outcome_of(case, exit_code, findings):
    """findings: warnings and stops."""
    if case not in FAULTS:
        return "alarm" if findings or exit_code != 0 else "clear"
    named = [finding for finding in findings if names_fault(finding, case)]
    if not named or exit_code != FAULTS[case][0]:
        return "not told"
    return "told" if len(findings) == len(named) else "in doubt"


def row_of(directory, case, seed):
    check = job_runner.read_json(directory / "check.json")
    exit_code = job_runner.read_json(directory / "exit_codes.json")[1]
    findings = [finding for finding in check["findings"] if finding["severity"] != "note"]
    return {"case": case, "seed": seed, "exit_code": exit_code, "mappable": check["mappable"],
            "findings": findings, "outcome": outcome_of(case, exit_code, findings)}


def collect(output, jobs):
    """Rows of the table, one for each run that is there."""
    rows = []
    for job in jobs:
        case, seed = job.info["case"], job.info["seed"]
        if job.destination.is_dir():
            rows.append(job_runner.readable(row_of, job.destination, case, seed))
        elif failure := output.read_failure(job.failure_file):
            rows.append({"case": case, "seed": seed, "findings": [], "outcome": "no recording",
                         "error": failure["error"]})
    return [row for row in rows if row]


def words_of(rows):
    """What was told of a case, in the words of its first run that has any."""
    for row in rows:
        if row["findings"]:
            return "; ".join(finding["sentence"] for finding in row["findings"])
    return ""


def table_of(rows):
    cases = {}
    for row in rows:
        cases.setdefault(row["case"], []).append(row)
    lines = ["| case | runs | outcome | in words, of the first run |", "|---|---|---|---|"]
    for case, of_case in cases.items():
        counts = collections.Counter(row["outcome"] for row in of_case)
        outcomes = ", ".join(f"{counts[outcome]} {outcome}" for outcome in OUTCOMES
                             if counts[outcome])
        lines.append(f"| `{case}` | {len(of_case)} | {outcomes} | "
                     f"{words_of(of_case).replace('|', '/')} |")
    counts = collections.Counter(row["outcome"] for row in rows)
    lines += ["", ", ".join(f"{counts[outcome]} {outcome}" for outcome in OUTCOMES
                            if counts[outcome])]
    return "\n".join(lines) + "\n"


def main():
    arguments = parse_arguments()
    setup = {"program": "check_cases.py",
             **series.build_of(arguments.binaries, PROGRAMS)}
    jobs = make_jobs(arguments)
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        output.run(jobs, executor, arguments.retry_failed, "runs")
        rows = collect(output, jobs)
        output.write_json("check_cases.json", rows)
        (output.path / "check_cases.md").write_text(table_of(rows), encoding="utf-8")
    print(table_of(rows), end="")
    failed = len(rows) < len(jobs) or any(row["outcome"] == "no recording" for row in rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

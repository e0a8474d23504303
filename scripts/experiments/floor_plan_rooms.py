#!/usr/bin/python3
"""Holds the rooms of floor plans against the buildings that were simulated, with several seeds.

Each run is one directory below --output, named by case and seed; runs that are there already are
not done again. The table, a line for each storey with the least rooms found and the worst area
over all seeds, goes to floor_plan_rooms.md and floor_plan_rooms.json there, and is printed.
"""

import argparse
import pathlib
import sys

import yaml

import experiment_files
import job_runner
import series

PROGRAMS = ("plumbline_simulate", "plumbline_map")
ROOMS = job_runner.ROOT / "scripts" / "analysis" / "rooms.py"
REQUIRED = ("rooms_and_truth.json", "result/rooms.json", "exit_codes.json")
OPTIONAL = ("result/floor_plan*.svg", "result/building.city.json")
CASES = ("office", "furniture", "people_and_doors", "fzk_ground", "duplex_a_stairs", "two_storeys",
         "curved_corridor", "round_room", "room")
# Of the section through a mesh above the floor: above doors and windows, below the ceiling, m.
SECTION_M = {"duplex.ply": 2.56}
MIN_WAY_M = 0.5  # in a room that was walked through


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE",
                        help="names in configs/experiments and its folder robustness (default: "
                        f"{', '.join(CASES)})")
    job_runner.add_seed_arguments(parser, "case", 3, first_seed=691)
    job_runner.add_arguments(parser)
    return parser.parse_args()


def building_of(experiment):
    parts = yaml.safe_load(job_runner.read_text(experiment))
    return (experiment.parent / parts["building"]).resolve()


def commands_of(experiment, seed, binaries):
    building = building_of(experiment)
    section = SECTION_M.get(building.name)
    return (
        (binaries / "plumbline_simulate", f"--experiment={experiment}", f"--seed={seed}",
         "--output=truth"),
        (binaries / "plumbline_map", "--recording=truth/recording.bag", "--rig=truth/rig.yaml",
         f"--config={experiment}", "--threads=1", "--floor_plan", "--output=result"),
        (sys.executable, ROOMS, "result", "--truth", "truth", "--building", building,
         "--output", "rooms_and_truth.json", *(("--height", section) if section else ())))


def make_jobs(arguments, cases):
    seeds = job_runner.seeds_of(arguments)
    jobs = []
    for case, experiment in cases.items():
        for seed in seeds:
            name = f"{case}_{seed:04d}"
            jobs.append(job_runner.Job(
                destination=arguments.output / name,
                commands=commands_of(experiment, seed, arguments.binaries),
                required=REQUIRED, optional=OPTIONAL, failure_file=f"failed_{name}.json",
                done_codes=(0, job_runner.NOT_TRUSTED), info={"case": case, "seed": seed}))
    return jobs


def worst_of(rooms):
    """The largest error of an area and its room; none of no rooms."""
    return max(rooms, key=lambda room: abs(room["error_percent"]), default=None)


def rows_of(directory, case, seed):
    """A row for each storey of a run."""
    storeys = job_runner.read_json(directory / "rooms_and_truth.json")
    plans = job_runner.read_json(directory / "rooms.json")["storeys"]
    rows = []
    for storey, plan in zip(storeys, plans):
        walked = [room for room in storey["rooms"] if room["way_m"] >= MIN_WAY_M]
        found = [room for room in walked if room["room"] is not None]
        looked_into = [room for room in storey["rooms"]
                       if room["way_m"] < MIN_WAY_M and room["room"] is not None]
        rows.append({
            "case": case, "seed": seed, "storey": storey["storey"],
            "walked": len(walked), "found": len(found), "not_in_truth": storey["not_in_truth"],
            "worst": worst_of(found), "looked_into": len(looked_into),
            "worst_looked_into": worst_of(looked_into),
            "doors": sum(None not in door["rooms"] for door in plan["doors"])})
    return rows


def collect(output, jobs):
    """Rows of all runs that are there, and the failures of the others."""
    rows, failures = [], []
    for job in jobs:
        case, seed = job.info["case"], job.info["seed"]
        if job.destination.is_dir():
            rows += job_runner.readable(rows_of, job.destination, case, seed) or []
        elif failure := output.read_failure(job.failure_file):
            failures.append({"case": case, "seed": seed, "error": failure["error"]})
    return rows, failures


def span(values):
    return f"{min(values)}" if min(values) == max(values) else f"{min(values)} to {max(values)}"


def error_text(rooms):
    """Of the worst room of each run, the worst one."""
    worst = worst_of([room for room in rooms if room])
    if worst is None:
        return ""
    difference = abs(worst["area_m2"] - worst["true_area_m2"])
    return f"{abs(worst['error_percent']):.3f} % ({difference:.3f} m²)"


def table_of(rows, failures):
    lines = ["| experiment | storey | runs | walked through, found | largest error of an area | "
             "only looked into | doors between rooms |", "|---|---|---|---|---|---|---|"]
    groups = {}
    for row in rows:
        groups.setdefault((row["case"], row["storey"]), []).append(row)
    for (case, storey), group in groups.items():
        found = min(group, key=lambda row: row["found"] - row["walked"])
        looked_into = error_text(row["worst_looked_into"] for row in group)
        lines.append(
            f"| `{case}` | {storey} | {len(group)} | {found['found']} of {found['walked']} | "
            f"{error_text(row['worst'] for row in group)} | "
            f"{span([row['looked_into'] for row in group]) + ', ' if looked_into else ''}"
            f"{looked_into} | {span([row['doors'] for row in group])} |")
    extra = [f"{row['case']} {row['seed']}, storey {row['storey']}: room "
             f"{', '.join(map(str, row['not_in_truth']))}" for row in rows if row["not_in_truth"]]
    if extra:
        lines += ["", "Not in the truth: " + "; ".join(extra)]
    for failure in failures:
        lines += ["", f"failed: {failure['case']} {failure['seed']}: {failure['error']}"]
    return "\n".join(lines) + "\n"


def main():
    arguments = parse_arguments()
    cases = {case: experiment_files.of_case(case) for case in arguments.cases or CASES}
    setup = {"program": pathlib.Path(__file__).name,
             **series.build_of(arguments.binaries, PROGRAMS)}
    jobs = make_jobs(arguments, cases)
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        output.run(jobs, executor, arguments.retry_failed, "runs")
        rows, failures = collect(output, jobs)
        table = table_of(rows, failures)
        output.write_table("floor_plan_rooms", rows, table)
    print(table, end="")
    done = {(row["case"], row["seed"]) for row in rows}
    return 1 if len(done) < len(jobs) else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

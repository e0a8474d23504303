#!/usr/bin/python3
"""Makes recordings that have something wrong, and good ones, and says of each whether the program
names what it is.

A fault lies in how a scanner sits or measures (the simulator's section "faults") or in what
drivers, clocks and wheels write (scripts/recordings/driver_faults.py). Each is made on three
recordings of 15 to 25 s and mapped by plumbline_map. What counts is the first cause named: the
error, or the cause in summary.json, or the first warning of a consistent map.

    true      it is the fault
    behind    it is not, but the fault is among the warnings
    other     the fault is named nowhere, but the map is an error, doubtful or contradictory
    silent    the map is said to be consistent, and nobody speaks of the fault

Good recordings are those of configs/experiments, held against their rig files by plumbline_check.

    clear     nothing is told
    warned    there is a warning
    stopped   the recording is said to be none that can be mapped

Each run is one directory below --output, named by case, recording and seed; runs that are there
already are not done again. The table goes to faults.md and faults.json there, and is printed.
"""

import argparse
import collections
import dataclasses
import re
import sys

import experiment_files
import job_runner
import series

PROGRAMS = ("plumbline_simulate", "plumbline_check", "plumbline_map")
EDIT = job_runner.ROOT / "scripts" / "recordings" / "driver_faults.py"
GOOD = ("room", "corridor", "office", "plain", "furniture", "glass", "people_and_doors",
        "fzk_ground", "attic_35_deg", "curved_corridor", "orthogonal_scanners", "carried",
        "strong_swings", "scattered_ranges", "uneven_4_mm", "hall", "round_room", "fzk_stairs",
        "duplex_a_stairs", "smooth_corridor")
OUTCOMES = ("true", "behind", "other", "silent", "clear", "warned", "stopped", "no recording")


@dataclasses.dataclass(frozen=True)
class Recording:
    """An experiment, how much of its way is gone, and what is other about its scanners."""

    experiment: str
    length_m: float = None
    scanner: dict = dataclasses.field(default_factory=dict)


# Slow scanners move a long way while they turn, so that times of beams matter.
SLOW = {"beams": 360, "field_of_view_deg": 360.0, "scan_rate_hz": 10.0, "range_noise_m": 0.01}
SCANNERS = {
    "room": Recording("room"),
    "room_slow": Recording("room", scanner=SLOW),
    "office_orthogonal": Recording("orthogonal_scanners", length_m=18.0),
}
WHEELS = {
    "wheels_office": Recording("wheels_office", length_m=15.0),
    "wheels_office_far": Recording("wheels_office", length_m=15.0, scanner={"max_range_m": 30.0}),
    "wheels_office_fine": Recording("wheels_office", length_m=15.0,
                                    scanner={"beams": 540, "range_noise_m": 0.01}),
}


@dataclasses.dataclass(frozen=True)
class Fault:
    """What is wrong, and a pattern of the words that name it."""

    words: str
    recordings: dict = dataclasses.field(default_factory=lambda: SCANNERS)
    # Of the simulator: scanner names -> section faults. None: driver_faults.py makes it.
    simulated: object = None


def of_second(**faults):
    return lambda names: {"scanners": [{"name": names[1], **faults}]}


FAULTS = {
    "mirrored": Fault(r"is mirrored",
                      simulated=lambda names: {"scanners": [{"name": names[0], "mirrored": True}]}),
    "swapped": Fault(r"are exchanged", simulated=lambda names: {"swapped": names[1:]}),
    "turned_10_deg": Fault(r"turned by (9\.[5-9]|10\.[0-5]|10) deg",
                           simulated=of_second(rotation_error_deg=[0.0, 0.0, 10.0])),
    "tilted_3_deg": Fault(r"turned by (2\.[6-9]|3\.[0-4]|3) deg",
                          simulated=of_second(rotation_error_deg=[0.0, 3.0, 0.0])),
    "shifted_10_cm": Fault(r"shifted by (8|9|10|11|12)\d mm",
                           simulated=of_second(translation_error_m=[0.06, 0.06, -0.05])),
    "feet": Fault(r"in feet", simulated=of_second(unit="feet")),
    "ranges_5_cm_long": Fault(r"measure [3-7]\d mm too long",
                              simulated=of_second(range_bias_m=0.05)),
    "rig_not_filled_in": Fault(r"sit at one pose"),
    "clock_50_ms": Fault(r"stamped (4[0-9]|5[0-9]) ms too late",
                         simulated=of_second(clock_late_s=0.05)),
    "other_clock": Fault(r"stamps lie 37\.\d+ s"),
    "uptime_clock": Fault(r"stamps lie \d{6,}\.\d+ s"),
    "no_clock": Fault(r"stamps do not count up"),
    "clock_steps": Fault(r"clock of the stamps jumps .*1\.\d+ s"),
    "first_stamps_of_1970": Fault(r"apart from all others"),
    "stamped_at_the_end": Fault(r"of the last beam|stamped \d+ ms too late"),
    "beam_times_zero": Fault(r"time_increment is 0"),
    "beam_times_in_ns": Fault(r"in nanoseconds"),
    "beam_times_too_small": Fault(r"time_increment is wrong"),
    "angles_too_far_apart": Fault(r"angle_increment is too large"),
    "beams_turned_round": Fault(r"the other way round"),
    "millimetres": Fault(r"in millimetres"),
    "points_in_the_body_frame": Fault(r"do not lie in one scan plane"),
    "two_on_one_topic": Fault(r"of (two|2) scanners"),
    "filtered_copy": Fault(r"repeats what"),
    "lines_lost": Fault(r"scan lines are missing"),
    "dead": Fault(r"is dead"),
    "frozen": Fault(r"frozen", simulated=of_second(
        episodes=[{"kind": "frozen", "from_s": 5.0, "to_s": 9.0}])),
    "random_ranges": Fault(r"nothing that continues", simulated=of_second(
        episodes=[{"kind": "random", "from_s": 5.0, "to_s": 9.0}])),
    "gone": Fault(r"sends nothing for", simulated=of_second(
        episodes=[{"kind": "gone", "from_s": 5.0, "to_s": 9.0}])),
    "wheels_frozen": Fault(r"pose never changes", WHEELS),
    "wheels_without_attitude": Fault(r"have no orientation", WHEELS),
    "wheels_mirrored": Fault(r"wheels turn the other way", WHEELS),
    "wheels_late": Fault(r"wheels are stamped about 0\.[456]\d s too late", WHEELS),
    "wheels_of_another_clock": Fault(r"wheels say nothing", WHEELS),
}


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE",
                        help=f"faults ({', '.join(FAULTS)}) or good recordings (default: all "
                        f"faults, and {', '.join(GOOD)})")
    job_runner.add_seed_arguments(parser, "fault and recording", 1, first_seed=601)
    parser.add_argument("--good-seeds", type=job_runner.positive, default=3, metavar="N",
                        help="runs of each good recording (default 3)")
    job_runner.add_arguments(parser)
    return parser.parse_args()


def faulty_job(arguments, case, name, seed):
    fault = FAULTS[case]
    experiment = arguments.output / "experiments" / f"{case}_{name}.yaml"
    recording = fault.recordings[name]
    experiment_files.write_variant(recording.experiment, experiment, scanner=recording.scanner,
                                   length_m=recording.length_m, faults=fault.simulated)
    folder = "truth"
    commands = [(arguments.binaries / "plumbline_simulate", f"--experiment={experiment}",
                 f"--seed={seed}", "--output=truth")]
    if fault.simulated is None:
        folder = "faulty"
        commands.append(("/usr/bin/python3", EDIT, case, "--recording=truth/recording.bag",
                         "--rig=truth/rig.yaml", "--output=faulty"))
    commands.append((arguments.binaries / "plumbline_map", f"--recording={folder}/recording.bag",
                     f"--rig={folder}/rig.yaml", "--threads=1", "--output=result"))
    run = f"{case}_{name}_{seed:04d}"
    return job_runner.Job(
        destination=arguments.output / run, commands=tuple(commands),
        required=("result/summary.json",), failure_file=f"failed_{run}.json",
        done_codes=(0, job_runner.NOT_TRUSTED),
        info={"case": case, "recording": name, "seed": seed})


def good_job(arguments, case, seed):
    run = f"{case}_{seed:04d}"
    return job_runner.Job(
        destination=arguments.output / run,
        commands=((arguments.binaries / "plumbline_simulate",
                   f"--experiment={experiment_files.of_case(case)}", f"--seed={seed}",
                   "--output=truth"),
                  (arguments.binaries / "plumbline_check", "--recording=truth/recording.bag",
                   "--rig=truth/rig.yaml", "--output=check")),
        required=("check/check.json",), failure_file=f"failed_{run}.json",
        done_codes=(0, job_runner.NOT_TRUSTED),
        info={"case": case, "recording": case, "seed": seed})


def make_jobs(arguments):
    jobs = []
    for case in arguments.cases or (*FAULTS, *GOOD):
        if case in FAULTS:
            jobs += [faulty_job(arguments, case, name, seed) for name in FAULTS[case].recordings
                     for seed in job_runner.seeds_of(arguments)]
        else:
            jobs += [good_job(arguments, case, seed)
                     for seed in range(arguments.first_seed,
                                       arguments.first_seed + arguments.good_seeds)]
    return jobs


def outcome_of(words, named, verdict):
    """named: what was said, the first cause first. verdict: of the map; None where there is none."""
    found = [re.search(words, sentence) is not None for sentence in named]
    if any(found):
        return "true" if found[0] else "behind"
    return "silent" if verdict == "consistent" else "other"


def row_of_map(directory, info):
    summary = job_runner.read_json(directory / "summary.json")
    cause = summary.get("cause")
    named = [f"{cause['name']}: {cause['evidence']}"] if cause else []
    named += summary["warnings"]
    verdict = summary["consistency"]["verdict"]
    return {**info, "verdict": verdict, "first": named[0] if named else "",
            "outcome": outcome_of(FAULTS[info["case"]].words, named, verdict)}


def row_of_check(directory, info):
    check = job_runner.read_json(directory / "check.json")
    findings = [finding for finding in check["findings"] if finding["severity"] != "note"]
    is_stopped = any(finding["severity"] == "stop" for finding in findings)
    return {**info, "first": findings[0]["sentence"] if findings else "",
            "outcome": "stopped" if is_stopped else "warned" if findings else "clear"}


def row_of(directory, info):
    return (row_of_map if info["case"] in FAULTS else row_of_check)(directory, info)


def failure_row(failure, info):
    """One row of the table, of a run that ended with an error."""
    program = str((failure.get("command") or [""])[0]).rsplit("/", 1)[-1]
    row = {**info, "verdict": "error", "first": failure["error"], "outcome": "no recording"}
    if program == "plumbline_map":
        row["outcome"] = outcome_of(FAULTS[info["case"]].words, [failure["error"]], None)
    return row


def table_of(rows):
    lines = ["| case | recording | seed | outcome | verdict | the first cause named |",
             "|---|---|---|---|---|---|"]
    lines += [f"| `{row['case']}` | {row['recording']} | {row['seed']} | {row['outcome']} | "
              f"{row.get('verdict', '')} | {row['first'].replace('|', '/')} |" for row in rows]
    lines.append("")
    for of_faults, kind in ((True, "faulty"), (False, "good")):
        chosen = [row for row in rows if (row["case"] in FAULTS) == of_faults]
        counts = collections.Counter(row["outcome"] for row in chosen)
        if chosen:
            lines.append(f"{len(chosen)} {kind} recordings: " + ", ".join(
                f"{counts[outcome]} {outcome}" for outcome in OUTCOMES if counts[outcome]))
    return "\n".join(lines) + "\n"


def main():
    arguments = parse_arguments()
    rows, num_missing = series.run_table("faults", PROGRAMS, arguments, make_jobs, row_of,
                                         failure_row, table_of)
    return 1 if num_missing or any(row["outcome"] == "no recording" for row in rows) else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

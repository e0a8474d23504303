#!/usr/bin/python3
"""Asks of each rule of the mapper whether it still pays: maps with the rule off, and without.

RULES names the rules that can be switched off (`rules:` in the mapper's settings) and the cases
that each was made for; others are mapped for what a rule may harm. Each run is one of
robustness.py: right, flagged or silent. Of the same seeds with and without a rule only those
count that come out otherwise; the probability is that of so uneven a split by chance alone (sign
test, two-sided).

The runs of each setting are a directory below --output; those that are there are not done again.
The table goes to ablation.md there, and is printed.
"""

import argparse
import math
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "experiments"))
# pylint: disable=wrong-import-position
import job_runner  # noqa: E402

ROBUSTNESS = pathlib.Path(__file__).resolve().parents[1] / "experiments/robustness.py"
AS_IT_IS = "as_it_is"
RULES = {
    "second_hypothesis": ("people_and_doors", "smooth_corridor"),
    "thin_evidence": ("people_and_doors", "orthogonal_scanners"),
    "points_over_planes": ("people_and_doors", "furniture"),
    "half_window_steps": ("furniture", "extrinsics_half_deg"),
    "several_starts": ("fzk_stairs", "duplex_a_stairs"),
    "beams_behind_walls": ("orthogonal_scanners", "ramp"),
    "redundant_planes": ("two_storeys", "duplex_a_stairs"),
    "passed_through_planes": ("people_and_doors", "furniture"),
    "oblique_planes": ("plain", "duplex_b_stairs"),
    "bent_walls": ("apse", "curved_corridor"),
    "rows_of_chords": ("apse", "curved_corridor"),
}
OTHERS = ("plain", "furniture", "people_and_doors", "carried", "strong_swings",
          "orthogonal_scanners", "duplex_a_stairs", "duplex_b_stairs", "fzk_stairs", "two_storeys",
          "halls_ramp", "apse")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rules", nargs="*", metavar="RULE",
                        help=f"of {', '.join(RULES)} (default: all)")
    job_runner.add_seed_arguments(parser, "case", 4)
    parser.add_argument("--own-cases", action="store_true",
                        help="map only the cases that a rule was made for")
    job_runner.add_arguments(parser)
    parser.set_defaults(jobs=1)
    arguments = parser.parse_args()
    for rule in arguments.rules:
        if rule not in RULES:
            raise job_runner.InputError(f"no rule {rule}; there are {', '.join(RULES)}")
    return arguments


def cases_of(rule, own_cases):
    return sorted(set(RULES[rule]) | set(() if own_cases else OTHERS))


def outcomes(arguments, setting, cases):
    """Maps by robustness.py; returns {(case, seed): outcome}."""
    config = arguments.output / f"{setting}.yaml"
    config.write_text(f"rules: {{{setting}: false}}\n" if setting in RULES else "{}\n",
                      encoding="utf-8")
    command = [sys.executable, ROBUSTNESS, *cases, f"--seeds={arguments.seeds}",
               f"--first-seed={arguments.first_seed}", f"--config={config}",
               f"--output={arguments.output / setting}", f"--binaries={arguments.binaries}",
               f"--jobs={arguments.jobs}"]
    result = subprocess.run(command, stdout=subprocess.DEVNULL, check=False)
    if result.returncode not in (0, 1):
        raise job_runner.InputError(f"robustness.py ended with exit code {result.returncode}")
    rows = job_runner.read_json(arguments.output / setting / "robustness.json")
    return {(row["case"], row["seed"]): row["outcome"] for row in rows}


def sign_test(gained, lost):
    """Probability of a split as uneven as this of gained + lost fair tosses."""
    count = gained + lost
    tail = sum(math.comb(count, k) for k in range(max(gained, lost), count + 1)) / 2 ** count
    return min(1.0, 2 * tail)


def row_of(rule, with_rule, without):
    """Cells of the table, of the runs that both settings have."""
    runs = [run for run in without if run in with_rule]
    gained = sum(with_rule[run] == "right" != without[run] for run in runs)
    lost = sum(without[run] == "right" != with_rule[run] for run in runs)
    silent = [sum(setting[run] == "silent" for run in runs) for setting in (with_rule, without)]
    right = [sum(setting[run] == "right" for run in runs) for setting in (with_rule, without)]
    return (rule, str(len(runs)), f"{right[0]}, {silent[0]}", f"{right[1]}, {silent[1]}",
            str(gained), str(lost), f"{sign_test(gained, lost):.2f}")


HEADINGS = ("rule", "runs", "with it: right, silent", "without", "only right with it",
            "only right without", "by chance")


def table_of(rows):
    lines = ["| " + " | ".join(HEADINGS) + " |", "|" + "---|" * len(HEADINGS)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def main():
    arguments = parse_arguments()
    arguments.output.mkdir(parents=True, exist_ok=True)
    rules = arguments.rules or list(RULES)
    all_cases = sorted({case for rule in rules for case in cases_of(rule, arguments.own_cases)})
    with_all = outcomes(arguments, AS_IT_IS, all_cases)
    rows = []
    for rule in rules:
        print(f"ablation: without {rule}", file=sys.stderr)
        rows.append(row_of(rule, with_all,
                           outcomes(arguments, rule, cases_of(rule, arguments.own_cases))))
        (arguments.output / "ablation.md").write_text(table_of(rows), encoding="utf-8")
    print(table_of(rows), end="")
    return 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

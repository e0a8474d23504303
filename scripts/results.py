#!/usr/bin/python3
"""Simulates, maps and evaluates the shipped experiments over several seeds and prints the figures
of docs/results.md as a Markdown table.

Every run keeps its evaluation.json and summary.json below --output; a run that is already there
is not done again. A run that fails is listed with its error.
"""

import argparse
import concurrent.futures
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXPERIMENTS = ROOT / "configs" / "experiments"

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


def run(command):
    result = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if result.returncode != 0:
        lines = result.stderr.strip().splitlines() or ["no message"]
        raise RuntimeError(lines[-1])


def run_one(case, seed, binaries, output):
    """Result of one run, or its error message."""
    experiment, config = CASES[case]
    directory = output / case.replace(", ", "-").replace(" ", "_") / f"seed_{seed}"
    evaluation = directory / "evaluation.json"
    summary = directory / "summary.json"
    try:
        if not evaluation.exists():
            work = directory / "work"
            run([binaries / "plumbline_simulate",
                 f"--experiment={EXPERIMENTS / experiment}.yaml", f"--seed={seed}",
                 f"--output={work / 'truth'}"])
            run([binaries / "plumbline_map", f"--recording={work / 'truth' / 'recording.bag'}",
                 f"--rig={work / 'truth' / 'rig.yaml'}",
                 f"--config={EXPERIMENTS / config}.yaml", f"--output={work / 'map'}"])
            shutil.copy(work / "map" / "summary.json", summary)
            run([binaries / "plumbline_evaluate", f"--result={work / 'map'}",
                 f"--truth={work / 'truth'}", f"--output={work / 'evaluation.json'}"])
            (work / "evaluation.json").rename(evaluation)
            shutil.rmtree(work)
        return json.loads(evaluation.read_text()), json.loads(summary.read_text())
    except RuntimeError as error:
        return str(error)


def span(values, digits):
    return f"{min(values):.{digits}f} to {max(values):.{digits}f}"


def row(case, results):
    good = [result for result in results if not isinstance(result, str)]
    cells = [case, f"{len(good)} of {len(results)}"]
    if good:
        trajectories = [e["trajectory"]["unaligned"] for e, _ in good]
        planes = [e["planes"] for e, _ in good]
        cells += [
            span([1e3 * t["position_m"]["rmse"] for t in trajectories], 2),
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


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--seeds", type=int, default=10, help="runs of each case (default 10)")
    parser.add_argument("--jobs", type=int, default=1, help="runs at the same time (default 1)")
    parser.add_argument("--case", action="append", choices=sorted(CASES),
                        help="only this case; may be repeated")
    parser.add_argument("--binaries", type=pathlib.Path, default=ROOT / "build" / "bin")
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "out" / "results")
    arguments = parser.parse_args()
    if not (arguments.binaries / "plumbline_map").exists():
        sys.exit(f"results.py: no plumbline_map in {arguments.binaries}; build first")
    cases = arguments.case or list(CASES)
    jobs = [(case, seed) for seed in range(1, arguments.seeds + 1) for case in cases]
    found = {case: [] for case in cases}
    errors = []
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        futures = [pool.submit(run_one, case, seed, arguments.binaries, arguments.output)
                   for case, seed in jobs]
        for number, ((case, seed), future) in enumerate(zip(jobs, futures), start=1):
            result = future.result()
            found[case].append(result)
            if isinstance(result, str):
                errors.append(f"{case}, seed {seed}: {result}")
            print(f"{number} of {len(jobs)} runs done", file=sys.stderr)
    print("| case | mapped | position RMSE / mm | rotation RMSE / deg | planes on true faces | "
          "wrong | doubled | missed | largest angle error / deg | largest distance error / mm | "
          "the same, aligned / mm | residual RMS / mm | times real time | memory / MB |")
    print("|" + "---|" * 14)
    for case in cases:
        print(row(case, found[case]))
    for error in errors:
        print(f"\nfailed: {error}")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(main())

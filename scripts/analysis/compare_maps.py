#!/usr/bin/python3
"""Says whether two builds make the same maps, byte by byte.

For changes of the code that must not change results. Maps the corridor, the office and the room
(simulated with seed 1 by the programs of --after) and the recording of a real robot (test/data)
with plumbline_map of --before and of --after, and prints for every file of the results whether it
is identical. Of summary.json times and memory are left out, and keys that only one of the two
builds writes are named but make no difference. config_used.yaml is left out: where an option has
another name, it differs by intent.

Both programs have to be built for the same processors by the same compiler. Where the compiler may
contract a multiplication and an addition into one instruction, as with -march=x86-64-v3, the
rounding depends on what it inlines where, so that a function that only moved to another file can
change the last digits. The default build has no such instructions.
"""

import argparse
import contextlib
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIMULATED = ("corridor", "office", "room")
MAPS = SIMULATED + ("robot",)
ROBOT = "robot_three_scanners"
LEFT_OUT = ("config_used.yaml",)
# Keys of summary.json that differ from run to run.
MEASURED = ("stages", "real_time_factor", "peak_memory_mb")


class InputError(Exception):
    """What the user has to mend."""


def resolved(path):
    return pathlib.Path(path).resolve()


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", type=resolved, required=True, metavar="DIR",
                        help="directory with the plumbline_map to compare with")
    parser.add_argument("--after", type=resolved, required=True, metavar="DIR",
                        help="directory with plumbline_map and plumbline_simulate")
    parser.add_argument("--before-configs", type=resolved, default=ROOT / "configs", metavar="DIR",
                        help="configs/ for --before, where options have changed their names since "
                        "(default: this checkout's)")
    parser.add_argument("--map", action="append", choices=MAPS,
                        help="only this one; may be repeated")
    parser.add_argument("--threads", type=int, default=2, help="of each run (default 2)")
    parser.add_argument("--output", type=resolved, metavar="DIR",
                        help="keep recordings and maps here (default: deleted at the end)")
    return parser.parse_args()


def run(command):
    """Runs a program quietly; its last line is the message if it fails."""
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError as error:
        raise InputError(f"{command[0]}: {error.strerror}") from error
    if result.returncode != 0:
        lines = result.stderr.strip().splitlines() or [f"exit code {result.returncode}"]
        raise InputError(f"{command[0]}: {lines[-1]}")


def simulate(name, binaries, directory):
    run([binaries / "plumbline_simulate",
         f"--experiment={ROOT / 'configs' / 'experiments' / name}.yaml", "--seed=1",
         f"--output={directory}"])


def map_recording(name, binaries, configs, recording, directory, threads):
    """recording: directory of the simulated one."""
    if name == "robot":
        files = (ROOT / "test" / "data" / f"{ROBOT}.bag", configs / "rigs" / f"{ROBOT}.yaml")
    else:
        files = (recording / "recording.bag", recording / "rig.yaml",
                 configs / "experiments" / f"{name}.yaml")
    flags = [f"--{flag}={file}" for flag, file in zip(("recording", "rig", "config"), files)]
    run([binaries / "plumbline_map", *flags, f"--threads={threads}", f"--output={directory}"])


def compare_summaries(before, after):
    """Differences of two summaries in the keys that both have; the other keys."""
    before, after = (json.loads(path.read_text()) for path in (before, after))
    compared = [key for key in before if key in after and key not in MEASURED]
    differing = [key for key in compared if before[key] != after[key]]
    return differing, sorted(set(before) ^ set(after))


def compare_file(before, after):
    """Whether a file of two results agrees, and the verdict in words."""
    for path, where in ((before, "before"), (after, "after")):
        if not path.exists():
            return False, f"not written {where}"
    if before.name == "summary.json":
        differing, only_one = compare_summaries(before, after)
        verdict = "differs in " + ", ".join(differing) if differing else "same figures"
        return not differing, verdict + (
            f" (only one has {', '.join(only_one)})" if only_one else "")
    same = before.read_bytes() == after.read_bytes()
    return same, "identical" if same else "differs"


def compare_results(name, before, after):
    """Prints a line for each file; whether all agree."""
    files = sorted({path.name for path in (*before.iterdir(), *after.iterdir())} - set(LEFT_OUT))
    all_same = True
    for file in files:
        same, verdict = compare_file(before / file, after / file)
        all_same &= same
        print(f"{name + '/' + file:36} {verdict}", flush=True)
    return all_same


def compare_maps(arguments, directory):
    all_same = True
    for name in arguments.map or MAPS:
        recording = directory / "recordings" / name
        if name in SIMULATED:
            recording.parent.mkdir(parents=True, exist_ok=True)
            simulate(name, arguments.after, recording)
        results = []
        for which, binaries, configs in (
                ("before", arguments.before, arguments.before_configs),
                ("after", arguments.after, ROOT / "configs")):
            results.append(directory / which / name)
            results[-1].parent.mkdir(parents=True, exist_ok=True)
            map_recording(name, binaries, configs, recording, results[-1], arguments.threads)
        all_same &= compare_results(name, *results)
    return all_same


def main():
    arguments = parse_arguments()
    with contextlib.ExitStack() as stack:
        directory = arguments.output or pathlib.Path(
            stack.enter_context(tempfile.TemporaryDirectory()))
        try:
            all_same = compare_maps(arguments, directory)
        except (InputError, OSError) as error:
            print(f"compare_maps.py: {error}", file=sys.stderr)
            return 1
    print("all the same" if all_same else "not the same")
    return 0 if all_same else 1


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""Maps a robot's CARMEN log from several starts and holds each map against relative poses.

One run that works proves nothing: the log is cut so that it begins later, mapped with a rig
file, or with the one that plumbline_check writes of what is left, and the trajectory is compared
as evaluate_relations.py does, loops included. A line a start is printed: parts, verdict,
relations covered, and of these root mean square, mean and largest error of translation and
rotation. Silently wrong is a map whose RMS is above the limits and whose verdict is none of
`contradictory` and `doubtful`. A run takes as long as the maps do; what has been done before in
the output directory is not done again.
"""

import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np

SCRIPTS = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SCRIPTS))

import evaluate_relations  # noqa: E402

MAX_TRANSLATION_M = 0.04
MAX_ROTATION_DEG = 0.5
DONE_CODES = (0, 3)  # 3: a map, with the verdict that it is not to be trusted


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", help="CARMEN log, not packed")
    parser.add_argument("--relations", required=True, metavar="FILE")
    parser.add_argument("--bin", default="build/bin", metavar="DIR")
    parser.add_argument("--rig", metavar="FILE",
                        help="rig file (default: what plumbline_check writes of each cut log)")
    parser.add_argument("--config", metavar="FILE", help="mapper settings")
    parser.add_argument("--starts", default="0,50,100,200,250,350", metavar="S,S,...",
                        help="seconds after the log's first scan")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--output", required=True, metavar="DIR")
    return parser.parse_args()


def stamp_of(line):
    """The time of a message's own stamp; None where the line is no message."""
    words = line.split()
    if len(words) < 4 or line.startswith(("#", "PARAM", "SYNC")):
        return None
    try:
        return float(words[-3])
    except ValueError:
        return None


def cut(lines, start_s):
    """The lines from so many seconds after the first scan on; all that have no stamp stay."""
    first = next((stamp_of(line) for line in lines
                  if "LASER" in line.split(" ", 1)[0] and stamp_of(line) is not None), None)
    if first is None:
        raise evaluate_relations.InputError("the log has no scans")
    return [line for line in lines
            if stamp_of(line) is None or stamp_of(line) >= first + start_s or start_s == 0.0]


def statistics(errors):
    """RMS, mean and largest of the errors that are covered; of translation (m) and rotation
    (deg)."""
    covered = errors[~np.isnan(errors[:, 0])]
    row = {"relations": len(errors), "covered": len(covered)}
    for name, values in (("translation_m", covered[:, 0]),
                         ("rotation_deg", np.degrees(covered[:, 1]))):
        row[name] = {"rms": float(np.sqrt(np.mean(values ** 2))) if len(values) else None,
                     "mean": float(np.mean(values)) if len(values) else None,
                     "max": float(np.max(values)) if len(values) else None}
    return row


def is_right(row):
    rms = [row[name]["rms"] for name in ("translation_m", "rotation_deg")]
    return None not in rms and rms[0] <= MAX_TRANSLATION_M and rms[1] <= MAX_ROTATION_DEG


def judgement(row):
    """`right`, `flagged` or `silently wrong`; a map that does not cover what lies within its
    log is right in what it covers, and its parts say so."""
    if is_right(row):
        return "right"
    flagged = row["verdict"] in ("contradictory", "doubtful") or row["verdict"] is None
    return "flagged" if flagged else "silently wrong"


def map_from(arguments, lines, relations, start_s, folder):
    """Maps the log from one start."""
    folder.mkdir(parents=True, exist_ok=True)
    log = folder / "log.clf"
    log.write_text("".join(line + "\n" for line in cut(lines, start_s)),
                   errors="surrogateescape")
    bin_dir = pathlib.Path(arguments.bin)
    rig = arguments.rig
    if rig is None:
        subprocess.run([bin_dir / "plumbline_check", log, f"--output={folder / 'check'}"],
                       capture_output=True, check=False)
        rig = folder / "check" / "rig.yaml"
    command = [bin_dir / "plumbline_map", f"--recording={log}", f"--rig={rig}",
               f"--output={folder / 'map'}", f"--threads={arguments.threads}"]
    if arguments.config:
        command.append(f"--config={arguments.config}")
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    (folder / "map.log").write_text(run.stdout + run.stderr)
    log.unlink()
    row = {"start_s": start_s, "exit_code": run.returncode, "verdict": None, "parts": 0}
    if run.returncode not in DONE_CODES:
        lines_said = run.stderr.strip().splitlines()
        row["error"] = lines_said[-1] if lines_said else "no message"
        return row
    summary = json.loads((folder / "map" / "summary.json").read_text())
    row["verdict"] = summary["consistency"]["verdict"]
    row["parts"] = 1 + sum(path.is_dir() for path in (folder / "map").glob("part_*"))
    row["seconds"] = summary["stages"]["total"]
    first_s = summary["start_time"] - 1.0
    trajectory = evaluate_relations.Trajectory(folder / "map" / "trajectory.tum", 1.0)
    within = relations[np.min(relations[:, :2], axis=1) >= first_s]
    row.update(statistics(evaluate_relations.errors_of(trajectory, within, 0.0)))
    row["judgement"] = judgement(row)
    return row


def print_row(row):
    text = f"{row['start_s']:5.0f} s  {row['parts']:2} parts  {row['verdict'] or '-':13} "
    if "error" in row:
        print(text + row["error"], flush=True)
        return
    translation, rotation = row["translation_m"], row["rotation_deg"]
    if translation["rms"] is None:
        print(text + "no relation is covered", flush=True)
        return
    print(text + f"{row['covered']:5} of {row['relations']:<5}"
          f"{translation['rms']:8.3f} {translation['mean']:7.3f} {translation['max']:8.2f} m  "
          f"{rotation['rms']:7.2f} {rotation['mean']:6.2f} {rotation['max']:7.2f} deg  "
          f"{row['judgement']}  {row['seconds']:.0f} s", flush=True)


def main():
    arguments = parse_arguments()
    output = pathlib.Path(arguments.output)
    try:
        relations = evaluate_relations.read_numbers(arguments.relations, 8)
        starts = [float(word) for word in arguments.starts.split(",")]
        lines = pathlib.Path(arguments.log).read_text(errors="surrogateescape").splitlines()
        cut(lines, 0.0)
    except (OSError, ValueError, evaluate_relations.InputError) as error:
        sys.exit(f"log_starts.py: {arguments.log}: {error}")
    print("          parts     verdict        covered         rms    mean  largest        rms"
          "   mean largest")
    for start_s in starts:
        folder = output / f"from_{start_s:g}"
        result = folder / "row.json"
        if not result.exists():
            row = map_from(arguments, lines, relations, start_s, folder)
            result.write_text(json.dumps(row, indent=2) + "\n")
        print_row(json.loads(result.read_text()))


if __name__ == "__main__":
    main()

#!/usr/bin/python3
"""Maps every recording (*.bag, *.mcap, *.db3, *.clf) below a folder.

A folder with metadata.yaml is one recording of ROS 2; files may be packed (.bz2, .zstd). Each
recording becomes one directory below --output with all that plumbline_map writes. It is named
as the recording without .bag, and with the folders above it where there are any: a/b.bag
becomes a_b. What is there already is not mapped again, so the same command goes on after an
interruption. A recording that can not be mapped is listed with its error and counted.
"""

import argparse
import sys

import job_runner
import series

SUFFIXES = (".bag", ".mcap", ".db3", ".clf")
PACKED_SUFFIXES = ("", ".bz2", ".zstd")
REQUIRED = ("result/summary.json", "result/planes.json", "result/trajectory.tum")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=job_runner.resolved, metavar="FOLDER",
                        help="where the recordings are")
    parser.add_argument("--rig", type=job_runner.resolved, metavar="FILE",
                        help="rig of the recordings that have no rig.yaml beside them")
    parser.add_argument("--config", type=job_runner.resolved, metavar="FILE",
                        help="mapper settings (default: plumbline_map's own)")
    job_runner.add_arguments(parser)
    return parser.parse_args()


def without_suffix(name):
    """The name of a recording without what shows that it is one; None for other files."""
    for packed in PACKED_SUFFIXES:
        for suffix in SUFFIXES:
            if name.endswith(suffix + packed):
                return name[:-len(suffix + packed)]
    return None


def is_rosbag2_folder(path):
    return (path / "metadata.yaml").is_file()


def is_recording(path):
    if path.is_dir():
        return is_rosbag2_folder(path)
    # What lies in a recording's folder is a part of that recording.
    return (path.is_file() and without_suffix(path.name) is not None
            and not is_rosbag2_folder(path.parent))


def result_name(recording):
    name = "_".join(recording.parts)
    name = name if without_suffix(name) is None else without_suffix(name)
    if not name or name.startswith("."):  # hidden names are for unfinished work
        name = "_" + name.lstrip(".")
    return name + "_" if name.endswith(".json") else name


def find_recordings(folder):
    """The recordings by the name of their results."""
    if not folder.is_dir():
        raise job_runner.InputError(f"no folder {folder}")
    recordings = {}
    for path in sorted(path for path in folder.rglob("*") if is_recording(path)):
        name = result_name(path.relative_to(folder))
        if name in recordings:
            raise job_runner.InputError(
                f"{recordings[name]} and {path} would both become {name}; rename one")
        recordings[name] = path
    if not recordings:
        raise job_runner.InputError(f"no *{', *'.join(SUFFIXES)} below {folder}")
    return recordings


def rig_of(recording, rig):
    own = recording.with_name("rig.yaml")
    if own.is_file():
        return own
    if rig is None:
        raise job_runner.InputError(f"{recording} has no rig.yaml beside it; give --rig")
    return rig


def make_job(name, recording, arguments):
    command = [arguments.binaries / "plumbline_map", f"--recording={recording}",
               f"--rig={rig_of(recording, arguments.rig)}", "--threads=1", "--output=result"]
    if arguments.config:
        command.append(f"--config={arguments.config}")
    return job_runner.Job(
        destination=arguments.output / name,
        commands=(tuple(command),),
        required=REQUIRED,
        optional=("result/*",),
        done_codes=(0, job_runner.NOT_TRUSTED),
        failure_file=f"failed_{name}.json",
        info={"recording": str(recording.relative_to(arguments.folder))})


def figures_of(directory):
    summary = job_runner.read_object(directory / "summary.json")
    figures = {key: summary.get(key) for key in ("duration_s", "planes", "residual_rms_m",
                                                 "variance_factor", "real_time_factor",
                                                 "warnings")}
    return {**figures, "verdict": (summary.get("consistency") or {}).get("verdict")}


def summarise(output, jobs):
    """Main figures of every recording, what failed, and what is damaged."""
    done = {job.destination.name: job_runner.readable(figures_of, job.destination)
            for job in jobs if job.destination.is_dir()}
    failures = [{"recording": failure["recording"], "error": failure["error"]}
                for failure in output.failures("recording")]
    return {"recordings": {name: figures for name, figures in done.items() if figures},
            "failed": len(failures), "failures": failures,
            "damaged": [name for name, figures in done.items() if not figures]}


def cell(value, digits):
    return f"{'-':>10}" if value is None else f"{value:10.{digits}f}"


def print_table(summary):
    print(f"{len(summary['recordings'])} recordings mapped, {summary['failed']} failed")
    width = max(map(len, summary["recordings"]), default=0)
    if summary["recordings"]:
        print(f"{'':{width}}  length/s    planes    RMS/mm  variance  speed  warnings  verdict")
    for name, figures in summary["recordings"].items():
        rms = figures["residual_rms_m"]
        print(f"{name:{width}}{cell(figures['duration_s'], 1)}{cell(figures['planes'], 0)}"
              f"{cell(rms and 1e3 * rms, 2)}{cell(figures['variance_factor'], 2)}"
              f"{cell(figures['real_time_factor'], 1)[3:]}{len(figures['warnings'] or []):10}  "
              f"{figures['verdict'] or '-'}")
    for failure in summary["failures"]:
        print(f"failed: {failure['recording']}: {failure['error']}")


def main():
    arguments = parse_arguments()
    recordings = find_recordings(arguments.folder)
    setup = {
        "program": "map_all.py",
        "folder": str(arguments.folder),
        "rig": arguments.rig and job_runner.read_text(arguments.rig),
        "config": arguments.config and job_runner.read_text(arguments.config),
        **series.build_of(arguments.binaries, ("plumbline_map",)),
    }
    jobs = [make_job(name, path, arguments) for name, path in recordings.items()]
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        output.run(jobs, executor, arguments.retry_failed, "recordings")
        summary = summarise(output, jobs)
        output.write_json("summary.json", summary)
    print_table(summary)
    return 1 if summary["failed"] or summary["damaged"] else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

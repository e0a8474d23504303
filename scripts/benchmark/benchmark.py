#!/usr/bin/python3
"""Measures whole mapping jobs, each pinned to one core, and writes the figures into
docs/performance.md.

A job is the process plumbline_map from its start to its end, with a recording in and a map out.
Recordings are simulated first and kept below --output for the next time. Runs of the cases take
turns, so that what slows the machine down for a while does not fall on one case alone; figures
are medians, and comparisons are made within one call of this script only. In the document, only
the tables between a group's two markers are replaced.

With --against or --against-bin, each case is run by another build of plumbline_map as well, the two
in turns; the ratios of this build's figures to the other's are printed, and no document changes.
"""

import argparse
import collections
import dataclasses
import datetime
import hashlib
import json
import os
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import time

import yaml

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "experiments"))
# pylint: disable=wrong-import-position
import comparison
import job_runner
import series
from benchmark_tables import make_tables, measured_line

ROOT = job_runner.ROOT
CONFIGS = ROOT / "configs"
SEED = 1
# Bytes that must depend neither on how often a job is run nor on its threads.
COMPARED_FILES = ("trajectory.tum", "trajectory_covariance.csv", "planes.json", "planes.ply",
                  "plane_covariance.csv", "map.ply", "map.pcd")
LONG_DURATIONS_MIN = (5, 10, 20, 60)
FACTOR_LENGTH_M = 10.0  # so short that single points fit into memory
RIGS = {270: "paper", 1080: "paper_1080"}


@dataclasses.dataclass(frozen=True)
class Recording:
    """What is simulated: an experiment, with another rig and length where these are given."""

    experiment: str
    beams: int
    length_m: float = 0.0  # 0: as the experiment says

    def text(self):
        """The experiment file, with files named by absolute paths."""
        path = CONFIGS / "experiments" / f"{self.experiment}.yaml"
        experiment = yaml.safe_load(job_runner.read_text(path))
        experiment["building"] = str((path.parent / experiment["building"]).resolve())
        experiment["rig"] = str(CONFIGS / "rigs" / f"{RIGS[self.beams]}.yaml")
        if self.length_m:
            experiment["path"].pop("laps", None)
            experiment["path"]["length_m"] = self.length_m
        return yaml.safe_dump(experiment, sort_keys=False)


@dataclasses.dataclass(frozen=True)
class Case:
    """One way to map one recording, which is run several times."""

    name: str
    group: str
    recording: Recording
    factor: str = "segment"
    threads: int = 1


def make_cases(longest_min, dense=False):
    """All cases; those of the large building up to this many minutes, dense: the longest with
    1080 beams too."""
    cases = [Case(f"{experiment}, {beams} beams", "jobs", Recording(experiment, beams))
             for experiment in ("corridor", "office") for beams in RIGS]
    for beams in RIGS:
        cases += [Case(f"corridor {FACTOR_LENGTH_M:g} m, {beams} beams, {factor}", "factors",
                       Recording("corridor", beams, FACTOR_LENGTH_M), factor=factor)
                  for factor in ("segment", "point")]
    for experiment in ("corridor", "office"):
        cases += [Case(f"{experiment}, {threads} thread{'s' * (threads > 1)}", "threads",
                       Recording(experiment, 270), threads=threads) for threads in (1, 2)]
    speed = yaml.safe_load(job_runner.read_text(
        CONFIGS / "experiments" / "large_building.yaml"))["speed_m_s"]
    durations = [minutes for minutes in LONG_DURATIONS_MIN if minutes <= longest_min]
    walks = [(minutes, 270) for minutes in durations] + [(durations[-1], 1080)] * dense
    cases += [Case(f"large building, {minutes} min, {beams} beams", "long",
                   Recording("large_building", beams, 60.0 * minutes * speed))
              for minutes, beams in walks]
    return cases


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=job_runner.positive, default=3, metavar="N",
                        help="runs of each case (default 3)")
    parser.add_argument("--long", type=job_runner.positive, nargs="?", metavar="MINUTES",
                        const=LONG_DURATIONS_MIN[-1],
                        help="also the large building, recordings of up to so many minutes "
                        f"(default {LONG_DURATIONS_MIN[-1]})")
    parser.add_argument("--dense", action="store_true",
                        help="the longest of these with 1080 beams, too: an hour takes 30 GB of "
                        "disk for its points")
    parser.add_argument("--group", action="append", choices=("jobs", "factors", "threads", "long"),
                        help="only these cases; may be repeated")
    other = parser.add_mutually_exclusive_group()
    other.add_argument("--against", metavar="COMMIT",
                       help="build this commit, too, in a folder below --output, and compare with "
                       "it (default --group jobs)")
    other.add_argument("--against-bin", type=job_runner.resolved, metavar="DIR",
                       help="compare with the plumbline_map of this folder")
    parser.add_argument("--case", action="append", metavar="TEXT",
                        help="compare only cases whose names contain this; may be repeated")
    parser.add_argument("--core", type=int, default=min(os.sched_getaffinity(0)), metavar="N",
                        help="the core to use (default: the first)")
    parser.add_argument("--binaries", type=job_runner.resolved, default=ROOT / "build" / "bin",
                        metavar="DIR", help="where the programs are (default build/bin)")
    parser.add_argument("--build", action="store_true",
                        help="build the programs first, as benchmark.sh does")
    parser.add_argument("--output", type=job_runner.resolved, default=ROOT / "out" / "benchmark",
                        metavar="DIR", help="for benchmark.json and the recordings "
                        "(default out/benchmark)")
    parser.add_argument("--document", type=job_runner.resolved,
                        default=ROOT / "docs" / "performance.md", metavar="FILE",
                        help="where the tables go (default docs/performance.md)")
    arguments = parser.parse_args()
    if arguments.core not in os.sched_getaffinity(0):
        parser.error(f"--core: this process may not use core {arguments.core}")
    arguments.compares = arguments.against is not None or arguments.against_bin is not None
    if arguments.case and not arguments.compares:
        parser.error("--case needs --against or --against-bin: the document's tables are whole")
    if arguments.against_bin == arguments.binaries:
        parser.error("--against-bin: that is the folder of this build")
    arguments.groups = set(arguments.group or (
        ("jobs",) if arguments.compares else ("jobs", "factors", "threads")))
    if arguments.long:
        arguments.groups.add("long")
        if arguments.long < LONG_DURATIONS_MIN[0]:
            parser.error(f"--long: the shortest recording has {LONG_DURATIONS_MIN[0]} minutes")
    arguments.long = arguments.long or LONG_DURATIONS_MIN[-1]
    return arguments


class Recordings:
    """Simulated recordings below the output directory. A name says what a recording was made
    from, the simulator itself included, so that an old one is not taken for a new one."""

    def __init__(self, arguments, work):
        self._directory = arguments.output / "recordings"
        self._simulate = arguments.binaries / "plumbline_simulate"
        self._work = work

    def directory(self, recording):
        inputs = hashlib.sha256(self._simulate.read_bytes())
        experiment = yaml.safe_load(recording.text())
        for text in (recording.text(), *(job_runner.read_text(job_runner.resolved(
                experiment[key])) for key in ("building", "rig"))):
            inputs.update(text.encode())
        name = f"{recording.experiment}_{recording.beams}_{inputs.hexdigest()[:12]}"
        return self._directory / name

    def make(self, recording):
        """Simulates the recording where it is not there yet; returns its directory."""
        destination = self.directory(recording)
        if destination.is_dir():
            return destination
        experiment = self._work / f"{destination.name}.yaml"
        experiment.write_text(recording.text(), encoding="utf-8")
        failure = job_runner.run_job(job_runner.Job(
            destination=destination,
            commands=((self._simulate, f"--experiment={experiment}", f"--seed={SEED}",
                       "--output=truth"),),
            required=("truth/recording.bag", "truth/rig.yaml")), self._work)
        if failure is not None:
            raise job_runner.InputError(f"{recording.experiment}: {failure['error']}")
        return destination


def mapper_settings(case):
    """The mapper's part of the experiment, with the factor."""
    experiment = yaml.safe_load(case.recording.text())
    settings = experiment.get("mapper") or {}
    settings.setdefault("batch", {})["factor"] = case.factor
    return yaml.safe_dump({"mapper": settings})


def cores_for(case, core):
    """The core, and as many others as the threads ask for and the machine has."""
    others = sorted(os.sched_getaffinity(0) - {core})
    return [core] + others[:case.threads - 1]


def run_measured(command, directory):
    """Exit code, wall time in s and resource usage of a process, which dies with this one."""
    with open(directory / "stderr.txt", "w", encoding="utf-8") as stderr:
        start = time.monotonic()
        process = subprocess.Popen(  # pylint: disable=consider-using-with
            ["setpriv", "--pdeathsig", "KILL", *map(str, command)], stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=stderr, start_new_session=True)
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            raise
        wall_s = time.monotonic() - start
        process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, wall_s, usage


def digest(path):
    inputs = hashlib.sha256()
    with open(path, "rb") as file:
        while block := file.read(1 << 20):
            inputs.update(block)
    return inputs.hexdigest()


def measure(case, recording, binaries, arguments, work):
    """The figures of one run. Throws JobError when the mapper fails; comparisons also take the time
    of a map that contradicts itself."""
    with job_runner.WorkDirectory(work) as directory:
        config = directory / "config.yaml"
        config.write_text(mapper_settings(case), encoding="utf-8")
        cores = cores_for(case, arguments.core)
        command = ["taskset", "-c", ",".join(map(str, cores)),
                   binaries / "plumbline_map",
                   f"--recording={recording / 'recording.bag'}", f"--rig={recording / 'rig.yaml'}",
                   f"--config={config}", f"--threads={case.threads}",
                   f"--output={directory / 'result'}"]
        exit_code, wall_s, usage = run_measured(command, directory)
        if exit_code not in ((0, job_runner.NOT_TRUSTED) if arguments.compares else (0,)):
            lines = (directory / "stderr.txt").read_text(errors="replace").strip().splitlines()
            raise job_runner.command_error([str(command[3])], exit_code, lines)
        result = directory / "result"
        summary = job_runner.read_json(result / "summary.json")
        figures = {"wall_s": wall_s, "cpu_s": usage.ru_utime + usage.ru_stime,
                   "peak_memory_mb": usage.ru_maxrss / 1024.0, "num_cores": len(cores),
                   "exit_code": exit_code}
        for key in ("duration_s", "stages", "points", "segments", "planes"):
            figures[key] = summary.get(key)
        if case.group == "threads":
            figures["digests"] = {name: digest(result / name) for name in COMPARED_FILES
                                  if (result / name).exists()}
        return figures


class Progress:
    """Tells on stderr what is being done and how long the rest will take, from the times of the
    runs so far: a case takes as long as before, a new one in proportion to its weight."""

    def __init__(self, runs):
        self._left = collections.Counter(runs)
        self._total = len(runs)
        self._seconds = {}

    @staticmethod
    def _weight(case):
        """Roughly in proportion to the time that a first run of the case takes."""
        length_m = case.recording.length_m or 60.0
        return length_m * (case.recording.beams / 270 if case.factor == "point" else 1.0)

    def begin(self, case, whose=""):
        done = self._total - sum(self._left.values())
        print(f"{done} of {self._total} runs done{self._rest()}; now {case.name}{whose}",
              file=sys.stderr, flush=True)

    def _rest(self):
        if not self._seconds:
            return ""
        rate = (sum(self._seconds.values()) /
                sum(self._weight(case) for case in self._seconds))
        seconds = sum(count * self._seconds.get(case, rate * self._weight(case))
                      for case, count in self._left.items())
        return f", ETA {datetime.timedelta(seconds=round(seconds))}"

    def end(self, case, seconds):
        self._left[case] -= 1
        self._seconds[case] = seconds


def median_of(runs):
    """The runs' medians; stages one by one."""
    median = {key: statistics.median(run[key] for run in runs)
              for key in ("wall_s", "cpu_s", "peak_memory_mb")}
    for key in ("duration_s", "points", "segments", "planes", "num_cores"):
        median[key] = runs[0][key]
    median["stages"] = {name: statistics.median(run["stages"][name] for run in runs)
                        for name in runs[0]["stages"] or {}}
    median["real_time_factor"] = median["duration_s"] / median["wall_s"]
    return median


def read_line(command):
    """The first line that a command prints, None where it fails."""
    try:
        result = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                check=False)
    except OSError:
        return None
    lines = result.stdout.splitlines()
    return lines[0].strip() if result.returncode == 0 and lines else None


def read_version():
    """The commit, marked when what the programs are made of is not as committed there."""
    version = read_line(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"])
    changed = read_line(["git", "-C", ROOT, "status", "--porcelain", "--", "CMakeLists.txt",
                         "apps", "core", "factors", "simulation"])
    return "unknown" if version is None else version + ("-modified" if changed else "")


def describe_machine(binaries):
    """What the figures depend on besides the program's text."""
    cpu = re.search(r"^model name\s*:\s*(.*)$", job_runner.read_text(
        job_runner.resolved("/proc/cpuinfo")), re.MULTILINE)
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    cache = binaries.parent / "CMakeCache.txt"
    variables = dict(re.findall(r"^(\w+):\w+=(.*)$", job_runner.read_text(cache), re.MULTILINE)
                     ) if cache.is_file() else {}
    compiler = variables.get("CMAKE_CXX_COMPILER")
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"),
        "version": read_version(),
        "cpu": cpu.group(1).strip() if cpu else "unknown",
        "cores": os.cpu_count(),
        "memory_gb": round(memory / 2 ** 30),
        "compiler": (compiler and read_line([compiler, "--version"])) or "unknown",
        "build_type": variables.get("CMAKE_BUILD_TYPE") or "unknown",
    }


def write_atomically(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text, encoding="utf-8")
    job_runner.write_through(partial)
    os.replace(partial, path)


def make_recordings(cases, arguments, work):
    """{recording: its directory}."""
    recordings = Recordings(arguments, work)
    directories = {}
    wanted = {case.recording for case in cases}
    for number, recording in enumerate(sorted(wanted, key=dataclasses.astuple), 1):
        print(f"recording {number} of {len(wanted)}: {recording.experiment}, "
              f"{recording.beams} beams", file=sys.stderr, flush=True)
        directories[recording] = recordings.make(recording)
    return directories


def run_all(cases, builds, arguments, work):
    """Figures of all runs by build (its folder) and case, and the errors of the cases that failed.
    Builds take turns within a case, and which is first changes from round to round."""
    directories = make_recordings(cases, arguments, work)
    runs = [(case, build) for number in range(arguments.repeat) for case in cases
            for build in (builds if number % 2 == 0 else builds[::-1])]
    progress = Progress([case for case, _ in runs])
    figures = {build: {case: [] for case in cases} for build in builds}
    errors = {}
    for case, build in runs:
        if case in errors:
            progress.end(case, 0.0)
            continue
        whose = "" if len(builds) == 1 else f", {build}"
        progress.begin(case, whose)
        start = time.monotonic()
        try:
            figures[build][case].append(
                measure(case, directories[case.recording], build, arguments, work))
        except job_runner.JobError as error:
            errors[case] = f"{error}{whose}"
        progress.end(case, time.monotonic() - start)
    return {build: {case: runs for case, runs in of_build.items() if case not in errors}
            for build, of_build in figures.items()}, errors


def compare(cases, arguments, setup):
    """Measures the two builds in turns and prints the ratios; returns the errors by case."""
    other = arguments.against_bin
    if arguments.against is not None:
        other = comparison.build_commit(ROOT, arguments.against, arguments.output / "builds")
    setup["other"] = {"commit": arguments.against, "folder": str(other),
                      "programs": series.build_of(other, ("plumbline_map",))["version"]}
    with job_runner.WorkDirectory(arguments.output) as work:
        figures, errors = run_all(cases, [arguments.binaries, other], arguments, work)
    results = {}
    for case, ours in figures[arguments.binaries].items():
        theirs = figures[other][case]
        results[case.name] = {**dataclasses.asdict(case),
                              "this": {"median": median_of(ours), "runs": ours},
                              "other": {"median": median_of(theirs), "runs": theirs},
                              "ratios": comparison.ratios_of(ours, theirs)}
    write_atomically(arguments.output / "against.json", json.dumps(
        {"setup": setup, "cases": results,
         "failed": {case.name: error for case, error in errors.items()}}, indent=2) + "\n")
    if results:
        whose = arguments.against[:12] if arguments.against else other
        print(f"{measured_line(setup)} This build over {whose}:\n")
        print("\n".join(comparison.ratios_table(results)))
    return errors


def fill_document(cases, arguments, setup):
    """Measures, and puts the tables into the document; returns the errors by case."""
    job_runner.read_text(arguments.document)  # an error now rather than after an hour
    with job_runner.WorkDirectory(arguments.output) as work:
        figures, errors = run_all(cases, [arguments.binaries], arguments, work)
    results = {case.name: {**dataclasses.asdict(case), "median": median_of(runs), "runs": runs}
               for case, runs in figures[arguments.binaries].items()}
    write_atomically(arguments.output / "benchmark.json", json.dumps(
        {"setup": setup, "cases": results,
         "failed": {case.name: error for case, error in errors.items()}}, indent=2) + "\n")
    document = job_runner.read_text(arguments.document)  # it may have been edited meanwhile
    for group, table in make_tables(setup, results).items():
        print(table + "\n")
        document, count = re.subn(
            rf"(<!-- begin {group} -->\n).*?(<!-- end {group} -->)",
            lambda match, text=table: f"{match.group(1)}{text}\n{match.group(2)}", document,
            flags=re.DOTALL)
        if count != 1:
            raise job_runner.InputError(f"{arguments.document}: no place marked for {group}")
    write_atomically(arguments.document, document)
    return errors


def main():
    arguments = parse_arguments()
    if arguments.against is not None:  # an error now rather than after the build
        arguments.against = comparison.find_commit(ROOT, arguments.against)
    cases = [case for case in make_cases(arguments.long, arguments.dense)
             if case.group in arguments.groups and
             (not arguments.case or any(text in case.name for text in arguments.case))]
    if not cases:
        raise job_runner.InputError(f"no case is named {' or '.join(arguments.case)}")
    if arguments.build and subprocess.run(
            [ROOT / "scripts" / "build.sh", "plumbline_simulate", "plumbline_map"],
            stdin=subprocess.DEVNULL, stdout=sys.stderr, check=False).returncode != 0:
        raise job_runner.InputError("the programs do not build, see above")
    versions = series.build_of(arguments.binaries,
                               ("plumbline_simulate", "plumbline_map"))["version"]
    setup = {**describe_machine(arguments.binaries), "programs": versions,
             "core": arguments.core, "repeat": arguments.repeat}
    errors = (compare if arguments.compares else fill_document)(cases, arguments, setup)
    for case, error in errors.items():
        print(f"failed: {case.name}: {error}")
    return 1 if errors else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

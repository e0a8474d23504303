"""Runs many jobs of the plumbline programs, on this machine or, by Dask, on many.

A job is a sequence of commands that work in a directory of its own. What it leaves is one
directory below the output directory, which appears complete or not at all. So a job whose
directory exists is done, and after any interruption the same command goes on where it stopped.

What is not finished is in .work.<session>/ below the output directory; a job whose work directory
is taken away gives up. What else lies there: series.py.
"""

import argparse
import concurrent.futures
import dataclasses
import datetime
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import uuid

ROOT = pathlib.Path(__file__).resolve().parents[2]
POLL_S = 0.5             # how soon a job notices that it shall give up
REPORT_INTERVAL_S = 10   # between lines of progress where these are not on a terminal
STDERR_LINES = 20        # of a failed command that are kept
NOT_TRUSTED = 3          # exit code of plumbline_map: a map, which contradicts itself
MAX_SUBMISSIONS = 5      # of a job to Dask, which itself tries it on a few workers if they die


class InputError(Exception):
    """Bad input; the message is one line."""


class JobError(Exception):
    """A command of a job failed; details are what is kept about it."""

    def __init__(self, error, **details):
        super().__init__(error)
        self.details = details


class GivenUp(Exception):
    """The job's work directory is gone: nobody waits for its results any more."""


@dataclasses.dataclass(frozen=True)
class Job:
    """One directory of results and the way to it. The commands run in a work directory that is
    empty at first; paths of results are relative to it."""

    destination: pathlib.Path
    commands: tuple           # of argument lists
    required: tuple           # paths of the results
    optional: tuple = ()      # patterns of results that are kept where they exist
    failure_file: str = ""    # beside the destination
    # Exit codes with which a command has done its work; exit_codes.json among the results holds
    # those of all commands where it is required.
    done_codes: tuple = (0,)
    info: dict = dataclasses.field(default_factory=dict)  # goes into the failure file


def run_job(job, work_root):
    """Does a job: None when it is done, else a dictionary that says what went wrong."""
    work = work_root / f"{job.destination.name}.{uuid.uuid4().hex}"
    try:
        work.mkdir()
    except FileNotFoundError as error:
        raise GivenUp(str(job.destination)) from error
    try:
        exit_codes = [run_command([str(part) for part in command], work, job.done_codes)
                      for command in job.commands]
        (work / "exit_codes.json").write_text(json.dumps(exit_codes), encoding="utf-8")
        publish(job, work)
        return None
    except JobError as error:
        return {**job.info, "error": str(error), **error.details}
    finally:
        shutil.rmtree(work, ignore_errors=True)


def run_command(command, work, done_codes):
    """Runs a command; returns its exit code, one of done_codes. It has a session of its own, so
    that Ctrl-C reaches only the script, and dies with the process that started it."""
    with open(work / "stderr.txt", "w+", encoding="utf-8", errors="replace") as stderr:
        with subprocess.Popen(["setpriv", "--pdeathsig", "KILL", *command], cwd=work,
                              stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                              stderr=stderr, start_new_session=True) as process:
            try:
                exit_code = wait_for(process, work)
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
        if exit_code not in done_codes:
            stderr.seek(0)
            raise command_error(command, exit_code, stderr.read().strip().splitlines())
        return exit_code


def wait_for(process, work):
    while True:
        try:
            return process.wait(POLL_S)
        except subprocess.TimeoutExpired:
            if not work.is_dir():
                raise GivenUp(str(work)) from None


def command_error(command, exit_code, lines):
    program = os.path.basename(command[0])
    if exit_code < 0:
        error = f"{program} was ended by signal {-exit_code}"
    else:
        error = lines[-1] if lines else f"{program}: no message, exit code {exit_code}"
    return JobError(error, command=command, exit_code=exit_code, stderr=lines[-STDERR_LINES:])


def publish(job, work):
    """Moves the job's results to their destination, all at once."""
    missing = [path for path in job.required if not (work / path).is_file()]
    if missing:
        raise JobError(f"the programs did not write {', '.join(missing)}")
    results = {work / path for path in job.required}
    for pattern in job.optional:
        results.update(work.glob(pattern))
    collected = work / "collected"
    collected.mkdir()
    for path in results:
        write_through(path)
        path.rename(collected / path.name)
    job.destination.parent.mkdir(parents=True, exist_ok=True)
    try:
        collected.rename(job.destination)
    except OSError:
        # A worker that was given up for lost may have finished the same job first.
        if not job.destination.is_dir():
            raise


def write_through(path):
    """Has what a path holds on the disk before its name is, in case the machine stops."""
    if path.is_dir():
        for entry in path.iterdir():
            write_through(entry)
        return
    with open(path, "rb") as file:
        os.fsync(file.fileno())


def discard(directory):
    """Takes a directory away at once, and then deletes it. Jobs that still work in it can no
    longer publish anything, not even a part."""
    trash = directory.with_name(f".trash.{uuid.uuid4().hex}")
    try:
        directory.rename(trash)
    except FileNotFoundError:
        return
    shutil.rmtree(trash, ignore_errors=True)


class WorkDirectory:
    """Context: a directory below root for unfinished work. When it ends, so do jobs in it."""

    def __init__(self, root):
        self.path = root / f".work.{uuid.uuid4().hex}"

    def __enter__(self):
        self.path.mkdir(parents=True)
        return self.path

    def __exit__(self, *_):
        discard(self.path)


def warn(text):
    print(f"{os.path.basename(sys.argv[0])}: {text}", file=sys.stderr)


def readable(read, *arguments):
    """What read says of a finished job's directory; None, after one line, where it is damaged."""
    try:
        return read(*arguments)
    except (InputError, OSError, LookupError, TypeError, ValueError, AttributeError) as error:
        warn(f"{arguments[0]} is damaged and left out; remove it to have it done again: {error!r}")
        return None


class Progress:
    """Tells on stderr how many jobs are done and how long the rest will take."""

    def __init__(self, total, missing, noun):
        self._total = total
        self._noun = noun
        self._missing = missing
        self._finished = 0
        self._failed = 0
        self._start = self._last_report = time.monotonic()
        self._on_terminal = sys.stderr.isatty()
        self._report()

    def count(self, failed):
        self._finished += 1
        self._failed += failed
        last = self._finished == self._missing
        if last or self._on_terminal or time.monotonic() - self._last_report > REPORT_INTERVAL_S:
            self._report()

    def _report(self):
        self._last_report = time.monotonic()
        rest = self._missing - self._finished
        text = f"{self._total - rest} of {self._total} {self._noun} finished"
        if self._failed:
            text += f", {self._failed} failed just now"
        if rest and self._finished:
            seconds = rest * (self._last_report - self._start) / self._finished
            text += f", ETA {datetime.timedelta(seconds=round(seconds))}"
        end = "" if self._on_terminal and rest else "\n"
        start = "\r\033[K" if self._on_terminal else ""
        print(f"{start}{text}", end=end, file=sys.stderr, flush=True)


class LocalExecutor:
    """Context: does jobs on this machine, num_jobs at a time."""

    def __init__(self, num_jobs):
        # Threads do: the work is in the programs they start.
        self._pool = concurrent.futures.ThreadPoolExecutor(num_jobs)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._pool.shutdown(cancel_futures=True)

    def run(self, jobs, work_root):
        """Yields each job when it has ended, with what went wrong (None: nothing)."""
        futures = {self._pool.submit(run_job, job, work_root): job for job in jobs}
        for future in concurrent.futures.as_completed(futures):
            yield futures[future], outcome(futures[future], future)


class DaskExecutor:
    """Context: does jobs on the workers of a Dask scheduler."""

    def __init__(self, scheduler):
        try:
            import cloudpickle
            import distributed
        except ImportError as error:
            raise InputError("--scheduler needs Debian's package python3-distributed") from error
        # The workers get this module with each job and need no files of ours in their path.
        cloudpickle.register_pickle_by_value(sys.modules[__name__])
        self._distributed = distributed
        try:
            self._client = distributed.Client(scheduler, timeout=10)
        except (OSError, ValueError) as error:
            raise InputError(f"no Dask scheduler at {scheduler}: {error}") from error
        if not self._client.nthreads():
            print(f"waiting for workers at {scheduler}", file=sys.stderr)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._client.close()

    def run(self, jobs, work_root):
        """As LocalExecutor.run. A job whose worker dies is done again by another worker."""
        futures = {self._submit(job, work_root): (job, 1) for job in jobs}
        ended = self._distributed.as_completed(futures)
        for future in ended:
            job, num_submissions = futures.pop(future)
            if future.cancelled():
                raise InputError("lost the Dask scheduler; the same command goes on from here")
            killed = isinstance(future.exception(), self._distributed.KilledWorker)
            if killed and num_submissions < MAX_SUBMISSIONS:
                again = self._submit(job, work_root)
                futures[again] = job, num_submissions + 1
                ended.add(again)
            elif killed:
                yield job, {**job.info, "error": "each worker that took it died, time and again; "
                            "see their logs"}
            else:
                yield job, outcome(job, future)

    def _submit(self, job, work_root):
        # A function made here is sent by value, and with it the job.
        return self._client.submit(lambda: run_job(job, work_root), pure=False)


def outcome(job, future):
    """What run_job returned, or the exception that ended it."""
    error = future.exception()
    if error is None:
        return future.result()
    return {**job.info, "error": f"{type(error).__name__}: {error}"}


def read_json(path):
    try:
        return json.loads(read_text(path))
    except ValueError as error:
        raise InputError(f"can not read {path}: {error}") from error


def read_object(path):
    data = read_json(path)
    if not isinstance(data, dict):
        raise InputError(f"can not read {path}: not an object")
    return data


def read_text(path):
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, ValueError) as error:
        raise InputError(f"can not read {path}: {error}") from error


def simulated_run(experiment, config, seed, binaries):
    """The commands that simulate, map and evaluate; results are in truth/ and result/."""
    return (
        (binaries / "plumbline_simulate", f"--experiment={experiment}", f"--seed={seed}",
         "--output=truth"),
        (binaries / "plumbline_map", "--recording=truth/recording.bag", "--rig=truth/rig.yaml",
         f"--config={config}", "--threads=1", "--output=result"),
        (binaries / "plumbline_evaluate", "--result=result", "--truth=truth",
         "--output=result/evaluation.json"),
    )


def positive(text):
    if int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text} is not positive")
    return int(text)


def resolved(text):
    """An absolute path, which workers in other directories understand."""
    return pathlib.Path(text).resolve()


def add_arguments(parser):
    parser.add_argument("--output", type=resolved, required=True, metavar="DIR",
                        help="where the results go; with --scheduler on a file system that all "
                        "machines share. Run again to go on after an interruption")
    parser.add_argument("--binaries", type=resolved, default=ROOT / "build" / "bin",
                        metavar="DIR", help="where the programs are (default build/bin)")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--jobs", type=positive, metavar="N",
                       help="jobs at the same time on this machine (default: all cores)")
    where.add_argument("--scheduler", metavar="tcp://HOST:PORT",
                       help="have the jobs done by the workers of this Dask scheduler, see "
                       "docs/cluster.md")
    parser.add_argument("--retry-failed", action="store_true",
                        help="also do what failed before once more")
    add_build_argument(parser)


def add_seed_arguments(parser, runs_of, seeds, first_seed=1):
    """Arguments of a script that runs each of several things with some seeds."""
    parser.add_argument("--seeds", type=positive, default=seeds, metavar="N",
                        help=f"runs of each {runs_of} (default {seeds})")
    parser.add_argument("--first-seed", type=positive, default=first_seed, metavar="N",
                        help=f"seed of the first run; the others count up (default {first_seed})")


def seeds_of(arguments):
    return range(arguments.first_seed, arguments.first_seed + arguments.seeds)


def add_build_argument(parser):
    parser.add_argument("--accept-other-build", action="store_true",
                        help="go on with a series that another build of the programs began; "
                        "setup.json names all builds")


def open_executor(arguments):
    if arguments.scheduler:
        return DaskExecutor(arguments.scheduler)
    return LocalExecutor(arguments.jobs or len(os.sched_getaffinity(0)))


def run_main(main):
    """Exit code of a script's main(), whose expected errors become one line on stderr."""
    name = os.path.basename(sys.argv[0])
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        return main()
    except KeyboardInterrupt:
        print(f"\n{name}: interrupted; the same command goes on from here", file=sys.stderr)
        return 130
    except (InputError, OSError) as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 1

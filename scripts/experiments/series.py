"""The output directory of a series of runs: what is run there, by which build of the programs.

A series can be gone on with for as long as nothing has changed. Results of something else are not
put beside it, nor, unasked, results of another build: their spread would say nothing of either.

Below the output directory, besides the results (job_runner.py):

    setup.json          what is run here, and by which builds
    failed_<...>.json   a job that failed, with its error
    .work.<session>/    what is not finished
    .lock               held while a script works here
"""

import fcntl
import hashlib
import json
import os
import subprocess

import job_runner

BUILD_KEYS = ("version", "sha256")  # of the setup; the others say what is run


def build_of(directory, programs):
    """The part of a setup that says which build it is: what the programs say with --version (None
    for those that do not tell), which names a commit, and checksums of the files, since much can
    be built from one commit."""
    build = {key: {} for key in BUILD_KEYS}
    for program in programs:
        path = directory / program
        if not os.access(path, os.X_OK) or not path.is_file():
            raise job_runner.InputError(
                f"no {program} in {directory}; build first, or see --binaries")
        result = subprocess.run([path, "--version"], stdin=subprocess.DEVNULL,
                                capture_output=True, text=True, check=False)
        build["version"][program] = result.stdout.strip() if result.returncode == 0 else None
        build["sha256"][program] = hashlib.sha256(path.read_bytes()).hexdigest()
    return build


def build_in(setup):
    return {key: setup.get(key) for key in BUILD_KEYS}


def difference(stored, build):
    """In words, where two builds differ: the first program that is another one."""
    for key in BUILD_KEYS:
        before, now = (setup.get(key) or {} for setup in (stored, build))
        for program in now:
            if before.get(program) == now[program]:
                continue
            if key == "version":
                return f"{before.get(program) or program}, now {now[program] or program}"
            return f"another {program} of the same version"
    return "other programs"


class Output:
    """Context: the output directory, held by one script at a time. setup is what is run there, a
    dictionary for JSON, with what build_of says; its other keys are words for messages."""

    def __init__(self, path, setup, accept_other_build):
        self.path = path
        self._setup = setup
        self._accept_other_build = accept_other_build
        self._lock = None
        self._work = job_runner.WorkDirectory(path)

    def __enter__(self):
        self.path.mkdir(parents=True, exist_ok=True)
        self._take_lock()
        try:
            setup = self._setup_to_write()
            for pattern in (".work.*", ".trash.*"):
                for leftover in self.path.glob(pattern):
                    job_runner.discard(leftover)
            self._work.__enter__()
            if setup is not None:
                self.write_json("setup.json", setup)
        except BaseException:
            os.close(self._lock)
            raise
        return self

    def __exit__(self, *arguments):
        self._work.__exit__(*arguments)
        os.close(self._lock)

    def _take_lock(self):
        self._lock = os.open(self.path / ".lock", os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(self._lock)
            raise job_runner.InputError(f"{self.path}: another script is at work here") from None
        except OSError:
            pass  # some shared file systems have no locks; results are safe without

    def _setup_to_write(self):
        """What setup.json has to become; None where it says so already. An error when another
        setup is stored there, and, unless accepted, when only the build is another one."""
        path = self.path / "setup.json"
        if not path.exists():
            if any(entry.is_dir() for entry in self.path.glob("[!.]*")):
                raise job_runner.InputError(f"{self.path} holds directories but no setup.json; "
                                            "choose another --output")
            return self._setup
        stored = job_runner.read_object(path)
        earlier = stored.pop("earlier_builds", [])
        keys = [key for key in {**self._setup, **stored}
                if key not in BUILD_KEYS and stored.get(key) != self._setup.get(key)]
        if keys:
            raise job_runner.InputError(
                f"{self.path} holds results of another {' and '.join(keys)}, see its setup.json; "
                "choose another --output")
        build = build_in(self._setup)
        if build_in(stored) == build:
            self._warn_of_mixture(earlier)
            return None
        if not self._accept_other_build:
            raise job_runner.InputError(
                f"{self.path} holds results of another build ({difference(stored, build)}); "
                "choose another --output, or go on with --accept-other-build")
        earlier = [other for other in (*earlier, build_in(stored)) if other != build]
        self._warn_of_mixture(earlier)
        return {**self._setup, "earlier_builds": earlier}

    def _warn_of_mixture(self, earlier):
        if earlier:
            job_runner.warn(f"{self.path} mixes results of {len(earlier) + 1} builds, see its "
                            "setup.json")

    def write_json(self, name, data):
        """Writes a file that appears complete or not at all."""
        temporary = self._work.path / name
        temporary.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
        job_runner.write_through(temporary)
        temporary.rename(self.path / name)

    def run(self, jobs, executor, retry_failed, noun):
        """Runs the jobs that are neither done nor, unless retry_failed, failed before."""
        missing = [job for job in jobs if self._is_missing(job, retry_failed)]
        progress = job_runner.Progress(len(jobs), len(missing), noun)
        for job, failure in executor.run(missing, self._work.path):
            if failure is None:
                (self.path / job.failure_file).unlink(missing_ok=True)
            else:
                self.write_json(job.failure_file, failure)
            progress.count(failure is not None)
        for job in jobs:  # one that an interruption left as failed and done
            if job.destination.is_dir():
                (self.path / job.failure_file).unlink(missing_ok=True)

    def _is_missing(self, job, retry_failed):
        if job.destination.is_dir() and not any(job.destination.iterdir()):
            job_runner.warn(f"{job.destination} is empty; done again")
            job.destination.rmdir()
        if job.destination.is_dir():
            return False
        return retry_failed or self.read_failure(job.failure_file) is None

    def read_failure(self, name):
        """What a failure file says; None where there is none or it is damaged."""
        path = self.path / name
        try:
            failure = job_runner.read_object(path) if path.exists() else None
            if failure is None or "error" in failure:
                return failure
            job_runner.warn(f"{path} has no error; left out")
        except job_runner.InputError as error:
            job_runner.warn(f"{error}; left out")
        return None

    def rows(self, jobs, row_of, failure_row):
        """row_of(directory, info) of each job that is done, failure_row(failure, info) of each that
        failed, in the order of the jobs. Damaged directories and jobs not yet run have no row."""
        rows = []
        for job in jobs:
            if job.destination.is_dir():
                rows.append(job_runner.readable(row_of, job.destination, job.info))
            elif failure := self.read_failure(job.failure_file):
                rows.append(failure_row(failure, job.info))
        return [row for row in rows if row]

    def write_table(self, name, rows, table):
        self.write_json(f"{name}.json", rows)
        (self.path / f"{name}.md").write_text(table, encoding="utf-8")

    def failures(self, key):
        """The failures so far that have the key, such as seed."""
        paths = sorted(self.path.glob("failed_*.json"))
        return [failure for failure in map(self.read_failure, (path.name for path in paths))
                if failure and key in failure]


def run_table(name, programs, arguments, make_jobs, row_of, failure_row, table_of):
    """Runs the jobs of make_jobs(arguments) and makes a table of what they came to, a row a job.

    row_of(directory, info) reads a job that is done, failure_row(failure, info) one that failed.
    The rows go to name.json in the output directory, the text of table_of(rows) to name.md and to
    stdout. Returns the rows and how many jobs have none.
    """
    setup = {"program": f"{name}.py", **build_of(arguments.binaries, programs)}
    with job_runner.open_executor(arguments) as executor, \
            Output(arguments.output, setup, arguments.accept_other_build) as output:
        jobs = make_jobs(arguments)
        output.run(jobs, executor, arguments.retry_failed, "runs")
        rows = output.rows(jobs, row_of, failure_row)
        output.write_table(name, rows, table_of(rows))
    print(table_of(rows), end="")
    return rows, len(jobs) - len(rows)

"""Another build of plumbline_map to be measured against, and the ratios to it."""

import io
import os
import statistics
import subprocess
import sys
import tarfile

import job_runner
from benchmark_tables import header, row, seconds

RATIOS = {"wall_s": "time", "cpu_s": "processor time", "peak_memory_mb": "memory"}


def find_commit(repository, name):
    """The full name of a commit. InputError where the repository has none of this name."""
    result = subprocess.run(
        ["git", "-C", repository, "rev-parse", "--verify", "--quiet", "--end-of-options",
         f"{name}^{{commit}}"], stdin=subprocess.DEVNULL, capture_output=True, text=True,
        check=False)
    if result.returncode != 0:
        raise job_runner.InputError(f"no commit {name} in {repository}")
    return result.stdout.strip()


def build_commit(repository, commit, directory):
    """Builds plumbline_map of a commit as the commit itself says, with a source and a build folder
    of its own below the directory, which stay for the next time. Returns where the program is."""
    source = directory / commit[:12]
    if not source.is_dir():
        archive = subprocess.run(["git", "-C", repository, "archive", commit],
                                 stdin=subprocess.DEVNULL, capture_output=True, check=False)
        if archive.returncode != 0:
            raise job_runner.InputError(f"{repository}: can not read commit {commit[:12]}")
        with job_runner.WorkDirectory(directory) as work:
            with tarfile.open(fileobj=io.BytesIO(archive.stdout)) as tar:
                tar.extractall(work / "source")
            (work / "source").rename(source)
    # With names of files that do not depend on the folder, ccache finds what it built for another
    # commit.
    environment = {**os.environ, "CCACHE_BASEDIR": str(source), "CCACHE_NOHASHDIR": "1"}
    result = subprocess.run([source / "scripts" / "build.sh", "plumbline_map"], env=environment,
                            stdin=subprocess.DEVNULL, stdout=sys.stderr, check=False)
    if result.returncode != 0:
        raise job_runner.InputError(f"{commit[:12]} does not build, see above and {source}")
    return source / "build" / "bin"


def ratios_of(ours, theirs):
    """{figure: ratio of each run to the other build's run of the same turn}."""
    return {key: [our[key] / their[key] for our, their in zip(ours, theirs)] for key in RATIOS}


def ratio_cell(ratios):
    """The median, and the range where there are several."""
    text = f"{statistics.median(ratios):.2f}"
    return text if len(ratios) < 2 else f"{text} ({min(ratios):.2f} to {max(ratios):.2f})"


def ratios_table(cases):
    """The lines of the table; cases as in against.json."""
    lines = header(["case", "this build / s", "the other / s",
                    *(f"ratio of {name}" for name in RATIOS.values())])
    return lines + [row([name, seconds(case["this"]["median"]["wall_s"]),
                         seconds(case["other"]["median"]["wall_s"]),
                         *(ratio_cell(case["ratios"][key]) for key in RATIOS)])
                    for name, case in cases.items()]

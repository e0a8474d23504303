"""Installs what the report's page is built from and tested with, below the build directory."""

import fcntl
import hashlib
import pathlib
import shutil
import subprocess
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
VIEWER = ROOT / "core/outputs/viewer"


def find_program(*names):
    """The first of these programs that there is; skips the test without any."""
    for name in names:
        if shutil.which(name):
            return shutil.which(name)
    raise unittest.SkipTest(f"needs the program {names[0]}")


def install(build_directory):
    """A directory with the page's source and the packages of its lockfile; skips the test where
    these can not be had."""
    npm = find_program("npm")
    find_program("node")
    directory = pathlib.Path(build_directory) / "report_viewer"
    directory.mkdir(parents=True, exist_ok=True)
    with open(directory / "lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for name in ("package.json", "package-lock.json", ".npmrc", "build.mjs"):
            shutil.copy(VIEWER / name, directory / name)
        shutil.rmtree(directory / "src", ignore_errors=True)
        shutil.copytree(VIEWER / "src", directory / "src")
        wanted = hashlib.sha256((VIEWER / "package-lock.json").read_bytes()).hexdigest()
        stamp = directory / "installed"
        if not stamp.exists() or stamp.read_text(encoding="utf-8") != wanted:
            run = subprocess.run(
                [npm, "ci", "--ignore-scripts", "--no-audit", "--no-fund"], cwd=directory,
                capture_output=True, text=True, check=False)
            if run.returncode != 0:
                lines = run.stderr.strip().splitlines() or ["no reason given"]
                if "package-lock.json" in run.stderr:
                    raise AssertionError(run.stderr)
                raise unittest.SkipTest(f"npm could not install the page's packages: {lines[0]}")
            stamp.write_text(wanted, encoding="utf-8")
    return directory

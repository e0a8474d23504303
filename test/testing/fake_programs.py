"""Stand-ins for the plumbline programs, for tests of the scripts that run them many times.

They write small files at once. A test steers and watches them by files in the directory "control":

    attempts          a line "seed or recording, process id of the parent" per plumbline_map
    hold              plumbline_map waits while this exists
    fail_<seed>       plumbline_map fails on this seed or recording
    contradict_<seed> plumbline_map ends with exit code 3 on this seed, its map written
    parts_<seed>      plumbline_map writes a folder part_2 for this seed or recording
    forget_planes     plumbline_map writes no planes.json
    threads_matter    plumbline_map writes another map with other --threads
    version           answer to --version; without it that is wrong usage, as any unknown flag
"""

import os
import pathlib
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCRIPTS = ROOT / "scripts"
PATIENCE_S = 60

PROGRAM = '''#!/usr/bin/python3 -ES
import json, os, pathlib, sys, time
control = pathlib.Path("{control}")
program = pathlib.Path(sys.argv[0]).name
if "--version" in sys.argv:
    if not (control / "version").exists():
        sys.exit(2)
    print((control / "version").read_text())
    sys.exit(0)
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
output = pathlib.Path(flags["output"])

def write(name, text):
    output.mkdir(exist_ok=True)
    (output / name).write_text(text)

if program == "plumbline_simulate":
    pathlib.Path(flags["experiment"]).read_text()
    write("recording.bag", flags["seed"])
    for name in ("rig.yaml", "truth_planes.json"):
        write(name, name)
    write("truth_trajectory.tum", "10.0 0 0 0 0 0 0 1\\n")
elif program == "plumbline_map":
    recording = pathlib.Path(flags["recording"])
    seed = recording.name if recording.is_dir() else recording.read_text()
    rig = pathlib.Path(flags["rig"]).read_text()
    config = pathlib.Path(flags["config"]).read_text() if "config" in flags else ""
    with open(control / "attempts", "a") as attempts:
        attempts.write(f"{{seed}} {{os.getppid()}}\\n")
    write("map.ply", "begun")
    while (control / "hold").exists():
        time.sleep(0.02)
    if (control / f"fail_{{seed}}").exists():
        print("a long story", file=sys.stderr)
        sys.exit(f"plumbline_map: lost in {{seed}}")
    for name in ("trajectory_covariance.csv", "config_used.yaml"):
        write(name, name + rig)
    write("trajectory.tum", f"# {{rig}}\\n9.5 0 0 0 0 0 0 1\\n")
    if not (control / "forget_planes").exists():
        write("planes.json", "[]")
    if (control / f"parts_{{seed}}").exists():
        (output / "part_2").mkdir()
        write("part_2/map.ply", "part")
    if (control / "threads_matter").exists():
        write("map.ply", flags["threads"])
    write("summary.json", json.dumps(dict(
        residual_rms_m=0.02, real_time_factor=5, peak_memory_mb=100, duration_s=1, planes=4,
        variance_factor=1, warnings=[], points=1000, segments=100,
        stages=dict(reading=0.1, batch=0.4 if "point" in config else 0.1))))
    if (control / f"contradict_{{seed}}").exists():
        sys.exit(3)
else:
    seed = int((pathlib.Path(flags["truth"]) / "recording.bag").read_text())
    errors = dict(position_m=dict(rmse=0.001 * seed, max=0.01 * seed),
                  rotation_deg=dict(rmse=0.01, max=0.1))
    distances = dict(angle_deg=dict(max=0.1), distance_m=dict(max=0.002))
    output.write_text(json.dumps(dict(
        trajectory=dict(unaligned=errors, aligned=errors), planes_aligned=distances,
        planes=dict(matched=10, wrong=0, doubled=0, missed=1, list=[],
                    **distances))))
'''


def wait_until(condition):
    deadline = time.monotonic() + PATIENCE_S
    while not condition():
        if time.monotonic() > deadline:
            raise AssertionError("waited too long")
        time.sleep(0.02)


class ScriptTest(unittest.TestCase):
    """A directory with the programs' stand-ins in bin/ and their control/."""

    script = None  # path of the script under test below scripts/

    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        self.output = self.directory / "output"
        self.control = self.directory / "control"
        self.control.mkdir()
        self.binaries = self.directory / "bin"
        self.binaries.mkdir()
        for name in ("plumbline_simulate", "plumbline_map", "plumbline_evaluate"):
            program = self.binaries / name
            program.write_text(PROGRAM.format(control=self.control))
            program.chmod(program.stat().st_mode | stat.S_IXUSR)

    def command(self, *arguments):
        return [sys.executable, SCRIPTS / self.script, "--output", self.output,
                "--binaries", self.binaries, *arguments]

    def run_script(self, *arguments, **options):
        return subprocess.run(self.command(*arguments), capture_output=True, text=True,
                              check=False, timeout=PATIENCE_S, **options)

    def start_script(self, *arguments):
        """The script as in a terminal: a process group that Ctrl-C reaches as a whole."""
        process = subprocess.Popen(
            self.command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            start_new_session=True,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler))
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def check_done(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)

    def check_error(self, text, *arguments):
        result = self.run_script(*arguments)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
        self.assertIn(text, result.stderr)
        self.assertEqual(result.stdout, "")

    def check_usage_error(self, *arguments):
        self.assertEqual(self.run_script(*arguments).returncode, 2)

    def set_control(self, name, text=""):
        (self.control / name).write_text(text)

    def unset_control(self, name):
        (self.control / name).unlink()

    def attempts(self):
        """Seed and parent of each mapping begun so far."""
        path = self.control / "attempts"
        lines = path.read_text().splitlines() if path.exists() else []
        return [tuple(line.split()) for line in lines]

    def seeds(self):
        return sorted(seed for seed, _ in self.attempts())

    def entries(self, hidden=False):
        """Names in the output directory; hidden ones are those of unfinished work."""
        return sorted(path.name for path in self.output.iterdir()
                      if path.name.startswith(".") == hidden and path.name != ".lock")

    def programs_running(self):
        """Whether any of the stand-ins runs."""
        for path in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                if os.fsencode(self.binaries) in path.read_bytes() and (
                        b"--recording" in path.read_bytes()):
                    return True
            except OSError:
                pass  # it has ended
        return False

#!/usr/bin/python3
"""Tests how plumbline_map ends when it is asked to, or killed: a real process maps the recording of a
robot. Argument: the program."""

import json
import os
import pathlib
import pty
import re
import select
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = None
PATIENCE_S = 120


class Mapper:
    """A plumbline_map whose stderr is a terminal, where it tells its progress."""

    def __init__(self, output, recording, rig, more=()):
        self._terminal, other_end = pty.openpty()
        self.text = ""
        self.process = subprocess.Popen(
            [PROGRAM, f"--recording={recording}",
             f"--rig={rig}",
             "--threads=1", "--checkpoint_after_s=0", f"--output={output}", *more],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=other_end,
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL))
        os.close(other_end)

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self._terminal)

    def _read(self, timeout_s):
        if not select.select([self._terminal], [], [], timeout_s)[0]:
            return True
        try:
            new = os.read(self._terminal, 4096)
        except OSError:  # the process has ended
            return False
        self.text += new.decode()
        return bool(new)

    def wait_for(self, condition):
        deadline = time.monotonic() + PATIENCE_S
        while not condition(self):
            if time.monotonic() > deadline or not self._read(1):
                raise AssertionError("this did not come: " + self.text)

    def progress(self):
        shares = re.findall(r"map: following, +(\d+) %", self.text)
        return int(shares[-1]) if shares else 0

    def exit_code(self):
        while self._read(PATIENCE_S):
            pass
        return self.process.wait(PATIENCE_S)


class StopTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.directory = pathlib.Path(directory.name)
        self.output = self.directory / "output"

    def start(self, recording=ROOT / "test/data/robot_three_scanners.bag",
              rig=ROOT / "configs/rigs/robot_three_scanners.yaml", more=(), output=None):
        mapper = Mapper(output or self.output, recording, rig, more)
        self.addCleanup(mapper.close)
        return mapper

    def entries(self):
        return sorted(path.name for path in self.directory.iterdir())

    def summary(self):
        return json.loads((self.output / "summary.json").read_text())

    def test_ctrl_c_ends_the_map_there(self):
        mapper = self.start()
        mapper.wait_for(lambda mapper: mapper.progress() >= 15)
        mapper.process.send_signal(signal.SIGINT)
        self.assertEqual(mapper.exit_code(), 0, mapper.text)
        self.assertIn("finishing the map of what was read so far; again: at once", mapper.text)
        self.assertGreater(self.summary()["consistency"]["ends_at_s"], 10.0)
        self.assertLess(self.summary()["consistency"]["ends_at_s"], 50.0)
        self.assertLess(self.summary()["scans"], 435)
        self.assertEqual(self.entries(), ["output"])

    def test_a_map_that_has_been_followed_is_finished(self):
        mapper = self.start()
        mapper.wait_for(lambda mapper: "batch round 1" in mapper.text)
        mapper.process.send_signal(signal.SIGTERM)
        self.assertEqual(mapper.exit_code(), 0, mapper.text)
        self.assertIn("finishing the map", mapper.text)
        self.assertEqual(self.summary()["scans"], 435)

    def test_the_second_signal_ends_it_at_once_and_the_next_run_clears_up(self):
        mapper = self.start()
        mapper.wait_for(lambda mapper: "batch round 1" in mapper.text)
        mapper.process.send_signal(signal.SIGINT)
        mapper.wait_for(lambda mapper: "finishing the map" in mapper.text)
        mapper.process.send_signal(signal.SIGTERM)
        self.assertEqual(mapper.exit_code(), -signal.SIGTERM)
        self.assertEqual(len(self.entries()), 1)
        self.assertRegex(self.entries()[0], r"^\.output\..*\.partial$")
        self.assertEqual(self.start().exit_code(), 0)
        self.assertEqual(self.entries(), ["output"])

    def test_killed(self):
        self.output.mkdir()
        (self.output / "map.ply").write_text("old")
        (self.output / "notes.txt").write_text("notes")
        mapper = self.start()
        mapper.wait_for(lambda mapper: mapper.progress() >= 15)
        second = self.start()
        self.assertEqual(second.exit_code(), 1)
        self.assertIn("another run is writing its result there", second.text)
        mapper.process.kill()
        self.assertEqual(mapper.exit_code(), -signal.SIGKILL)
        self.assertEqual((self.output / "map.ply").read_text(), "old")
        self.assertEqual(self.start().exit_code(), 0)
        self.assertEqual(self.entries(), ["output"])
        self.assertEqual((self.output / "notes.txt").read_text(), "notes")
        self.assertEqual(self.summary()["scans"], 435)

    def kill_in_the_batch(self):
        mapper = self.start()
        mapper.wait_for(lambda mapper: "batch round 1" in mapper.text)
        mapper.process.kill()
        self.assertEqual(mapper.exit_code(), -signal.SIGKILL)

    def checkpoint(self):
        [checkpoint] = self.directory.glob(".output.*.partial/checkpoint.bin")
        return checkpoint

    def assert_refused(self, mapper, message):
        self.assertEqual(mapper.exit_code(), 1, mapper.text)
        self.assertIn(message, mapper.text)
        self.assertEqual(mapper.text.count("plumbline_map: "), 1, mapper.text)
        self.assertFalse(self.output.exists())

    def test_a_killed_run_is_resumed_to_the_same_bytes(self):
        whole = self.directory / "whole"
        self.assertEqual(self.start(output=whole).exit_code(), 0)
        self.kill_in_the_batch()
        self.checkpoint()
        resumed = self.start(more=["--resume"])
        self.assertEqual(resumed.exit_code(), 0, resumed.text)
        self.assertIn("going on with what a killed run has followed", resumed.text)
        self.assertEqual(self.entries(), ["output", "whole"])
        names = sorted(path.name for path in whole.iterdir())
        self.assertEqual(names, sorted(path.name for path in self.output.iterdir()))
        for name in set(names) - {"summary.json"}:
            self.assertEqual((whole / name).read_bytes(), (self.output / name).read_bytes(), name)
        timings = {"stages", "real_time_factor", "peak_memory_mb"}
        expected = json.loads((whole / "summary.json").read_text())
        for key in set(expected) - timings:
            self.assertEqual(expected[key], self.summary()[key], key)

    def test_a_checkpoint_of_other_inputs_or_damaged_is_refused_and_kept(self):
        self.kill_in_the_batch()
        config = self.directory / "config.yaml"
        config.write_text("recording: {max_gap_s: 1.0}  # the default\n")
        rig = self.directory / "rig.yaml"
        rig.write_text((ROOT / "configs/rigs/robot_three_scanners.yaml").read_text() + "\n")
        self.assert_refused(self.start(rig=rig, more=["--resume"]), "had another rig file")
        recording = self.directory / "copy.bag"
        recording.write_bytes((ROOT / "test/data/robot_three_scanners.bag").read_bytes())
        self.assert_refused(self.start(recording, more=["--resume"]), "had another recording")
        whole = self.checkpoint().read_bytes()
        self.checkpoint().write_bytes(whole[:len(whole) // 2])
        self.assert_refused(self.start(more=["--resume"]), "is damaged or incomplete")
        self.checkpoint().write_bytes(whole)
        # Other words, the same settings.
        self.assertEqual(self.start(more=["--resume", f"--config={config}"]).exit_code(), 0)
        self.assertTrue(self.output.exists())

    def test_following_that_takes_no_time_leaves_no_checkpoint(self):
        mapper = self.start(more=["--checkpoint_after_s=1000"])
        mapper.wait_for(lambda mapper: "batch round 1" in mapper.text)
        mapper.process.kill()
        self.assertEqual(mapper.exit_code(), -signal.SIGKILL)
        self.assertEqual(list(self.directory.glob(".output.*.partial/checkpoint.bin")), [])
        self.assert_refused(self.start(more=["--resume"]), "or in so short a time that nothing was kept")

    def test_without_a_killed_run_there_is_nothing_to_resume(self):
        self.assert_refused(self.start(more=["--resume"]), "there is no killed run to resume")
        self.assertEqual(self.entries(), [])

    def test_before_the_following_a_signal_ends_it_at_once(self):
        rig = self.directory / "rig.yaml"
        os.mkfifo(rig)
        mapper = self.start(rig=rig)
        writer = os.open(rig, os.O_WRONLY)  # waits for who reads
        self.addCleanup(os.close, writer)
        mapper.process.send_signal(signal.SIGTERM)
        self.assertEqual(mapper.exit_code(), -signal.SIGTERM)
        self.assertNotIn("finishing", mapper.text)

    def test_an_output_that_can_not_be_written_is_told_at_once(self):
        self.output.write_text("a file")
        mapper = self.start(self.directory / "no_such_recording.bag")
        self.assertEqual(mapper.exit_code(), 1)
        self.assertEqual(mapper.text.count("\n"), 1)
        self.assertIn(f"{self.output}: can not be used as output directory: it is a file",
                      mapper.text)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()

#!/usr/bin/python3
"""Tests what the programs show on a terminal, and elsewhere. Argument: the directory of the programs."""

import json
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = None
PATIENCE_S = 120
ESCAPE = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")


def run_on_terminal(command, **environment):
    """Exit code and all that the command writes to a terminal of 80 columns."""
    terminal, other_end = pty.openpty()
    settings = {**os.environ, "TERM": "xterm", **environment}
    if "NO_COLOR" not in environment:
        settings.pop("NO_COLOR", None)
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=other_end, stderr=other_end,
                               env=settings)
    os.close(other_end)
    text = b""
    while True:
        try:
            new = os.read(terminal, 4096)
        except OSError:  # the process has ended
            break
        if not new:
            break
        text += new
    os.close(terminal)
    return process.wait(PATIENCE_S), text.decode().replace("\r\n", "\n")


def shown(text):
    """What a terminal shows in the end: the last state of each line."""
    lines = []
    for line in text.split("\n"):
        line = line.split("\x1b[K")[-1] if "\x1b[K" in line else line
        lines.append(ESCAPE.sub("", line).replace("\r", ""))
    return "\n".join(lines)


class TerminalTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.directory = pathlib.Path(cls.temporary.name)
        cls.simulate = [PROGRAMS / "plumbline_simulate", f"--output={cls.directory}/room",
                        f"--experiment={ROOT}/configs/experiments/room.yaml"]
        cls.map = [PROGRAMS / "plumbline_map", f"--recording={cls.directory}/room/recording.bag",
                   f"--rig={cls.directory}/room/rig.yaml", f"--output={cls.directory}/map"]
        code, cls.simulated = run_on_terminal(cls.simulate)
        assert code == 0, cls.simulated

    def test_progress_says_share_speed_and_time_and_goes_away(self):
        self.assertRegex(self.simulated, r"simulate: +\d+ %, [\d.]+ times real time, \d+ s to go")
        self.assertNotIn("simulate: ", shown(self.simulated))

    def test_every_program_ends_with_a_table_and_what_it_wrote(self):
        evaluation = f"{self.directory}/evaluation.json"
        _, mapped = run_on_terminal(self.map)
        _, evaluated = run_on_terminal(
            [PROGRAMS / "plumbline_evaluate", f"--result={self.directory}/map",
             f"--truth={self.directory}/room", f"--output={evaluation}"])
        _, bound = run_on_terminal(
            [PROGRAMS / "plumbline_bound", f"--output={self.directory}/bound",
             f"--experiment={ROOT}/configs/experiments/room.yaml"])
        for text, written in ((self.simulated, "room: recording.bag"), (mapped, "map: map.*"),
                              (evaluated, evaluation), (bound, "bound: planes.json")):
            self.assertRegex(shown(text), rf"Written to .*{re.escape(written)}")
        self.assertRegex(shown(self.simulated), r"recording +13\.\d s\n")
        self.assertIn("beams", shown(self.simulated))

    def test_stages_of_a_map(self):
        code, text = run_on_terminal(self.map)
        self.assertEqual(code, 0, text)
        self.assertRegex(text, r"(?s)map: following, +\d+ %.*map: estimating, +\d+ %.*map: writing, +\d+ %")
        self.assertRegex(text, r"map: \w+, +\d+ %, [\d.]+ times real time, \d+ s to go")
        self.assertNotRegex(shown(text), r"map: (following|estimating|writing)")
        # Messages without glog's time and place in the source.
        self.assertRegex(shown(text), r"(?m)^batch round 1: ")
        self.assertIn("\x1b[32mVerdict: consistent\x1b[0m", text)

    def test_the_progress_fits_into_a_narrow_terminal(self):
        for line in re.findall(r"\x1b\[K([^\r\n\x1b]*)", self.simulated):
            self.assertLess(len(line), 80)

    def test_no_colour_where_none_is_wanted(self):
        _, text = run_on_terminal(self.map, NO_COLOR="1")
        self.assertIn("Verdict: consistent", text)
        self.assertNotRegex(text, r"\x1b\[\d+m")
        _, text = run_on_terminal(self.map, NO_COLOR="")
        self.assertIn("\x1b[32mVerdict", text)

    def test_a_terminal_that_can_do_nothing_gets_plain_lines(self):
        _, text = run_on_terminal(self.map, TERM="dumb")
        self.assertIn("Verdict: consistent", text)
        self.assertNotIn("\x1b", text)

    def test_plain_text_where_there_is_no_terminal(self):
        result = subprocess.run(self.map, capture_output=True, text=True, check=True)
        self.assertIn("Verdict: consistent\n", result.stdout)
        self.assertNotIn("\x1b", result.stdout + result.stderr)
        # Logs keep the time and the place in the source.
        self.assertRegex(result.stderr, r"(?m)^I\d{8} [\d:.]+ +\d+ batch\.cc:\d+\] batch round 1: ")
        self.assertEqual(json.loads((self.directory / "map/summary.json").read_text())
                         ["consistency"]["verdict"], "consistent")

    def test_errors_are_one_red_line(self):
        code, text = run_on_terminal([*self.map, "--rig=/no_such_rig.yaml"])
        self.assertEqual(code, 1)
        self.assertIn("\x1b[31mplumbline_map: \x1b[0m/no_such_rig.yaml: ", text)
        self.assertEqual(text.count("\n"), 1, text)


if __name__ == "__main__":
    PROGRAMS = pathlib.Path(sys.argv.pop(1))
    unittest.main()

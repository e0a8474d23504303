#!/usr/bin/python3
"""Runs the commands of docs/guide.md as typed, from its text, in the order of the page.

    guide_test.py BUILD_DIRECTORY

scripts/build.sh only counts what it names: the programs must have been named before they are
called. The many runs of monte_carlo.py are left out. A reader's own my.bag and my_rig.yaml are the
recording of the guide's first room.
"""

import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
SAVED = re.compile(r"Save this as `([^`]+)`.*?```yaml\n(.*?)```", re.DOTALL)
COMMAND = re.compile(r"^    ((?:build/bin/plumbline_|scripts/)(?:[^\\\n]|\\\n)+)$", re.MULTILINE)
DONE_CODES = (0, 3)  # a map not to be trusted is one, too


def steps(text):
    """("file", path, content) and ("run", words), in the order of the page."""
    found = [(match.start(2), ("file", match[1], match[2])) for match in SAVED.finditer(text)]
    found += [(match.start(), ("run", shlex.split(match[1].replace("\\\n", " "))))
              for match in COMMAND.finditer(text)]
    return [step for _, step in sorted(found, key=lambda entry: entry[0])]


class Guide(unittest.TestCase):
    def setUp(self):
        self.directory = tempfile.TemporaryDirectory()
        self.place = pathlib.Path(self.directory.name)
        for name in ("configs", "scripts", "test"):
            (self.place / name).symlink_to(ROOT / name)
        (self.place / "build").symlink_to(BUILD)
        (self.place / "out").mkdir()
        (self.place / "my.bag").symlink_to(self.place / "out/room/recording.bag")
        (self.place / "my_rig.yaml").symlink_to(self.place / "out/room/rig.yaml")

    def tearDown(self):
        self.directory.cleanup()

    def test_commands_work_as_typed(self):
        built = set()
        called = set()
        for kind, *step in steps((ROOT / "docs/guide.md").read_text(encoding="utf-8")):
            if kind == "file":
                (self.place / step[0]).write_text(step[1], encoding="utf-8")
                continue
            words = step[0]
            program = pathlib.Path(words[0]).name
            if program == "build.sh":
                built.update(words[1:])
                continue
            if program.startswith("plumbline_"):
                self.assertIn(program, built, "is called before it is built")
            called.add(program)
            if program == "monte_carlo.py":
                continue
            with self.subTest(command=" ".join(words)):
                run = subprocess.run(words, cwd=self.place, capture_output=True, text=True,
                                     check=False)
                self.assertIn(run.returncode, DONE_CODES, run.stdout + run.stderr)
        for program in ("check", "evaluate", "map", "plan", "report", "simulate", "bound"):
            self.assertIn(f"plumbline_{program}", called)
        for name in ("out/room_map/map.ply", "out/room_map/report.html", "my_map/rooms.json",
                     "out/room_map/floor_plan.png", "my_check/rig.yaml", "out/my_map/planes.json",
                     "out/robot_map/summary.json"):
            self.assertTrue((self.place / name).exists(), name)

    def test_demo_builds_what_guide_and_readme_call(self):
        demo = (ROOT / "scripts/demo.sh").read_text(encoding="utf-8")
        build = re.search(r'scripts/build\.sh"((?:.*\\\n)*.*)', demo)[1]
        self.assertEqual(sorted(re.findall(r"plumbline_\w+", build)),
                         [f"plumbline_{name}" for name in ("check", "evaluate", "export", "map",
                                                           "plan", "report", "simulate")])


if __name__ == "__main__":
    unittest.main()

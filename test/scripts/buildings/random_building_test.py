#!/usr/bin/python3
"""Tests scripts/buildings/random_building.py: random_building_test.py SIMULATE"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts" / "buildings"))
# pylint: disable=wrong-import-position
import random_building  # noqa: E402

SIMULATE = sys.argv.pop(1)
NUMBERS = (1, 2)


class RandomBuildingTest(unittest.TestCase):
    def test_a_world_depends_on_kind_and_number_alone(self):
        worlds = [random_building.draw("furnished", number).building() for number in (1, 1, 2)]
        self.assertEqual(worlds[0], worlds[1])
        self.assertNotEqual(worlds[0], worlds[2])

    def test_the_simulator_takes_every_kind(self):
        with tempfile.TemporaryDirectory() as name:
            output = pathlib.Path(name)
            for kind in random_building.KINDS:
                for number in NUMBERS:
                    random_building.write(kind, number, "paper", output)
                    experiment = output / "experiments" / f"{kind}_{number}.yaml"
                    # Half a metre of the way is enough to see that building and files are understood.
                    text = experiment.read_text(encoding="utf-8")
                    experiment.write_text(
                        text.replace("path:\n", "path:\n  length_m: 0.5\n"), encoding="utf-8")
                    result = subprocess.run(
                        [SIMULATE, f"--experiment={experiment}", f"--output={output / kind}"],
                        capture_output=True, text=True, check=False)
                    self.assertEqual(result.returncode, 0, f"{kind} {number}: {result.stderr}")

    def test_unknown_kinds_are_errors(self):
        result = subprocess.run(
            [sys.executable, random_building.__file__, "castle", "--output", "nowhere"],
            capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertIn("no kind castle; there are furnished,", result.stderr)


if __name__ == "__main__":
    unittest.main()

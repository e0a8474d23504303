#!/usr/bin/python3
"""Tests scripts/experiments/floor_plan_rooms.py with stand-ins for the programs."""

import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
# pylint: disable=wrong-import-position
from fake_programs import SCRIPTS, ScriptTest

sys.path.insert(0, str(SCRIPTS / "experiments"))
import experiment_files  # noqa: E402
import floor_plan_rooms  # noqa: E402

# A rig that walks through the room of configs/experiments/room.yaml.
SIMULATE = '''#!/usr/bin/python3
import pathlib, sys
if "--version" in sys.argv:
    sys.exit(2)
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
output = pathlib.Path(flags["output"])
output.mkdir()
(output / "recording.bag").write_text(flags["seed"])
(output / "rig.yaml").write_text("")
(output / "truth_trajectory.tum").write_text(
    "".join(f"{i} {1 + 0.5 * i} 1.5 1.3 0 0 0 1\\\\n" for i in range(5)))
'''
# Its map is moved by 10 m, and its room's corners by 0.1 % of the seed times their distance.
MAP = '''#!/usr/bin/python3
import json, pathlib, sys
if "--version" in sys.argv:
    sys.exit(2)
flags = dict(argument[2:].split("=", 1) for argument in sys.argv[1:] if "=" in argument)
seed = int(pathlib.Path(flags["recording"]).read_text())
if seed == 9:
    sys.exit("plumbline_map: lost")
output = pathlib.Path(flags["output"])
output.mkdir()
(output / "trajectory.tum").write_text(
    "".join(f"{i} {11 + 0.5 * i} 1.5 1.3 0 0 0 1\\\\n" for i in range(5)))
scale = 1 + 0.001 * seed
def ring(corners):
    return [[10 + scale * x, scale * y] for x, y in corners]
outline = [[0.0, 0.0], [5.6, 0.3], [6.2, 2.9], [4.9, 5.1], [1.1, 4.7], [-0.4, 2.2]]
pillar = [[2.75, 2.2], [3.2, 2.3], [3.1, 2.75], [2.65, 2.65]]
def area(corners):
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1]
                     for a, b in zip(corners, corners[1:] + corners[:1]))
room = dict(number=1, entered=True, area_m2=scale ** 2 * (area(outline) - area(pillar)),
            sigma_area_m2=0.002, outline=ring(outline), holes=[ring(pillar)])
doors = [dict(rooms=[1, 2])] * seed + [dict(rooms=[1, None])]
(output / "rooms.json").write_text(json.dumps(dict(
    storeys=[dict(storey=1, floor_m=0.0, rooms=[room], doors=doors)])))
(output / "floor_plan.svg").write_text("<svg/>")
'''


class FloorPlanRoomsTest(ScriptTest):
    script = "experiments/floor_plan_rooms.py"

    def setUp(self):
        super().setUp()
        for name, text in (("plumbline_simulate", SIMULATE), ("plumbline_map", MAP)):
            program = self.binaries / name
            program.write_text(text.replace("\\\\n", "\\n"))
            program.chmod(0o755)

    def test_the_table_shows_the_worst_of_all_seeds(self):
        result = self.run_script("room", "--first-seed", "1", "--seeds", "3")
        self.assertEqual(result.returncode, 0, result.stderr)
        # 1.003 squared, of 26.54 m2.
        self.assertIn("| `room` | 1 | 3 | 1 of 1 | 0.601 % (0.159 m²) |  | 1 to 3 |",
                      result.stdout)
        self.assertEqual(result.stdout, (self.output / "floor_plan_rooms.md").read_text())
        rows = json.loads((self.output / "floor_plan_rooms.json").read_text())
        self.assertEqual([row["seed"] for row in rows], [1, 2, 3])
        self.assertAlmostEqual(rows[1]["worst"]["error_percent"], 0.4004, 3)
        self.assertTrue((self.output / "room_0002" / "floor_plan.svg").exists())

    def test_a_failure_is_named_and_counts(self):
        result = self.run_script("room", "--first-seed", "8", "--seeds", "2")
        self.assertEqual(result.returncode, 1)
        self.assertIn("failed: room 9: plumbline_map: lost", result.stdout)
        self.assertIn("| `room` | 1 | 1 | 1 of 1 |", result.stdout)

    def test_unknown_case(self):
        self.check_error("no case no_such_case", "no_such_case")


class TableTest(unittest.TestCase):
    ROW = {"case": "a", "seed": 1, "storey": 2, "walked": 3, "found": 3, "not_in_truth": [],
           "worst": {"error_percent": -0.2, "area_m2": 9.98, "true_area_m2": 10.0},
           "looked_into": 0, "worst_looked_into": None, "doors": 2}

    def test_the_least_rooms_and_the_worst_area_count(self):
        other = {**self.ROW, "seed": 2, "found": 2, "doors": 4, "not_in_truth": [5], "worst": {
            "error_percent": 0.1, "area_m2": 10.01, "true_area_m2": 10.0}}
        table = floor_plan_rooms.table_of([self.ROW, other], [])
        self.assertIn("| `a` | 2 | 2 | 2 of 3 | 0.200 % (0.020 m²) |  | 2 to 4 |", table)
        self.assertIn("Not in the truth: a 2, storey 2: room 5", table)

    def test_a_storey_of_which_no_room_was_found(self):
        row = {**self.ROW, "found": 0, "worst": None}
        self.assertIn("| 0 of 3 |  |  | 2 |", floor_plan_rooms.table_of([row], []))

    def test_all_cases_and_their_buildings_exist(self):
        for case in floor_plan_rooms.CASES:
            experiment = experiment_files.of_case(case)
            self.assertTrue(floor_plan_rooms.building_of(experiment).exists())


if __name__ == "__main__":
    unittest.main()

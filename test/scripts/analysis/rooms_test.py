#!/usr/bin/python3
"""Tests scripts/analysis/rooms.py: the rooms that it takes from buildings, and the comparison."""

import math
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts" / "analysis"))
# pylint: disable=wrong-import-position
import rooms  # noqa: E402
from shapely.geometry import Polygon  # noqa: E402

BUILDINGS = ROOT / "configs" / "buildings"


def box(x, y, width, depth):
    return [[x, y], [x + width, y], [x + width, y + depth], [x, y + depth]]


class TruthTest(unittest.TestCase):
    def test_a_storey_has_its_own_rooms_without_the_opening_in_its_floor(self):
        path = BUILDINGS / "two_storeys.yaml"
        upper = sum(room.area for room in rooms.plan_rooms(path, 2.9))
        # 10 m by 6 m without walls of 0.15 m, a pillar of 0.4 m, and the stair's opening.
        walls = 7.0 * 0.15 + 0.15 * (6.0 - 1.575)
        self.assertAlmostEqual(upper, 60.0 - walls - 0.16 - 3.8 * 1.2, places=2)
        self.assertGreater(sum(room.area for room in rooms.plan_rooms(path, 0.0)), 57.0)

    def test_the_pillar_is_no_floor(self):
        (room,) = rooms.plan_rooms(BUILDINGS / "room.yaml", 0.0)
        self.assertAlmostEqual(room.area, 53.51 / 2 - 0.2125, 3)

    def test_walls_part_rooms_where_their_doors_are(self):
        with tempfile.TemporaryDirectory() as directory:
            path = pathlib.Path(directory) / "two.yaml"
            path.write_text("outlines: [{corners: [[0, 0], [5, 0], [5, 3], [0, 3]]}]\n"
                            "walls: [{from: [2, 0], to: [2, 3], thickness_m: 0.2, openings: "
                            "[{position_m: 1, width_m: 0.9, height_m: 2}]}]\n")
            areas = sorted(room.area for room in rooms.plan_rooms(path, 0.0))
        self.assertAlmostEqual(areas[0], 1.9 * 3)
        self.assertAlmostEqual(areas[1], 2.9 * 3)

    def test_arcs_are_round(self):
        corners = rooms.with_arcs([[1, 0], {"through": [0, 1], "to": [-1, 0]}])
        self.assertAlmostEqual(Polygon(corners).area, math.pi / 2, 3)

    def test_a_mesh_is_cut_above_its_doors(self):
        # The architects' ground floor has four rooms.
        found = rooms.mesh_rooms(BUILDINGS / "AC20-FZK-Haus.ply", 2.4)
        self.assertEqual([round(room.area, 1) for room in sorted(found, key=lambda r: r.area)],
                         [12.5, 13.0, 22.1, 53.8])


    def test_what_walls_enclose_holds_openings_in_the_floor(self):
        room = {"number": 1, "area_m2": 6.5, "floor_openings": [{"area_m2": 3.0}, {"area_m2": 0.5}]}
        self.assertAlmostEqual(rooms.with_floor_openings(room)["area_m2"], 10.0)
        self.assertEqual(rooms.with_floor_openings({"area_m2": 6.5}), {"area_m2": 6.5})


class CompareTest(unittest.TestCase):
    TRUTH = [Polygon(box(0, 0, 4, 3)), Polygon(box(5, 0, 4, 3)), Polygon(box(10, 0, 4, 3))]
    PATH = [(1, 1), (7, 1)]

    @staticmethod
    def room(number, outline):
        return {"number": number, "outline": outline, "holes": [], "area_m2": Polygon(outline).area,
                "sigma_area_m2": 0.01, "entered": True}

    def compare(self, *found):
        return rooms.compare({"rooms": list(found)}, self.TRUTH, 1.0, 0.0, self.PATH)

    def test_errors_are_those_of_the_rooms_that_match(self):
        rows, extra = self.compare(self.room(1, box(0, 0, 4, 3.03)), self.room(2, box(5, 0, 4, 3)),
                                   self.room(3, box(20, 0, 4, 3)))
        self.assertEqual([row["room"] for row in rows], [1, 2])
        self.assertAlmostEqual(rows[0]["error_percent"], 1.0)
        self.assertAlmostEqual(rows[0]["way_m"], 3.0)
        self.assertAlmostEqual(rows[1]["error_percent"], 0.0)
        self.assertEqual(extra, [3])

    def test_a_room_that_the_path_enters_is_missed(self):
        rows, _ = self.compare(self.room(1, box(0, 0, 4, 3)))
        self.assertEqual([row["room"] for row in rows], [1, None])

    def test_two_rooms_in_one_are_not_found(self):
        rows, extra = self.compare(self.room(1, box(0, 0, 9, 3)))
        self.assertEqual([row["room"] for row in rows], [None, None])
        self.assertEqual(extra, [1])


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Opens what plumbline_plan writes with other programs.

Usage: plan_files_test.py DIRECTORY_OF_THE_PROGRAMS. DXF by ezdxf (python3-ezdxf) and ogrinfo
(gdal-bin), SVG by rsvg-convert (librsvg2-bin): skipped where Debian's package is not installed.
CityJSON by the rules of its specification (city_json_rules.py).
"""

import copy
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

import city_json_rules

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = None


def loop_area(corners):
    return 0.5 * sum(a[0] * b[1] - a[1] * b[0]
                     for a, b in zip(corners, corners[1:] + corners[:1]))


class PlanFilesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        scratch = pathlib.Path(cls.scratch.name)
        subprocess.run([PROGRAMS / "plumbline_simulate",
                        f"--experiment={ROOT}/configs/experiments/room.yaml", "--seed=1",
                        f"--output={scratch}/sim"], check=True, capture_output=True)
        subprocess.run([PROGRAMS / "plumbline_map", f"--recording={scratch}/sim/recording.bag",
                        f"--rig={scratch}/sim/rig.yaml", f"--output={scratch}/map"],
                       check=True, capture_output=True)
        cls.said = subprocess.run([PROGRAMS / "plumbline_plan", f"--result={scratch}/map",
                                   f"--rig={scratch}/sim/rig.yaml", f"--output={scratch}/plan"],
                                  check=True, capture_output=True, text=True).stdout
        cls.plan = scratch / "plan"
        cls.rooms = json.loads((cls.plan / "rooms.json").read_text())["storeys"][0]["rooms"]
        cls.city = json.loads((cls.plan / "building.city.json").read_text())

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_the_table_names_the_room(self):
        self.assertIn(f"{self.rooms[0]['area_m2']:.2f}", self.said)

    def test_ezdxf_opens_the_drawing(self):
        if importlib.util.find_spec("ezdxf") is None:
            self.skipTest("python3-ezdxf is not installed")
        import ezdxf
        drawing = ezdxf.readfile(self.plan / "floor_plan.dxf")
        audit = drawing.audit()
        self.assertEqual((audit.errors, audit.fixes), ([], []))
        outlines = [entity for entity in drawing.modelspace().query("POLYLINE")
                    if entity.dxf.layer == "ROOMS"]
        loops = [self.rooms[0]["outline"]] + self.rooms[0]["holes"]
        self.assertEqual(len(outlines), len(loops))
        for outline, loop in zip(outlines, loops):
            self.assertTrue(outline.is_closed)
            corners = [tuple(vertex.dxf.location)[:2] for vertex in outline.vertices]
            self.assertAlmostEqual(loop_area(corners), loop_area(loop), places=3)
        texts = [entity.dxf.text for entity in drawing.modelspace().query("TEXT")]
        self.assertTrue(any(f"{self.rooms[0]['area_m2']:.2f}" in text for text in texts))

    def test_gdal_opens_the_drawing(self):
        if shutil.which("ogrinfo") is None:
            self.skipTest("ogrinfo (gdal-bin) is not installed")
        out = subprocess.run(["ogrinfo", "-al", "-where", "Layer='ROOMS'",
                              self.plan / "floor_plan.dxf"],
                             check=True, capture_output=True, text=True)
        self.assertIn("Layer (String) = ROOMS", out.stdout)
        self.assertNotIn("ERROR", out.stderr)

    def test_the_drawing_is_xml_that_librsvg_draws(self):
        root = xml.etree.ElementTree.parse(self.plan / "floor_plan.svg").getroot()
        ids = {element.get("id") for element in root.iter()}
        self.assertLessEqual({"walls", "rooms", "doors", "dimensions", "labels", "legend", "scale"},
                             ids)
        if shutil.which("rsvg-convert") is None:
            self.skipTest("rsvg-convert (librsvg2-bin) is not installed")
        drawn = subprocess.run(["rsvg-convert", "-w", "200", self.plan / "floor_plan.svg"],
                               check=True, capture_output=True)
        self.assertEqual(drawn.stdout[:4], b"\x89PNG")

    def test_city_json_keeps_the_rules(self):
        self.assertEqual(city_json_rules.violations(self.city), [])
        rooms = [thing for thing in self.city["CityObjects"].values()
                 if thing["type"] == "BuildingRoom"]
        self.assertEqual(len(rooms), len(self.rooms))

    def test_the_rules_find_what_is_wrong(self):
        name = "storey_1_room_1"

        def broken(change):
            city = copy.deepcopy(self.city)
            change(city)
            return city_json_rules.violations(city)
        room = self.city["CityObjects"][name]
        self.assertEqual(room["geometry"][0]["type"], "Solid")
        changes = [
            lambda c: c.update(version="1.1"),
            lambda c: c["CityObjects"][name].update(parents=[]),
            lambda c: c["CityObjects"]["storey_1"].update(children=[]),
            lambda c: c["vertices"].append([1, 2, 3]),
            lambda c: c["vertices"][0].__setitem__(0, 0.5),
            lambda c: c["CityObjects"][name]["geometry"][0].update(lod=2),
            lambda c: c["CityObjects"][name]["geometry"][0]["boundaries"][0][0][0].reverse(),
            lambda c: c["CityObjects"][name]["geometry"][0]["boundaries"][0].pop(),
            lambda c: c["CityObjects"][name]["geometry"][0]["semantics"]["surfaces"][0].update(
                type="Floor"),
            lambda c: c["metadata"]["geographicalExtent"].__setitem__(0, -99.0),
        ]
        for i, change in enumerate(changes):
            self.assertNotEqual(broken(change), [], i)

    def test_errors_name_what_is_missing(self):
        out = subprocess.run([PROGRAMS / "plumbline_plan", "--result=/no/such",
                              f"--rig={self.scratch.name}/sim/rig.yaml"],
                             capture_output=True, text=True)
        self.assertEqual(out.returncode, 1)
        self.assertIn("/no/such/summary.json", out.stderr)
        self.assertEqual(out.stderr.count("\n"), 1)


if __name__ == "__main__":
    PROGRAMS = pathlib.Path(sys.argv.pop(1))
    unittest.main()

#!/usr/bin/python3
"""Reads what plumbline_export writes with readers of our own that follow the specifications.

Usage: cloud_files_test.py PLUMBLINE_EXPORT
"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "testing"))
from e57_file import E57File  # pylint: disable=wrong-import-position
from known_map import known_points, write_map  # pylint: disable=wrong-import-position
from las_file import LasFile  # pylint: disable=wrong-import-position

PROGRAM = ""
NUM_POINTS = 4000  # several packets of E57
# red, green, blue of the planes 0 and 1, of points on none, and on what moves
COLOURS = {0: (255, 64, 64), 1: (64, 120, 255), -1: (160, 160, 160), -2: (90, 90, 90)}


class CloudFilesTest(unittest.TestCase):
    def setUp(self):
        directory = tempfile.TemporaryDirectory()
        self.addCleanup(directory.cleanup)
        self.result = pathlib.Path(directory.name)
        self.points = known_points(NUM_POINTS)

    def export(self, formats):
        write_map(self.result / "map.ply", self.points)
        done = subprocess.run([PROGRAM, f"--result={self.result}", f"--formats={formats}"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"{len(self.points)} points written to {self.result}", done.stdout)

    def expect_colours(self, red, green, blue):
        for plane_id, colour in COLOURS.items():
            of_plane = self.points["plane_id"] == plane_id
            self.assertTrue(of_plane.any())
            for channel, value in zip((red, green, blue), colour):
                self.assertTrue((channel[of_plane] == value).all(), plane_id)

    def expect_las(self, las):
        xyz = numpy.stack([self.points[name] for name in "xyz"], axis=1).astype(float)
        self.assertLess(abs(las.coordinates() - xyz).max(), 0.51e-4)
        numpy.testing.assert_array_equal(las.points["gps_time"], self.points["time"])
        self.assertEqual(las.header["software"], "plumbline")
        self.assertEqual(las.header["global_encoding"] & 1, 0)
        on_plane = self.points["plane_id"] >= 0
        numpy.testing.assert_array_equal(las.points["classification"],
                                         numpy.where(on_plane, 6, 1))
        numpy.testing.assert_array_equal(las.points["user_data"], self.points["scanner"])
        self.expect_colours(*(las.points[name] / 257 for name in ("red", "green", "blue")))

    def test_las_1_4(self):
        self.export("las")
        las = LasFile(self.result / "map.las")
        self.assertEqual((las.header["minor"], las.header["point_format"]), (4, 7))
        self.expect_las(las)
        self.assertEqual(las.extra_fields(), [("scanner", "u1"), ("plane_id", "<i4"),
                                              ("residual", "<f4")])
        for name in ("scanner", "plane_id", "residual"):
            numpy.testing.assert_array_equal(las.points[name], self.points[name])
        wkt = las.records["LASF_Projection", 2112]
        self.assertTrue(wkt.startswith(b"LOCAL_CS[") and wkt.endswith(b"]\0"))

    def test_las_1_2(self):
        self.export("las12")
        las = LasFile(self.result / "map_las12.las")
        self.assertEqual((las.header["minor"], las.header["point_format"]), (2, 3))
        self.expect_las(las)
        source = numpy.maximum(self.points["plane_id"], -1) + 1
        numpy.testing.assert_array_equal(las.points["source"], source)

    def test_e57(self):
        self.export("e57")
        e57 = E57File(self.result / "map.e57")
        for name, ours in (("cartesianX", "x"), ("cartesianY", "y"), ("cartesianZ", "z"),
                           ("timeStamp", "time"), ("normalX", "nx"), ("normalY", "ny"),
                           ("normalZ", "nz"), ("scanner", "scanner"), ("planeId", "plane_id")):
            numpy.testing.assert_array_equal(e57.points[name], self.points[ours], name)
        self.expect_colours(*(e57.points["color" + name] for name in ("Red", "Green", "Blue")))
        for axis in "xyz":
            for end, value in (("Minimum", self.points[axis].min()),
                               ("Maximum", self.points[axis].max())):
                bound = e57.find(f"data3D/vectorChild/cartesianBounds/{axis}{end}")
                self.assertEqual(numpy.float32(bound.text), value)
        self.assertEqual(e57.find("formatName").text, "ASTM E57 3D Imaging Data File")
        guids = {e57.find("guid").text, e57.find("data3D/vectorChild/guid").text}
        self.assertEqual(len(guids), 2)
        self.points["z"][0] += 1
        self.export("e57")
        changed = E57File(self.result / "map.e57")
        self.assertNotIn(changed.find("guid").text, guids)

    def test_maps_without_points_are_whole(self):
        self.points = known_points(0)
        self.export("las,las12,e57,pcd")
        self.assertEqual(len(LasFile(self.result / "map.las").points), 0)
        self.assertEqual(len(LasFile(self.result / "map_las12.las").points), 0)
        self.assertEqual(len(E57File(self.result / "map.e57").points["cartesianX"]), 0)

    def test_a_damaged_page_is_seen(self):
        """The reader of the tests would notice a wrong checksum."""
        self.export("e57")
        path = self.result / "map.e57"
        data = bytearray(path.read_bytes())
        data[5000] ^= 1
        path.write_bytes(data)
        with self.assertRaisesRegex(AssertionError, "checksum"):
            E57File(path)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()

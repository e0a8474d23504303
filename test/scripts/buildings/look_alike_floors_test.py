#!/usr/bin/python3
"""Tests scripts/buildings/look_alike_floors.py and ramp.py."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts" / "buildings"))
# pylint: disable=wrong-import-position
import look_alike_floors  # noqa: E402
import ramp  # noqa: E402

NAMES = ("buildings/look_alike_floors.ply", "experiments/robustness/look_alike_floors.yaml")


class RampTest(unittest.TestCase):
    def test_the_shipped_file_is_what_it_makes(self):
        with tempfile.TemporaryDirectory() as output:
            subprocess.run([sys.executable, ramp.__file__, "--output", output], check=True)
            self.assertEqual((pathlib.Path(output) / "buildings" / "ramp.ply").read_bytes(),
                             (ROOT / "configs" / "buildings" / "ramp.ply").read_bytes())

    def test_the_corridor_is_seen_from_inside(self):
        middle = (17.0, ramp.WIDTH / 2, 1.95)  # above all floors and below all ceilings
        for a, b, c in ramp.make_elements()[0]:
            self.assertGreater(signed_volume(a, b, c, middle), 0)


def signed_volume(a, b, c, apex):
    """Positive where a, b, c run counter-clockwise seen from the apex."""
    u, v, w = ([q - p for p, q in zip(a, other)] for other in (b, c, apex))
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return sum(n * x for n, x in zip(normal, w))


class LookAlikeFloorsTest(unittest.TestCase):
    def test_the_shipped_files_are_what_it_makes(self):
        with tempfile.TemporaryDirectory() as output:
            subprocess.run([sys.executable, look_alike_floors.__file__, "--output", output],
                           check=True)
            for name in NAMES:
                self.assertEqual((pathlib.Path(output) / name).read_bytes(),
                                 (ROOT / "configs" / name).read_bytes(), name)

    def test_storeys_look_alike(self):
        lower = look_alike_floors.storey_boxes(0.0)
        upper = look_alike_floors.storey_boxes(look_alike_floors.STOREY)
        for (x_low, y_low, z_low), (x_high, y_high, z_high) in zip(lower, upper):
            self.assertEqual((x_low, y_low), (x_high, y_high))
            for below, above in zip(z_low, z_high):
                self.assertAlmostEqual(above - below, look_alike_floors.STOREY)

    def test_triangles_face_outwards(self):
        box = ((1.0, 2.0), (3.0, 5.0), (0.0, 4.0))
        middle = [sum(side) / 2 for side in box]
        triangles = list(look_alike_floors.triangles_of(box))
        self.assertEqual(len(triangles), 12)
        for a, b, c in triangles:
            self.assertLess(signed_volume(a, b, c, middle), 0)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Tests scripts/buildings/slopes.py."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts" / "buildings"))
# pylint: disable=wrong-import-position
import slopes  # noqa: E402


def signed_volume(triangle, apex):
    """Positive where the triangle runs counter-clockwise seen from the apex."""
    a = triangle[0]
    u, v, w = ([q - p for p, q in zip(a, other)] for other in (*triangle[1:], apex))
    normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
    return sum(n * x for n, x in zip(normal, w))


class SlopesTest(unittest.TestCase):
    def test_the_shipped_files_are_what_it_makes(self):
        with tempfile.TemporaryDirectory() as output:
            subprocess.run([sys.executable, slopes.__file__, "--output", output], check=True)
            for name in (*slopes.RISES, *slopes.ROOFS):
                for file in (f"buildings/{name}.ply", f"experiments/robustness/{name}.yaml"):
                    self.assertEqual((pathlib.Path(output) / file).read_bytes(),
                                     (ROOT / "configs" / file).read_bytes(), file)

    def test_an_attic_is_seen_from_inside(self):
        for slope, knee in slopes.ROOFS.values():
            for triangle in slopes.make_attic(slope, knee)[0]:
                self.assertGreater(signed_volume(triangle, (8.0, 4.0, 1.0)), 0)

    def test_each_hall_is_seen_from_inside(self):
        rise = 0.8
        far = slopes.HALL_LENGTH + slopes.RAMP_LENGTH
        for triangles, apex in ((slopes.hall(0.0, 0.0, slopes.HALL_LENGTH), (5.0, 4.0, 1.5)),
                                (slopes.hall(far, rise, far), (far + 5.0, 4.0, rise + 1.5))):
            for triangle in triangles:
                self.assertGreater(signed_volume(triangle, apex), 0)

    def test_the_ramp_rises(self):
        heights = [z for triangle in slopes.make_halls(0.8)[0] for _, _, z in triangle]
        self.assertEqual(max(heights), slopes.HEIGHT + 0.8)
        self.assertEqual(min(heights), 0.0)


if __name__ == "__main__":
    unittest.main()

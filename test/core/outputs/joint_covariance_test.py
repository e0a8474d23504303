#!/usr/bin/python3
"""Holds what the report's page computes between surfaces against finite differences."""

import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from joint_precision import PARAMETERS, JointPrecision, foot_and_distance, moved
from viewer_install import find_program

SCRIPT = pathlib.Path(__file__).with_name("joint_covariance.mjs")


def unit(*vector):
    return list(np.array(vector) / np.linalg.norm(vector))


def plane(number, kind, normal, centre):
    return {"id": number, "type": kind, "normal": normal, "centre": centre,
            "distance": float(np.dot(normal, centre))}


def cylinder(number, normal, centre, radius, side):
    made = plane(number, "cylinder", normal, centre)
    made["radius"] = radius
    made["axis_point"] = list(np.array(centre) - side * radius * np.array(normal))
    return made


PLANES = [
    plane(3, "horizontal", [0.0, 0.0, 1.0], [1.0, 2.0, -1.5]),
    plane(4, "horizontal", [0.0, 0.0, -1.0], [2.0, 1.0, 1.3]),
    plane(7, "vertical", unit(1.0, 0.2, 0.0), [-2.0, 5.0, 0.1]),
    plane(8, "vertical", unit(-1.0, -0.2, 0.0), [4.0, 5.5, 0.0]),
    plane(9, "vertical", unit(0.3, -1.0, 0.0), [1.0, 9.0, 0.2]),
    plane(12, "general", unit(0.2, 0.1, 0.9), [3.0, 3.0, 0.5]),
    plane(13, "general", unit(-0.5, 0.6, 0.4), [3.5, -3.0, 0.5]),
    cylinder(15, unit(0.6, 0.8, 0.0), [2.0, -1.0, 0.0], 2.5, -1.0),
    cylinder(16, unit(-0.3, 0.9, 0.0), [8.0, -1.0, 0.0], 0.4, 1.0),
]


class JointCovariance(unittest.TestCase):
    def test_page_agrees_with_finite_differences(self):
        node = find_program("node")
        names = [f"{p['id']}:{name}" for p in PLANES for name in PARAMETERS[p["type"]]]
        factor = np.random.default_rng(1).normal(size=(len(names), len(names)))
        covariance = 1e-6 * factor @ factor.T
        # At the first one's centre, and somewhere else.
        pairs = [[i, j, point] for i in range(len(PLANES)) for j in range(len(PLANES)) if i != j
                 for point in (PLANES[i]["centre"], [0.7, 2.2, 0.4])]
        # Off a surface its nearest point turns along with it, which the formula leaves out.
        for pair in pairs:
            pair[2] = list(map(float, nearest(PLANES[pair[0]], pair[2])))
        with tempfile.NamedTemporaryFile("w", suffix=".json") as case:
            json.dump({"planes": PLANES, "covariance": covariance.tolist(), "pairs": pairs}, case)
            case.flush()
            run = subprocess.run([node, SCRIPT, case.name], check=True, capture_output=True)
        expected = JointPrecision(PLANES, names, covariance)
        for (i, j, point), found in zip(pairs, json.loads(run.stdout), strict=True):
            first, second = PLANES[i]["id"], PLANES[j]["id"]
            wanted = [*expected.angle(first, second), *expected.separation(point, first, second)]
            np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-9,
                                       err_msg=f"{first} and {second} at {point}")


def nearest(surface, point):
    return foot_and_distance(moved(surface, np.zeros(3)), np.array(point))[0]


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])

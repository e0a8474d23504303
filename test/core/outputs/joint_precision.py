"""Angles and distances between surfaces with standard deviations, by finite differences.

Independent of the page and of core/result/plane_covariance.cc: only what docs/outputs.md says of
the parameters in plane_covariance.csv is used.
"""

import numpy as np

STEP = 1e-6
PARAMETERS = {"horizontal": ["d"], "vertical": ["angle", "d"],
              "general": ["turn_u", "turn_v", "d_centre"],
              "cylinder": ["turn_u", "radius", "d_centre"]}


def level_and_steep(normal):
    """u, the level direction along the plane, and v = n x u."""
    u = np.cross([0.0, 0.0, 1.0], normal)
    u = u / np.linalg.norm(u) if np.linalg.norm(u) > 1e-9 else np.array([1.0, 0.0, 0.0])
    return u, np.cross(normal, u)


def moved(plane, change):
    """The plane after its parameters have changed: (normal, distance), or of a cylinder (normal at
    the centre, axis, radius, side)."""
    normal = np.array(plane["normal"])
    centre = np.array(plane["centre"])
    if plane["type"] == "horizontal":
        return normal, plane["distance"] + change[0]
    if plane["type"] == "vertical":
        angle = np.arctan2(normal[1], normal[0]) + change[0]
        return np.array([np.cos(angle), np.sin(angle), 0.0]), plane["distance"] + change[1]
    u, v = level_and_steep(normal)
    if plane["type"] == "general":
        turned = normal + change[0] * u + change[1] * v
        turned /= np.linalg.norm(turned)
        return turned, turned @ (centre + change[2] * normal)
    turned = np.cos(change[0]) * normal + np.sin(change[0]) * u
    side = np.sign(normal @ (centre - np.array(plane["axis_point"])))
    radius = plane["radius"] + change[1]
    return turned, centre + change[2] * normal - side * radius * turned, radius, side


def foot_and_distance(shape, point):
    """The nearest point of the surface, and the signed distance from it."""
    if len(shape) == 2:
        normal, distance = shape
        signed = normal @ point - distance
        return point - signed * normal, signed
    _, axis, radius, side = shape
    away = (point - axis) * [1.0, 1.0, 0.0]
    length = np.linalg.norm(away)
    return point - (length - radius) * away / length, side * (length - radius)


class JointPrecision:
    def __init__(self, planes, names, covariance):
        """names: ["<plane id>:<parameter>", ...] of the covariance's rows."""
        self.planes = {plane["id"]: plane for plane in planes}
        self.names = names
        self.covariance = covariance

    def _columns(self, plane):
        return [self.names.index(f"{plane['id']}:{name}") for name in PARAMETERS[plane["type"]]]

    def _derivatives(self, a, b, function):
        """Rows of derivatives of function(shape of a, shape of b) by all parameters."""
        value = np.atleast_1d(function(moved(a, np.zeros(3)), moved(b, np.zeros(3))))
        rows = np.zeros((len(value), len(self.names)))
        for plane, other_first in ((a, False), (b, True)):
            for k, column in enumerate(self._columns(plane)):
                ends = []
                for step in (STEP, -STEP):
                    change = np.zeros(3)
                    change[k] = step
                    shapes = (moved(a, np.zeros(3)), moved(b, change)) if other_first else (
                        moved(a, change), moved(b, np.zeros(3)))
                    ends.append(np.atleast_1d(function(*shapes)))
                rows[:, column] += (ends[0] - ends[1]) / (2.0 * STEP)
        return value, rows

    def angle(self, id_a, id_b):
        """(angle between the normals, its standard deviation), rad."""
        a, b = self.planes[id_a], self.planes[id_b]

        def angle_of(shape_a, shape_b):
            sine = np.linalg.norm(np.cross(shape_a[0], shape_b[0]))
            return np.arctan2(sine, shape_a[0] @ shape_b[0])

        normal_a, normal_b = np.array(a["normal"]), np.array(b["normal"])
        sine = np.linalg.norm(np.cross(normal_a, normal_b))
        if sine > 1e-3:
            value, rows = self._derivatives(a, b, angle_of)
            return value[0], np.sqrt((rows @ self.covariance @ rows.T)[0, 0])
        tangents = np.array(level_and_steep(normal_a))
        sign = np.sign(normal_a @ normal_b)
        _, rows = self._derivatives(
            a, b, lambda shape_a, shape_b: tangents @ (shape_a[0] - sign * shape_b[0]))
        largest = np.linalg.eigvalsh(rows @ self.covariance @ rows.T)[-1]
        return angle_of((normal_a,), (normal_b,)), np.sqrt(max(0.0, largest))

    def separation(self, point, id_a, id_b):
        """(distance of b from the point of a nearest to `point`, its standard deviation), m."""
        a, b = self.planes[id_a], self.planes[id_b]

        def distance_of(shape_a, shape_b):
            return foot_and_distance(shape_b, foot_and_distance(shape_a, np.array(point))[0])[1]

        value, rows = self._derivatives(a, b, distance_of)
        return abs(value[0]), np.sqrt((rows @ self.covariance @ rows.T)[0, 0])


def read_covariance(path):
    """(names, matrix) of a plane_covariance.csv."""
    with open(path, encoding="utf-8") as file:
        names = file.readline().strip().split(",")[2:]
        rows = [[float(x) for x in line.split(",")[2:]] for line in file]
    return names, np.array(rows).reshape(len(names), len(names))

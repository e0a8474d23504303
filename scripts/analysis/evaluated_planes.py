"""Planes of a result or of a bound with their joint covariance, and the true faces they show."""

import collections
import json

import numpy as np

MIN_POINTS = 2000  # of a plane that takes part: the paper's walls have many thousands


def read_json(path):
    return json.loads(path.read_text())


def read_covariance(path):
    """Row of each (plane, parameter), and the matrix."""
    lines = path.read_text().splitlines()
    rows = {}
    matrix = []
    for row, line in enumerate(lines[1:]):
        fields = line.split(",")
        rows[int(fields[0]), fields[1]] = row
        matrix.append([float(field) for field in fields[2:]])
    return rows, np.array(matrix)


def azimuth(normal):
    return np.arctan2(normal[1], normal[0])


def wrap(angle):
    return (angle + np.pi) % (2 * np.pi) - np.pi


def rotation_matrix(xyzw):
    x, y, z, w = xyzw
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def rotation_vector(matrix):
    angle = np.arccos(np.clip((np.trace(matrix) - 1) / 2, -1, 1))
    axis = np.array([matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0],
                     matrix[1, 0] - matrix[0, 1]])
    return axis / 2 if angle < 1e-6 else axis * angle / (2 * np.sin(angle))


def tangents(normal):
    """The level direction along a surface, and the one across it: u = z x n, v = n x u."""
    u = np.cross([0.0, 0.0, 1.0], normal)
    u /= np.linalg.norm(u)
    return u, np.cross(normal, u)


class Planes:
    """The planes of a result or of a bound with their covariance, each with its true face.
    prefix: how the files' names begin."""

    def __init__(self, directory, face_of_plane, prefix=""):
        self.planes = {plane["id"]: plane
                       for plane in read_json(directory / f"{prefix}planes.json")
                       if plane["num_points"] >= MIN_POINTS and plane["id"] in face_of_plane}
        self.face_of_plane = face_of_plane
        self.rows, self.covariance = read_covariance(
            directory / f"{prefix}plane_covariance.csv")

    def unit_row(self, plane, parameter):
        row = np.zeros(len(self.covariance))
        row[self.rows[plane, parameter]] = 1.0
        return row

    def angle_row(self, plane):
        return self.unit_row(plane, "angle")

    def distance_row(self, plane, point):
        """Derivative of the signed distance of a point."""
        row = np.zeros(len(self.covariance))
        normal = self.planes[plane]["normal"]
        if (plane, "d_centre") in self.rows:
            row[self.rows[plane, "d_centre"]] = -1.0
            from_centre = np.array(point) - self.planes[plane]["centre"]
            for parameter, axis in zip(("turn_u", "turn_v"), tangents(normal)):
                row[self.rows[plane, parameter]] = axis @ from_centre
            return row
        row[self.rows[plane, "d"]] = -1.0
        if (plane, "angle") in self.rows:
            row[self.rows[plane, "angle"]] = normal[0] * point[1] - normal[1] * point[0]
        return row

    def errors(self, plane, face, frame, at=None):
        """What of a surface is off from its true face: (what, error, derivative by the parameters).

        angle: rad, of the normal along the level direction on the surface; slope: rad, across it;
        distance: m, signed, of the point `at` (model frame; default: the surface's centre, and of
        cylinders always that); radius: m. frame: rotation and translation, model from building."""
        entry = self.planes[plane]
        rotation, translation = frame
        if entry["type"] == "cylinder":
            return self._errors_of_cylinder(entry, face, rotation, translation)
        normal = rotation @ np.array(face["normal"])
        distance = face["distance"] + normal @ translation
        at = np.array(entry["centre"]) if at is None else at
        found = [("distance", self.signed_distance(plane, at) - (normal @ at - distance),
                  self.distance_row(plane, at))]
        if entry["type"] == "vertical":
            found.append(("angle", wrap(azimuth(entry["normal"]) - azimuth(normal)),
                          self.angle_row(plane)))
        elif entry["type"] == "general":
            for what, parameter, axis in zip(("angle", "slope"), ("turn_u", "turn_v"),
                                             tangents(entry["normal"])):
                found.append((what, axis @ (entry["normal"] - normal),
                              self.unit_row(plane, parameter)))
        return [(what, error, row) for what, error, row in found if self.variance(row) > 0]

    def _errors_of_cylinder(self, entry, face, rotation, translation):
        axis = rotation @ np.array(face["axis_point"]) + translation
        from_axis = (np.array(entry["centre"]) - axis)[:2]
        seen = np.sign(np.dot(np.array(face["normal"])[:2],
                              (np.array(face["centre"]) - face["axis_point"])[:2]))
        normal = np.append(seen * from_axis / np.linalg.norm(from_axis), 0.0)
        distance = seen * (np.linalg.norm(from_axis) - face["radius"])
        return [("distance", -distance, -self.unit_row(entry["id"], "d_centre")),
                ("angle", tangents(entry["normal"])[0] @ (entry["normal"] - normal),
                 self.unit_row(entry["id"], "turn_u")),
                ("radius", entry["radius"] - face["radius"],
                 self.unit_row(entry["id"], "radius"))]

    def variance(self, row):
        return row @ self.covariance @ row

    def signed_distance(self, plane, point):
        return np.dot(self.planes[plane]["normal"], point) - self.planes[plane]["distance"]


class Truth:
    """The true faces and the true trajectory of a run."""

    def __init__(self, directory):
        self.faces = {face["id"]: face for face in read_json(directory / "truth_planes.json")}
        poses = np.loadtxt(directory / "truth_trajectory.tum")
        self.poses = poses
        # The faces that lie on the same plane and look the same way, for each face's id.
        by_plane = collections.defaultdict(list)
        for face, entry in sorted(self.faces.items()):
            by_plane[tuple(np.round([*entry["normal"], entry["distance"]], 5))].append(face)
        self.surface = {face: faces for faces in by_plane.values() for face in faces}
        forward = np.stack([1 - 2 * (poses[:, 5] ** 2 + poses[:, 6] ** 2),
                            2 * (poses[:, 4] * poses[:, 5] + poses[:, 6] * poses[:, 7])], axis=1)
        self.heading = np.unwrap(np.arctan2(forward[:, 1], forward[:, 0]))
        self.turn = np.sign(self.heading[-1] - self.heading[0]) or 1.0
        walls = [face for face in self.faces.values() if face["type"] == "vertical"]
        self.centre = np.mean([corner for face in walls for corner in face["outline"]], axis=0)

    def pose_at(self, time):
        """Position and rotation matrix."""
        position = [np.interp(time, self.poses[:, 0], self.poses[:, k]) for k in (1, 2, 3)]
        after = np.clip(np.searchsorted(self.poses[:, 0], time), 1, len(self.poses) - 1)
        before, after = self.poses[after - 1], self.poses[after]
        share = np.clip((time - before[0]) / (after[0] - before[0]), 0, 1)
        sign = np.sign(before[4:8] @ after[4:8])
        quaternion = (1 - share) * before[4:8] + share * sign * after[4:8]
        return np.array(position), rotation_matrix(quaternion / np.linalg.norm(quaternion))

    def width(self, face):
        """Extent of a wall along it, with all faces of its surface, m."""
        outline = np.concatenate([self.faces[other]["outline"] for other in self.surface[face]])
        return np.ptp(outline @ np.cross([0.0, 0.0, 1.0], self.faces[face]["normal"]))

    def is_outer(self, face):
        wall = self.faces[face]
        return np.dot(self.centre - np.array(wall["centre"]), wall["normal"]) > 0

    def corner_index(self, face, first_time, last_time):
        """Number of corners from the start of the path to where the wall was seen."""
        side = self.turn if self.is_outer(face) else -self.turn
        along = azimuth(self.faces[face]["normal"]) - side * np.pi / 2
        heading = np.interp((first_time + last_time) / 2, self.poses[:, 0], self.heading)
        return int(round(self.turn * (heading + wrap(along - heading) - self.heading[0]) /
                         (np.pi / 2)))

    def corners(self, face):
        """The wall's two ends, in the building's frame, at half height."""
        outline = np.array(self.faces[face]["outline"])
        along = np.cross([0.0, 0.0, 1.0], self.faces[face]["normal"])
        position = outline @ along
        height = (outline[:, 2].min() + outline[:, 2].max()) / 2
        ends = []
        for index in (position.argmin(), position.argmax()):
            end = outline[index].copy()
            end[2] = height
            ends.append(end)
        return ends


def model_frame(evaluation):
    frame = evaluation["model_from_truth"]
    return rotation_matrix(frame["rotation_xyzw"]), np.array(frame["translation"])

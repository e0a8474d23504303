"""Errors and stated variances of quantities that people measure in a map: angles between walls,
distances between what different loops saw of one wall, and faces by themselves."""

import numpy as np

from evaluated_planes import azimuth, wrap

WIDE = 2.0  # m, of a wall: faces of pillars and jambs are told apart from it


def wall_instances(planes, truth):
    """(outer?, corner index) -> plane id; the plane with most points where there are several."""
    found = {}
    for plane in planes.planes.values():
        face = planes.face_of_plane[plane["id"]]
        if plane["type"] != "vertical":
            continue
        key = (truth.is_outer(face),
               truth.corner_index(face, plane["first_time"], plane["last_time"]))
        other = found.get(key)
        if other is None or planes.planes[other]["num_points"] < plane["num_points"]:
            found[key] = plane["id"]
    return found


def pair_quantities(planes, truth, model_from_truth):
    """(category, pair) -> (error or None, variance): angles in rad, separations in m."""
    rotation, translation = model_from_truth
    walls = wall_instances(planes, truth)
    result = {}
    for (outer_a, index_a), a in walls.items():
        for (outer_b, index_b), b in walls.items():
            corners = index_b - index_a
            if outer_a != outer_b or corners <= 0:
                continue
            side = "outer" if outer_a else "inner"
            face_a, face_b = planes.face_of_plane[a], planes.face_of_plane[b]
            true_angle = (azimuth(truth.faces[face_b]["normal"]) -
                          azimuth(truth.faces[face_a]["normal"]))
            angle = (azimuth(planes.planes[b]["normal"]) -
                     azimuth(planes.planes[a]["normal"]))
            key = (f"angle, {side}, {corners} corners", (index_a, index_b))
            result[key] = (wrap(angle - true_angle),
                           planes.variance(planes.angle_row(b) - planes.angle_row(a)))
            if face_a != face_b:
                continue
            loops = corners // 4
            ends = truth.corners(face_a)
            for where, points in (("centre", [(ends[0] + ends[1]) / 2]), ("corners", ends)):
                for number, point in enumerate(points):
                    at = rotation @ point + translation
                    row = planes.distance_row(b, at) - planes.distance_row(a, at)
                    error = planes.signed_distance(b, at) - planes.signed_distance(a, at)
                    key = (f"distance, {side}, {loops} loops, {where}",
                           (index_a, index_b, number))
                    result[key] = (error, planes.variance(row))
    return result


def face_quantities(planes, truth, model_from_truth):
    """(category, first face of a surface) -> (error, variance): angles to the reference wall and
    slopes in rad, distances at the face's centre and radii in m; of the surface with most
    points."""
    rotation, translation = model_from_truth
    result = {}
    for plane in sorted(planes.planes.values(), key=lambda plane: plane["num_points"]):
        face = truth.surface[planes.face_of_plane[plane["id"]]][0]
        at = rotation @ np.array(truth.faces[face]["centre"]) + translation
        kind = {"general": "slopes", "cylinder": "cylinders"}.get(
            plane["type"], "floors and ceilings")
        if plane["type"] == "vertical":
            kind = f"walls {'from' if truth.width(face) >= WIDE else 'below'} {WIDE:g} m"
        for what, error, row in planes.errors(
                plane["id"], truth.faces[face], model_from_truth, at):
            name = "angle, upwards" if what == "slope" else what
            result[f"{name}, {kind}", face] = (error, planes.variance(row))
    return result

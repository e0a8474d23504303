#!/usr/bin/python3
"""Holds the runs of scripts/experiments/monte_carlo.py against the Cramer-Rao bound of plumbline_bound and
against the covariances that the runs state themselves.

Quantities that do not depend on the model frame: angles between walls, distances between what
different loops saw of one wall. For a building whose walls follow each other round a corridor,
walls are counted by the corners between them. For any other, with --faces, each face by itself
in the model frame (first pose, normal of the reference wall). With --ideal, also against the best
estimate that the same noise allows. Prints Markdown tables and writes precision.json.
"""

import argparse
import collections
import json
import pathlib
import sys

import numpy as np

MIN_POINTS = 2000  # of a plane that takes part: the paper's walls have many thousands
WIDE = 2.0  # m, of a wall: faces of pillars and jambs are told apart from it
NUM_SIGN_FLIPS = 2000


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


class Planes:
    """The planes of a result or of a bound with their covariance, each with its true face.
    prefix: of the files' names."""

    def __init__(self, directory, face_of_plane, prefix=""):
        self.planes = {plane["id"]: plane
                       for plane in read_json(directory / f"{prefix}planes.json")
                       if plane["num_points"] >= MIN_POINTS and plane["id"] in face_of_plane}
        self.face_of_plane = face_of_plane
        self.rows, self.covariance = read_covariance(
            directory / f"{prefix}plane_covariance.csv")

    def angle_row(self, plane):
        row = np.zeros(len(self.covariance))
        row[self.rows[plane, "angle"]] = 1.0
        return row

    def distance_row(self, plane, point):
        """Derivative of the signed distance of a point."""
        row = np.zeros(len(self.covariance))
        normal = self.planes[plane]["normal"]
        row[self.rows[plane, "d"]] = -1.0
        if (plane, "angle") in self.rows:
            row[self.rows[plane, "angle"]] = normal[0] * point[1] - normal[1] * point[0]
        return row

    def variance(self, row):
        return row @ self.covariance @ row

    def signed_distance(self, plane, point):
        return np.dot(self.planes[plane]["normal"], point) - self.planes[plane]["distance"]


class Truth:
    """True faces and what of them does not depend on the frame."""

    def __init__(self, directory):
        self.faces = {face["id"]: face for face in read_json(directory / "truth_planes.json")}
        poses = np.loadtxt(directory / "truth_trajectory.tum")
        self.poses = poses
        # Of each face all that lie on its plane and look the same way, by id.
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
        """Of a wall, along it, all of its surface."""
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
    """(category, first face of a surface) -> (error, variance): angles to the reference wall in
    rad, distances at the face's centre in m; of the plane with most points."""
    rotation, translation = model_from_truth
    result = {}
    for plane in sorted(planes.planes.values(), key=lambda plane: plane["num_points"]):
        face = truth.surface[planes.face_of_plane[plane["id"]]][0]
        normal = rotation @ truth.faces[face]["normal"]
        at = rotation @ np.array(truth.faces[face]["centre"]) + translation
        kind = "floors and ceilings"
        if plane["type"] == "vertical":
            kind = f"walls {'from' if truth.width(face) >= WIDE else 'below'} {WIDE:g} m"
            row = planes.angle_row(plane["id"])
            if planes.variance(row) > 0:
                result[f"angle, {kind}", face] = (
                    wrap(azimuth(plane["normal"]) - azimuth(normal)), planes.variance(row))
        result[f"distance, {kind}", face] = (
            planes.signed_distance(plane["id"], at),
            planes.variance(planes.distance_row(plane["id"], at)))
    return result


def model_frame(evaluation):
    frame = evaluation["model_from_truth"]
    return rotation_matrix(frame["rotation_xyzw"]), np.array(frame["translation"])


def plane_nees(planes, truth, frame):
    """Normalised squared error of all planes together, and its degrees of freedom."""
    rotation, translation = frame
    errors, rows = [], []
    for plane in planes.planes.values():
        face = truth.faces[planes.face_of_plane[plane["id"]]]
        normal = rotation @ np.array(face["normal"])
        distance = face["distance"] + normal @ translation
        at = np.array(plane["centre"])
        row = planes.distance_row(plane["id"], at)
        errors.append(planes.signed_distance(plane["id"], at) - (normal @ at - distance))
        rows.append(row)
        if plane["type"] == "vertical":
            row = planes.angle_row(plane["id"])
            if planes.variance(row) > 0:
                errors.append(wrap(azimuth(plane["normal"]) - azimuth(normal)))
                rows.append(row)
    rows = np.array(rows)
    covariance = rows @ planes.covariance @ rows.T
    scale = 1 / np.sqrt(np.diag(covariance))
    white = np.array(errors) * scale
    return white @ np.linalg.solve(covariance * np.outer(scale, scale), white), len(white)


def pose_nees(directory, truth, frame, prefix="", count=20):
    """Normalised squared errors of poses spread over the path, 6 degrees of freedom each."""
    rotation, translation = frame
    poses = np.loadtxt(directory / f"{prefix}trajectory.tum")
    covariances = np.loadtxt(directory / f"{prefix}trajectory_covariance.csv",
                             delimiter=",", skiprows=1)
    values = []
    for index in np.linspace(0.02 * len(poses), 0.98 * len(poses), count).astype(int):
        true_position, true_rotation = truth.pose_at(poses[index, 0])
        turn = rotation_matrix(poses[index, 4:8]) @ (rotation @ true_rotation).T
        error = np.concatenate([poses[index, 1:4] - rotation @ true_position - translation,
                                rotation_vector(turn)])
        covariance = np.zeros((6, 6))
        covariance[np.triu_indices(6)] = covariances[index, 1:]
        covariance = covariance + covariance.T - np.diag(np.diag(covariance))
        values.append(error @ np.linalg.solve(covariance, error))
    return np.array(values)


def read_run(directory, quantities=pair_quantities):
    """All that one run says: quantities, NEES of planes, of poses, the truth, and NEES of planes
    and poses of the window where the run kept its statements."""
    evaluation = read_json(directory / "evaluation.json")
    truth = Truth(directory)
    face_of_plane = {entry["id"]: min(entry["true_faces"])
                     for entry in evaluation["planes"]["list"] if entry["status"] != "wrong"}
    planes = Planes(directory, face_of_plane)
    frame = model_frame(evaluation)
    window = None
    if (directory / "window_trajectory.tum").exists():
        in_view = Planes(directory, face_of_plane, "window_")
        window = (plane_nees(in_view, truth, frame),
                  pose_nees(directory, truth, frame, "window_"))
    return (quantities(planes, truth, frame), plane_nees(planes, truth, frame),
            pose_nees(directory, truth, frame), truth, window)


def read_bound(directory, truth, quantities=pair_quantities):
    """What plumbline_bound wrote: quantities, NEES of planes (of a seed's best estimate)."""
    lines = (directory / "faces.csv").read_text().splitlines()[1:]
    face_of_plane = dict(tuple(map(int, line.split(","))) for line in lines)
    # A face that no noisy beam hit is not in the truth.
    face_of_plane = {plane: face for plane, face in face_of_plane.items()
                     if face in truth.faces}
    planes = Planes(directory, face_of_plane)
    # The frame from the reference wall's normal and the first pose, which is its origin.
    plane = next(p for p in planes.planes.values() if p["type"] == "vertical")
    turn = azimuth(plane["normal"]) - azimuth(truth.faces[face_of_plane[plane["id"]]]["normal"])
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0],
                         [0, 0, 1.0]])
    frame = (rotation, -rotation @ truth.poses[0, 1:4])
    return quantities(planes, truth, frame), plane_nees(planes, truth, frame)


def bound_variances(bound_directory, truth, quantities=pair_quantities):
    """Quantity -> variance, as the bound has it."""
    values, _ = read_bound(bound_directory, truth, quantities)
    return {key: variance for key, (_, variance) in values.items()}


def read_ideals(directory, run_directories, runs, quantities=pair_quantities):
    """What the best estimate makes of each run's noise; None for runs that have none."""
    ideals = [read_bound(directory / run_directory.name, run[3], quantities)
              if (directory / run_directory.name).is_dir() else None
              for run_directory, run in zip(run_directories, runs)]
    if sum(ideal is not None for ideal in ideals) < 2:
        raise ValueError(f"{directory}: at least two of the runs' seeds (run_*) expected")
    return ideals


def ratio_of_means(values, others):
    """Square root of the ratio of two means over the same runs, and its standard error."""
    values, others = np.array(values), np.array(others)
    ratio = values.mean() / others.mean()
    spread = (values - ratio * others).std(ddof=1) / np.sqrt(len(values)) / others.mean()
    return np.sqrt(ratio), 0.5 * spread / np.sqrt(ratio)


def compare_with_ideal(runs, summary):
    """Adds to each category the map's error over that of the best estimate, same seeds."""
    squares = collections.defaultdict(list)
    for pairs, ideal in runs:
        of_run = collections.defaultdict(list)
        for key, (error, _) in pairs.items():
            if key in ideal and key[0] in summary:
                of_run[key[0]].append((error ** 2, ideal[key][0] ** 2))
        for category, values in of_run.items():
            squares[category].append(np.mean(values, axis=0))
    for category, values in squares.items():
        if len(values) < 2:
            continue
        ratio, ratio_error = ratio_of_means(*np.transpose(values))
        summary[category].update({"ideal_runs": len(values), "ideal_ratio": ratio,
                                  "ideal_ratio_error": ratio_error})


def summarise_pairs(runs, bound):
    """Category -> figures, over the pairs that the bound knows."""
    by_category = collections.defaultdict(list)  # one entry a run: list of (error^2, ...)
    errors_of_pair = collections.defaultdict(list)
    for pairs in runs:
        of_run = collections.defaultdict(list)
        for key, (error, variance) in pairs.items():
            if key in bound:
                of_run[key[0]].append((error ** 2, variance, bound[key], error))
                errors_of_pair[key].append(error)
        for category, values in of_run.items():
            by_category[category].append(np.mean(values, axis=0))
    result = {}
    for category, values in by_category.items():
        values = np.array(values)
        square, stated, best, mean = values.mean(axis=0)
        spread, _, _, mean_error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
        bias = [np.mean(errors) / (np.std(errors, ddof=1) / np.sqrt(len(errors)))
                for key, errors in errors_of_pair.items()
                if key[0] == category and len(errors) > 2]
        result[category] = {
            "runs": len(values), "pairs": sum(key[0] == category for key in errors_of_pair),
            "stddev": np.sqrt(square), "bound": np.sqrt(best), "stated": np.sqrt(stated),
            "ratio": np.sqrt(square / best), "ratio_error": 0.5 * spread / square *
            np.sqrt(square / best),
            "mean": mean, "mean_error": mean_error, "nees": square / stated, "nees_error": spread / stated,
            "largest_bias": max(map(abs, bias)) if bias else None}
    return result


def mean_errors_in_standard_errors(errors):
    """Of each column, over the rows that have a number there."""
    count = np.sum(~np.isnan(errors), axis=0)
    return np.nanmean(errors, axis=0) / (np.nanstd(errors, axis=0, ddof=1) / np.sqrt(count))


def judge_largest_bias(runs, bound):
    """The largest mean error of all quantities, in its standard errors, and how large it comes
    out by chance: errors that are no bias have either sign, so that runs with their signs drawn
    anew, all errors of a run together, show what noise alone makes of so many quantities and of
    their correlations. None where too few runs have any of them."""
    keys = sorted({key for pairs in runs for key in pairs if key in bound})
    errors = np.array([[pairs[key][0] if key in pairs else np.nan for key in keys]
                       for pairs in runs])
    often = np.sum(~np.isnan(errors), axis=0) > 2
    if not often.any():
        return None
    errors = errors[:, often]
    largest = np.abs(mean_errors_in_standard_errors(errors)).max()
    random = np.random.default_rng(1)
    by_chance = [np.abs(mean_errors_in_standard_errors(
        errors * random.choice([-1.0, 1.0], size=(len(errors), 1)))).max()
                 for _ in range(NUM_SIGN_FLIPS)]
    return {"quantities": int(often.sum()), "largest": largest,
            "limit": np.quantile(by_chance, 0.95),
            "chance": np.mean(np.array(by_chance) >= largest)}


def growth_exponent(summary, prefix, suffix):
    """Exponent of the growth of a standard deviation with the number of corners or loops."""
    points = [(int(name[len(prefix):].split()[0]), figures["stddev"])
              for name, figures in summary.items()
              if name.startswith(prefix) and name.endswith(suffix)]
    if len(points) < 2:
        return None
    numbers, values = np.array(sorted(points)).T
    return np.polyfit(np.log(numbers), np.log(values), 1)[0]


def natural(name):
    """Sorts numbers within names as numbers."""
    return [part.rjust(6, "0") if part.isdigit() else part for part in name.split(" ")]


def table(summary, noun="pairs"):
    has_ideal = any("ideal_ratio" in figures for figures in summary.values())
    lines = ["| quantity | runs | empirical | bound | empirical / bound | NEES "
             "| largest bias, in standard errors |" +
             (" empirical / best, same seeds |" if has_ideal else ""),
             "|---|---|---|---|---|---|---|" + ("---|" if has_ideal else "")]
    for name in sorted(summary, key=natural):
        figures = summary[name]
        scale, unit = (180 / np.pi, "deg") if name.startswith("angle") else (1e3, "mm")
        lines.append(
            "| {} | {} | {:.4f} {} | {:.4f} {} | {:.3f} +- {:.3f} | {:.2f} +- {:.2f} "
            "| {} |".format(
                name, figures["runs"], scale * figures["stddev"], unit,
                scale * figures["bound"], unit, figures["ratio"], figures["ratio_error"],
                figures["nees"], figures["nees_error"],
                "" if figures["largest_bias"] is None else
                "{:.1f} of {} {}".format(figures["largest_bias"], figures["pairs"], noun)))
        if has_ideal:
            lines[-1] += (" {ideal_ratio:.3f} +- {ideal_ratio_error:.3f} |".format(**figures)
                          if "ideal_ratio" in figures else " |")
    return "\n".join(lines)


def nees_line(what, values, freedom):
    """Mean of NEES / freedom over independent values with its 95 % interval."""
    half = 1.96 * np.sqrt(2.0 / np.sum(freedom))
    mean = np.sum(values) / np.sum(freedom)
    return {"what": what, "mean": mean, "low": 1 - half, "high": 1 + half,
            "inside": bool(abs(mean - 1) <= half)}


def nees_of_runs(what, values, freedom):
    """The same where a run's values (its row) depend on each other: from the runs' spread."""
    means = np.mean(values, axis=1) / freedom
    half = 1.96 * means.std(ddof=1) / np.sqrt(len(means))
    return {"what": what, "mean": means.mean(), "low": 1 - half, "high": 1 + half,
            "inside": bool(abs(means.mean() - 1) <= half)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("runs", type=pathlib.Path, help="directory of scripts/experiments/monte_carlo.py")
    parser.add_argument("--bound", type=pathlib.Path, required=True,
                        help="directory of plumbline_bound for the same experiment")
    parser.add_argument("--ideal", type=pathlib.Path,
                        help="directory of run_0001, ...: plumbline_bound --seed=1, ...")
    parser.add_argument("--faces", action="store_true",
                        help="each face by itself, not pairs of a corridor's walls")
    parser.add_argument("--output", type=pathlib.Path, help="file for the figures (JSON)")
    arguments = parser.parse_args()
    quantities = face_quantities if arguments.faces else pair_quantities
    directories = sorted(arguments.runs.glob("run_*"))
    if len(directories) < 2:
        sys.exit(f"precision.py: {arguments.runs}: at least two runs (run_*) expected")
    try:
        runs = [read_run(directory, quantities) for directory in directories]
        bound = bound_variances(arguments.bound, runs[0][3], quantities)
        ideals = arguments.ideal and read_ideals(arguments.ideal, directories, runs, quantities)
    except (OSError, ValueError) as error:
        sys.exit(f"precision.py: {error}")
    except KeyError as error:
        sys.exit(f"precision.py: an input file has no {error}")
    summary = summarise_pairs([run[0] for run in runs], bound)
    bias = judge_largest_bias([run[0] for run in runs], bound)
    plane_values = np.array([run[1] for run in runs])
    pose_values = np.array([run[2] for run in runs])
    nees = [nees_line("all planes of a run", plane_values[:, 0], plane_values[:, 1]),
            nees_of_runs("poses, each of its own", pose_values, 6)]
    windows = [run[4] for run in runs if run[4] is not None]
    if len(windows) >= 2:
        values = np.array([window[0] for window in windows])
        nees.append(nees_line("planes in view, as the window left them",
                              values[:, 0], values[:, 1]))
        nees.append(nees_of_runs("poses, as the window stated each when it was the newest",
                                 np.array([window[1] for window in windows]), 6))
    if arguments.ideal:
        compared = [(run, ideal) for run, ideal in zip(runs, ideals) if ideal is not None]
        compare_with_ideal([(run[0], ideal[0]) for run, ideal in compared], summary)
        values = np.array([ideal[1] for _, ideal in compared])
        nees.append(nees_line("all planes of the best estimate", values[:, 0], values[:, 1]))
        values = np.array([run[1] for run, _ in compared])
        nees.append(nees_line("all planes of these seeds' runs", values[:, 0], values[:, 1]))
    growth = {prefix + suffix: growth_exponent(summary, prefix, suffix)
              for prefix, suffix in (("angle, outer, ", "corners"),
                                     ("distance, outer, ", "centre"),
                                     ("distance, outer, ", "corners"))}
    print(table(summary, "faces" if arguments.faces else "pairs"))
    print()
    for line in nees:
        print("NEES of {what}: {mean:.3f} per degree of freedom, 95 % interval "
              "{low:.3f} to {high:.3f}".format(**line))
    if bias is not None:
        print("largest mean error of all {quantities} quantities: {largest:.1f} standard errors; "
              "by chance, over {limit:.1f} in 5 % of such series, over this in {percent:.0f} %"
              .format(percent=100 * bias["chance"], **bias))
    for what, exponent in growth.items():
        if exponent is not None:
            print(f"growth of {what}: exponent {exponent:.2f}")
    if arguments.output:
        temporary = arguments.output.with_name(arguments.output.name + ".part")
        temporary.write_text(json.dumps({"pairs": summary, "nees": nees, "bias": bias,
                                         "growth": growth}, indent=1) + "\n")
        temporary.rename(arguments.output)


if __name__ == "__main__":
    main()

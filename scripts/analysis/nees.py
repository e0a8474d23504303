"""Normalised estimation errors squared (NEES) of planes and poses, with their 95 % intervals."""

import numpy as np

from evaluated_planes import rotation_matrix, rotation_vector

SIGMAS_95 = 1.96  # half width of the 95 % interval of a normal variable


def plane_nees(planes, truth, frame):
    """Normalised squared error of all planes together, and its degrees of freedom."""
    errors, rows = [], []
    for plane in planes.planes:
        face = truth.faces[planes.face_of_plane[plane]]
        for _, error, row in planes.errors(plane, face, frame):
            errors.append(error)
            rows.append(row)
    rows = np.array(rows)
    covariance = rows @ planes.covariance @ rows.T
    scale = 1 / np.sqrt(np.diag(covariance))
    white = np.array(errors) * scale
    return white @ np.linalg.solve(covariance * np.outer(scale, scale), white), len(white)


def pose_covariances(directory, prefix=""):
    """Covariances (n, 6, 6) of position, m, and rotation, rad, at the poses of a trajectory."""
    entries = np.loadtxt(directory / f"{prefix}trajectory_covariance.csv", delimiter=",",
                         skiprows=1, ndmin=2)[:, 1:]
    covariances = np.zeros((len(entries), 6, 6))
    rows, columns = np.triu_indices(6)
    covariances[:, rows, columns] = covariances[:, columns, rows] = entries
    return covariances


def pose_nees(directory, truth, frame, prefix="", count=20):
    """Normalised squared errors of poses spread over the path, 6 degrees of freedom each."""
    rotation, translation = frame
    poses = np.loadtxt(directory / f"{prefix}trajectory.tum")
    covariances = pose_covariances(directory, prefix)
    values = []
    for index in np.linspace(0.02 * len(poses), 0.98 * len(poses), count).astype(int):
        true_position, true_rotation = truth.pose_at(poses[index, 0])
        turn = rotation_matrix(poses[index, 4:8]) @ (rotation @ true_rotation).T
        error = np.concatenate([poses[index, 1:4] - rotation @ true_position - translation,
                                rotation_vector(turn)])
        values.append(error @ np.linalg.solve(covariances[index], error))
    return np.array(values)


def nees_line(what, values, freedom):
    """Mean of NEES / freedom over independent values with its 95 % interval."""
    half = SIGMAS_95 * np.sqrt(2.0 / np.sum(freedom))
    mean = np.sum(values) / np.sum(freedom)
    return {"what": what, "mean": mean, "low": 1 - half, "high": 1 + half,
            "inside": bool(abs(mean - 1) <= half)}


def nees_of_runs(what, values, freedom):
    """Mean of NEES / freedom where a run's values (its row) depend on each other: the 95 % interval
    follows from the spread of the runs."""
    means = np.mean(values, axis=1) / freedom
    half = SIGMAS_95 * means.std(ddof=1) / np.sqrt(len(means))
    return {"what": what, "mean": means.mean(), "low": 1 - half, "high": 1 + half,
            "inside": bool(abs(means.mean() - 1) <= half)}

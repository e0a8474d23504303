"""Reads what the figures show, writes each figure as PNG and as PDF, and holds their colours."""

import contextlib
import os

import numpy as np

from floor_plan import InputError, read_json, read_ply_vertices

PNG_DPI = 150

# Okabe and Ito's colours, which colour-blind readers can tell apart.
BLACK, ORANGE, SKY, GREEN = "#000000", "#e69f00", "#56b4e9", "#009e73"
BLUE, VERMILION, PURPLE = "#0072b2", "#d55e00", "#cc79a7"


@contextlib.contextmanager
def contents_of(path):
    """Names the file when what it holds is not what is expected."""
    try:
        yield
    except KeyError as error:
        raise InputError(f"{path}: has no {error}") from error
    except (AttributeError, IndexError, TypeError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error


def join(directory, name):
    return os.path.join(directory, name)


def read_map(directory, fields):
    """The map's points, as a structured array that has these fields."""
    path = join(directory, "map.ply")
    with contents_of(path):
        points = read_ply_vertices(path)
    for field in fields:
        if field not in points.dtype.names:
            raise InputError(f"{path}: its vertices have no {field}")
    return points


def coordinates(points):
    return np.column_stack([points["x"], points["y"], points["z"]]).astype(float)


def read_positions(path):
    """Positions of a trajectory, one row per pose, metres."""
    with contents_of(path):
        return np.loadtxt(path, ndmin=2)[:, [1, 2, 3]]


def read_scan_period(directory):
    path = join(directory, "summary.json")
    with contents_of(path):
        summary = read_json(path)
        return summary["duration_s"] / max(1, summary["scans"] - 1)


def save(figure, directory, name):
    """Both files or none; the same input gives the same files."""
    os.makedirs(directory, exist_ok=True)
    formats = {"png": {"Software": None}, "pdf": {"CreationDate": None}}
    paths = {suffix: join(directory, f"{name}.{suffix}") for suffix in formats}
    try:
        for suffix, metadata in formats.items():
            figure.savefig(paths[suffix] + ".partial", format=suffix, dpi=PNG_DPI,
                           bbox_inches="tight", metadata=metadata)
        for path in paths.values():
            os.replace(path + ".partial", path)
    finally:
        for path in paths.values():
            if os.path.exists(path + ".partial"):
                os.remove(path + ".partial")
    for path in paths.values():
        print(path)

#!/usr/bin/python3
"""Shows whether the scanners of a result agree on the walls that two or more of them see.

For each such plane: the mean signed residual of every scanner's points (positive: on the side
the normal points to) and the largest difference between two scanners. Below, for each pair of
scanners, their differences over all common planes. Differences well beyond a few millimetres
mean that the extrinsics or the time offsets in the rig file are wrong: a heading that is wrong
by 0.1 degrees moves a wall 5 m away by 9 mm.
"""

import argparse
import itertools
import os
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "figures"))
# pylint: disable=wrong-import-position
from floor_plan import InputError, read_json, read_ply_vertices


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("result", help="directory that plumbline_map wrote")
    parser.add_argument(
        "--min-points", type=int, default=200,
        help="points of a scanner on a plane below which the pair is left out (default: 200)")
    arguments = parser.parse_args()
    if arguments.min_points < 1:
        parser.error("--min-points must be at least 1")
    return arguments


def read_points(path):
    """Scanner, plane id and residual (m) of the points that lie on a plane."""
    points = read_ply_vertices(path)
    missing = [name for name in ("scanner", "plane_id", "residual")
               if name not in points.dtype.names]
    if missing:
        raise InputError(f"{path}: vertices have no property {missing[0]}")
    points = points[points["plane_id"] >= 0]
    return points["scanner"], points["plane_id"], points["residual"].astype(float)


def means_by_plane(scanners, plane_ids, residuals, min_points):
    """{plane id: {scanner: (number of points, mean residual in mm)}}, two scanners or more."""
    table = {}
    for plane_id in np.unique(plane_ids):
        on_plane = plane_ids == plane_id
        row = {}
        for scanner in np.unique(scanners[on_plane]):
            chosen = residuals[on_plane & (scanners == scanner)]
            if len(chosen) >= min_points:
                row[int(scanner)] = (len(chosen), 1000.0 * chosen.mean())
        if len(row) > 1:
            table[int(plane_id)] = row
    return table


def read_names(result, count):
    """The scanners' names; of maps of earlier versions, which do not say, their numbers."""
    path = os.path.join(result, "summary.json")
    names = read_json(path).get("scanners", []) if os.path.exists(path) else []
    return [str(name) for name in names] + [f"scanner {i}" for i in range(len(names), count)]


def print_planes(table, planes, scanners, names):
    heads = {i: f"{names[i] + ': points':>19} mean/mm" for i in scanners}
    print("plane   normal/deg  at x/m    y/m" + "".join(f" {heads[i]}" for i in scanners) +
          "   spread/mm")
    for plane_id, row in table.items():
        plane = planes[plane_id]
        heading = np.degrees(np.arctan2(plane["normal"][1], plane["normal"][0]))
        cells = "".join(
            f"{row[i][0]:{len(heads[i]) - 7}d} {row[i][1]:+7.1f}" if i in row
            else f"{'-':>{len(heads[i]) + 1}}"
            for i in scanners)
        means = [mean for _, mean in row.values()]
        print(f"{plane_id:5d} {heading:12.1f} {plane['centre'][0]:7.2f} "
              f"{plane['centre'][1]:6.2f}{cells}{max(means) - min(means):12.1f}")


def print_pairs(table, scanners, names):
    """Differences of each pair, a plane weighted by the points of the scanner with fewer."""
    pairs = {(i, j): f"{names[i]}, {names[j]}"
             for i, j in itertools.combinations(scanners, 2)}
    width = max(map(len, ["scanners", *pairs.values()]))
    print(f"\n{'scanners':{width}}  planes  mean difference/mm  rms difference/mm")
    for (i, j), pair in pairs.items():
        common = [row for row in table.values() if i in row and j in row]
        if not common:
            print(f"{pair:{width}} {0:7d} {'-':>19} {'-':>18}")
            continue
        difference = np.array([row[i][1] - row[j][1] for row in common])
        weight = np.array([min(row[i][0], row[j][0]) for row in common], dtype=float)
        mean = np.average(difference, weights=weight)
        rms = np.sqrt(np.average(difference**2, weights=weight))
        print(f"{pair:{width}} {len(common):7d} {mean:+19.1f} {rms:18.1f}")


def main():
    arguments = parse_arguments()
    try:
        planes = {plane["id"]: plane
                  for plane in read_json(os.path.join(arguments.result, "planes.json"))}
        path = os.path.join(arguments.result, "map.ply")
        scanners, plane_ids, residuals = read_points(path)
        table = means_by_plane(scanners, plane_ids, residuals, arguments.min_points)
        unknown = [plane_id for plane_id in table if plane_id not in planes]
        if unknown:
            raise InputError(f"{path}: plane {unknown[0]} is not in planes.json")
        if not table:
            raise InputError(f"{path}: no plane has {arguments.min_points} points of each of "
                             "two scanners")
        seen = sorted({scanner for row in table.values() for scanner in row})
        names = read_names(arguments.result, seen[-1] + 1)
        print_planes(table, planes, seen, names)
        print_pairs(table, seen, names)
    except (InputError, OSError) as error:
        print(f"scanner_agreement.py: {error}", file=sys.stderr)
        return 1
    except KeyError as error:
        print(f"scanner_agreement.py: an input file has no field {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/python3
"""Holds what the runs of scripts/experiments/monte_carlo.py find of the mounts of scanners and of
the IMU against the truth, against the bound of plumbline_bound and against what the runs state
themselves.

For each parameter: the root mean square of its errors, the standard deviation that the bound
allows, their ratio, and the mean of the squared errors over the stated variances (NEES) with its
95 % interval about 1. Of an IMU's biases, which wander, all instants count that the truth gives.
With the positions of the trajectories beside them.
"""

import argparse
import json
import math
import pathlib

import numpy as np
import yaml

from evaluated_planes import read_json

SIGMAS_95 = 1.96  # half width of the 95 % interval of a normal variable
IMU = "imu"


def biases_at(biases, times_ns):
    """By name: values and standard deviations (if stated) at these instants."""
    nodes_ns = np.array([at["time_ns"] for at in biases], dtype=float)
    found = {}
    for sensor, unit in (("gyroscope", "deg_s"), ("accelerometer", "m_s2")):
        values, sigmas = ([np.interp(times_ns, nodes_ns, axis) for axis in np.transpose(
            [at.get(key, [0.0] * 3) for at in biases])]
            for key in (f"{sensor}_{unit}", f"{sensor}_sigma_{unit}"))
        for axis, value, sigma in zip("xyz", values, sigmas):
            found[f"{sensor}_bias_{axis}_{unit}"] = (value, sigma)
    return found


def found_of(calibration, times_ns):
    """By scanner (or the IMU) and name of the parameter: value, standard deviation; of biases at
    these instants."""
    found = {(scanner["name"], parameter["name"]): (parameter["value"], parameter["sigma"])
             for scanner in calibration["scanners"] for parameter in scanner["parameters"]
             if parameter["prior_sigma"] > 0}
    if IMU in calibration:
        imu = calibration[IMU]
        found.update({(IMU, parameter["name"]): (parameter["value"], parameter["sigma"])
                      for parameter in imu["parameters"] if parameter["sigma"] > 0})
        found.update({(IMU, name): value
                      for name, value in biases_at(imu["biases"], times_ns).items()})
    return found


def rotation_of(roll, pitch, yaw):
    """The matrix of Rz(yaw) Ry(pitch) Rx(roll), degrees."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(math.radians(a)), math.sin(math.radians(a)))
                                    for a in (roll, pitch, yaw))
    return (np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
            @ np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
            @ np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]]))


def matrix_of(x, y, z, w):
    """The matrix of a unit quaternion."""
    axis = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * axis + 2 * axis @ axis


def true_imu(directory):
    """By name of the parameter: what the simulated IMU is off the rig file by; and the instants
    of its biases."""
    truth = read_json(directory / "truth_imu.json")
    stated = yaml.safe_load((directory / "rig.yaml").read_text())["imu"]["body_from_imu"]
    pose = truth["body_from_imu"]
    turn = matrix_of(*pose["quaternion_xyzw"]) @ rotation_of(*stated["rotation_rpy_deg"]).T
    # Of a turn by few degrees: its rotation vector by the sine of its angle.
    sine_vector = 0.5 * np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0],
                                  turn[1, 0] - turn[0, 1]])
    sine = np.linalg.norm(sine_vector)
    vector = np.degrees(sine_vector * (math.asin(sine) / sine if sine > 0 else 1.0))
    shift = np.subtract(pose["translation_m"], stated["translation"])
    values = {"time_s": truth["late_s"]}
    for name, triple in (("{}_deg", vector), ("{}_m", shift)):
        axes = ("roll", "pitch", "yaw") if name.endswith("deg") else "xyz"
        values.update({name.format(axis): value for axis, value in zip(axes, triple)})
    for sensor in ("gyroscope", "accelerometer"):
        values.update({f"{sensor}_scale_{axis}": value
                       for axis, value in zip("xyz", truth[f"{sensor}_scale"])})
    # The map's heading is its own: only a vertical that does not lean is the same in it.
    if truth["gravity_m_s2"][0] == truth["gravity_m_s2"][1] == 0.0:
        values.update({"gravity_x_deg": 0.0, "gravity_y_deg": 0.0})
    biases = [{"time_ns": at["time_ns"],
               "gyroscope_deg_s": np.degrees(at["gyroscope_rad_s"]),
               "accelerometer_m_s2": at["accelerometer_m_s2"]} for at in truth["biases"]]
    times_ns = [at["time_ns"] for at in biases]
    values.update({name: value for name, (value, _) in biases_at(biases, times_ns).items()})
    return values, times_ns


def read_run(directory):
    """By scanner (or the IMU) and name of the parameter: errors, stated standard deviations; and
    the instants of an IMU's biases."""
    truths = {}
    times_ns = []
    if (directory / "truth_mounts.json").exists():
        truths.update({scanner.pop("name"): scanner for scanner in read_json(
            directory / "truth_mounts.json")["scanners"]})
    if (directory / "truth_imu.json").exists():
        truths[IMU], times_ns = true_imu(directory)
    found = found_of(read_json(directory / "calibration.json"), times_ns)
    errors = {(who, name): np.atleast_2d((found[who, name][0] - true_value, found[who, name][1]))
              for who, values in truths.items() for name, true_value in values.items()
              if (who, name) in found}
    return {key: error.reshape(2, -1) for key, error in errors.items()}, times_ns


def position_bound(directory):
    """Root mean square over the bound's poses of the standard deviation of the position, m."""
    rows = np.loadtxt(directory / "trajectory_covariance.csv", delimiter=",", skiprows=1)
    # The upper triangle by rows: xx, xy, xz, ..., yy, ..., zz.
    return np.sqrt(np.mean(rows[:, 1] + rows[:, 7] + rows[:, 12]))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", type=pathlib.Path, metavar="RUNS",
                        help="the --output of scripts/experiments/monte_carlo.py")
    parser.add_argument("--bound", type=pathlib.Path, required=True, metavar="DIR",
                        help="the --output of plumbline_bound")
    parser.add_argument("--output", type=pathlib.Path, metavar="FILE", help="writes JSON")
    arguments = parser.parse_args()
    directories = sorted(path for path in arguments.runs.glob("run_*") if path.is_dir())
    runs_and_times = [read_run(directory) for directory in directories]
    if not runs_and_times or not runs_and_times[0][0]:
        parser.error(f"{arguments.runs} has no runs of a rig with a mount or an IMU")
    runs = [errors for errors, _ in runs_and_times]
    bound = found_of(read_json(arguments.bound / "calibration.json"), runs_and_times[0][1])
    half = SIGMAS_95 * np.sqrt(2.0 / len(runs))
    table = []
    print(f"{len(runs)} runs; NEES has to lie in {1 - half:.2f} .. {1 + half:.2f}")
    print(f"{'scanner':12}{'parameter':28}{'RMS error':>12}{'bound':>12}{'ratio':>8}{'NEES':>8}")
    for scanner, name in runs[0]:
        errors, sigmas = np.concatenate([run[scanner, name] for run in runs], axis=1)
        rms = np.sqrt(np.mean(errors**2))
        sigma = np.sqrt(np.mean(np.square(bound[scanner, name][1])))
        nees = np.mean((errors / sigmas)**2)
        table.append({"scanner": scanner, "parameter": name, "rms": rms, "bound": sigma,
                      "ratio": rms / sigma, "nees": nees, "largest": np.abs(errors).max(),
                      "inside": bool(abs(nees - 1) <= half)})
        print(f"{scanner:12}{name:28}{rms:12.6f}{sigma:12.6f}{rms / sigma:8.2f}{nees:8.2f}")
    positions = [read_json(directory / "evaluation.json")["trajectory"]["unaligned"]["position_m"]
                 ["rmse"] for directory in directories]
    rms, sigma = np.sqrt(np.mean(np.square(positions))), position_bound(arguments.bound)
    print(f"positions: RMS {1e3 * rms:.2f} mm, bound {1e3 * sigma:.2f} mm, ratio {rms / sigma:.2f}")
    if arguments.output:
        arguments.output.write_text(json.dumps(
            {"runs": len(runs), "parameters": table,
             "positions": {"rms_m": rms, "bound_m": sigma, "ratio": rms / sigma}}, indent=1))


if __name__ == "__main__":
    main()

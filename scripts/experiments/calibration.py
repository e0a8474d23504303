#!/usr/bin/python3
"""Maps simulated recordings with rig files that are wrong, and holds map and calibration against
the truth and against the bound of what any mapper could find (plumbline_bound).

Every scanner but the body's is turned and shifted in a random direction and stamped early or late,
and every scanner's ranges are too long or short, each by the size that is asked for; the rig file
does not say how well it knows itself, or says it by --stated. The body's is the first of the
steepest scanners (docs/calibration.md).

One line a run: the map's errors after rigid alignment, verdict, and how far the calibrated rig is
from the true one (rotation, translation, clock, range bias: root mean square over scanners and
axes). Below, per experiment: how many are right (5 cm and 0.5 deg at most) and consistent, what the bound
leaves open and what the maps name as open, the root mean squares over the runs, of the errors, in stated
standard deviations and in those of the bound, and the normalised errors squared (NEES) of all
parameters together, per degree of freedom. All errors of the rig are those of the parameters that
the bound shows.

With --right each recording is also mapped with the right rig file, known exactly and as uncertain as
the wrong one, and how much larger the errors of the map are than these is said as well.
"""

import argparse
import collections
import math
import sys

import numpy as np
import yaml

import experiment_files
import job_runner
import robustness
import series

PROGRAMS = (*robustness.PROGRAMS, "plumbline_bound")
BY_HAND = (1.0, 0.01, 0.002, 0.01)  # what a rig file means that does not say how well it knows
RIGHT = {"exact": "the right rig file, known exactly",
         "uncertain": "the right rig file, as uncertain"}
KINDS = {"deg": ("roll_deg", "pitch_deg", "yaw_deg"), "m": ("x_m", "y_m", "z_m"),
         "s": ("time_s",), "range_m": ("range_m",)}
UNITS = {"deg": ("deg", 1.0), "m": ("mm", 1e3), "s": ("ms", 1e3), "range_m": ("mm of range", 1e3)}
MAP_ERRORS = {"positions": ("trajectory", "aligned", "position_m"),
              "rotations": ("trajectory", "aligned", "rotation_deg"),
              "surfaces' angles": ("planes_aligned", "angle_deg"),
              "surfaces' distances": ("planes_aligned", "distance_m")}
LEVEL = math.radians(2.0)  # less tilted scanners see no heights
NORMAL_95 = 1.96  # half width of the 95 % interval of a normal variable


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("experiments", nargs="+", metavar="EXPERIMENT",
                        help="names in configs/experiments or its folder robustness")
    parser.add_argument("--off", nargs=4, type=float, default=BY_HAND,
                        metavar=("DEG", "M", "S", "RANGE_M"), help="how far the rig file is off")
    parser.add_argument("--stated", nargs=4, type=float, metavar=("DEG", "M", "S", "RANGE_M"),
                        help="uncertainty that it states (default: none)")
    parser.add_argument("--right", action="store_true",
                        help="also map with the right rig file")
    job_runner.add_seed_arguments(parser, "experiment", 4)
    job_runner.add_arguments(parser)
    return parser.parse_args()


def turn_of(vector):
    """The rotation matrix of a rotation vector."""
    angle = np.linalg.norm(vector)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = vector / angle
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross


def rotation_of(roll_pitch_yaw_deg):
    roll, pitch, yaw = np.radians(roll_pitch_yaw_deg)
    return (turn_of([0.0, 0.0, yaw]) @ turn_of([0.0, pitch, 0.0]) @ turn_of([roll, 0.0, 0.0]))


def roll_pitch_yaw_of(rotation):
    return [float(angle) for angle in np.degrees([
        math.atan2(rotation[2, 1], rotation[2, 2]), -math.asin(rotation[2, 0]),
        math.atan2(rotation[1, 0], rotation[0, 0])])]


def uncertainty_of(stated):
    return dict(zip(("rotation_deg", "translation_m", "time_s", "range_m"), map(float, stated)))


def body_scanner(rig):
    """The position of the scanner whose pose and clock are the body's in a rig (a dictionary) of
    which none is known exactly: core/sensor/rig.cc."""
    tilts = [math.acos(min(1.0, abs(rotation_of(
        scanner["body_from_scanner"]["rotation_rpy_deg"])[2, 2]))) for scanner in rig["scanners"]]
    if rig.get("motion") == "planar" or max(tilts) < LEVEL:
        return 0
    return next(i for i, tilt in enumerate(tilts) if 2.0 * tilt >= max(tilts))


def wrong_rig(rig, off, stated, seed):
    """The text of a rig file (a dictionary) that is off; and by how much, {scanner: {parameter:
    value}}, of what has to be found."""
    random = np.random.default_rng(seed)
    truth = {}
    scanners = []
    body = body_scanner(rig)
    for number, scanner in enumerate(rig["scanners"]):
        direction, way = random.normal(size=(2, 3))
        turn = math.radians(off[0]) * direction / np.linalg.norm(direction)
        shift = off[1] * way / np.linalg.norm(way)
        late, too_long = random.choice([-1.0, 1.0], size=2) * off[2:]
        if number == body:
            turn, shift, late = np.zeros(3), np.zeros(3), 0.0
        pose = scanner["body_from_scanner"]
        wrong = {
            **scanner,
            "body_from_scanner": {
                "translation": [float(x) for x in np.array(pose["translation"]) + shift],
                "rotation_rpy_deg": roll_pitch_yaw_of(
                    turn_of(turn) @ rotation_of(pose["rotation_rpy_deg"]))},
            "time_offset_s": float(scanner.get("time_offset_s", 0.0) + late),
            "range_bias_m": float(scanner.get("range_bias_m", 0.0) + too_long)}
        wrong.pop("uncertainty", None)
        if stated:
            wrong["uncertainty"] = uncertainty_of(stated)
        scanners.append(wrong)
        turned, shifted = -np.degrees(turn), -shift
        truth[scanner["name"]] = {
            **dict(zip(KINDS["deg"], turned)), **dict(zip(KINDS["m"], shifted)),
            "time_s": -late, "range_m": -too_long}
    return yaml.safe_dump({**rig, "scanners": scanners}), truth


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def with_uncertainty(rig, stated):
    """The text of a rig file that is right."""
    return yaml.safe_dump({**rig, "scanners": [
        {**scanner, "uncertainty": uncertainty_of(stated)} for scanner in rig["scanners"]]})


def bound_job(experiment, arguments):
    """The bound of an experiment whose rig file is as uncertain as the wrong one."""
    file = arguments.output / "experiments" / f"{experiment}.yaml"
    experiment_files.write_variant(
        experiment, file, {"uncertainty": uncertainty_of(arguments.stated or BY_HAND)})
    return job_runner.Job(
        destination=arguments.output / f"{experiment}_bound",
        commands=((arguments.binaries / "plumbline_bound", f"--experiment={file}",
                   "--output=bound"),),
        required=("bound/calibration.json",), failure_file=f"failed_{experiment}_bound.json",
        info={"experiment": experiment, "seed": "bound"})


def run_job(experiment, seed, arguments):
    source = experiment_files.of_case(experiment)
    name = yaml.safe_load(job_runner.read_text(source))["rig"]
    rig = yaml.safe_load(job_runner.read_text(source.parent / name))
    run = f"{experiment}_{seed:04d}"
    text, truth = wrong_rig(rig, arguments.off, arguments.stated, seed)
    rigs = {"result": write(arguments.output / "rigs" / f"{run}.yaml", text)}
    if arguments.right:
        for right, stated in (("exact", (0,) * 4), ("uncertain", arguments.stated or BY_HAND)):
            rigs[right] = write(arguments.output / "rigs" / f"{experiment}_{right}.yaml",
                                with_uncertainty(rig, stated))
    commands = [(arguments.binaries / "plumbline_simulate", f"--experiment={source}",
                 f"--seed={seed}", "--output=truth")]
    for folder, file in rigs.items():
        commands += [
            (arguments.binaries / "plumbline_map", "--recording=truth/recording.bag",
             f"--rig={file}", "--threads=1", "--formats=ply", f"--output={folder}"),
            (arguments.binaries / "plumbline_evaluate", f"--result={folder}", "--truth=truth",
             f"--output={folder}/{evaluation_file(folder)}")]
    return job_runner.Job(
        destination=arguments.output / run,
        commands=tuple(commands),
        required=("result/summary.json", "result/calibration.json",
                  *(f"{folder}/{evaluation_file(folder)}" for folder in rigs)),
        failure_file=f"failed_{run}.json",
        done_codes=(0, job_runner.NOT_TRUSTED),
        info={"experiment": experiment, "seed": seed, "truth": truth})


def evaluation_file(folder):
    return f"evaluation_{folder}.json"


def free_parameters(calibration):
    """{(scanner, parameter): its entry} of a calibration.json, in the covariance's order."""
    return {(scanner["name"], parameter["name"]): parameter
            for scanner in calibration["scanners"] for parameter in scanner["parameters"]
            if parameter["prior_sigma"] > 0.0}


def shown(calibration):
    return {key for key, parameter in free_parameters(calibration).items()
            if parameter["observed"]}


def open_in_words(calibration):
    names = {}
    for scanner, name in free_parameters(calibration):
        if (scanner, name) not in shown(calibration):
            names.setdefault(scanner, []).append(name)
    return "; ".join(f"{', '.join(of_scanner)} of {scanner}"
                     for scanner, of_scanner in names.items()) or "nothing"


def nees_of(calibration, errors):
    """e^T C^-1 e of the errors ({(scanner, parameter): value}); their number is its freedom."""
    rows = [row for row, key in enumerate(free_parameters(calibration)) if key in errors]
    keys = [key for key in free_parameters(calibration) if key in errors]
    covariance = np.array(calibration["covariance"])[np.ix_(rows, rows)]
    scale = 1.0 / np.sqrt(np.diag(covariance))  # degrees beside seconds
    white = scale * [errors[key] for key in keys]
    return float(white @ np.linalg.solve(covariance * np.outer(scale, scale), white))


def chi_square_interval(freedom):
    """The 95 % interval of a chi-square variable per degree of freedom (Wilson and Hilferty)."""
    spread = 2.0 / (9.0 * freedom)
    return tuple((1.0 - spread + side * math.sqrt(spread)) ** 3 for side in (-NORMAL_95, NORMAL_95))


def figures_of(found, bound, truth):
    """What a calibration.json is off the truth, in the parameters that the bound shows."""
    parameters = free_parameters(found)
    errors = {key: parameters[key]["value"] - truth[key[0]][key[1]] for key in parameters
              if key in shown(bound)}
    figures = {"open": open_in_words(found), "nees": nees_of(found, errors),
               "freedom": len(errors)}
    for kind, names in KINDS.items():
        keys = [key for key in errors if key[1] in names]
        figures[kind] = rms([errors[key] for key in keys])
        figures[f"{kind}_normalised"] = rms(
            [errors[key] / parameters[key]["sigma"] for key in keys])
    return figures


def bound_of_kind(bound, kind):
    """The root mean square of the bound's standard deviations, of the parameters that it shows."""
    return rms([parameter["sigma"] for key, parameter in free_parameters(bound).items()
                if key in shown(bound) and key[1] in KINDS[kind]])


def map_errors(evaluation):
    errors = {}
    for name, path in MAP_ERRORS.items():
        value = evaluation
        for part in path:
            value = value[part]
        errors[name] = value["rmse"]
    return errors


def row_of(directory, info, bound):
    evaluation = job_runner.read_json(directory / evaluation_file("result"))
    aligned = evaluation["trajectory"]["aligned"]
    row = {
        **{key: info[key] for key in ("experiment", "seed")},
        "position_max_m": aligned["position_m"]["max"],
        "rotation_max_deg": aligned["rotation_deg"]["max"],
        "verdict": job_runner.read_json(directory / "summary.json")["consistency"]["verdict"],
        "errors": map_errors(evaluation),
        **figures_of(job_runner.read_json(directory / "calibration.json"), bound, info["truth"])}
    row["right"] = (row["position_max_m"] <= robustness.MAX_POSITION_M
                    and row["rotation_max_deg"] <= robustness.MAX_ROTATION_DEG)
    row["right_errors"] = {
        right: map_errors(job_runner.read_json(directory / evaluation_file(right)))
        for right in RIGHT if (directory / evaluation_file(right)).exists()}
    return row


def failure_row(failure, info):
    return {"experiment": info["experiment"], "seed": info["seed"], "error": failure["error"]}


def rms(values):
    """0 of none."""
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else 0.0


def line_of(row):
    if "error" in row:
        return f"{row['experiment']} {row['seed']}: {row['error']}"
    errors = row["errors"]
    parts = [f"{row['experiment']} {row['seed']}: {'right' if row['right'] else 'WRONG'}, "
             f"{row['verdict']}, {1e3 * errors['positions']:.2f} mm rms, "
             f"{1e3 * row['position_max_m']:.1f} mm, {errors['rotations']:.3f} deg rms, "
             f"{row['rotation_max_deg']:.2f} deg; rig"]
    parts += [f"{factor * row[kind]:.4f} {unit}" for kind, (unit, factor) in UNITS.items()]
    return " ".join(parts)


def ratio_to_right(rows, right, name):
    return (rms([row["errors"][name] for row in rows])
            / rms([row["right_errors"][right][name] for row in rows]))


def summary_of(experiment, rows, bound):
    mapped = [row for row in rows if "error" not in row]
    lines = [f"{experiment}: {sum(row['right'] for row in mapped)} of {len(rows)} right, "
             f"{sum(row['verdict'] == 'consistent' for row in mapped)} consistent"]
    if not mapped:
        return lines[0]
    lines[0] += f", {1e3 * rms([row['errors']['positions'] for row in mapped]):.2f} mm rms"
    named = collections.Counter(row["open"] for row in mapped)
    lines.append(f"  open: {open_in_words(bound)}; named: " + "; ".join(
        f"{words} ({count} of {len(mapped)})" for words, count in sorted(named.items())))
    for kind, (unit, factor) in UNITS.items():
        limit = bound_of_kind(bound, kind)
        if limit == 0.0:
            continue
        error = rms([row[kind] for row in mapped])
        stated = rms([row[f"{kind}_normalised"] for row in mapped])
        lines.append(f"  {factor * error:.4f} {unit}, {stated:.2f} stated standard deviations, "
                     f"{error / limit:.2f} of the bound {factor * limit:.4f}")
    freedom = sum(row["freedom"] for row in mapped)
    mean = sum(row["nees"] for row in mapped) / freedom
    low, high = chi_square_interval(freedom)
    lines.append(f"  NEES {mean:.3f}, {'inside' if low <= mean <= high else 'OUTSIDE'} "
                 f"{low:.3f} to {high:.3f} ({freedom} degrees of freedom)")
    for right, words in RIGHT.items():
        beside = [row for row in mapped if right in row["right_errors"]]
        if beside:
            ratios = ", ".join(f"{name} {ratio_to_right(beside, right, name):.2f}"
                               for name in MAP_ERRORS)
            lines.append(f"  errors of the map by those with {words}: {ratios}")
    return "\n".join(lines)


def table_of(experiments, rows, bounds):
    lines = [line_of(row) for row in rows]
    lines += [summary_of(name, [row for row in rows if row["experiment"] == name], bounds[name])
              for name in experiments if name in bounds]
    return "\n".join(lines) + "\n"


def main():
    arguments = parse_arguments()
    names = list(dict.fromkeys(arguments.experiments))
    cases = {name: experiment_files.of_case(name) for name in names}
    setup = {"program": "calibration.py", "off": list(arguments.off), "stated": arguments.stated,
             "right": arguments.right, **series.build_of(arguments.binaries, PROGRAMS)}
    with job_runner.open_executor(arguments) as executor, \
            series.Output(arguments.output, setup, arguments.accept_other_build) as output:
        robustness.check_experiments(output, cases)
        limits = [bound_job(name, arguments) for name in names]
        jobs = [run_job(name, seed, arguments)
                for name in names for seed in job_runner.seeds_of(arguments)]
        output.run(limits + jobs, executor, arguments.retry_failed, "runs")
        bounds, rows = {}, []
        for job in limits:
            rows += output.rows([job], lambda directory, info: bounds.update(
                {info["experiment"]: job_runner.read_json(directory / "calibration.json")}),
                                failure_row)
        rows += output.rows([job for job in jobs if job.info["experiment"] in bounds],
                            lambda directory, info: row_of(directory, info,
                                                           bounds[info["experiment"]]),
                            failure_row)
        table = table_of(names, rows, bounds)
        output.write_table("calibration", rows, table)
    print(table, end="")
    failed = len(rows) < len(jobs) or any("error" in row for row in rows)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

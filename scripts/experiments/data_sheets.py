#!/usr/bin/python3
"""Maps rooms with scanners that one can buy, simulated by their data sheets, and says how exact the
maps are and how fast they come.

Three of a kind sit on the paper's rig (configs/rigs/paper.yaml), which is carried at 0.9 m/s through
a small room and at 1.0 m/s through the first 20 m of the office. Noise is the standard deviation of
one range, as the data sheet states it, or a third of the accuracy where it states that alone.
Scanners are simulated with the number of beams of a turn that they deliver at that rate.

Each run is one directory below --output, named by scanner, place and seed; runs that are there
already are not done again. The table goes to data_sheets.md and data_sheets.json there, and is printed.
"""

import argparse
import statistics
import sys

import experiment_files
import job_runner
import series

PROGRAMS = ("plumbline_simulate", "plumbline_map", "plumbline_evaluate")
REQUIRED = ("result/evaluation.json", "result/summary.json")


def scanner(beams, field_of_view_deg, scan_rate_hz, range_noise_m, min_range_m, max_range_m):
    return dict(beams=beams, field_of_view_deg=field_of_view_deg, scan_rate_hz=scan_rate_hz,
                range_noise_m=range_noise_m, min_range_m=min_range_m, max_range_m=max_range_m)


# Sources: docs/results.md. The field of view is that of all beams, each a step wide.
SCANNERS = {
    "UTM-30LX": scanner(1081, 270.25, 40.0, 0.01, 0.1, 30.0),
    "UST-10LX": scanner(1081, 270.25, 40.0, 0.03, 0.06, 10.0),
    "URG-04LX": scanner(682, 239.77, 10.0, 0.02, 0.06, 4.0),
    "LMS1xx": scanner(541, 270.5, 50.0, 0.012, 0.5, 20.0),
    "TiM5xx": scanner(811, 270.33, 15.0, 0.02, 0.05, 10.0),
    "RPLIDAR_A": scanner(400, 360.0, 10.0, 0.02, 0.15, 12.0),
    "RPLIDAR_S": scanner(920, 360.0, 10.0, 0.02, 0.1, 40.0),
    "LD06": scanner(450, 360.0, 10.0, 0.01, 0.02, 12.0),
    "LDS-01": scanner(360, 360.0, 5.0, 0.02, 0.12, 3.5),
    "picoScan": scanner(1104, 276.0, 20.0, 0.01, 0.05, 25.0),
}
PLACES = {"room": None, "office": 20.0}  # length of the way, m; None: the experiment's own


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scanners", nargs="*", metavar="SCANNER",
                        help=f"of {', '.join(SCANNERS)} (default: all)")
    job_runner.add_seed_arguments(parser, "scanner and place", 2)
    job_runner.add_arguments(parser)
    parser.set_defaults(jobs=1)
    return parser.parse_args()


def make_jobs(arguments):
    jobs = []
    for name in arguments.scanners or SCANNERS:
        if name not in SCANNERS:
            raise job_runner.InputError(f"no scanner {name}; there are {', '.join(SCANNERS)}")
        for place, length_m in PLACES.items():
            experiment = arguments.output / "experiments" / f"{name}_{place}.yaml"
            experiment_files.write_variant(place, experiment, SCANNERS[name], length_m)
            for seed in job_runner.seeds_of(arguments):
                run = f"{name}_{place}_{seed:04d}"
                jobs.append(job_runner.Job(
                    destination=arguments.output / run,
                    commands=job_runner.simulated_run(experiment, experiment, seed,
                                                      arguments.binaries),
                    required=REQUIRED, failure_file=f"failed_{run}.json",
                    done_codes=(0, job_runner.NOT_TRUSTED),
                    info={"scanner": name, "place": place, "seed": seed}))
    return jobs


def row_of(directory, info):
    evaluation = job_runner.read_json(directory / "evaluation.json")
    summary = job_runner.read_json(directory / "summary.json")
    position = evaluation["trajectory"]["aligned"]["position_m"]
    return {**info, "verdict": summary["consistency"]["verdict"],
            "position_rms_m": position["rmse"], "position_max_m": position["max"],
            "plane_distance_rms_m": evaluation["planes_aligned"]["distance_m"]["rmse"],
            "times_real_time": summary["real_time_factor"]}


def failure_row(failure, info):
    return {**info, "verdict": "error", "error": failure["error"]}


def cell_of(rows):
    """What the runs of a scanner in a place came to; figures are those of consistent maps."""
    maps = [row for row in rows if row["verdict"] == "consistent"]
    if not maps:
        return f"0 of {len(rows)} | | | "
    rms, largest, planes, speed = (
        [row[key] for row in maps] for key in ("position_rms_m", "position_max_m",
                                               "plane_distance_rms_m", "times_real_time"))
    return (f"{len(maps)} of {len(rows)} | {1e3 * statistics.mean(rms):.1f} "
            f"({1e3 * max(largest):.1f}) | {1e3 * statistics.mean(planes):.1f} | "
            f"{statistics.mean(speed):.1f}")


def table_of(rows):
    places = " | ".join(f"{place}: consistent | positions, mm | surfaces, mm | times real time"
                        for place in PLACES)
    lines = [f"| three of | beams, rate | {places} |",
             "|---" * (2 + 4 * len(PLACES)) + "|"]
    for name, kind in SCANNERS.items():
        of_scanner = [row for row in rows if row["scanner"] == name]
        if of_scanner:
            cells = " | ".join(cell_of([row for row in of_scanner if row["place"] == place])
                               for place in PLACES)
            lines.append(f"| {name.replace('_', ' ')} | {kind['beams']}, "
                         f"{kind['scan_rate_hz']:.0f} Hz | {cells} |")
    return "\n".join(lines) + "\n"


def main():
    _, num_missing = series.run_table("data_sheets", PROGRAMS, parse_arguments(), make_jobs, row_of,
                                      failure_row, table_of)
    return 1 if num_missing else 0


if __name__ == "__main__":
    sys.exit(job_runner.run_main(main))

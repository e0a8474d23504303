#!/usr/bin/python3
"""Measures how long a report takes to be written and to open, and how fast it turns.

Opens the report of a result in Debian's Chromium, which draws in software here, and prints a
table. Needs npm and Chromium; the browser is driven by playwright-core of the page's lockfile.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "test/core/outputs"))
import viewer_install  # pylint: disable=wrong-import-position

SCRIPT = pathlib.Path(__file__).with_name("report_page.mjs")
NAMES = {
    "write_s": "plumbline_report, from start to end, s",
    "verdict_s": "page: verdict shows after, s",
    "open_s": "page: everything but all points shows after, s",
    "all_points_s": "page: all points are drawn after, s",
    "total_s": "report written and opened, s",
    "turn_hz": "turning: frames a second",
    "turn_worst_s": "turning: longest frame, s",
    "turn_points": "turning: points in a frame",
}


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", type=pathlib.Path, help="directory that plumbline_map wrote")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build",
                        help="build directory (default: build)")
    parser.add_argument("--runs", type=int, default=3, help="medians of so many runs (default: 3)")
    parser.add_argument("--output", type=pathlib.Path, help="JSON file for all runs")
    return parser.parse_args()


def measure(arguments, node, chromium, packages, directory):
    report = pathlib.Path(directory) / "report.html"
    start = time.monotonic()
    subprocess.run([arguments.build / "bin/plumbline_report", arguments.result,
                    f"--output={report}"], check=True, capture_output=True)
    write_s = time.monotonic() - start
    page = subprocess.run([node, SCRIPT, packages, chromium, report], check=True,
                          capture_output=True, text=True)
    figures = {"write_s": write_s, **json.loads(page.stdout)}
    figures["total_s"] = write_s + figures["open_s"]
    figures["bytes"] = report.stat().st_size
    return figures


def main():
    arguments = parse_arguments()
    try:
        node = viewer_install.find_program("node")
        chromium = viewer_install.find_program("chromium", "chromium-browser", "google-chrome")
        packages = viewer_install.install(arguments.build.resolve())
    except unittest.SkipTest as missing:
        sys.exit(f"report_page.py: {missing}")
    runs = []
    with tempfile.TemporaryDirectory() as directory:
        for _ in range(arguments.runs):
            runs.append(measure(arguments, node, chromium, packages, directory))
    load = os.getloadavg()[0]
    print(f"{runs[0]['points']:,} points, {runs[0]['bytes'] / 1e6:.1f} MB, {runs[0]['browser']}, "
          f"{runs[0]['width']} x {runs[0]['height']} pixels in software, {os.cpu_count()} cores, "
          f"load {load:.1f}; medians of {len(runs)} runs\n")
    print("| | |\n|---|---|")
    for key, name in NAMES.items():
        value = statistics.median(run[key] for run in runs)
        print(f"| {name} | {value:,.0f} |" if value > 1000 else f"| {name} | {value:.2f} |")
    if arguments.output:
        arguments.output.write_text(json.dumps({"load": load, "runs": runs}, indent=2) + "\n",
                                    encoding="utf-8")


if __name__ == "__main__":
    main()

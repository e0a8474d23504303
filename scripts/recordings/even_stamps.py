#!/usr/bin/python3
"""Gives the scans of a CARMEN log even stamps where the computer stamped them late and in bursts.

A scanner turns at a steady rate, but old logs hold the instants at which a busy computer took
the scans in: several at once, then none for a second. Between such stamps no continuous motion
can be found. The log's order is kept; scan i gets the instant period * i + offset, the period
being the median over the whole log and the offset the running median of stamp - period * i
over WINDOW scans, so that real pauses stay. ODOM lines, whose stamps are as late, get that of
the scan that follows them. Everything else is copied as it is.
"""

import argparse
import pathlib
import sys

import numpy as np

SCANS = ("FLASER", "RLASER")


def parse_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", help="CARMEN log, not packed")
    parser.add_argument("--output", required=True, metavar="LOG")
    parser.add_argument("--window", type=int, default=41, metavar="SCANS",
                        help="over which the offset is taken (default: 41)")
    return parser.parse_args()


def even(stamps, window):
    """Stamps of the same order and rate that increase strictly."""
    count = len(stamps)
    indices = np.arange(count)
    window = min(window, count)
    # Over a window the delays cancel; over one scan they are all there is.
    spans = (stamps[window - 1:] - stamps[:count - window + 1]) / max(1, window - 1)
    period = float(np.median(spans))
    if not period > 0.0:
        raise ValueError("the stamps do not increase")
    offsets = stamps - period * indices
    half = window // 2
    padded = np.pad(offsets, half, mode="edge")
    running = np.median(np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1), axis=1)
    evened = period * indices + running
    # A pause that ends early in the window would let stamps stand still.
    for i in range(1, count):
        evened[i] = max(evened[i], evened[i - 1] + 0.25 * period)
    return evened


def main():
    arguments = parse_arguments()
    try:
        lines = pathlib.Path(arguments.log).read_text(errors="surrogateescape").splitlines()
    except OSError as error:
        sys.exit(f"even_stamps.py: {arguments.log}: {error.strerror}")
    scans = [number for number, line in enumerate(lines) if line.startswith(SCANS)]
    if len(scans) < 3:
        sys.exit(f"even_stamps.py: {arguments.log}: has {len(scans)} scans, too few")
    try:
        evened = even(np.array([float(lines[i].split()[-3]) for i in scans]), arguments.window)
    except (ValueError, IndexError) as error:
        sys.exit(f"even_stamps.py: {arguments.log}: {error}")
    next_scan = 0
    for number, line in enumerate(lines):
        if not line.startswith(SCANS + ("ODOM",)):
            continue
        while next_scan < len(scans) and scans[next_scan] < number:
            next_scan += 1
        if next_scan == len(scans):
            lines[number] = ""  # odometry after the last scan
            continue
        words = line.split()
        words[-3] = f"{evened[next_scan]:.6f}"
        lines[number] = " ".join(words)
    text = "".join(line + "\n" for line in lines if line)
    pathlib.Path(arguments.output).write_text(text, errors="surrogateescape")


if __name__ == "__main__":
    main()

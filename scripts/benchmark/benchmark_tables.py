"""The tables of docs/performance.md from the figures of scripts/benchmark/benchmark.py."""

STAGES = ("reading", "segmentation", "window", "batch", "covariance", "writing")
# A run that had less of its core than this did not have it for itself.
OWN_CORE_SHARE = 0.9


def make_tables(setup, results):
    """Text by group, for the groups of which every case that a table needs was measured."""
    makers = {"jobs": jobs_table, "factors": factors_table, "threads": threads_table,
              "long": long_table}
    tables = {}
    for group, make in makers.items():
        cases = [case for case in results.values() if case["group"] == group]
        lines = make(cases)
        if len(lines) > 2:
            notes = [measured_line(setup)] + busy_lines(cases)
            tables[group] = "\n".join([*notes, "", *lines])
    return tables


def measured_line(setup):
    return (f"Measured {setup['date']}: {setup['cpu']}, "
            f"{setup['cores']} cores, {setup['memory_gb']} GB, {setup['compiler']}, "
            f"{setup['build_type']}; medians of {setup['repeat']}.")


def busy_lines(cases):
    """A sentence when other processes took part of the core."""
    busy = [case["name"] for case in cases if case["threads"] == 1 and
            case["median"]["cpu_s"] < OWN_CORE_SHARE * case["median"]["wall_s"]]
    if not busy:
        return []
    return [f"The machine was busy with other things as well during: {'; '.join(busy)}."]


def row(cells):
    return "| " + " | ".join(map(str, cells)) + " |"


def header(cells):
    return [row(cells), "|" + "---|" * len(cells)]


def seconds(value):
    return "-" if value is None else f"{value:.2f}" if value < 10.0 else f"{value:.1f}"


def stage_cells(median):
    return [seconds(median["stages"].get(stage)) for stage in STAGES]


def tail_cells(median):
    return [seconds(median["wall_s"]), f"{median['real_time_factor']:.1f}",
            f"{median['peak_memory_mb']:.0f}"]


def jobs_table(cases):
    lines = header(["case", "recording / s", *[f"{stage} / s" for stage in STAGES],
                    "whole run / s", "times real time", "memory / MB"])
    return lines + [row([case["name"], f"{case['median']['duration_s']:.1f}",
                         *stage_cells(case["median"]), *tail_cells(case["median"])])
                    for case in cases]


def pairs(cases, key, first, second):
    """Cases of the same recording that differ in the key, both of which were measured."""
    def find(case, value):
        return next((other for other in cases if other[key] == value and
                     other["recording"] == case["recording"]), None)

    found = [(case, find(case, second)) for case in cases if case[key] == first]
    return [(a, b) for a, b in found if b is not None]


def factors_table(cases):
    lines = header(["recording", "points", "segments", "batch by point / s",
                    "batch by segment / s", "ratio", "memory by point / MB",
                    "memory by segment / MB", "ratio"])
    for point, segment in pairs(cases, "factor", "point", "segment"):
        a, b = point["median"], segment["median"]
        if "batch" not in a["stages"] or "batch" not in b["stages"]:
            continue
        lines.append(row([
            segment["name"].rsplit(",", 1)[0], f"{b['points']:,}", f"{b['segments']:,}",
            seconds(a["stages"]["batch"]), seconds(b["stages"]["batch"]),
            f"{a['stages']['batch'] / b['stages']['batch']:.1f}",
            f"{a['peak_memory_mb']:.0f}", f"{b['peak_memory_mb']:.0f}",
            f"{a['peak_memory_mb'] / b['peak_memory_mb']:.1f}"]))
    return lines


def threads_table(cases):
    lines = header(["recording", "one thread / s", "two threads / s", "ratio",
                    "same bytes in all runs"])
    for one, two in pairs(cases, "threads", 1, 2):
        digests = [run["digests"] for case in (one, two) for run in case["runs"]]
        same = bool(digests[0]) and all(other == digests[0] for other in digests)
        if two["median"]["num_cores"] < 2:
            time, ratio = "only one core", "-"
        else:
            time = seconds(two["median"]["wall_s"])
            ratio = f"{one['median']['wall_s'] / two['median']['wall_s']:.2f}"
        lines.append(row([one["name"].rsplit(",", 1)[0], seconds(one["median"]["wall_s"]), time,
                          ratio, "yes" if same else "**no**"]))
    return lines


def long_table(cases):
    lines = header(["recording / min", "beams", "planes", "segments",
                    *[f"{stage} / s" for stage in STAGES], "whole run / s", "times real time",
                    "memory / MB", "MB per minute"])
    for case in cases:
        median = case["median"]
        minutes = median["duration_s"] / 60.0
        lines.append(row([f"{minutes:.0f}", case["recording"]["beams"], median["planes"],
                          f"{median['segments']:,}",
                          *stage_cells(median), *tail_cells(median),
                          f"{median['peak_memory_mb'] / minutes:.0f}"]))
    return lines

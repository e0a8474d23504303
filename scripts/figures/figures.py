#!/usr/bin/python3
"""Draws the figures of the paper from results of this program, each as PNG and as PDF.

The paper: G. Vosselman, Design of an indoor mapping system using three 2D laser scanners and
6 DOF SLAM, ISPRS Annals II-3, 2014.
"""

import argparse
import sys

import matplotlib

matplotlib.use("Agg")
# pylint: disable=wrong-import-position
from figure_files import save
from floor_plan import InputError
from map_figures import draw_corridor, draw_office
from normal_matrix_figure import draw_normal_matrix
from precision_figures import draw_angles, draw_distances

FIGURES = {
    "normal_matrix": (draw_normal_matrix, "Figure 2: where the final normal matrix is filled"),
    "corridor": (draw_corridor, "Figure 3: building, path and one scan"),
    "angles": (draw_angles, "Figure 4: precision of angles between walls"),
    "distances": (draw_distances, "Figure 5: precision of distances between walls"),
    "office": (draw_office, "Figure 7: the point cloud without floor and ceiling"),
}


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    subparsers = parser.add_subparsers(dest="figure", required=True, metavar="FIGURE")
    for name, (_, description) in FIGURES.items():
        subparser = subparsers.add_parser(name, help=description, description=description)
        if name in ("angles", "distances"):
            subparser.add_argument("precision", metavar="PRECISION_JSON",
                                   help="file that scripts/analysis/precision.py --output wrote")
        else:
            subparser.add_argument("result", metavar="RESULT_DIR",
                                   help="directory that plumbline_map wrote")
        if name == "corridor":
            subparser.add_argument("truth", metavar="TRUTH_DIR",
                                   help="directory that plumbline_simulate wrote")
            subparser.add_argument("--evaluation", metavar="FILE",
                                   help="JSON file of plumbline_evaluate (default: "
                                   "evaluation.json in RESULT_DIR)")
        subparser.add_argument("--output", metavar="DIR", default="out/figures",
                               help="where to write the PNG and the PDF (default: %(default)s)")
    return parser.parse_args()


def main():
    arguments = parse_arguments()
    try:
        draw, _ = FIGURES[arguments.figure]
        save(draw(arguments), arguments.output, arguments.figure)
    except (InputError, OSError) as error:
        print(f"figures.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""The ``gapath-genotype`` command: whether S04's genotype can express a path on a grid."""

import argparse
import sys
from collections.abc import Sequence

from tabulate import tabulate

import gapath
from gapath.api import load_map
from gapath.errors import InputError, printable, require
from gapath.grid import Field, GridMap
from gapath.kernels.s04.genotype import MAX_SIDE, SWITCHES
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Problem
from gapath.survey.row_column import classify

TEXT = """\
Prove, for each grid, which of the genotypes of Sedighi et al. 2004 (S04) have a chromosome whose
path is free: row-wise ones (Geisler's planner), row- or column-wise ones (Hermanu's), and those
with at most two switches between the two (S04's). It decides by dynamic programming over all
chromosomes, so "no" means that no run of the planner can ever succeed. Switches are the fewest
that a free path takes, were there any number of them; where "none helps", there are paths, but
none that goes through the rows, or columns, one after another."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    argv : sequence of str, optional
        Arguments without the program's name; those of the process if not given.

    Returns
    -------
    int
        Exit code: 0, or 2 for bad input.
    """
    parser = argparse.ArgumentParser(
        prog="gapath-genotype",
        description=TEXT,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "maps",
        nargs="+",
        metavar="MAP",
        help="a map file (.txt grid, .map, ROS .yaml, .png) or one of gapath's own, as s04_sp07",
    )
    for name in ("start", "target"):
        corner = {"start": "upper left", "target": "lower right"}[name]
        parser.add_argument(
            f"--{name}",
            type=_field,
            metavar="X,Y",
            help=f"a field, (0, 0) top left (default: the map's own, else the {corner} corner)",
        )
    version = f"gapath-genotype {gapath.__version__}"
    parser.add_argument("--version", action="version", version=version)
    given = parser.parse_args(argv)
    try:
        rows = [_row(load_map(name), given.start, given.target) for name in given.maps]
    except InputError as error:
        print(f"gapath-genotype: {error}", file=sys.stderr)
        return 2
    print(tabulate(rows, headers="keys", disable_numparse=True))
    return 0


def _field(text: str) -> Field:
    try:
        x, y = (int(part) for part in text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"got {text!r}, expected two integers as 3,7") from None
    return x, y


def _row(grid: GridMap, start: Field | None, target: Field | None) -> dict[str, str]:
    start = start or grid.start or (0, 0)
    target = target or grid.target or (grid.cols - 1, grid.rows - 1)
    problem = Problem(grid, start, target, CornerCutting.NO_DIAGONALS)
    side = max(grid.rows, grid.cols)
    require(side <= MAX_SIDE, f"map {grid.name}", f"{side} fields a side", f"at most {MAX_SIDE}")
    found = classify(problem)
    any_path = shortest_path(problem).feasible
    fewest = found.switches
    switches = "-" if not any_path else "none helps" if fewest is None else str(fewest)

    def say(yes: bool) -> str:
        return "yes" if yes else "no"

    return {
        "map": printable(grid.name),
        "fields": f"{grid.cols} x {grid.rows}",
        "from": f"{start[0]},{start[1]}",
        "to": f"{target[0]},{target[1]}",
        "any path": say(any_path),
        "row-wise": say(found.row_wise),
        "column-wise": say(found.column_wise),
        "switches": switches,
        "geisler": say(found.row_wise),
        "hermanu": say(found.row_wise or found.column_wise),
        "sedighi": say(fewest is not None and fewest <= SWITCHES),
    }


if __name__ == "__main__":
    sys.exit(main())

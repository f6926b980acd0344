"""The command `gapath-report compare`."""

import argparse
import json
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from gapath.errors import InputError, one_of, require

MEASURES = {
    "success": ("success",),
    "evaluations": ("evaluations", "expected_evaluations"),
    "time": ("time", "expected_time"),
    "cost": ("cost",),
}
"""What `--measure` may name, and the quantities that belong to it."""

_ROWS = 12
"""Rows of a table in the terminal; its files have all."""


def parser() -> argparse.ArgumentParser:
    """Make the parser of its arguments."""
    made = argparse.ArgumentParser(
        "gapath-report compare",
        description="Say which of two or more groups of runs is best, and from which others it can "
        "be told apart: paired by map, start, target, seed and trial where they pair, with "
        "intervals, tests and Holm's correction. Writes CSV, Markdown, LaTeX and pictures.",
    )
    made.add_argument("outputs", type=Path, nargs="?", default=Path("outputs"), help="folder "
                      "with <experiment>/<key>/ [outputs]")  # fmt: skip
    made.add_argument("--by", metavar="NAME", help="what tells the groups apart: a setting as "
                      "planner.population, or method, preset, experiment")  # fmt: skip
    made.add_argument("--where", action="append", default=[], metavar="SQL", help="with --by: "
                      "only runs that fulfil it; without: a group, so two or more")  # fmt: skip
    made.add_argument("--measure", default="all", metavar="LIST", help="of success, evaluations, "
                      "time, cost, joined by commas [all]")  # fmt: skip
    made.add_argument("-o", "--output", type=Path, metavar="DIR", help="where to write "
                      "[OUTPUTS/compare/<name>]")  # fmt: skip
    made.add_argument("--json", action="store_true", help="print numbers and sentences as JSON")
    return made


def run(arguments: Sequence[str]) -> None:
    """Compare, print what was found, and write it.

    Parameters
    ----------
    arguments : sequence of str
        What stands behind ``gapath-report compare``.

    Raises
    ------
    InputError
        If the arguments are wrong, or the runs make no two groups.
    """
    given = parser().parse_args(list(arguments))
    measures = list(MEASURES) if given.measure == "all" else given.measure.split(",")
    for measure in measures:
        require(measure in MEASURES, "--measure", measure, one_of(measure, MEASURES))
    quantities = [each for measure in measures for each in MEASURES[measure]]
    folder = given.output or given.outputs / "compare" / _name(given.by, given.where)
    # SciPy, pandas and matplotlib take a second to start
    from gapath.pipelines.compare.answer import Answer, answer

    found: Answer = answer(given.outputs, given.by, given.where, quantities)
    for name, reason in found.choice.left_out:
        print(f"left out {name}: {reason}", file=sys.stderr)
    files = found.files()
    try:
        from gapath.store.durable import write_whole

        folder.mkdir(parents=True, exist_ok=True)
        for name, content in files:
            write_whole(folder / name, content)
    except OSError as error:
        raise InputError(folder, error.strerror, "a folder that can be written") from error
    if given.json:
        print(json.dumps(found.plain(), indent=1))
        return
    print(found.text(_ROWS))
    print(f"{len(files)} files in {folder}; read {folder / 'comparison.md'}")


def _name(by: str | None, wheres: Sequence[str]) -> str:
    words: list[Any] = [*([by] if by else []), *wheres]
    return "_".join(re.sub(r"[^\w.]+", "-", word).strip("-") for word in words)[:80]

"""The command `gapath-report compare`."""

import argparse
import hashlib
import json
import re
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from gapath.errors import InputError, one_of, printable, require

MEASURES = {
    "success": ("success",),
    "evaluations": ("evaluations", "expected_evaluations"),
    "time": ("time", "expected_time"),
    "cost": ("cost",),
}
"""What `--measure` may name, and the quantities that belong to it."""

PAGE = "comparison.md"
"""The file that holds all of an answer, and leads to its others."""

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
    made.add_argument("--by", action="append", default=[], metavar="NAME", help="what tells the "
                      "groups apart: a setting as planner.population, or method, preset, "
                      "experiment")  # fmt: skip
    made.add_argument("--where", action="append", default=[], metavar="SQL", help="with --by: "
                      "only runs that fulfil it; without: a group, so two or more")  # fmt: skip
    made.add_argument("--measure", default="all", metavar="LIST", help="of success, evaluations, "
                      "time, cost, joined by commas [all]")  # fmt: skip
    made.add_argument("-o", "--output", type=Path, metavar="DIR", help="where to write "
                      "[OUTPUTS/compare/<name>]")  # fmt: skip
    made.add_argument("--json", action="store_true", help="print numbers and sentences as JSON")
    return made


def run(arguments: Sequence[str]) -> None:
    """Compare, print what was found, then write it.

    Parameters
    ----------
    arguments : sequence of str
        What stands behind ``gapath-report compare``.

    Raises
    ------
    InputError
        If the arguments are wrong, the runs make no two groups, or nothing can be written.
    """
    given = parser().parse_args(list(arguments))
    require(len(given.by) <= 1, "--by", ", ".join(given.by), "one name")
    by = given.by[0] if given.by else None
    measures = list(MEASURES) if given.measure == "all" else given.measure.split(",")
    for measure in measures:
        require(measure in MEASURES, "--measure", measure, one_of(measure, MEASURES))
    quantities = [each for measure in measures for each in MEASURES[measure]]
    folder = given.output or given.outputs / "compare" / _name(by, given.where)
    # SciPy, pandas and matplotlib take a second to start
    from gapath.pipelines.compare.answer import Answer, answer

    found: Answer = answer(given.outputs, by, given.where, quantities)
    _name_left_out(found.choice.left_out)
    print(json.dumps(found.plain(), indent=1) if given.json else found.text(_ROWS), flush=True)
    files = dict(found.files())
    try:
        _write(folder, files)
    except OSError as error:
        raise InputError(folder, error.strerror, "a folder that can be written") from error
    if not given.json:
        print(printable(f"{len(files)} files in {folder}; read {folder / PAGE}"))


def _name_left_out(runs: Sequence[tuple[str, str]]) -> None:
    """Name the runs that were left out; many with one reason in one line."""
    by_reason: dict[str, list[str]] = {}
    for name, reason in runs:
        by_reason.setdefault(reason, []).append(name)
    for reason, names in by_reason.items():
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        print(printable(f"left out {names[0]}{more}: {reason}"), file=sys.stderr)


def _write(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write an answer's files, and remove those that only an older answer there had."""
    from gapath.pipelines.compare.answer import NAMES
    from gapath.store.durable import write_whole

    older = NAMES.difference(files) if (folder / PAGE).exists() else ()
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in files.items():
        write_whole(folder / name, content)
    for name in older:
        (folder / name).unlink(missing_ok=True)


def _name(by: str | None, wheres: Sequence[str]) -> str:
    """Name a question's folder: to be read, with a hash where that does not say all of it."""
    words = [*([by] if by else []), *wheres]
    text = "_".join(re.sub(r"[^\w.]+", "-", word).strip("-") for word in words)[:80]
    whole = json.dumps([by, *wheres]).encode()
    return text if text == by else f"{text}_{hashlib.sha256(whole).hexdigest()[:6]}"

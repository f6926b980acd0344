"""``python -m benchmarks --output DIR [--quick] [QUESTION ...]``: as CSV and one page."""

import argparse
import csv
import sys
import time
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

from tabulate import tabulate

from benchmarks.measure import Quartiles, Row, machine
from benchmarks.targets import TARGETS, judge

_PLACES = (
    "kg18.fitness",
    "kg18.ga_run",
    "kg18.tricks",
    "kg18.epochs",
    "s04.row_column",
    "m22.visibility",
    "m22.visibility_growth",
    "m22.visibility_agreement",
    "exact",
    "kg18.growth",
    "kg18.growth_settings",
    "kg18.threads",
    "kg18.sweep",
    "kg18.logging",
    "kg18.drives",
    "field.field_movingai",
    "field.field_test4",
    "field.field_large",
    "field.field_drives",
    "field.field_calls",
    "field.field_found",
    "field.field_ablation",
    "asking",
    "cold_start",
    "engines",
)

QUESTIONS = {place.rpartition(".")[2]: place for place in _PLACES}
"""Names of the questions, in order, and their modules in `benchmarks.questions`."""

INDEX = "questions.csv"
"""The questions of the last run, written when all have been answered."""

TARGET_COLUMNS = ("what", "target", "measured", "met")


def question(name: str) -> ModuleType:
    """Import a question."""
    return import_module(f"benchmarks.questions.{QUESTIONS[name]}")


def columns(rows: list[Row]) -> list[str]:
    """List the columns of a table in the order in which they first appear."""
    return list(dict.fromkeys(name for row in rows for name in row))


def write_csv(path: Path, rows: list[Row]) -> None:
    """Write a table with all its digits; a median's quartiles stand in columns of their own."""
    flat: list[Row] = []
    for row in rows:
        cells: Row = {}
        for name, value in row.items():
            cells[name] = value.median if isinstance(value, Quartiles) else value
            if isinstance(value, Quartiles):
                cells |= {f"{name} q1": value.lower, f"{name} q3": value.upper}
        flat.append(cells)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns(flat))
        writer.writeheader()
        writer.writerows(flat)


def cell(value: Any) -> str:
    """Write a value for people: three digits; a median with its quartiles."""
    if isinstance(value, Quartiles):
        return f"{cell(value.median)} [{cell(value.lower)}, {cell(value.upper)}]"
    if isinstance(value, float):
        return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"
    return "" if value is None else str(value)


def table(rows: list[Row]) -> str:
    """Write a table as Markdown."""
    names = columns(rows)
    cells = [[cell(row.get(name)) for name in names] for row in rows]
    return str(tabulate(cells, names, tablefmt="github", disable_numparse=True))


def ask(names: list[str], quick: bool, folder: Path) -> dict[str, list[Row]]:
    """Answer questions one after the other; print and write the rows of each."""
    answers = {}
    for number, name in enumerate(names, 1):
        print(f"{number}/{len(names)} {name} ...", file=sys.stderr, flush=True)
        begin = time.perf_counter()
        rows = answers[name] = question(name).measure(quick)
        write_csv(folder / f"{name}.csv", rows)
        print(f"\n{name}, {time.perf_counter() - begin:.1f} s\n{table(rows)}\n", flush=True)
    return answers


def write_page(folder: Path, about: Row, answers: dict[str, list[Row]]) -> None:
    """Write the page: targets, machine, every question; and what else `gapath-report` reads."""
    targets = [judge(target, answers) for target in TARGETS]
    shown = table([{name: row[name] for name in TARGET_COLUMNS} for row in targets])
    texts = {name: str(question(name).__doc__).strip() for name in answers}
    page = [
        f"# gapath benchmarks ({about['kind']})",
        shown,
        "Medians with [lower quartile, upper quartile]; times are wall times.",
        table([about]),
    ]
    for name, rows in answers.items():
        page += [f"## {name}", texts[name], table(rows)]
    (folder / "README.md").write_text("\n\n".join(page) + "\n", encoding="utf-8")
    write_csv(folder / "targets.csv", targets)
    write_csv(folder / "machine.csv", [about])
    write_csv(folder / INDEX, [{"question": name, "text": text} for name, text in texts.items()])
    print(f"targets\n{shown}\n")


def main() -> None:
    """Answer the questions, print the tables and write them."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    parser.add_argument("--output", type=Path, required=True, help="folder of the results")
    parser.add_argument("--quick", action="store_true", help="few repetitions: a check, no figures")
    known = ", ".join(QUESTIONS)
    parser.add_argument("questions", nargs="*", metavar="QUESTION", help=f"of {known} [all]")
    given = parser.parse_args()
    for name in given.questions:  # argparse's choices refuse that none is named
        if name not in QUESTIONS:
            parser.error(f"QUESTION {name}: no such question; choose from {known}")
    try:
        given.output.mkdir(parents=True, exist_ok=True)
        (given.output / INDEX).unlink(missing_ok=True)  # results old and new belong to no one run
    except OSError as error:
        parser.error(f"--output {given.output}: {error.strerror}; give a folder to write to")
    about = {"kind": "quick, not to be quoted" if given.quick else "full", **machine()}
    names = [name for name in QUESTIONS if name in given.questions or not given.questions]
    write_page(given.output, about, ask(names, given.quick, given.output))
    print(f"{given.output}: {', '.join(['README.md', *(f'{name}.csv' for name in names)])}")


if __name__ == "__main__":
    main()

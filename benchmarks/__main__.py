"""``python -m benchmarks --output DIR [--quick]``: every question, as CSV and one page."""

import argparse
import csv
import sys
import time
from importlib import import_module
from pathlib import Path
from typing import Any

from tabulate import tabulate

from benchmarks.measure import Quartiles, Row, machine

QUESTIONS = (
    "ga_run",
    "row_column",
    "visibility",
    "visibility_growth",
    "visibility_agreement",
    "exact",
    "sweep",
    "logging",
    "drives",
    "cold_start",
)


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
    return tabulate(cells, names, tablefmt="github", disable_numparse=True)


def main() -> None:
    """Answer every question, print the tables and write them."""
    parser = argparse.ArgumentParser(prog="benchmarks", description=__doc__)
    parser.add_argument("--output", type=Path, required=True, help="folder of the results")
    parser.add_argument("--quick", action="store_true", help="few repetitions: a check, no figures")
    given = parser.parse_args()
    try:
        given.output.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        parser.error(f"--output {given.output}: {error.strerror}; give a folder to write to")

    kind = "quick, not to be quoted" if given.quick else "full"
    page = [f"# gapath benchmarks ({kind})", table([machine()])]
    page.append("Times are wall times: median [lower quartile, upper quartile].")
    for number, name in enumerate(QUESTIONS, 1):
        print(f"{number}/{len(QUESTIONS)} {name} ...", file=sys.stderr, flush=True)
        begin = time.perf_counter()
        question = import_module(f"benchmarks.{name}")
        rows = question.measure(given.quick)
        write_csv(given.output / f"{name}.csv", rows)
        print(f"\n{name}, {time.perf_counter() - begin:.1f} s\n{table(rows)}\n", flush=True)
        page += [f"## {name}", question.__doc__.strip(), table(rows)]
    (given.output / "README.md").write_text("\n\n".join(page) + "\n", encoding="utf-8")
    names = ", ".join(["README.md", *(f"{name}.csv" for name in QUESTIONS)])
    print(f"{given.output}: {names}")


if __name__ == "__main__":
    main()

"""Which numbers of the pages do new runs no longer give? `make numbers` asks."""

import argparse
import re
import shutil
import sys
import tempfile
from pathlib import Path

import bound

from gapath.pipelines.asking.answer import write_csv
from gapath.pipelines.asking.sql import asked
from gapath.pipelines.reading.frame import described
from gapath.store.records import MANIFEST, find_runs

LAST = "questions.csv"
"""What `python -m benchmarks` writes when it has answered all that it was asked."""


def asked_anew(outputs, folder):
    """Ask each question of `docs/results` to the runs; tables of those that have any."""
    runs = find_runs(outputs)
    frame, _ = described(runs)
    counts = (frame["fault"].isna() & frame["superseded"].isna()).to_numpy()
    for question in sorted((bound.ROOT / bound.RESULTS).glob("*.sql")):
        text = question.read_text("utf-8")
        of = frame["experiment"].isin(re.findall(r"'(\w+)'", text)).to_numpy() & counts
        if not of.any():
            print(f"{question.stem}: no such runs, left as it is")
            continue
        chosen = [run for run, wanted in zip(runs, of, strict=True) if wanted]
        answer, bad = asked(text, frame[of], chosen)
        if bad:
            sys.exit(f"{question.stem}: cannot read {', '.join(bad)}")
        with (folder / f"{question.stem}.csv").open("w", encoding="utf-8", newline="") as file:
            write_csv(answer, file)


def measured_anew(outputs, folder):
    """Copy what `make bench` measured; tells whether it answered all of its questions."""
    if not (outputs / bound.BENCH / LAST).is_file():
        print(f"{bound.BENCH}: no results, left as they are")
        return False
    shutil.copytree(outputs / bound.BENCH, folder / bound.BENCH)
    (folder / bound.BENCH / "README.md").unlink()
    return True


def accept(folder, pages, wrong):
    """Take new tables, and write their numbers into the pages."""
    shutil.copytree(folder, bound.ROOT / bound.RESULTS, dirs_exist_ok=True)
    for fault in sorted(wrong, key=lambda fault: fault.start, reverse=True):
        if fault.value is not None:
            page, end = pages[fault.where], fault.start + len(fault.shown)
            pages[fault.where] = page[: fault.start] + fault.value + page[end:]
    for name, text in pages.items():
        (bound.ROOT / name).write_text(text, "utf-8")


def main():
    """Tell a line a number that changed; exit code 1 if there are any that were not accepted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("outputs", type=Path, help="folder with <experiment>/<key>/")
    parser.add_argument("--accept", nargs="*", metavar="TABLE", help="take these tables, or all")
    given = parser.parse_args()
    numbers, whole = bound.read()
    pages = bound.read_pages(numbers, whole)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        if not measured_anew(given.outputs, folder) or any(given.outputs.glob(f"*/*/{MANIFEST}")):
            asked_anew(given.outputs, folder)
        if given.accept is not None and "all" not in given.accept:
            for table in folder.rglob("*.csv"):
                if table.stem not in given.accept:
                    table.unlink()
        wrong = bound.faults(numbers, pages, bound.tables(bound.ROOT / bound.RESULTS, folder))
        if given.accept is not None:
            accept(folder, pages, wrong)
    for fault in wrong:
        print(fault)
    taken = given.accept is not None
    print(f"{len(wrong)} numbers changed{', and are written' if taken else ''}")
    sys.exit(any(fault.value is None or not taken for fault in wrong))


if __name__ == "__main__":
    main()

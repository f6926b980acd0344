"""Targets are held against what was measured, and `python -m benchmarks` says what came of it."""

import csv
import sys

import pytest

from benchmarks import __main__
from benchmarks.measure import Quartiles
from benchmarks.questions.kg18 import drives, growth_settings
from benchmarks.targets import TARGETS, Target, column, epochs_of, judge

FEWER = Target("fewer", "exact", "<=", 2.0, column("us", map="a"), "us")
MORE = Target("more", "exact", ">=", 2.0, column("us", map="a"))


def rows(*values, **cells):
    return {"exact": [{"map": "a", "us": value} | cells for value in values]}


@pytest.mark.parametrize(
    ("target", "values", "measured", "met"),
    [
        (FEWER, (1.0, 2.0), 2.0, "met"),
        (FEWER, (2.1, 1.0), 2.1, "missed"),
        (MORE, (3.0, 2.0), 2.0, "met"),
        (MORE, (3.0, 1.9), 1.9, "missed"),
        (FEWER, (Quartiles(1.9, 1.0, 5.0), Quartiles(1.8, 1.7, 9.0)), (1.9, 1.0, 5.0), "met"),
        (MORE, (Quartiles(1.9, 1.8, 5.0), Quartiles(9.0, 1.0, 9.5)), (1.9, 1.8, 5.0), "missed"),
    ],
)
def test_the_worst_median_counts(target, values, measured, met):
    row = judge(target, rows(*values))
    assert (row["measured"], row["met"]) == (measured, met)
    assert row["target"] == ("<= 2 us" if target is FEWER else ">= 2")


def test_a_miss_says_why_where_that_is_known():
    target = MORE._replace(why="it is slow")
    assert judge(target, rows(1.9))["met"] == "missed: it is slow"
    assert judge(target, rows(2.0))["met"] == "met"


def test_only_the_rows_asked_for_count():
    other = rows(0.1, map="b")["exact"] + [{"map": "a", "ms": 0.1}]
    assert judge(MORE, {"exact": [*rows(3.0)["exact"], *other]})["measured"] == 3.0
    assert judge(MORE, {"exact": other})["met"] == "not measured: not in this form"


def test_what_was_not_measured_says_why():
    assert judge(MORE, {"drives": []})["met"] == "not measured: exact was not run"
    skipped = {"exact": [{"map": "a", "time": "skipped: no compiler"}, *rows(9.0)["exact"]]}
    row = judge(MORE, skipped)
    assert row["met"] == "not measured: skipped: no compiler"
    assert row["measured"] is None


def test_a_library_is_known_by_its_name_without_the_version():
    libraries = [
        {"library": "gapath 0.1", "library / gapath": 1.0},
        {"library": "deap 1.4", "library / gapath": 50.0},
        {"library": "pygad", "us an epoch": "skipped: not installed"},
    ]
    assert epochs_of("deap")(libraries) == [50.0]
    assert epochs_of("pygad")(libraries) == ["skipped: not installed"]


def test_targets_are_told_apart():
    whats = [target.what for target in TARGETS]
    assert len(whats) == len(set(whats))


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """Run `python -m benchmarks` with drives that are made up and with a real question."""
    made_up = [
        {"map": "kg18_map1", "navigator": "kg18", "drive ms": Quartiles(1.5, 1.4, 1.6)},
        {"map": "kg18_map1", "navigator": "kg18_fast", "drive ms": Quartiles(1.5, 1.4, 1.6)},
    ]
    monkeypatch.setattr(drives, "measure", lambda quick: made_up)
    monkeypatch.setattr(growth_settings, "VARIED", {"population": (25, 50)})

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["benchmarks", "--output", str(tmp_path), *arguments])
        __main__.main()
        return tmp_path

    return run


def read(path):
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_page_begins_with_the_targets(bench):
    folder = bench("--quick", "drives", "growth_settings")
    page = (folder / "README.md").read_text("utf-8").split("\n\n")
    assert page[0] == "# gapath benchmarks (quick, not to be quoted)"
    cells = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page[1].split("\n")]
    head, _, *lines = cells
    assert head == ["what", "target", "measured", "met"]
    assert len(lines) == len(TARGETS)
    assert ["a drive on unknown map 1, KG18", "<= 2 ms", "1.5 [1.4, 1.6]", "met"] in lines
    assert ["a drive on unknown map 1, KG18 fast", "<= 1 ms", "1.5 [1.4, 1.6]", "missed"] in lines
    assert [line[2:] for line in lines if line[0].startswith("the command")] == [
        ["", "not measured: cold_start was not run"]
    ] * 2
    (fast,) = [row for row in read(folder / "targets.csv") if row["what"].endswith("fast")]
    assert (fast["question"], fast["measured q3"], fast["met"]) == ("drives", "1.6", "missed")


def test_only_the_questions_that_were_named_are_asked(bench, capsys):
    folder = bench("--quick", "growth_settings", "drives", "drives")
    asked = [row["question"] for row in read(folder / "questions.csv")]
    assert asked == [name for name in __main__.QUESTIONS if name in ("drives", "growth_settings")]
    (machine,) = read(folder / "machine.csv")
    assert machine["kind"] == "quick, not to be quoted" and machine["CPU"] and machine["numba"]
    assert "2/2 drives" in capsys.readouterr().err
    bench("drives")
    assert [row["question"] for row in read(folder / "questions.csv")] == ["drives"]
    assert read(folder / "machine.csv")[0]["kind"] == "full"


def test_an_unknown_question_is_one_line_and_exit_code_2(bench, capsys, tmp_path):
    with pytest.raises(SystemExit) as ended:
        bench("drives", "fitnes")
    assert ended.value.code == 2
    assert "QUESTION fitnes: no such question; choose from fitness, " in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_breaks_off_leaves_no_list_of_questions(bench, monkeypatch, tmp_path):
    bench("--quick", "drives")

    def disagree(quick):
        raise RuntimeError("rivals disagree")

    monkeypatch.setattr(drives, "measure", disagree)
    with pytest.raises(RuntimeError, match="rivals disagree"):
        bench("drives")
    assert (tmp_path / "drives.csv").exists() and not (tmp_path / "questions.csv").exists()

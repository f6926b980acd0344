"""The page of the benchmarks, from what `python -m benchmarks` writes."""

import sys

import pandas as pd
import pytest

from benchmarks import __main__
from benchmarks.measure import MAPS, SETTINGS, Quartiles
from benchmarks.questions import exact
from benchmarks.questions.kg18 import drives, growth, growth_settings
from benchmarks.questions.m22 import visibility
from gapath.pipelines.bench import figure_map_size as bench_figure_map_size
from gapath.pipelines.bench import figure_settings as bench_figure_settings
from gapath.pipelines.report.bench import make_bench_page
from gapath.pipelines.report.cli import main

from .test_report import Page

pytestmark = pytest.mark.usefixtures("undrawn")

GROWTH = [
    {
        "class": name, "size": size, "planner": planner, "found": float(name != MAPS[3]),
        "GA us": Quartiles(us, us - 1, us + 1), "A* us": Quartiles(2.5 * us, 2 * us, 3 * us),
    }
    for name in MAPS
    for size, us in (("100 x 50", 20.0), ("400 x 200", 1234567.8))
    for planner in SETTINGS
]  # fmt: skip
SETTING = [
    {"setting": setting, "value": value, "us an epoch": Quartiles(float(value), 1.0, 99.0)}
    for setting in ("population", "control_points")
    for value in (3, 30)
]
MADE_UP = {
    drives: [{"map": MAPS[0], "reached": 3, "log MB": 0.25}, {"map": "all", "log MB": None}],
    exact: [{"map": "<b>", "peer": "A*", "solve us": Quartiles(5.0, 5.0, 5.0), "as": "1.10"}],
    growth: GROWTH,
    growth_settings: SETTING,
    visibility: [
        {"work": "a line", "its time": "skipped: no library"},
        {"work": "a path", "its time": Quartiles(0.123456, 0.1, 0.2)},
    ],
}


@pytest.fixture
def bench(tmp_path, monkeypatch):
    """Run the benchmarks with answers that are made up; give the folder of outputs."""
    for module, rows in MADE_UP.items():
        monkeypatch.setattr(module, "measure", lambda quick, rows=rows: rows)

    def run(*arguments):
        folder = tmp_path / "bench"
        monkeypatch.setattr(sys, "argv", ["benchmarks", "--output", str(folder), *arguments])
        __main__.main()
        return tmp_path

    return run


ALL = ("drives", "exact", "growth", "growth_settings", "visibility")


def page_of(outputs):
    assert main([str(outputs)]) == 0
    return (outputs / "report" / "bench.html").read_text("utf-8")


@pytest.mark.drawn
def test_every_answer_is_a_section_with_its_files(bench):
    outputs = bench(*ALL)
    page = page_of(outputs)
    tags = Page(page)
    anchors = [attrs["id"] for attrs in tags.all("section")]
    assert anchors == ["targets", "visibility", "exact", "growth", "growth_settings", "drives",
                       "machine"]  # fmt: skip
    for attrs in tags.all("a"):
        target = attrs["href"]
        there = target[1:] in (*anchors, "content")
        assert there or (outputs / "report" / target).is_file()
    assert len(tags.all("img")) == 2
    assert all(len(attrs["alt"]) > 40 for attrs in tags.all("img"))
    assert "python -m benchmarks --output DIR growth_settings" in page
    assert "&lt;b&gt;" in page and "<b>" not in page.partition("<script>")[0]
    assert "not to be quoted" not in page and "--quick" not in page
    assert "GA 1-3 against A* as maps grow" in page  # the docstring
    assert "<li>&#34;found&#34; is the share of runs" in page


def test_quick_results_say_so_everywhere(bench):
    outputs = bench("--quick", *ALL)
    page = page_of(outputs)
    assert page.count("Quick, not to be quoted") == 1 + 6 + 2  # the page, tables, figures
    assert "Quick, not to be quoted" in (outputs / "report" / "bench_growth.md").read_text("utf-8")
    assert "python -m benchmarks --output DIR --quick exact" in page


def test_the_machine_is_named(bench):
    outputs = bench("exact")
    machine = pd.read_csv(outputs / "bench" / "machine.csv", dtype=str).iloc[0]
    page = page_of(outputs)
    for name in ("CPU", "cores", "Python", "numba"):
        assert f'<th scope="row">{name}</th><td>{machine[name]}</td>' in page


def test_cells_are_for_people(bench):
    outputs = bench(*ALL)
    page_of(outputs)

    def lines(name):
        text = (outputs / "report" / f"bench_{name}.md").read_text("utf-8").split("\n")
        return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text[2:]]

    fixed = "\N{NO-BREAK SPACE}"
    low, middle, high = (f"1 234 {end}".replace(" ", "\u202f")
                         for end in (567, 568, 569))  # fmt: skip
    assert lines("visibility")[:2] == [
        ["a line", "skipped: no library"],
        ["a path", f"0.123 (0.1 to{fixed}0.2)"],
    ]
    assert lines("drives")[:2] == [[MAPS[0], "3", "0.25"], ["all", "", ""]]
    assert lines("exact")[0] == ["&lt;b>", "A*", "5", "1.1"]
    assert lines("growth")[3][4] == f"{middle} ({low} to{fixed}{high})"
    kept = pd.read_csv(outputs / "report" / "bench_growth.csv")
    assert kept["GA us q3"].max() == 1234568.8  # all digits


def test_the_targets_come_first(bench):
    page = page_of(bench("exact"))
    assert page.index("not measured: drives was not run") < page.index('<section id="exact">')


def test_a_question_that_was_not_run_again_is_not_shown(bench):
    bench("drives", "exact")
    page = page_of(bench("exact"))
    assert 'id="exact"' in page and 'id="drives"' not in page


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("growth_settings.csv", None, "growth_settings.csv: got no file"),
        ("growth_settings.csv", "", "growth_settings.csv: got EmptyDataError"),
        ("growth_settings.csv", "setting\na\n", "growth_settings.csv: got no column us an epoch, "),
        ("exact.csv", "map,peer\n", "exact.csv: got no rows"),
        ("exact.csv", b"map\n\xff\n", "exact.csv: got UnicodeDecodeError"),
        ("questions.csv", "question,text\n../a,b\nexact,b\n", "questions.csv, question: got ../a"),
    ],
)
def test_a_table_that_cannot_be_read_is_named_and_the_rest_goes_on(
    bench, capsys, name, content, reason
):
    outputs = bench("exact", "growth_settings")
    path = outputs / "bench" / name
    path.unlink()
    if content is not None:
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
    page = page_of(outputs)
    assert f"left out bench: {reason}" in capsys.readouterr().err
    assert page.count("<section") == 3  # the targets, what is left, the machine


@pytest.mark.parametrize("name", ["questions.csv", "machine.csv", "targets.csv"])
def test_a_run_that_broke_off_is_left_out(bench, capsys, name):
    outputs = bench("exact")
    (outputs / "bench" / name).unlink()
    files, (skipped,) = make_bench_page(outputs / "bench")
    assert files == [] and name in skipped.reason
    assert main([str(outputs)]) == 2
    assert "no runs" in capsys.readouterr().err


def test_the_page_stands_beside_that_of_the_runs(bench, make_run):
    outputs = bench("exact")
    make_run(outputs, "plan", "kg18_test1", "ga3", n=1, log=False)
    page_of(outputs)
    index = (outputs / "report" / "index.html").read_text("utf-8")
    assert [a for a in Page(index).all("a") if a["href"] == "bench.html"]
    assert "Left out" not in index
    (outputs / "bench" / "exact.csv").unlink()
    page_of(outputs)
    left_out = (outputs / "report" / "index.html").read_text("utf-8").partition("Left out")[2]
    assert "exact.csv" in left_out


def test_without_benchmarks_nothing_links_to_them(tmp_path, make_run):
    make_run(tmp_path, "plan", "kg18_test1", "ga3", n=1, log=False)
    assert main([str(tmp_path)]) == 0
    assert "bench.html" not in (tmp_path / "report" / "index.html").read_text("utf-8")
    assert not (tmp_path / "report" / "bench.html").exists()


def test_the_same_results_give_the_same_page(bench):
    outputs = bench("exact", "growth_settings")
    first, again = (dict(make_bench_page(outputs / "bench")[0]) for _ in range(2))
    assert first == again and list(first)[-1] == "bench.html"


def frame(rows):
    """Read rows as the page does."""
    flat = [
        {key: cell for name, value in row.items() for key, cell in
         (zip((name, f"{name} q1", f"{name} q3"), value, strict=True)
          if isinstance(value, Quartiles) else [(name, value)])}
        for row in rows
    ]  # fmt: skip
    return pd.DataFrame(flat)


def test_the_figures_say_where_nothing_was_found():
    figure = bench_figure_map_size.figure(frame(GROWTH))
    assert "Map 3, GA 1: 20 to 1\u202f234\u202f568 us, found 100 %" in figure.alt
    assert "Map 4, GA 3: 20 to 1\u202f234\u202f568 us, found 0 %" in figure.alt
    assert "Map 1, A*: 50 to" in figure.alt
    found = bench_figure_map_size.figure(frame([row | {"found": 1.0} for row in GROWTH]))
    assert found.svg != figure.svg


@pytest.mark.drawn
def test_the_settings_have_a_panel_each():
    figure = bench_figure_settings.figure(frame(SETTING))
    assert "population 3 to 30: 3 to 30 us. control points 3 to 30: 3 to 30 us." in figure.alt
    alone = bench_figure_settings.figure(frame(SETTING[:2]))
    assert "control" not in alone.alt

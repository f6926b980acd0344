"""What of a table the page knows, how figures follow its colours, and the library that it holds."""

import hashlib
import math
import re
import tomllib
from pathlib import Path

import matplotlib
import pandas as pd
import pytest

from gapath.pipelines.numbers.text import middle, number, percent, percent_range
from gapath.pipelines.page.figures import INK, looks, panels, picture_of, render, style
from gapath.pipelines.page.page import script, template
from gapath.pipelines.page.page import style as style_sheet
from gapath.pipelines.page.rows import number_in, numeric, rows_of, width_of
from gapath.pipelines.page.section import Table

ROOT = Path(__file__).parents[3]
VENDOR = ROOT / "pipelines" / "page" / "vendor"
NARROW, FIXED = "\N{NARROW NO-BREAK SPACE}", "\N{NO-BREAK SPACE}"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("12", 12), ("-3.5", -3.5), ("\N{MINUS SIGN}2", -2), ("+8.3", 8.3), ("1e-05", 1e-5),
        (number(1234567), 1234567), (f"1{NARROW}234 (1 to{FIXED}2)", 1234),
        (middle(12, 10, 14), 12), (percent_range((0.5, 0.75)), 50), ("12\N{EN DASH}14", 12),
        ("64.9 % (62-68)", 64.9), ("64.9%", 64.9), ("2 of 3", 2), ("30; 2 never left", 30),
        ("0.03, 0.04", 0.03), ("∞", math.inf), ("-∞", -math.inf),
        ("\N{EN DASH}", None), ("", None), ("N.F.", None), ("GA 1", None), ("2nd", None),
        ("2026-01-01", None), ("(3, 4)", None), ("8room_000", None), ("yes", None),
    ],
)  # fmt: skip
def test_a_cell_is_worth_the_number_that_it_begins_with(text, value):
    assert number_in(text) == value


def test_what_is_less_comes_before_and_what_is_more_after():
    below, above = number_in(percent(0.0001)), number_in(percent(0.9999))
    assert 0 < below < number_in(percent(0.001)) == 0.1
    assert number_in(percent(0.999)) == 99.9 < above < 100


def test_a_column_of_numbers_may_miss_some():
    assert numeric(["\N{EN DASH}", "", "3", "∞"])
    assert numeric(["N.F., 3.1", "2.5", "1"])
    assert not numeric(["N.F.", "2.5"])
    assert not numeric(["GA 1", "GA 2"])
    assert not numeric(["\N{EN DASH}", ""])


def test_heads_are_in_every_row_and_marked_where_they_repeat():
    shown = pd.DataFrame({
        "Experiment": ["a", "a", "a", "b", "b"],
        "Map": ["m", "m", "n", "n", "n"],
        "Planner": ["x", "y", "y", "y", "y"],
        "Time": ["1", "\N{EN DASH}", "∞", "1\N{NARROW NO-BREAK SPACE}000", "2 (1 to 3)"],
    })  # fmt: skip
    rows = rows_of(Table("t", "T.", shown, shown, heads=3))
    assert [[cell.text for cell in row.cells] for row in rows] == shown.to_numpy().tolist()
    again = [[cell.again for cell in row.cells] for row in rows]
    assert again == [
        [False, False, False, False],
        [True, True, False, False],
        [True, False, False, False],
        [False, False, False, False],  # another experiment's map n
        [True, True, False, False],  # the last head is the row's own, and stays
    ]
    assert [row.first for row in rows] == [True, False, False, True, False]
    assert [row.cells[3].order for row in rows] == ["1.0", "", "Infinity", "1000.0", "2.0"]
    assert {row.cells[2].order for row in rows} == {None}
    alone = rows_of(Table("t", "T.", shown, shown, heads=1))
    assert not any(cell.again for row in alone for cell in row.cells)
    assert not any(row.first for row in alone)


def shown_page(table):
    return template("table.html.j2").module.show(table, lambda keys: f"to/{'+'.join(keys)}")


def test_rows_lead_to_their_runs_and_a_table_whose_order_means_something_is_not_sorted():
    shown = pd.DataFrame({"Map": ["<m>", "n"], "Time": ["1", "2"]})
    table = Table("t", "T.", shown, shown, heads=1, runs=(("k1",), ("k1", "k2")))
    html = shown_page(table)
    assert re.findall(r'<a href="(.*?)">(.*?)</a>', html) == [
        ("to/k1", "&lt;m&gt;"),
        ("to/k1+k2", "n"),
    ]
    assert "data-sortable" in html and 'data-kind="number">Time' in html
    fixed = Table("t", "T.", shown, shown, heads=1, sortable=False)
    assert "data-sortable" not in shown_page(fixed) and "<a" not in shown_page(fixed)
    assert "data-sortable" not in shown_page(Table("t", "T.", shown[:1], shown[:1]))
    assert "No" not in shown_page(Table("t", "T.", shown[:0], shown[:0]))  # without a row, too


def test_a_long_word_does_not_make_a_wide_column():
    assert width_of(["Map 1 (reconstructed)", "x"]) == 17
    assert width_of(["a" * 80]) == 18
    assert width_of([]) == 2


@pytest.fixture(scope="module")
def figure():
    """A figure with each of the page's colours, and a plain black that is meant."""
    with style():
        canvas, (axes,) = panels(1, 1.5)
        axes.plot([0, 1], [0.123456, 1], color=looks("abcde")["e"].color)
        axes.plot([0, 1], [1, 0], color="black")
        axes.set(title="50 % & more", xlabel="it's #1")
        return render(canvas)


def test_the_files_of_a_figure_are_for_paper(figure):
    svg, png = figure
    assert b"fill: #fffffe" in svg and INK.encode() in svg and b"--i" not in svg
    assert png.startswith(b"\x89PNG")


def test_a_figure_on_the_page_takes_its_colours(figure):
    picture = picture_of(figure[0])
    head, _, svg = picture.partition(",")
    assert head == "data:image/svg+xml"
    assert not set('"\n') & set(svg) and "#" not in svg
    assert "&" not in re.sub("&amp;", "", svg)
    assert "prefers-color-scheme:dark" in svg
    used = {name: svg.count(f": var(--{name})") for name in "ipg"}
    assert all(used.values()), used
    assert svg.count("stroke: %23000000") == 1, "plain black stays"
    assert svg.count("%23000001") == 1, "the light scheme's ink, where it is named"
    assert "<!--" not in svg and len(picture) < 0.9 * len(figure[0])
    assert "scale(0.015625 0.015625)" in svg or "scale(0.1 -0.1)" in svg, "letters keep their size"


def test_the_library_is_the_one_that_is_named():
    table = (VENDOR / "README.md").read_text("utf-8")
    (version,) = re.findall(r"^\| version \| ([\d.]+) \|", table, re.MULTILINE)
    (digest,) = re.findall(r"\b[0-9a-f]{64}\b", table)
    library = (VENDOR / "dataTables.min.js").read_bytes()
    assert hashlib.sha256(library).hexdigest() == digest
    assert f"DataTables {version}".encode() in library[:100]
    assert "MIT" in (VENDOR / "LICENSE.txt").read_text("utf-8")


def test_the_script_stands_within_a_page():
    assert "</script" not in script() and "<!--" not in script()
    assert "//# sourceMapping" not in script()  # which a console would ask for
    assert not re.search(r"@import|url\(", style_sheet())


def test_a_wheel_has_whatever_the_page_is_made_of():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    kept = project["tool"]["setuptools"]["package-data"]["gapath"]
    packed = {path for pattern in kept for path in (ROOT / "gapath").glob(pattern)}
    page = ROOT / "gapath" / "pipelines" / "page"
    needed = {
        path for path in page.rglob("*") if path.is_file() and path.suffix not in (".py", ".pyc")
    }
    assert len(needed) > 8 and needed <= packed


def test_powers_of_ten_are_formulas_along_logarithmic_axes_though_names_are_none():
    def drawn(**more):
        with style(), matplotlib.rc_context(more):
            canvas, axes = panels(2, height=2, same_axes=False)
            for panel, most in zip(axes, (3.0, 1e6), strict=True):
                panel.plot([1, most], [1, most])
                panel.set(xscale="log", yscale="log", title="a map")
            return render(canvas)

    assert drawn() == drawn(**{"text.parse_math": True})
    with style():
        canvas, (panel, other) = panels(2, height=2, same_axes=False)
        panel.set(title="a$b_$x", xscale="log")
        panel.set_yticks(range(3), labels=["c$d_$y"] * 3)
        other.plot(["e$f_$z", "g$h_$z"], [1, 2])
        svg, _ = render(canvas)
    assert [svg.count(name) for name in (b"a$b_$x", b"c$d_$y", b"$z")] == [1, 3, 2]

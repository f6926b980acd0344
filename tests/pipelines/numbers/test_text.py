import csv
import io
import math
import shlex
from itertools import product

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.pipelines.numbers import text
from gapath.pipelines.numbers.text import in_csv, in_latex, in_markdown
from gapath.pipelines.page.section import Table
from gapath.pipelines.report.command import as_sweeps


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0, "0"), (9.0, "9"), (5.5, "5.5"), (0.01234, "0.0123"), (43.06, "43.1"), (999.4, "999"),
        (1234.5, "1\u202f234"), (37525, "37\u202f525"), (math.inf, "∞"),
        (math.nan, text.NOTHING), (0.5, "0.5"), (12.0001, "12"),
    ],
)  # fmt: skip
def test_number(value, shown):
    assert text.number(value) == shown


@given(st.floats(-1e9, 1e9))
def test_no_line_ends_within_a_number(value):
    shown = text.number(value)
    assert not set(shown) - set("-0123456789.\u202f")
    assert text.span(value, value + 1e4).count(" ") == 2  # about "to"


@given(st.floats(1e-9, 999.9))
def test_number_keeps_three_digits(value):
    assert float(text.number(value)) == pytest.approx(value, rel=5.1e-3)


@pytest.mark.parametrize(
    ("rate", "shown"),
    [(0, "0"), (1, "100"), (0.9999, "> 99.9"), (0.0001, "< 0.1"), (0.783, "78.3"), (0.999, "99.9")],
)
def test_percent_never_rounds_to_all_or_nothing(rate, shown):
    assert text.percent(rate) == shown


def test_spans_and_middles():
    assert text.span(1, 3) == "1 to 3"
    assert text.span(2, 2) == "2"
    assert text.span(math.nan, math.nan) == text.NOTHING
    assert text.middle(2, 1, 3) == "2 (1 to 3)"
    assert text.middle(math.nan, math.nan, math.nan) == text.NOTHING
    assert text.percent_range((0.21, 0.94), 0) == "21 to 94"
    assert text.percent_range((math.nan, math.nan)) == text.NOTHING


VALUES = st.lists(st.text("abc019", min_size=1, max_size=3), min_size=1, max_size=4, unique=True)


@given(VALUES, VALUES)
def test_a_sweep_stands_for_exactly_its_jobs(maps, planners):
    jobs = [f"gapath map={m} planner={p} trials=5" for m, p in product(maps, planners)]
    (line,) = as_sweeps(jobs * 2)
    if len(jobs) == 1:
        assert line == jobs[0]
        return
    program, flag, *words = shlex.split(line)
    assert (program, flag, words[-1]) == ("gapath", "-m", "trials=5")
    chosen = [word.partition("=")[2].split(",") for word in words[:2]]
    assert {f"gapath map={m} planner={p} trials=5" for m, p in product(*chosen)} == set(jobs)


@pytest.mark.parametrize(
    "commands",
    [
        ["gapath map=a planner=x", "gapath map=b planner=y"],  # not all combinations
        ["gapath map=a", "gapath planner=x"],
        ["gapath 'map.path=a,b'", "gapath map.path=c"],
        ["gapath 'map.path=\"a\"'", "gapath map.path=c"],
        ["gapath 'map.path=a", "gapath map.path=b"],
        ["gapath map=a", "gapath map=a seed=1"],
        ["", "gapath"],
    ],
)
def test_commands_that_are_no_sweep_stay_as_they_are(commands):
    assert as_sweeps(commands) == sorted(commands)


def test_of_very_many_commands_the_first_are_shown():
    jobs = [f"gapath map=m{i} seed={i}" for i in range(1000)]
    lines = as_sweeps(jobs)
    assert lines[:-1] == sorted(jobs)[:200]
    assert lines[-1] == "# and 800 more: each run's manifest.json"


def test_lists_and_variables_are_values_of_a_sweep():
    ends = product(("[0,1]", "[0,2]"), ("a", "b"))
    jobs = [f"gapath 'map.start={start}' 'map.path=${{oc.env:X}}/{name}'" for start, name in ends]
    assert as_sweeps(jobs) == [
        "gapath -m 'map.start=[0,1],[0,2]' 'map.path=${oc.env:X}/a,${oc.env:X}/b'"
    ]


def test_each_experiment_is_a_sweep_of_its_own():
    jobs = [f"gapath map={m} navigator={n} experiment=far" for m in "ab" for n in "xy"]
    jobs += [f"gapath map=c navigator={n} experiment=near" for n in "xyz"]
    assert as_sweeps(jobs) == [
        "gapath -m map=a,b navigator=x,y experiment=far",
        "gapath -m map=c navigator=x,y,z experiment=near",
    ]


def test_many_numbers_on_end_are_written_as_their_range():
    jobs = [f"gapath map.problem={i} planner={p}" for i in range(5, 125) for p in ("a", "b")]
    (line,) = as_sweeps(jobs)
    assert line == "gapath -m 'map.problem=range(5,125)' planner=a,b"
    (line,) = as_sweeps(job for job in jobs if "=17 " not in job)
    assert "16,18" in line and "range" not in line


EVIL = "=cmd()|<script>alert(1)</script>](javascript:x)`\x1b[2J\u202e_$&%#{}~^\\"


def test_text_of_others_is_no_more_than_text_in_any_file():
    frame = pd.DataFrame({EVIL: [EVIL, "a"], "n": [-1.5, 2.0]})
    table = Table("evil", EVIL, frame, frame.astype(str), heads=1)
    for each in (table.csv(), table.markdown(), table.latex()):
        assert "\x1b" not in each and "\u202e" not in each
        assert r"\x1b[2J" in each or r"textbackslash x1b" in each
    assert list(csv.reader(io.StringIO(table.csv())))[1][0].startswith("'=cmd()")
    assert "-1.5" in table.csv() and "'-1.5" not in table.csv()
    assert "<script" not in table.markdown() and "](" not in table.markdown()
    assert r"\$\&\%\#\{\}\textasciitilde \^{}\textbackslash " in table.latex()
    assert in_latex("[1]") == "{[}1]"


def test_what_people_write_stays_as_it_is():
    for plain in ("ga1[population=20]", "< 0.1", "12 (10 to 14)", "büro", "kg18_test3"):
        assert in_markdown(plain) == in_csv(plain) == plain
    assert in_latex("50 %, a_b") == r"50 \%, a\_b"

"""What the figures of sweeps show and say."""

import numpy as np
import pytest

from gapath.pipelines.sweeps import table
from gapath.pipelines.sweeps.pictures import curves, heat, shares

from .made import Tried, by_name, grid, planned, sections
from .test_varied import CASES, ga


@pytest.mark.parametrize("change", [{"success": 0.0}, {"n": 1, "success": 1.0}])
@pytest.mark.parametrize("case", ["null", "two, some missing", "scattered", "methods"])
def test_where_none_or_each_succeeded_is_drawn(case, change):
    tried = [each._replace(**change) for each in CASES[case][0]]
    for section in sections(tried):
        assert section.figures
        for each in section.figures:
            assert each.svg.startswith(b"<?xml") and each.png.startswith(b"\x89PNG")


def test_combinations_that_were_not_tried_or_never_succeed_are_marked():
    pairs = grid(population=[20, 50, 80], control_points=[5, 6])
    tried = [Tried(changes=each, success=0.5 * (i > 0)) for i, each in enumerate(pairs[:5])]
    (section,) = sections(tried)
    success, expected = by_name(section, "success"), by_name(section, "expected")
    assert "1 combination was not tried and is hatched" in success.caption
    assert "in 1 no trial succeeded" in expected.caption
    for figure in (success, expected):
        assert b"<pattern" in figure.svg
    assert "\N{INFINITY}" in heat_text(expected)
    assert "\N{INFINITY}" not in heat_text(success)


def heat_text(figure):
    """Give what stands in comments of an SVG: its texts, drawn as paths."""
    lines = figure.svg.decode().splitlines()
    return " ".join(line for line in lines if line.strip().startswith("<!--"))


def test_a_heat_map_has_each_value_at_its_place():
    pairs = grid(population=[20, 50, 80], control_points=[5, 6])
    tried = [Tried(changes=each, success=0.1 * i) for i, each in enumerate(pairs)]
    trials, runs = planned(tried)
    (view,) = table.views_of(trials, runs)
    down, across = view.sweep.settings
    found = heat.values_of(view.cells, curves.quantities(view)[0], across, down)
    assert found == pytest.approx(np.array([[0, 20, 40], [10, 30, 50]]))


def test_importance_and_effects_of_three_settings():
    pairs = grid(population=[20, 50, 80], control_points=[4, 5, 6], mixing=[0.2, 0.4, 0.6])
    tried = [Tried(changes=each, n=20, success=each["planner.population"] / 100) for each in pairs]
    (section,) = sections(tried)
    assert "What matters, most first: population." in section.remarks[0]
    assert "out of bag" in section.remarks[0]
    assert "population, Map 3 (reconstructed): 20 to 80." in by_name(section, "effects").alt
    assert by_name(section, "importance").alt.startswith("Bars: population ")


def test_curves_evenly_chosen_are_drawn():
    (view,) = table.views_of(*planned(ga(grid(population=range(10, 610, 10)), n=2)))
    figure = shares.shares(view)
    assert "8 of 60 values, evenly chosen" in figure.caption
    assert figure.alt.count("population") == 0 and figure.alt.count(" %") == 8


@pytest.mark.usefixtures("undrawn")
def test_many_maps_are_drawn_together():
    tried = [
        Tried(name, map=f"world{i}", success=rate)
        for name, rate in (("ga1", 0.5), ("ga2", 1.0))
        for i in range(8)
    ]
    (section,) = sections(tried)
    rows = by_name(section, "planner")
    assert len(rows.data) == 2 + 16
    assert list(rows.shown["Map"].iloc[:2]) == ["All 8 maps"] * 2
    assert list(rows.shown["Planner"].iloc[:2]) == ["GA 2", "GA 1"]
    assert list(rows.data["n"].iloc[:2]) == [80, 80]
    assert [len(keys) for keys in rows.runs[:3]] == [8, 8, 1]
    assert section.text[1].startswith("Most often found: GA 2, 100 (95.4 to 100.0) %.")
    assert "GA 1 50 %" in by_name(section, "effort").alt


@pytest.mark.parametrize("values", [[None, "", "a", "b"], [None, "", *"abcdefgh"]])
def test_null_is_a_value_of_which_a_curve_is_drawn(monkeypatch, values):
    drawn = []
    monkeypatch.setattr(shares, "_draw", lambda *given: drawn.append(given))
    tried = [Tried(changes=each, success=0.9 - 0.05 * i) for i, each in enumerate(grid(of=values))]
    (view,) = table.views_of(*planned(tried))
    figure = shares.shares(view)
    most = min(len(values), curves.LINES)
    assert len(drawn) == most and "null 90 %" in figure.alt
    assert (f"{most} of {len(values)} values" in figure.caption) == (most < len(values))


def test_null_may_be_among_the_values_that_succeed_most(monkeypatch):
    monkeypatch.setattr(curves, "POINTS", 3)
    tried = [Tried(changes=each, success=0.9 - 0.1 * i)
             for i, each in enumerate(grid(of=[None, "a", "", "b", "c"]))]  # fmt: skip
    (view,) = table.views_of(*planned(tried))
    drawn = []
    monkeypatch.setattr(curves, "_draw_points", lambda _, rows, *rest: drawn.append(rows))
    figure = curves.curves(view)
    assert {tuple(map(repr, rows["planner.of"])) for rows in drawn} == {("None", "'a'", "''")}
    assert "the 3 of 5 values that succeed most are drawn" in figure.caption


def test_dollars_in_the_names_of_maps_and_values_are_no_formula():
    tried = [
        Tried(changes=each, map=name)
        for name in ("a$b_$x", "c$d_$y")
        for each in grid(population=[20, 90], of=["$_$", "e"])
    ]
    assert [len(section.figures) > 1 for section in sections(tried)] == [True]

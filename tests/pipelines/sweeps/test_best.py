"""Which is best, and whether the next can be told from it."""

import pytest

from .made import Tried, by_name, grid, sections
from .test_varied import ga


@pytest.mark.usefixtures("undrawn")
def test_the_best_is_told_from_the_next_by_enough_trials():
    tried = [
        Tried(changes=changes, n=200, success=rate)
        for changes, rate in zip(grid(population=[20, 50, 80]), (0.2, 0.9, 0.6), strict=True)
    ]
    (section,) = sections(tried)
    first, second = by_name(section, "best").data.to_dict("records")
    assert (first["by"], first["method"]) == ("success", "ga1[population=50]")
    assert (first["value"], first["next"]) == (0.9, "ga1[population=80]")
    assert first["difference"] == pytest.approx(0.3)
    assert first["told_apart"] and first["alike"] == 0 and first["p_adjusted"] < 1e-6
    assert (second["by"], second["method"]) == ("expected_evaluations", "ga1[population=50]")
    assert "population 50, 90 (85.1 to 93.4) %" in section.text[1]
    assert section.text[1].endswith("The next, population 80, can be told from it.")


@pytest.mark.usefixtures("undrawn")
def test_alike_ones_cannot_be_told_apart():
    (section,) = sections(ga(grid(population=[20, 50, 80]), n=50))
    row = by_name(section, "best").data.iloc[0]
    assert not row["told_apart"] and (row["alike"], row["held"]) == (2, 2)
    assert section.text[1].endswith("cannot be told from it, nor can 1 of the 1 after it.")


@pytest.mark.usefixtures("undrawn")
def test_the_best_of_several_maps_stands_in_a_row_each_and_one_for_all():
    tried = [Tried(name, map=f"kg18_test{i}") for name in ("ga1", "ga2") for i in (1, 2)]
    (section,) = sections(tried)
    rows = by_name(section, "best").data
    assert list(zip(rows["place"], rows["by"], strict=True)) == [
        ("kg18_test1", "success"), ("kg18_test1", "expected_evaluations"),
        ("kg18_test2", "success"), ("kg18_test2", "expected_evaluations"), ("all", "success"),
    ]  # fmt: skip
    assert len(section.text) == 1

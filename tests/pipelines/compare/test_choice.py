"""Which runs are compared, and what pairs their trials."""

import pandas as pd
import pytest

from ..conftest import sign
from .conftest import compare

pytestmark = pytest.mark.usefixtures("undrawn")


def test_settings_that_vary_beside_pair_trials_or_are_named(try_out, tmp_path, capsys):
    for population, points in ((40, 3), (40, 4), (80, 3), (80, 4)):
        changes = {"planner.population": population, "planner.control_points": points}
        try_out(tmp_path / "both", changes)
    compare(tmp_path / "both", "--by", "planner.population")
    text = capsys.readouterr().out
    assert "seed, trial, planner.control_points: 120 pairs" in text
    assert "Each group holds several values of planner.control_points." in text
    for population, points in ((40, 3), (80, 4)):
        changes = {"planner.population": population, "planner.control_points": points}
        try_out(tmp_path / "one", changes)
    compare(tmp_path / "one", "--by", "planner.population")
    assert "The groups differ in planner.control_points, too." in capsys.readouterr().out


@pytest.mark.parametrize(
    ("known", "said"),
    [
        ([(40, "a/k.map", "12"), (80, "b/k.map", "12")], "seed, trial: 60 pairs."),
        ([(40, "a/k.map", "12"), (80, "a/k.map", "34")], "groups differ in planner.known, too."),
        ([(40, "a/k.map", "12"), (80, "a/m.map", "12")], "groups differ in planner.known, too."),
        ([(each, "a/k.map", content) for each in (40, 80) for content in ("12", "34")],
         "seed, trial, planner.known: 120 pairs."),
        ([(40, "", "12"), (80, "", "34")], "groups differ in content.k.map, too."),
    ],
)  # fmt: skip
def test_files_are_what_they_hold_not_where_they_lie(try_out, tmp_path, capsys, known, said):
    for population, path, content in known:
        changes = {"planner.population": population, **({"planner.known": path} if path else {})}
        folder = try_out(tmp_path, changes, experiment=f"on{content}")
        sign(folder, method_inputs={path or "a/k.map": content * 32})
    compare(tmp_path, "--by", "planner.population")
    text = capsys.readouterr().out
    assert said in text
    assert ("too." in text) == ("too." in said)


def test_a_condition_names_a_setting_by_its_whole_name(try_out, tmp_path, capsys):
    for population, pop in ((40, 1), (80, 2)):
        try_out(tmp_path, {"planner.population": population, "planner.pop": pop})
    compare(tmp_path, "--where=Planner.population = 40", "--where=planner.population > 40")
    assert "The groups differ in planner.pop, too." in capsys.readouterr().out


def test_values_of_every_kind_have_an_order(try_out, tmp_path, capsys):
    for value in ("b", "", None, 0, 7):
        try_out(tmp_path, {"planner.kind": value}, n=12)
    compare(tmp_path, "--by", "planner.kind", "--measure", "success", into=tmp_path / "it")
    pairs = pd.read_csv(tmp_path / "it" / "comparison.csv", keep_default_na=False)
    assert list(pairs["second"].head(4)) == ["7", "", "b", "null"]


def test_of_many_settings_that_differ_the_first_are_named(try_out, tmp_path, capsys):
    for population in (40, 80):
        others = {f"planner.own_{name}": population for name in "abcdefg"}
        try_out(tmp_path, {"planner.population": population, **others}, n=12)
    compare(tmp_path, "--by", "planner.population", "--measure", "success")
    text = capsys.readouterr().out
    assert "differ in planner.own_a, planner.own_b" in text
    assert "planner.own_e and 2 more, too." in text


def test_groups_without_a_common_seed_are_compared_unpaired(try_out, tmp_path, capsys):
    for seed, population in ((1, 40), (2, 160)):
        try_out(tmp_path, {"planner.population": population}, seed=seed)
    compare(tmp_path, "--by", "planner.population")
    text = capsys.readouterr().out
    assert "No two groups have enough trials in common" in text
    assert "unpaired" in text
    tests = set(pd.read_csv(next(tmp_path.rglob("comparison.csv")))["test"])
    assert {"score test", "Mann-Whitney"} <= tests


def test_what_was_left_unpaired_is_said(try_out, tmp_path, capsys):
    try_out(tmp_path, {"planner.population": 40}, n=60)
    try_out(tmp_path, {"planner.population": 160}, n=40)
    compare(tmp_path, "--by", "planner.population")
    text = capsys.readouterr().out
    assert "trial: 40 pairs." in text
    assert "Left unpaired, at the least: 40 20 trials." in text


def test_runs_that_are_left_out_are_named(try_out, tmp_path, capsys):
    for population in (40, 80):
        try_out(tmp_path, {"planner.population": population})
    broken = try_out(tmp_path, {"planner.population": 160})
    (broken / "trials.parquet").write_bytes(b"none")
    sign(broken)
    try_out(tmp_path, preset="astar")
    compare(tmp_path, "--by", "planner.population")
    error = capsys.readouterr().err
    assert f"left out mine/{broken.name}: trials.parquet" in error
    assert "has no planner.population" in error

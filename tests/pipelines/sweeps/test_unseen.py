"""The section on maps that were not chosen."""

import math

import pandas as pd
import pytest

from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.text import NOTHING
from gapath.pipelines.sweeps import table_unseen

from ..conftest import record_of


def run_of(preset, path="maps/arena.map", kind="movingai", problem=0, **changes):
    """Make what is known of a run of the experiment; its key says what it tries."""
    known = {name.replace("planner_", "planner."): value for name, value in changes.items()}
    key = f"{preset} {path} {problem} {changes}".replace("/", "-")
    run = record_of(preset, key, changes=known)
    given = {"path": path, "start": None, "target": None, "free_weight": 0.5}
    own = {"movingai": {"scenario": "a.scen", "problem": problem}, "rosmap": {"unknown": "free"}}
    settings = {"kind": kind, **given, **own.get(kind, {})}
    vars(run)["settings"] = {f"map.{name}": value for name, value in settings.items()}
    return run


def trials(run, found, of, ms=1.0, **columns):
    frame = pd.DataFrame({"feasible": [i < found for i in range(of)]})
    settings = run.settings
    defaults = {
        "map_source": settings["map.kind"], "planner": run.known.method,
        "start": f"({settings.get('map.problem', 0)}, 0)", "target": "(9, 9)",
        "plan_time_s": ms / 1000, "length_ratio": math.nan, "key": run.folder.name,
    }  # fmt: skip
    return frame.assign(**defaults | columns)


def section(*counts):
    """Make the section from (run, found, of, ms)."""
    frame = pd.concat([trials(*count) for count in counts], ignore_index=True)
    return table_unseen.section(frame, [count[0] for count in counts])


@pytest.fixture
def two_maps():
    """GA 3 and A* on two problems of one map and one of another."""
    rooms = {"path": "x/rooms.map"}
    return section(
        (run_of("ga3"), 4, 4, 1.0),
        (run_of("ga3", problem=1), 2, 4, 3.0),
        (run_of("ga3", **rooms), 1, 4, 5.0),
        (run_of("astar_length"), 4, 4, 2.0),
        (run_of("astar_length", problem=1), 4, 4, 4.0),
        (run_of("astar_length", **rooms), 4, 4, 1.0),
    )


def test_a_family_worked_by_hand(two_maps):
    family, _ = two_maps.tables
    assert list(family.shown["Planner"]) == ["GA 3", "A*, by length"]
    row = family.data.iloc[0]
    assert (row["family"], row["maps"], row["problems"], row["n"]) == ("MovingAI", 2, 3, 12)
    rate = (0.75 + 0.25) / 2  # each map counts once, whatever the number of its problems
    assert row["success"] == rate
    assert (row["success_low"], row["success_high"]) == wilson(rate, 2)
    assert (row["least"], row["greatest"]) == (0.25, 0.75)
    assert row["seconds_median"] == pytest.approx(0.003)
    assert row["ert_seconds"] == pytest.approx(4 * (1 + 3 + 5) / 7 / 1000)
    least = 4 * (2 + 4 + 1) / 12 / 1000
    assert row["times_exact"] == pytest.approx(row["ert_seconds"] / least)
    assert row["faster"] == 1  # 16 / 6 ms against 3 on the first map, 20 against 1 on the other
    shown, exact = family.shown.to_dict("records")
    assert (shown["Found, %"], shown["By map, %"]) == ("50", "25 to 75")
    assert (exact["Found, %"], exact["95 % interval"]) == ("100", NOTHING)
    assert shown["Faster than A*: maps"] == "1"


def test_one_by_one_the_interval_counts_problems(two_maps):
    _, maps = two_maps.tables
    assert list(maps.shown["Map"]) == ["arena", "arena", "rooms", "rooms"]
    row = maps.data.iloc[0]
    assert (row["problems"], row["n"], row["success"]) == (2, 8, 0.75)
    assert (row["success_low"], row["success_high"]) == wilson(0.75, 2)
    assert row["times_exact"] == pytest.approx((16 / 6) / 3)
    single = maps.data.iloc[2]
    assert (single["problems"], single["success_low"]) == (1, wilson(0.25, 4)[0])  # its trials
    assert all(table.latex().isascii() for table in two_maps.tables)


def test_whoever_finds_nothing_is_slower_than_anybody():
    family, _ = section((run_of("ga1"), 0, 4), (run_of("astar_length"), 4, 4)).tables
    shown = family.shown.iloc[0]
    assert shown["Expected time, ms"] == shown["Expected / A*'s"] == "∞"
    assert shown["Faster than A*: maps"] == "0"


def test_digits_that_the_published_length_lacks_are_no_difference():
    for ratio, shown in ((1.0000003, "0"), (0.9999997, "0"), (1.0437, "4.37"), (math.nan, NOTHING)):
        run = run_of("astar_length")
        made = table_unseen.section(trials(run, 2, 2, length_ratio=ratio), [run])
        assert list(made.tables[0].shown["Length above published, %"]) == [shown]


def test_without_an_exact_planner_nothing_is_held_against_it():
    for runs in ([run_of("ga1")], [run_of("ga1", kind="barn", path="maps/x.json")]):
        family, _ = section(*[(run, 2, 4) for run in runs]).tables
        assert list(family.shown["Expected / A*'s"]) == [NOTHING]


def test_what_the_experiments_set_is_no_other_method_but_all_else_is():
    metres = {"planner_robot_radius": 0.22, "planner_radius_unit": "metres"}
    until_found = {"corner_cutting": "no_diagonals", "planner_stop_when_feasible": True}
    other = metres | {"planner_robot_radius": 0.3}
    cases = [
        (run_of("ga3", corner_cutting="forbid"), "ga3"),
        (run_of("sedighi", **until_found), "sedighi"),
        (run_of("visibility_ga", **metres), "visibility_ga"),
        (run_of("visibility_ga", **other), "visibility_ga[robot_radius=0.3]"),
        (run_of("ga3", planner_population=50), "ga3[population=50]"),
    ]
    runs = [run for run, _ in cases]
    frame = pd.concat([trials(run, 1, 1) for run in runs], ignore_index=True)
    named = table_unseen.by_problem(frame, runs)["method"]
    assert list(named) == [name for _, name in cases]


def test_a_map_called_map_has_its_folders_name():
    run = run_of("inflated_astar", path="ros/office02/map.yaml", kind="rosmap")
    (row,) = table_unseen.by_problem(trials(run, 1, 1), [run]).to_dict("records")
    assert row["place"] == "office02[unknown=free]"
    assert (row["family"], row["exact"]) == ("pictures of floors", True)

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.events import Called, RunStarted
from gapath.pipelines.kg18.drives import table as table_drives
from gapath.pipelines.kg18.drives import table_calls as table_drive_calls
from gapath.pipelines.kg18.drives import table_choices as table_drive_choices
from gapath.pipelines.kg18.drives import table_classes as table_drive_classes
from gapath.pipelines.numbers.drive_summary import rate, summarise_drives
from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.summary import over_instances
from gapath.pipelines.report.report import make_report
from gapath.problem import Answer, PlanStatus, Problem
from gapath.recorders.mcap import FILE
from gapath.store.records import find_runs

from .conftest import collect, sign
from .synthetic import drive_settings, make_map, make_path

TABLES = (table_drives, table_drive_calls, table_drive_classes, table_drive_choices)


@pytest.fixture(scope="module")
def case(drive_outputs):
    return collect(drive_outputs).trials["drive"], find_runs(drive_outputs)


def of(case, experiment):
    drives, runs = case
    return (
        drives[drives["experiment"] == experiment],
        [run for run in runs if run.folder.parent.name == experiment],
    )


def drives_of(**columns):
    defaults = {
        "map": "kg18_map4", "map_source": "array", "map_instance": 0, "navigator": "kg18",
        "outcome": "reached", "reached": True, "steps": 100, "steps_ratio": 1.0, "replans": 1,
        "calls_a": 0, "calls_b": 0, "calls_c": 1, "stands": 0, "evaluations": 10,
        "compute_time_s": 0.5,
    }  # fmt: skip
    frame = pd.DataFrame(columns)
    defaults["key"] = [f"run {i}" for i in range(len(frame))]
    return frame.assign(**{k: v for k, v in defaults.items() if k not in frame})


def test_other_instances_alone_make_no_table_of_drives():
    assert table_drives.section(drives_of(map_instance=[3, 5]), []) is None


@pytest.mark.usefixtures("undrawn")
def test_plans_and_drives_do_not_mix(tmp_path, make_run, make_drive_run):
    make_run(tmp_path, "mine", "kg18_test1", "ga1", n=3, log=False)
    make_drive_run(tmp_path, "mine", "kg18_map1", "kg18", n=4)
    trials, skipped, _ = collect(tmp_path)
    plans, drives = trials["plan"], trials["drive"]
    assert (len(plans), len(drives), skipped) == (3, 4, [])
    assert "navigator" not in plans
    assert "planner" not in drives
    assert plans["feasible"].dtype == drives["reached"].dtype == bool
    page = make_report(tmp_path, tmp_path / "report")[0][-1].read_text()
    for task in ("plan", "drive"):
        assert f'<section id="sweeps-table-{task}-mine">' in page
    assert "mine (drives)" in page
    assert "7 trials in 2 runs" in page


@pytest.mark.parametrize("task", ["fly", 3, None])
def test_a_task_that_nobody_knows_is_named(tmp_path, make_drive_run, task):
    run = make_drive_run(tmp_path, "mine", "kg18_map1", "kg18")
    sign(run, task=task)
    assert "manifest.json, task" in find_runs(tmp_path)[0].fault


def test_rows_of_the_other_task_are_named(tmp_path, make_drive_run):
    run = make_drive_run(tmp_path, "mine", "kg18_map1", "kg18")
    sign(run, task="plan")
    assert "no column" in collect(tmp_path).skipped[0].reason


@pytest.mark.parametrize("settings", [("a", "b"), ("a", "a")])
def test_only_runs_of_the_same_setting_supersede_each_other(tmp_path, make_drive_run, settings):
    for n, setting in enumerate(settings, start=2):
        run = make_drive_run(tmp_path, f"x{n}", "kg18_map1", "kg18", n=n)
        sign(run, experiment="x", setting=setting)
    assert len(collect(tmp_path).trials["drive"]) == (5 if settings == ("a", "b") else 3)


def only(summary, frame, *names):
    """Give the row that a frame of one group comes to."""
    found = summary(frame, Groups.one(len(frame)), *names)
    return {name: values[0] for name, values in found.items()}


def test_a_summary_worked_by_hand():
    row = only(
        summarise_drives,
        drives_of(
            outcome=["reached", "returned", "reached", "overran"],
            reached=[True, False, True, False],
            steps=[100, 60, 120, 2000],
            steps_ratio=[1.0, math.nan, 1.2, math.nan],
            calls_a=[0, 9, 0, 3],
        ),
    )
    assert [row[name] for name in ("n", "reached", "returned", "overran")] == [4, 2, 1, 1]
    assert (row["returned_low"], row["returned_high"]) == wilson(0.25, 4)
    assert row["steps_median"] == 110  # failures count
    assert row["steps_ratio_median"] == pytest.approx(1.1)
    assert row["calls_a"] == 3
    assert row["never_left"] == 0


def test_drives_that_never_left_are_told():
    drives = drives_of(
        outcome=["returned"] * 3 + ["reached"], steps=[4, 1, 9, 5], stands=[4, 1, 8, 5]
    )
    row = only(summarise_drives, drives)
    assert row["never_left"] == 2
    assert rate(row, "returned").endswith("; 2 never left")
    assert "never left" not in rate(row, "reached") + rate(row, "overran")


def test_who_draws_no_random_number_has_no_interval():
    alike = drives_of(steps=[100] * 5, evaluations=0)
    assert math.isnan(only(summarise_drives, alike)["reached_low"])
    drawn = only(summarise_drives, alike.assign(evaluations=5))
    assert drawn["reached_low"] == wilson(1.0, 5)[0]
    changing = alike.assign(steps=[100, 100, 101, 99, 100])  # the map differed by trial
    assert only(summarise_drives, changing)["reached_low"] == wilson(1.0, 5)[0]


@given(st.lists(st.tuples(st.integers(0, 4), st.booleans()), min_size=1, max_size=30))
def test_over_instances_weighs_instances_alike(rows):
    frame = pd.DataFrame(rows, columns=["map_instance", "reached"])
    row = only(over_instances, frame, "reached", "rate")
    rates = [
        np.mean([reached for other, reached in rows if other == instance])
        for instance in {instance for instance, _ in rows}
    ]
    assert row["instances"] == len(rates)
    assert row["rate"] == pytest.approx(np.mean(rates))
    interval = row["rate_low"], row["rate_high"]
    assert interval == pytest.approx(wilson(float(np.mean(rates)), len(rates)))


def test_table_of_drives(case):
    trials, runs = of(case, "drives")
    section = table_drives.section(trials, runs)
    outcomes, effort = (t.shown.set_index(["Map", "Navigator"]) for t in section.tables)
    assert len(outcomes) == len(effort) == 6
    hard = ("Unknown map 4 (reconstructed)", "KG18")
    ours = trials[(trials["map"] == "kg18_map4") & (trials["navigator"] == "kg18")]
    assert 0 < ours["reached"].mean() < 1
    assert float(outcomes.loc[hard, "Reached, %"].split()[0]) == pytest.approx(
        100 * ours["reached"].mean(), abs=0.1
    )
    assert outcomes.loc[hard, "Overran, %"].startswith("0 (0.0 to ")
    assert outcomes.loc[(hard[0], "Repeated A*"), "Reached, %"] == "100"
    assert effort.loc[hard, "Paper: time, s"] == "0 to 140"
    assert effort.loc[(hard[0], "KG18 + A*"), "Paper: time, s"] == "\N{EN DASH}"
    # The fewest steps and the least time are those of the numbers, whoever wins.
    (said,) = (text for text in section.remarks if text.startswith("Unknown map 4, of those"))
    assert "fewest steps by Repeated A*, median 21" in said
    assert "the quickest is Repeated A*" in said


def test_no_winner_is_named_where_nobody_arrives():
    mine = drives_of(navigator=["kg18", "replan_astar"], reached=False, outcome="returned",
                     steps_ratio=math.nan)  # fmt: skip
    assert not any("fewest" in text for text in table_drives.section(mine, []).remarks)


def test_calls_worked_by_hand(case):
    trials, runs = of(case, "drives")
    section = table_drive_calls.section(trials, runs)
    (table,) = section.tables
    rows = table.data.set_index(["map", "part", "planner"])
    assert len(rows) == 2 + 6  # on the easy map only those that found a path were called
    failed = int((~trials.query("map == 'kg18_map4' and navigator == 'kg18'")["reached"]).sum())
    total = 12 * 1400 + failed * 8600
    first, third, back = (rows.loc["kg18_map4", *key] for key in (("C", 1), ("C", 3), ("A", 1)))
    assert (first["calls"], first["failed"], first["control_points"]) == (12 + failed, failed, 4)
    assert first["found"] == first["adopted"] == pytest.approx(12 / (12 + failed))
    assert [row["one_obstacle"] for row in (first, third, back)] == [1, 0, 0]
    assert first["evaluations_share"] == pytest.approx((12000 + 2000 * failed) / total)
    assert rows.loc["kg18_map4"]["evaluations_share"].sum() == pytest.approx(1)
    look = rows.loc["kg18_map1", "B", 1]
    assert (look["found"], look["adopted"], look["failed"]) == (1, 0, 0)
    assert look["evaluations_share"] == pytest.approx(400 / 1400)
    shown = table.shown.set_index(["Map", "Part", "Planner"])
    assert shown.loc["Unknown map 1 (reconstructed)", "B", "1 (k = 4)"].tolist() == [
        "12", "100", "0", "\N{EN DASH}", "28.6",
    ]  # fmt: skip
    vain = f"unknown map 1 0 %, unknown map 4 {100 * failed * 8600 / total:.1f} %"
    assert vain in section.remarks[0].lower()


def test_obstacles_are_counted_by_the_log_whatever_they_are_shown_to_cost():
    """A small VLN, of which more go into the weights of a path than there are obstacles on it."""
    grid = make_map("kg18_map4")
    settings = drive_settings("kg18")
    start = RunStarted(
        "drives", "kg18", "drive", Problem(grid, grid.start, grid.target), 0, 1, settings, {},
        make_path(0), 11.0,
    )  # fmt: skip
    nothing = np.empty((0, 2), dtype=np.int32)
    answer = Answer(PlanStatus.NOT_FOUND, nothing, 14.5, 3, vln=1.0, epochs=9, evaluations=50)
    calls = [Called(1, 0, part, index, False, answer) for part, index in (("A", 0), ("C", 3))]
    read = table_drive_calls.read_calls(iter([start, *calls]))
    assert list(read["obstacles"]) == [3, 3]
    assert list(read["control_points"]) == [5, 8]


def test_a_planner_without_control_points_has_a_row():
    rows = {
        "map": "kg18_map4", "map_source": "array", "part": "C", "planner": [1, 5],
        "control_points": pd.array([4, None], dtype="Int64"), "found": True, "adopted": True,
        "obstacles": 0, "evaluations": [10, 0],
    }  # fmt: skip
    table = table_drive_calls._table(table_drive_calls.summarise_calls(pd.DataFrame(rows)))
    assert list(table.shown["Planner"]) == ["1 (k = 4)", "5"]
    assert ",C,5,," in table.csv() and ",C,1,4," in table.csv()


def test_calls_of_a_log_that_cannot_be_read_are_named(tmp_path, make_drive_run):
    folder = make_drive_run(tmp_path, "drives", "kg18_map1", "kg18", log=True)
    log = folder / FILE
    log.write_bytes(log.read_bytes()[:-200] + bytes(200))
    section = table_drive_calls.section(pd.DataFrame(), find_runs(tmp_path))
    assert section.tables == ()
    assert section.skipped[0][0] == f"drives/{folder.name}"
    log.unlink()
    sign(folder)
    assert table_drive_calls.section(pd.DataFrame(), find_runs(tmp_path)) is None


def test_classes_count_instances_and_name_those_that_failed():
    mine = drives_of(
        map_instance=[0, 0, 0, 0, 1, 1, 2, 2],
        reached=[True] * 5 + [False] * 3,
        outcome=["reached"] * 5 + ["returned"] * 3,
    )
    row = only(table_drive_classes.summarise_class, mine)
    assert row["reached"] == pytest.approx(0.5)
    assert (row["reached_low"], row["reached_high"]) == pytest.approx(wilson(0.5, 3))
    assert (row["instances"], row["n"], row["always"], row["never"]) == (3, 8, 1, 1)
    failed = table_drive_classes.failing_instances(mine)
    assert list(failed["map_instance"]) == [1, 2]
    assert list(failed["returned"]) == [1, 2]
    more = pd.concat([mine, mine[-2:].assign(map_instance=3)])
    remarks = table_drive_classes.section(more, []).remarks
    assert "3 of unknown map 4; the two worst make 80 %" in remarks[-1]


def test_classes_without_a_failure_have_no_second_table():
    section = table_drive_classes.section(drives_of(map_instance=[0, 1]), [])
    assert len(section.tables) == 1
    assert "every drive" in section.remarks[-1]


@pytest.mark.parametrize(
    ("preset", "changes", "expected"),
    [
        ("kg18", {}, {}),
        ("kg18_fast", {}, {"Least epochs, C": "3"}),
        ("kg18", {"drive.sensor.range": 8}, {"Sensor range, layers": "8"}),
        ("kg18", {"drive.sensor.occlusion": True}, {"Obstacles hide what lies behind": "yes"}),
        ("kg18", {"navigator.explore.sampling": "span", "navigator.replan[0].sampling": "span",
                  "navigator.replan[3].sampling": "span"}, {"Way points per": "span"}),
        ("kg18_astar", {"navigator.return_penalty": 3.0},
         {"Last planner, C": "A*", "Penalty on the way back, A": "3.0"}),
        ("kg18", {"drive.step_limit": 50}, {"drive.step_limit": "50"}),
        ("dstar_lite", {}, {"Navigator": "D* Lite"}),
    ],
)  # fmt: skip
def test_what_was_varied_is_read_from_what_differs(preset, changes, expected):
    assert table_drive_choices.varied(preset, changes) == expected


def test_choices_are_held_against_the_first_row(case):
    trials, runs = of(case, "drive_choices")
    (table,) = table_drive_choices.section(trials, runs).tables
    assert list(table.shown["Decision"]) == [
        "as described", "Last planner, C", "Sensor range, layers", "Sensor range, layers",
    ]  # fmt: skip
    assert list(table.shown["Value"]) == ["", "A*", "8", "10"]
    rates = trials.groupby(["navigator", "map_instance"])["reached"].mean()
    better = (rates["kg18_astar"] > rates["kg18"]).sum()
    assert better > 0
    assert list(table.data["better"])[:2] == [0, better]
    assert list(table.data["worse"])[:2] == [0, 0]


@pytest.mark.usefixtures("undrawn")
def test_the_page_has_every_section_and_every_table_in_ascii(case, drive_outputs, tmp_path):
    files, skipped = make_report(drive_outputs, tmp_path)
    assert skipped == []
    page = files[-1].read_text()
    for title in ("KG18 Sec. 6", "classes of unknown maps", "What the paper leaves open"):
        assert title in page
    assert "Other drives" not in page
    for module in TABLES:
        for table in module.section(*case).tables:
            assert table.latex().isascii()

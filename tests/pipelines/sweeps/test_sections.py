"""Sections of experiments of a user's own, as the report shows them."""

import math

import pytest

from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.report.report import make_report
from gapath.pipelines.sweeps import table
from gapath.tasks.plan import Task as PlanTask

from .made import Tried, by_name, driven, grid, names_of, planned, sections
from .test_varied import CASES, ONE_AT_A_TIME, ga

POPULATIONS = ga(grid(population=[20, 50, 80]))


@pytest.mark.parametrize(
    ("case", "files"),
    [
        ("one", [["population_best", "population", "population_curves", "population_effort"]]),
        ("two", [["control_points_population_best", "control_points_population",
                  "control_points_population_success", "control_points_population_expected"]]),
        ("three", [["3_best", "3", "3_parallel", "3_effects"]]),
        ("words", [["sampling_best", "sampling", "sampling_curves", "sampling_effort"]]),
        ("methods", [["planner_best", "planner", "planner_curves", "planner_effort"]]),
        ("methods and a setting", [["population_best", "population", "population_curves",
                                    "population_effort"]]),
        ("one at a time", [["mutation_probability_best", "mutation_probability",
                            "mutation_probability_curves", "mutation_probability_effort"],
                           ["population_best", "population", "population_curves",
                            "population_effort"]]),
        ("a sweep and odds and ends", [["population_best", "population", "population_curves",
                                        "population_effort"], ["others"]]),
        ("nothing", [["others"]]),
        ("instances", [["others", "others_problems"]]),
    ],
)  # fmt: skip
@pytest.mark.usefixtures("undrawn")
def test_names_of_files_are_stable(case, files):
    three = "control_points_mixing_population"
    expected = [
        [f"sweep_plan_mine_{name.replace('3', three, name[0] == '3')}" for name in each]
        for each in files
    ]
    assert [names_of(section) for section in sections(CASES[case][0])] == expected


@pytest.mark.parametrize("tried", [tried for tried, _ in CASES.values()], ids=CASES)
@pytest.mark.parametrize("change", [{}, {"success": 0.0}, {"n": 1, "success": 1.0}])
@pytest.mark.usefixtures("undrawn")
def test_whatever_was_tried_has_its_place(tried, change):
    """Half, none and all succeeded; a trial each: every run is behind a row, nothing fails."""
    tried = [each._replace(**change) for each in tried]
    made = sections(tried)
    keys = {key for section in made for each in section.tables for row in each.runs for key in row}
    assert keys == {f"k{i}" for i in range(len(tried))}
    for section in made:
        assert section.title and section.text[0].endswith(".")
        assert set(section.runs) <= keys
        for each in section.tables:
            assert each.latex().isascii() and len(each.shown)
            assert not each.shown.isna().any(axis=None)
        for each in section.figures:
            assert len(each.alt) > 40 and each.caption.endswith(".")
    names = [name for section in made for name in names_of(section)]
    assert len(names) == len(set(names))


@pytest.mark.parametrize(
    ("tried", "said"),
    [
        (
            ga(grid(population=range(10, 610, 10)), n=4),
            "planner.population took 60 values (10 to 600) with GA 1, on Map 3 (reconstructed), "
            "4 trials each.",
        ),
        (
            [Tried(name, map=f"kg18_test{i}") for name in ("ga1", "astar") for i in (1, 2)],
            "planner took 2 values (GA 1, A*), on 2 maps (Map 1 (reconstructed), Map 2 "
            "(reconstructed)), 10 trials each.",
        ),
        (
            ga(grid(population=[20, 50, 80], control_points=[5, 6])[:5]),
            "planner.control_points took 2 values (5, 6) and planner.population 3 values (20, 50, "
            "80), 5 of 6 combinations with GA 1, on Map 3 (reconstructed), 10 trials each.",
        ),
        (
            [Tried(name, instance=i, n=1 + i) for name in ("ga1", "ga2") for i in range(3)],
            "planner took 2 values (GA 1, GA 2), on Map 3 (reconstructed), 6 trials each, over 3 "
            "problems a map.",
        ),
        ([Tried()], "GA 1, on Map 3 (reconstructed), 10 trials each."),
    ],
)
@pytest.mark.usefixtures("undrawn")
def test_a_sentence_says_what_varied(tried, said):
    (section,) = sections(tried)
    assert section.text[0] == said


@pytest.mark.usefixtures("undrawn")
def test_a_title_says_which_sweep_where_there_are_several():
    assert [each.title for each in sections(POPULATIONS)] == ["mine"]
    assert [each.title for each in sections(ga(ONE_AT_A_TIME))] == [
        "mine: planner.mutation_probability",
        "mine: planner.population",
    ]
    drives = [Tried(name) for name in ("kg18", "dstar_lite")]
    assert [each.title for each in sections(drives, driven)] == ["mine (drives)"]


@pytest.mark.usefixtures("undrawn")
def test_rows_stand_in_the_order_of_the_setting_else_the_best_first():
    (one,) = sections(ga(grid(population=[200, 30, 1000])))
    assert list(by_name(one, "population").shown["Population"]) == ["30", "200", "1000"]
    tried = [
        Tried(changes=changes, success=0.1 * (i + 1))
        for i, changes in enumerate(grid(population=[20, 50, 80], control_points=[5, 6]))
    ]
    (two,) = sections(tried)
    shown = by_name(two, "population").shown
    assert list(shown["Found, %"].str.split().str[0]) == ["60", "50", "40", "30", "20", "10"]


@pytest.mark.usefixtures("undrawn")
def test_a_row_shows_its_numbers():
    (section,) = sections(ga(grid(population=[20, 50]), n=8, success=0.25, evaluations=100))
    row = by_name(section, "population").shown.iloc[0]
    low, high = wilson(0.25, 8)
    assert row["Found, %"] == f"25 ({100 * low:.1f} to {100 * high:.1f})"
    assert row["Expected evaluations"].startswith("414 (")  # (8 x 100 + 28) / 2
    assert row["Median time, ms"] == "4.5"
    assert row["Above optimal, %"] == "10"


@pytest.mark.usefixtures("undrawn")
def test_rows_of_a_scenario_are_one_row_a_method_with_totals():
    tried = [
        Tried(name, map=f"arena[start={i}]", start=f"({i}, 0)", path="maps/arena.map",
              success={"ga1": 0.5 * (i % 3), "astar": 1.0}[name], n=4)
        for name in ("ga1", "astar")
        for i in range(6)
    ]  # fmt: skip
    (section,) = sections(tried)
    rows = by_name(section, "planner").shown
    assert list(rows["Planner"]) == ["A*", "GA 1"]
    assert list(rows["Problems"]) == ["6", "6"]
    assert list(rows["Solved once"]) == ["6", "4"]
    assert list(rows["Always"]) == ["6", "2"]
    assert list(rows["Trials"]) == ["24", "24"]
    problems = by_name(section, "problems")
    assert len(problems.data) == 12 and len(problems.shown) == 6
    assert list(problems.shown["GA 1"]) == ["0", "0", "50", "50", "100", "100"]
    assert set(problems.shown["A*"]) == {"100"}


@pytest.mark.usefixtures("undrawn")
def test_problems_that_all_solved_are_sorted_by_time():
    tried = [Tried("astar", instance=i, n=1 + 2 * i, success=1) for i in range(3)]
    (section,) = sections(tried)
    problems = by_name(section, "problems").shown
    assert list(problems["Instance"]) == ["2", "1", "0"]
    assert list(problems["Median time, ms"]) == ["3", "2", "1"]


@pytest.mark.usefixtures("undrawn")
def test_other_problems_of_one_map_are_remarked():
    tried = [Tried("ga1", instance=i) for i in range(4)] + [
        Tried("ga2", instance=i) for i in range(3)
    ]
    (section,) = sections(tried)
    assert any("same problems" in remark for remark in section.remarks)
    (section,) = sections(tried[:3] + tried[4:])
    assert not any("same problems" in remark for remark in section.remarks)


@pytest.mark.usefixtures("undrawn")
def test_drives_have_their_own_columns():
    tried = [Tried("kg18", {"drive.sensor.range": r}, n=4, success=0.5) for r in (3, 4, 6)]
    (section,) = sections(tried, driven)
    row = by_name(section, "range").shown.iloc[0]
    assert row["Reached, %"].startswith("50 (")
    assert row["Expected steps / shortest"].startswith("2.15 (")
    assert row["Returned, %"] == "50"
    assert "Never left, %" not in row and "Expected evaluations" not in row
    assert by_name(section, "best").data["by"].tolist() == ["success", "expected_seconds"]


class RoundTrip(PlanTask):
    """A task of which the report knows nothing."""

    name = "round_trip"
    row = type("RoundTripRow", (), {})
    success = "came_back"


def test_a_task_of_which_nothing_is_known_has_its_success(monkeypatch):
    monkeypatch.setattr(table, "find_task", lambda name: RoundTrip)
    trials, runs = planned([Tried("ga1", n=4), Tried("astar", n=4)])
    trials = trials.assign(came_back=trials["trial"] < 3)
    trials = trials.drop(columns=["evaluations", "feasible", "plan_time_s"])
    (section,) = table.section(trials, runs)
    rows = by_name(section, "planner").data
    assert list(rows["success"]) == [0.75, 0.75]
    assert list(rows["success_low"]) == pytest.approx([wilson(0.75, 4)[0]] * 2)
    assert "Came back, %" in by_name(section, "planner").shown
    assert names_of(section) == [
        f"sweep_round_trip_mine_planner{end}" for end in ("_best", "", "_curves")
    ]


@pytest.mark.usefixtures("undrawn")
def test_the_report_has_a_section_for_each_experiment(tmp_path, make_run, make_drive_run):
    for planner in ("ga1", "astar"):
        make_run(tmp_path, "first", "kg18_test1", planner, n=3, log=False)
        make_run(tmp_path, "second", "kg18_test2", planner, n=3, log=False)
    make_run(tmp_path, "table1", "kg18_test2", "ga1", n=3, log=False)
    make_drive_run(tmp_path, "third", "kg18_map1", "kg18", n=4)
    files, _ = make_report(tmp_path, tmp_path / "report")
    names = {file.name for file in files}
    page = files[-1].read_text()
    for task, experiment in (("plan", "first"), ("plan", "second"), ("drive", "third")):
        assert f'id="sweeps-table-{task}-{experiment}"' in page
    assert "sweeps-table-plan-table1" not in page
    assert {"sweep_plan_first_planner.csv", "sweep_plan_second_planner_best.csv"} <= names
    assert "sweep_drive_third_others.csv" in names


@pytest.mark.usefixtures("undrawn")
def test_infinite_effort_is_shown_with_the_least_it_can_be():
    (section,) = sections(ga(grid(population=[20, 50]), success=0.0, n=10))
    shown = by_name(section, "population").shown["Expected evaluations"].iloc[0]
    least = 104.5 / wilson(0, 10)[1]
    assert shown == f"\N{INFINITY} (at least {least:.0f})"
    assert math.isinf(by_name(section, "population").data["expected_evaluations"].iloc[0])

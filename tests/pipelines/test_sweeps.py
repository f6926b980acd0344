"""Sections that are about every experiment, or every task, alike."""

import math

import pandas as pd
import pytest

from gapath.discovery import load
from gapath.pipelines.numbers.text import NOTHING
from gapath.pipelines.page.section import ALL, find_sections
from gapath.pipelines.report.report import make_report
from gapath.pipelines.sweeps import table_metrics
from gapath.store.records import find_runs
from gapath.task import find_task, metrics
from gapath.tasks.plan import Task as PlanTask

from .conftest import collect, record_of
from .synthetic import METRICS


class RoundTrip(PlanTask):
    """A task of which the report knows nothing."""

    name = "round_trip"
    row = type("RoundTripRow", (), {})
    success = "came_back"


@pytest.fixture
def round_trip(monkeypatch):
    """Let the sections find the task."""
    monkeypatch.setattr(table_metrics, "find_task", lambda name: RoundTrip)
    return [record_of("astar", "a", task="round_trip")]


def trials(**columns):
    frame = pd.DataFrame(columns)
    defaults = {
        "experiment": "mine", "map": "kg18_test1", "map_source": "reconstructed",
        "map_instance": 0, "start": "(1, 6)", "target": "(22, 6)", "planner": "ga1",
        "feasible": True, "key": "a", **METRICS,
    }  # fmt: skip
    return frame.assign(**{k: v for k, v in defaults.items() if k not in frame})


def test_metrics_worked_by_hand():
    """A trial that failed has no turns and no length: neither may count."""
    frame = trials(
        feasible=[True, True, False, True, True, True],
        turns=[1, 2, 0, 4, 8, 100],
        length=[10.0, 20.0, math.nan, 30.0, 40.0, 50.0],
        clearance=[1.0, 1.0, math.nan, 1.5, 2.5, 4.0],
    )
    made = table_metrics.section(frame, [record_of("ga1", "a")])
    (made_table,) = made.tables
    (row,) = made_table.data.to_dict("records")
    assert (row["n"], row["succeeded"]) == (6, 5)
    assert [row[f"turns_{key}"] for key in ("q1", "median", "q3")] == [2, 4, 8]
    assert [row[f"length_{key}"] for key in ("q1", "median", "q3")] == [20, 30, 40]
    (shown,) = made_table.shown.to_dict("records")
    assert list(shown) == ["Experiment", "Map", "Planner", "Problems", "Trials", "Feasible"] + [
        load("metric", name).TITLE for name in metrics()
    ]
    assert list(shown.values())[:6] == ["mine", "Map 1 (reconstructed)", "GA 1", "1", "6", "5"]
    assert (shown["Turns"], shown["Length, fields"]) == ("4 (2 to 8)", "30 (20 to 40)")
    assert shown["Clearance, fields"] == "1.5 (1 to 2.5)"
    assert made_table.name == "metrics_plan" and "(feasible)" in made_table.caption
    assert len(made.remarks) == len(metrics()) and all(made.remarks)


def test_quartiles_lie_between_two_paths():
    made = table_metrics.section(trials(turns=[1, 2, 4, 8]), [record_of("ga1", "a")])
    (row,) = made.tables[0].data.to_dict("records")
    assert [row[f"turns_{key}"] for key in ("q1", "median", "q3")] == [1.75, 3, 5]


def test_a_metric_that_is_missing_everywhere_shows_a_dash():
    frame = trials(planner=["ga1", "ga1", "astar"], curvature=[math.nan, math.nan, 0.25])
    rows = table_metrics.section(frame, [record_of("ga1", "a")]).tables[0].shown
    assert list(rows["Curvature, rad / field"]) == [NOTHING, "0.25 (0.25)"]
    assert list(rows["Turns"]) == ["4 (4)", "4 (4)"]


def test_whoever_never_succeeds_has_a_row_without_metrics():
    (made,) = table_metrics.section(trials(feasible=[False]), [record_of("ga1", "a")]).tables
    (shown,) = made.shown.to_dict("records")
    assert (shown["Trials"], shown["Feasible"]) == ("1", "0")
    assert [shown[load("metric", name).TITLE] for name in metrics()] == [NOTHING] * len(metrics())
    assert made.latex().isascii()


def test_each_experiment_map_and_method_has_its_metrics(outputs):
    frame = collect(outputs).trials["plan"]
    (made,) = table_metrics.section(frame, find_runs(outputs)).tables
    assert len(made.data) == 2 * 4 * 5
    assert made.data["n"].sum() == len(frame)
    assert made.data["succeeded"].sum() == frame["feasible"].sum()


@pytest.mark.usefixtures("undrawn")
def test_every_task_has_its_metrics(tmp_path, make_run, make_drive_run):
    make_run(tmp_path, "table1", "kg18_test1", "ga1", n=3)
    make_drive_run(tmp_path, "drives", "kg18_map1", "kg18", n=4, log=True)
    files, skipped = make_report(tmp_path, tmp_path / "report")
    assert skipped == []
    assert {f"metrics_{task}.csv" for task in ("plan", "drive")} <= {file.name for file in files}
    page = files[-1].read_text()
    for task in ("plan", "drive"):
        rows = pd.read_csv(tmp_path / "report" / f"metrics_{task}.csv")
        assert list(rows["n"]) == [{"plan": 3, "drive": 4}[task]]
        assert find_task(task).groups[0] in rows
        assert f'id="sweeps-table-metrics-{task}"' in page
    assert "sweeps-table-plan" not in page and "sweeps-table-drive" not in page


def test_metrics_are_asked_for_every_task_and_experiment():
    asked = [module for module in find_sections() if module.TASK == ALL == module.EXPERIMENT]
    assert asked == [table_metrics]


def test_a_task_without_a_section_has_metrics_of_what_succeeded(round_trip):
    frame = trials(came_back=[True, False], turns=[3, 9], feasible=True)
    (made,) = table_metrics.section(frame, round_trip).tables
    assert made.name == "metrics_round_trip" and "(came_back)" in made.caption
    (row,) = made.data.to_dict("records")
    assert (row["n"], row["succeeded"], row["turns_median"]) == (2, 1, 3)

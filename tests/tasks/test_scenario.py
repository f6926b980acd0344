"""A whole scenario in one run: rows, streams, keys, logs, and problems without a way."""

import itertools
import json
import math
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf
from recorders.log_events import plain
from recorders.recordings import centres, read

from gapath.commands import log as log_cli
from gapath.errors import InputError
from gapath.events import Posed, RunStarted
from gapath.kernels.rng import stream
from gapath.pipelines.reading.library import run as run_in
from gapath.pipelines.report.stills import stills_of
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem
from gapath.querying.row import PlanRow
from gapath.recorders.mcap import FILE, read_events
from gapath.running.again import events_again, made_again
from gapath.running.config import conf_folder, make_run
from gapath.running.experiment import execute, run_folder
from gapath.store.records import read_record
from gapath.task import Batch, columns
from gapath.tasks import scenario

MAP = "type octile\nheight 6\nwidth 9\nmap\n" + "\n".join(
    [".........", ".@@@@....", ".@..@....", ".@@@@....", ".........", "........."]
)
ROWS = (
    (1, 0, 0, 8, 5, 9.4853),  # round the box
    (0, 2, 2, 3, 2, 1.0),  # within it
    (1, 0, 0, 2, 2, 5.0),  # from without to within: no way
    (1, 1, 1, 8, 5, 8.0),  # from an obstacle
    (1, 8, 0, 0, 5, 9.0711),
    (2, 8, 5, 8, 0, 5.0),
)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("m.map").write_text(MAP)
    lines = ["\t".join(map(str, (b, "m.map", 9, 6, x, y, u, v, n))) for b, x, y, u, v, n in ROWS]
    Path("m.map.scen").write_text("\n".join(["version 1", *lines]) + "\n")
    return tmp_path


def run_of(*overrides):
    words = ["task=scenario", "recorder=none", *overrides]
    if not any(word.startswith("map=") for word in words):
        words = ["map=movingai", "map.path=m.map", "map.scenario=m.map.scen", *words]
    with initialize_config_dir(conf_folder(), version_base="1.3"):
        config = compose("config", overrides=words, return_hydra_config=True)
    choices = dict(config.hydra.runtime.choices)
    OmegaConf.set_struct(config, False)
    del config["hydra"]
    return make_run(config, choices)


def rows_of(*overrides):
    return rows_in(execute(run_of("force=true", *overrides), ""))


def rows_in(execution):
    """A run's rows, one by one."""
    names, values = zip(*execution.rows.items(), strict=True)
    trials = zip(*(column.tolist() for column in values), strict=True)
    return [SimpleNamespace(**dict(zip(names, trial, strict=True))) for trial in trials]


def test_a_row_of_the_file_is_a_row_with_its_own_problem(here):
    rows = rows_of("planner=astar")
    assert [row.trial for row in rows] == [row.row for row in rows] == list(range(6))
    assert [(r.bucket, r.start, r.target, r.published_length) for r in rows] == [
        (b, str((x, y)), str((u, v)), n) for b, x, y, u, v, n in ROWS
    ]
    assert [row.status for row in rows] == [
        "optimal", "optimal", "infeasible", "infeasible", "optimal", "optimal"
    ]  # fmt: skip
    for row in rows:
        feasible = row.feasible
        assert feasible == math.isfinite(row.optimal_cost) == (row.optimality_ratio == 1.0)
        assert feasible == math.isfinite(row.plan_time_s) == math.isfinite(row.length)


@pytest.mark.parametrize("rule", ["allow", "forbid"])
def test_a_row_is_what_a_run_of_its_own_is(here, rule):
    """For planners without chance: those of a row after another, and one at a time, agree."""
    rows = rows_of("planner=astar_length", f"corner_cutting={rule}")
    for number in (0, 1, 4, 5):
        (alone,) = rows_of(
            "task=plan", "planner=astar_length", f"map.problem={number}", f"corner_cutting={rule}"
        )
        mine = vars(rows[number])
        for name in columns(PlanRow):
            value = getattr(alone, name)
            if name not in ("trial", "experiment", "plan_time_s", "stage_times_s"):
                assert mine[name] == value or (value != value and mine[name] != mine[name]), name


def test_a_trial_depends_on_seed_row_and_repetition_alone(here):
    settings = ("planner=ga1", "planner.population=10", "seed=5", "trials=3")
    rows = rows_of(*settings)
    run = run_of(*settings)
    assert run.trials == len(rows) == 18
    assert [row.row for row in rows] == [number for number in range(6) for _ in range(3)]
    for row in rows:
        if row.status == "infeasible":
            continue
        _, x, y, u, v, _ = ROWS[row.row]
        problem = Problem(run.problem.map, (x, y), (u, v))
        alone = run.task.planner.plan(problem, stream(5, row.trial % 3, row.row))
        assert (alone.cost, alone.epochs) == (row.cost, row.epochs)

    def drawn(*more):
        return {(r.row, r.trial % 3): (r.cost, r.epochs) for r in rows_of(*settings, *more)}

    every = drawn()
    assert drawn("threads=3") == every
    some = drawn("scenario.first=1", "scenario.every=3")
    assert some == {key: value for key, value in every.items() if key[0] in (1, 4)}
    last = drawn("scenario.last=1")
    assert last == {key: value for key, value in every.items() if key[0] <= 1}


def test_the_key_knows_the_scenario_and_what_is_taken_of_it(here):
    whole, again = run_of("planner=astar"), run_of("planner=astar")
    assert run_folder(whole).path == run_folder(again).path
    half = run_of("planner=astar", "scenario.every=2")
    manifests = []
    for run in (whole, half):
        execute(run, "")
        manifests.append(read_record(run_folder(run).path).known)
    text = Path("m.map.scen").read_text()
    Path("m.map.scen").write_text(text.replace("8\t0\t0\t5\t", "8\t1\t0\t5\t"))
    other = run_of("planner=astar")
    assert len({run_folder(run).path for run in (whole, half, other)}) == 3
    execute(other, "")
    manifests.append(read_record(run_folder(other).path).known)
    assert len({known.setting for known in manifests}) == 3
    assert len({known.queries for known in manifests}) == 3
    assert [known.trials for known in manifests] == [6, 3, 6]


def test_the_log_holds_every_problem_and_does_it_again(here):
    run = run_of("planner=ga1", "planner.population=10", "trials=2", "recorder=[mcap,rerun]",
                 "recorder.rerun.trials=[3]")  # fmt: skip
    done = execute(run, "")
    assert "trial-3.rrd" in done.files
    shown = read(done.folder / "trial-3.rrd")  # the second of row 1
    assert shown["/map/start", "Points2D:positions"] == centres([(2, 2)])
    assert shown["/map/target", "Points2D:positions"] == centres([(3, 2)])
    assert shown["/map/optimal_path", "LineStrips2D:strips"] == [centres([(2, 2), (3, 2)])]
    assert "| problem | 1 |" in shown["/text", "TextDocument:text"][0]
    events = read_events(done.folder / FILE)
    started = next(events)
    assert isinstance(started, RunStarted) and started.trials == 12
    assert all(
        mine.tolist() == theirs.tolist()
        for mine, theirs in zip(
            started.problem.queries.columns, run.problem.queries.columns, strict=True
        )
    )
    logged = list(events)
    again = list(events_again(made_again(started)))[1:]
    assert list(map(plain, logged)) == list(map(plain, again))
    assert log_cli.main(["verify", str(done.folder / FILE)]) == 0
    posed = [event for event in logged if isinstance(event, Posed)]
    assert [(e.trial, e.number, *e.start, *e.target) for e in posed] == [
        (2 * i + k, i, x, y, u, v) for i, (_, x, y, u, v, _) in enumerate(ROWS) for k in range(2)
    ]
    for event, row in zip(posed, rows_in(done), strict=True):
        assert event.optimal_cost == row.optimal_cost
        assert len(event.optimal_path) > 0 or not row.feasible


def test_the_library_and_the_page_know_the_problem_of_a_trial(here):
    done = execute(run_of("planner=astar", "recorder=mcap"), "")
    mine = run_in(done.folder)
    assert (mine.trial(4).problem.start, mine.trial(4).path[0].tolist()) == ((8, 0), [8, 0])
    with pytest.raises(InputError, match="obstacle"):
        mine.trial(3)
    (still,) = stills_of(read_record(done.folder)).stills
    assert still.asked.ends[:2] == [("S", 0, 0), ("T", 8, 5)] and len(still.asked.ends) == 10
    assert len(still.lines) == len(still.asked.least) == 3
    unlogged = execute(run_of("planner=astar"), "")
    assert len(run_in(unlogged.folder).problem.queries) == 6


def test_the_run_stands_for_the_first_problem_that_has_a_way(here):
    lines = Path("m.map.scen").read_text().splitlines()
    order = [3, 2, 4]  # blocked, no way, a way
    Path("m.map.scen").write_text("\n".join(lines[:1] + [lines[1 + i] for i in order]))
    run = run_of("planner=astar")
    assert (run.problem.start, run.problem.target) == ((8, 0), (0, 5))
    assert execute(run, "").state == "done"
    Path("m.map.scen").write_text("\n".join(lines[:1] + [lines[1 + i] for i in order[:2]]))
    none = run_of("planner=astar")
    assert none.problem.start == (0, 0) and execute(none, "").state == "infeasible"


@pytest.mark.parametrize(("planner", "searches"), [("astar", 1), ("ga1", 5), ("astar_length", 9)])
def test_what_is_known_to_be_optimal_is_not_searched_twice(here, monkeypatch, planner, searches):
    """One for the run, and one for each row with a way, by each measure that is asked for."""
    calls = []

    def counted(*given, **more):
        calls.append(given)
        return shortest_path(*given, **more)

    monkeypatch.setattr(scenario, "shortest_path", counted)
    monkeypatch.setattr("gapath.querying.row.shortest_path", counted)
    rows_of(f"planner={planner}", "trials=2")
    assert len(calls) == searches


class Told:
    """A* that tells of its stages, and takes no problem that starts at (2, 2)."""

    exact, minimises = False, "weights"

    def check(self, problem):
        if problem.start == (2, 2):
            raise InputError("map.start", problem.start, "another")

    def plan(self, problem, stream):
        return replace(shortest_path(problem), stages={"search": 0.25})


def test_a_refused_problem_is_a_failure(here):
    run = run_of("planner=astar")
    task = replace(run.task, planner=Told())
    batch = Batch("", "told", run.problem, 0, run.trials)
    rows = [trial.row for trial in task.trials(batch, task.optimum(run.problem))]
    assert [row.feasible for row in rows] == [True, False, False, False, True, True]
    assert (rows[1].status, rows[1].optimal_cost) == ("not_found", 1.0)
    assert math.isnan(rows[1].plan_time_s)
    assert json.loads(rows[0].stage_times_s) == {"search": 0.25}


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (["scenario.first=6"], "scenario.first: got 6, expected a row of the scenario, 0 to 5"),
        (["scenario.last=6"], "scenario.last: got 6, expected null, or a row of the scenario"),
        (["scenario.first=3", "scenario.last=2"], "scenario.last: got 2, expected an integer from"),
        (["scenario.every=0"], "scenario.every: got 0"),
        (["scenario.drawn=0"], "scenario.drawn: got 0"),
        (["trials=200000"], "trials: got 200000, expected fewer: 1200000 in all"),
        (["recorder=rerun", "recorder.rerun.trials=[6]"], "trials of this run, 0 to 5"),
    ],
)
def test_bad_settings_are_one_line(here, settings, message):
    with pytest.raises(InputError) as caught:
        run_of("planner=astar", *settings)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("version 1\n", "a row of m.map.scen, which has 0"),
        ("version 1\n0 m.map 9 6 0 0 9 5 1\n", "problem 0: got [0, 0] to [9, 5], expected fields"),
        ("version 1\n0 m.map 9 6 0 0 -1 5 1\n", "problem 0: got [0, 0] to [-1, 5]"),
        ("version 1\n0 m.map 9 6 0 0 8 5 9\n0 n.map 9 6 0 0 8 5 9\n", "m.map.scen, row 1: got"),
        ("version 1\n0 m.map 9 6 1 1 8 5 9\n", "[1, 1], an obstacle"),
    ],
)
def test_a_scenario_of_another_map_is_one_line(here, text, message):
    Path("m.map.scen").write_text(text)
    with pytest.raises(InputError) as caught:
        run_of("planner=astar")
    assert message in str(caught.value)


def test_where_no_scenario_is_problems_are_drawn(here):
    rows = rows_of("map=kg18_test2", "planner=astar", "scenario.drawn=12")
    assert len({(row.start, row.target) for row in rows}) == 12
    assert (rows[0].start, rows[0].target) == ("(0, 24)", "(98, 24)")  # the map's own
    assert all(row.feasible and math.isnan(row.published_length) for row in rows)
    assert all(row.bucket == int(row.length / 4) for row in rows)


def test_a_log_of_no_queries_has_none(here):
    run = run_of("planner=astar")
    alone = replace(run.problem, queries=None)
    batch = Batch("", "astar", alone, 0, 2)
    trials = list(run.task.trials(batch, run.task.optimum(alone)))
    assert [trial.row.row for trial in trials] == [0, 0]
    first, second = (list(trial.events(0))[1] for trial in trials)
    assert plain(first) == plain(replace(second, trial=0))


def test_all_rows_of_a_real_scenario_have_their_published_lengths(data, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    grid = data / "movingai" / "dao" / "arena.map"
    rows = rows_of(
        "map=movingai", f"map.path={grid}", f"map.scenario={grid}.scen", "planner=astar_length",
        "corner_cutting=forbid",
    )  # fmt: skip
    assert len(rows) == 160
    assert np.allclose([row.length_ratio for row in rows], 1.0, atol=1e-4)
    ratios = itertools.pairwise(sorted(row.bucket for row in rows))
    assert all(b - a in (0, 1) for a, b in ratios)

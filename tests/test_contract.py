"""What every planner, recorder and map reader must do; they are found, not listed."""

import inspect
from functools import cache
from importlib.resources import files

import numpy as np
import pytest
import yaml

from gapath import components, discovery
from gapath.discovery import kinds, readers, yaml_names, yaml_values
from gapath.driving.navigation import Navigator
from gapath.errors import InputError
from gapath.events import Finished, Recorder, RunFinished, TrialStarted
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.planning.flaw import flaw
from gapath.planning.path import polyline_length
from gapath.planning.planner import Planner
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import plan_once, plan_trials
from gapath.problem import CornerCutting, Plan, PlanStatus, Problem
from gapath.querying.told import trial_events
from gapath.running import config
from gapath.running.experiment import execute, run_started
from gapath.running.naming import Method
from gapath.store.settings import flatten
from gapath.task import Batch, Task, check_events, columns, find_task
from gapath.tasks.plan import Task as PlanTask

PLANNERS, RECORDERS, MAPS = map(yaml_names, ("planner", "recorder", "map"))


def make_planner(name, **values) -> Planner:
    return components.build("planner", yaml_values("planner", name) | values, "planner")


def make_problem(rule=CornerCutting.ALLOW):
    """A map that every planner should solve now and then: one wall with a wide gap."""
    weights = np.full((40, 60), 0.5)
    weights[:24, 30] = 1.0
    return Problem(GridMap("wall", weights), (4, 20), (54, 20), rule)


@pytest.mark.parametrize("group", sorted(discovery.OFFERS.keys() - {"task"}))
def test_every_module_has_a_yaml_and_every_yaml_a_module(group):
    named = {yaml_values(group, name)["kind"] for name in yaml_names(group)}
    assert named == set(discovery.kinds(group))


@pytest.mark.parametrize("group", sorted(discovery.OFFERS.keys() - {"task"}))
def test_every_value_of_a_yaml_is_a_field_without_default(group):
    for name in yaml_names(group):
        values = yaml_values(group, name)
        target = discovery.load(group, values.pop("kind"))
        wanted = inspect.signature(target).parameters
        assert set(values) == set(wanted), name
        assert all(p.default is inspect.Parameter.empty for p in wanted.values()), name


@pytest.mark.parametrize("protocol", [Planner, Navigator, Recorder, Task])
def test_what_is_asked_of_a_package_is_the_protocol(protocol):
    name, needed = discovery.OFFERS[protocol.__name__.lower()]
    members = {*vars(protocol), *inspect.get_annotations(protocol)}
    assert name == protocol.__name__
    assert set(needed.split()) == {member for member in members if not member.startswith("_")}


@pytest.mark.parametrize("name", PLANNERS)
@pytest.mark.parametrize("rule", list(CornerCutting))
def test_planners_give_paths_that_are_paths(name, rule):
    planner, problem = make_planner(name), make_problem(rule)
    assert isinstance(planner, Planner)
    optimum = shortest_path(problem)
    for trial in range(5):
        plan = planner.plan(problem, rng.stream(1, trial))
        assert isinstance(plan, Plan)
        if plan.feasible:
            assert flaw(problem, plan.path) is None
            assert plan.cost >= optimum.cost
            entries = problem.map.weights[plan.path[:, 1], plan.path[:, 0]]
            assert plan.cost == pytest.approx(entries.sum())
        else:
            assert plan.status in (PlanStatus.NOT_FOUND, PlanStatus.INFEASIBLE)
            assert not len(plan.path)


def check_finds(planner):
    """Raise AssertionError unless a planner finds a path on a map without an obstacle."""
    grid = GridMap("empty", np.full((24, 24), 0.5))
    problem = Problem(grid, (2, 2), (21, 21))
    assert any(planner.plan(problem, rng.stream(3, trial)).feasible for trial in range(20))


@pytest.mark.parametrize("name", PLANNERS)
def test_planners_find_a_path_where_nothing_is_in_the_way(name):
    check_finds(make_planner(name))


@pytest.mark.parametrize("name", PLANNERS)
def test_exact_planners_find_every_path(name):
    planner = make_planner(name)
    for rule in CornerCutting:
        plan = planner.plan(make_problem(rule), rng.stream(0))
        assert plan.feasible or not planner.exact


def test_a_planner_that_gives_up_breaks_the_contract():
    class Quitter:
        exact = False
        minimises = "weights"

        def plan(self, problem, stream):
            return Plan(PlanStatus.NOT_FOUND)

    with pytest.raises(AssertionError):
        check_finds(Quitter())


@pytest.mark.parametrize("name", PLANNERS)
def test_planners_give_the_same_plan_for_the_same_stream(name):
    planner, problem = make_planner(name), make_problem()
    first, again = (planner.plan(problem, rng.stream(5, 3)) for _ in range(2))
    assert (first.status, first.cost, first.epochs) == (again.status, again.cost, again.epochs)
    assert first.path.tolist() == again.path.tolist()
    in_company = list(plan_trials(problem, shortest_path(problem), planner, 5, 4))[3].plan
    assert in_company.path.tolist() == first.path.tolist()


PICTURES = ("plot", "convergence", "animate")


def told(plan):
    """All that can be asked of a plan, by name: what is called needs no argument."""
    names = [name for name in dir(plan) if not name.startswith(("_", *PICTURES))]
    return {
        name: value() if callable(value := getattr(plan, name)) else value
        for name in [*names, "__repr__", "_repr_html_"]
    }


@pytest.mark.parametrize("name", PLANNERS)
def test_whatever_is_asked_of_a_plan_it_tells(name):
    planner, grid = make_planner(name), make_problem().map
    weights = np.full((24, 24), 0.5)
    weights[:, 12] = 1.0
    halves = Problem(GridMap("halves", weights), (2, 2), (21, 21))
    problems = [make_problem(), Problem(grid, (4, 20), (4, 20)), halves]
    plans = [planner.plan(each, rng.stream(3, i)) for each in problems for i in range(2)]
    assert not all(plan.feasible for plan in plans)
    asked = [problem for problem in problems for _ in range(2)]
    asked += [problems[2], problems[0]]
    plans += [plan_once(problems[2], planner, 0), Plan(PlanStatus.NOT_FOUND)]
    for problem, plan in zip(asked, plans, strict=True):
        answers = told(plan)
        lines = answers["lines"]
        assert lines.dtype == np.int32 and lines.ndim == 2 and lines.shape[1] == 2
        if len(lines):
            assert plan.feasible
            assert [tuple(lines[i]) for i in (0, -1)] == [problem.start, problem.target]
        assert answers["trace"] is None or len(answers["trace"].best) == plan.epochs
        assert answers["survey"] is None or len(answers["survey"].points) >= 2
        assert plan.status.name.lower() in answers["_repr_html_"]


@pytest.mark.parametrize("name", PLANNERS)
def test_a_walled_in_target_is_infeasible(name):
    weights = np.full((12, 12), 0.5)
    weights[7:10, 7:10] = 1.0
    weights[8, 8] = 0.0
    problem = Problem(GridMap("walled", weights), (1, 1), (8, 8))
    assert plan_once(problem, make_planner(name), 0).status is PlanStatus.INFEASIBLE


@pytest.mark.parametrize("name", PLANNERS)
def test_an_evolution_tells_its_epochs(name):
    problem = make_problem()
    plan = make_planner(name).plan(problem, rng.stream(2))
    evolution = plan.evolution
    if evolution is None:
        assert plan.epochs == plan.evaluations == 0
        return
    assert plan.evaluations >= plan.epochs >= 1
    assert {len(part) for part in evolution[:4]} == {plan.epochs}
    assert evolution.way_points.shape[2] == 2
    if evolution.genotype == "keypoints":  # fitness is a length, on a resized map that of blocks
        resized = plan.survey().block > 1
        length = polyline_length(evolution.way_points[-1])
        assert evolution.best[-1] == pytest.approx(length, rel=0.1 if resized else 1e-5)
    else:
        assert evolution.best[-1] == plan.cost
    assert (evolution.mean >= evolution.best).all()


def make_run(recorders, planner, tmp_path, trials=3):
    return config.Run(
        "contract",
        Method("any"),
        make_problem(),
        PlanTask(planner),
        recorders,
        4,
        trials,
        flatten({"task": "plan", "planner": yaml_values("planner", "ga1")}),
        str(tmp_path),
        False,
    )


@cache  # each recorder takes the same
def trials_of(planner_name):
    planner, problem = make_planner(planner_name), make_problem()
    return [*plan_trials(problem, shortest_path(problem), planner, 4, 3)]


@pytest.mark.parametrize("name", RECORDERS)
@pytest.mark.parametrize("planner_name", PLANNERS)
def test_recorders_take_every_planners_events(name, planner_name, tmp_path):
    planner, problem = make_planner(planner_name), make_problem()
    recorder = components.build("recorder", yaml_values("recorder", name), "recorder")
    assert isinstance(recorder, Recorder)
    optimum = shortest_path(problem)
    recorder.open(str(tmp_path))
    recorder.record(run_started(make_run([], planner, tmp_path), optimum))
    step = 0
    for trial in trials_of(planner_name):
        for event in trial_events(trial, 4, step):
            recorder.record(event)
        step += max(trial.plan.epochs, 1)
    recorder.record(RunFinished(step, 3, 3))
    names = recorder.close()
    assert sorted(names) == sorted(path.name for path in tmp_path.iterdir())
    assert all((tmp_path / file).stat().st_size > 0 for file in names)


@pytest.mark.parametrize("name", RECORDERS)
def test_a_recorder_that_is_aborted_leaves_no_file_that_looks_whole(name, tmp_path):
    planner, problem = make_planner("ga1"), make_problem()
    recorder = components.build("recorder", yaml_values("recorder", name), "recorder")
    recorder.open(str(tmp_path))
    recorder.record(run_started(make_run([], planner, tmp_path), shortest_path(problem)))
    recorder.abort()
    assert all(path.suffix == ".part" for path in tmp_path.iterdir())


@pytest.mark.parametrize("name", RECORDERS)
def test_recording_changes_no_result(name, tmp_path):
    rows, recorder = [], components.build("recorder", yaml_values("recorder", name), "recorder")
    for recorders in ([], [recorder]):
        folder = tmp_path / str(len(recorders))
        came = execute(make_run(recorders, make_planner("ga1"), folder), "test", False).rows
        rows.append([came[name].tolist() for name in ("status", "cost", "epochs", "evaluations")])
    assert rows[0] == rows[1]


@pytest.mark.parametrize("name", MAPS)
def test_map_readers_read_or_say_what_is_missing(name):
    values = yaml_values("map", name)
    if values.get("path") == "???":
        values["path"] = "no such file"
        with pytest.raises(InputError, match="no such file"):
            components.build("map", values, "map").read()
    else:
        grid = components.build("map", values, "map").read()
        assert isinstance(grid, GridMap)
        Problem(grid, grid.start, grid.target)


NO_MAPS = [
    b"",
    b"hello",
    b"\0\xff\xfe\xfd",
    b"{}",
    b"[" * 50_000,
    b"<sdf/>",
    b"999999999\n",
    b"type octile\nheight 3\nwidth 999999999\nmap\n...",
    b"P5 999999999 999999999 255\n\0",
    b"image: ../../x\n",
    bytes(range(256)) * 40,
]


@pytest.mark.parametrize("content", NO_MAPS, ids=lambda content: str(content[:12]))
@pytest.mark.parametrize("suffix", sorted(readers()))
def test_map_readers_turn_what_is_no_map_into_one_error(suffix, content, tmp_path):
    path = tmp_path / f"map{suffix}"
    path.write_bytes(content)
    for where in (path, tmp_path, tmp_path / f"none{suffix}"):
        values = yaml_values("map", readers()[suffix]) | {"path": str(where)}
        with pytest.raises(InputError) as caught:
            components.build("map", values, "map").read()
        message = str(caught.value)
        assert message.startswith(str(where)) and "expected" in message
        assert "\n" not in message and len(message) < 500


def make_task(task):
    plain = yaml.safe_load((files("gapath.conf") / "config.yaml").read_text("utf-8"))
    method = yaml_values(task.groups[0], MADE_WITH[task.groups[0]])
    return task.make({group: plain.get(group, method) for group in task.groups})


@pytest.mark.parametrize("name", kinds("task"))
def test_trials_that_fail_have_no_metrics(name):
    made = make_task(find_task(name))
    weights = np.full((24, 24), 0.5)
    weights[:, 12] = 1.0
    problem = Problem(GridMap("halves", weights), (2, 2), (21, 21))
    batch = Batch("contract", "any", problem, 3, 2)
    for trial in made.trials(batch, made.optimum(problem)):
        values = trial.row.values()
        assert not trial.found
        assert all(np.isnan(values[metric]) for metric in [*kinds("metric"), "length_ratio"])


@pytest.mark.parametrize("name", kinds("task"))
def test_tasks_say_what_they_are_and_tell_what_they_say(name):
    task = find_task(name)
    assert isinstance(task, Task)
    assert task.name == name
    check_events(task)
    assert columns(task.row)[task.groups[0]] is str
    assert columns(task.row)[task.success] is bool
    made, problem = make_task(task), make_problem()
    made.check(problem)
    optimum = made.optimum(problem)
    trials = list(made.trials(Batch("contract", "any", problem, 3, 2), optimum))
    assert [trial.row.trial for trial in trials] == [0, 1]
    later = made.trials(Batch("contract", "any", problem, 3, 2, first=1), optimum)
    assert [trial.row.trial for trial in later] == [1]
    step = 0
    for trial in trials:
        told = list(trial.events(step))
        assert {type(event) for event in told} <= set(task.events)
        assert isinstance(told[0], TrialStarted) and told[0].step == step
        assert isinstance(told[-1], Finished) and told[-1].ending
        assert told[-1].step == step + trial.steps - 1
        assert trial.row.values().keys() == columns(task.row).keys()
        assert trial.row.values()[task.success] == trial.found
        step += trial.steps
    kinds, rows = columns(task.row), [trial.row.values() for trial in trials]
    for some in (rows, rows[:1]):
        held = {name: np.array([row[name] for row in some], dtype=object if kind is str else kind)
                for name, kind in kinds.items()}  # fmt: skip
        assert made.summary(held) and made.line(held)


MADE_WITH = {"planner": "ga1", "navigator": "replan_astar"}

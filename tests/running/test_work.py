"""How much work a run is said to be: a bound, of plans, of drives, and of what a log has."""

import pytest
from reliability.logs.logs_of_runs import OF_FILES, RUNS, log_of
from test_config import run_of

from gapath.errors import InputError
from gapath.recorders import mcap
from gapath.running import verify
from gapath.running.again import made_again
from gapath.running.work import MUCH, likely, told, work


def bound_of(log):
    """The bound of a trial, how many there are, and what all of them did."""
    run = next(mcap.read_events(log))
    each = work(made_again(run).task, run.settings, run.problem.map.weights.size)
    plans = list(mcap.answers(log, mcap.USUAL))
    return each, run.trials, sum(1 + plan.evaluations + plan.expansions for plan in plans)


@pytest.mark.parametrize("name", [*RUNS, *OF_FILES])
def test_no_run_does_more_than_it_is_said_to(name, tmp_path):
    each, trials, did = bound_of(log_of(name, tmp_path))
    assert 0 < did <= trials * each


@pytest.mark.parametrize(("steps", "words", "once"), [
    (1, ["planner=ga3", "planner.population=50", "planner.max_epochs=900"], 50 * 900),
    (70, ["task=drive"], 100 * 100 + 40 * 10 + 4 * 100 * 200),
    (2000, ["task=drive", "navigator=replan_astar"], 0),
])  # fmt: skip
def test_a_drive_may_plan_in_every_step(steps, words, once):
    run = run_of(*words, *([f"drive.step_limit={steps}"] if steps > 1 else []))
    fields = run.problem.map.weights.size
    few = 100  # a planner without a number of tries counts as one
    assert 0 <= work(run.task, run.settings, fields) - steps * (fields + once) <= few * steps


@pytest.mark.parametrize(("words", "least"), [
    (["planner=memetic", "planner.effort=1e6"], 10**6 * 100),
    (["planner=rrt_connect", "planner.shortcuts=1000000"], 10**6),
])  # fmt: skip
def test_what_is_done_beside_the_count_of_tries_counts(words, least):
    run = run_of(*words)
    fields = run.problem.map.weights.size
    assert least <= work(run.task, run.settings, fields)


def test_hours_are_told_before_they_begin():
    assert told([(10, MUCH // 20), (1, 0)]) is None
    assert "1000000 trials of up to 3e+07 individuals and fields each: up to 2.1e+03 hours" in str(
        told([(10**6, 3 * 10**7)])
    )


def test_nobody_is_told_of_hours_before_a_hundred_drives_of_seconds(tmp_path):
    """Of a drive a hundredth of the bound is told, which is more than it does."""
    log = log_of("drive", tmp_path)
    each, trials, did = bound_of(log)
    run = next(mcap.read_events(log))
    told_of = likely(made_again(run).task, run.settings, run.problem.map.weights.size)
    assert told_of == each // 100
    assert did <= trials * told_of
    run = run_of("task=drive", "map=kg18_map4", "navigator=kg18")
    assert told([(100, likely(run.task, run.settings, run.problem.map.weights.size))]) is None


def test_of_a_log_what_it_has_is_counted(tmp_path, monkeypatch):
    log = log_of("plan", tmp_path, "trials=9")
    each, trials, did = bound_of(log)
    assert each + did < trials * each
    monkeypatch.setattr(verify, "MOST_WORK", each + did)
    assert not verify.verify(log, mcap.USUAL).found.difference
    monkeypatch.setattr(verify, "MOST_WORK", each + did - 1)
    with pytest.raises(InputError, match="or --yes to do it"):
        verify.verify(log, mcap.USUAL)
    assert not verify.verify(log, mcap.USUAL, much_work=True).found.difference

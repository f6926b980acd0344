"""Trials one after another: streams, clock, and planners that are wrong."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import planner

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.mapio.reconstructed import generate
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import batches, plan_trials
from gapath.planning.threads import in_order
from gapath.problem import Plan, PlanStatus, Problem

OPEN = Problem(GridMap("open", np.full((9, 9), 0.5)), (0, 4), (8, 4))


@dataclass
class Liar:
    """Claims to have found a path that is none."""

    def plan(self, problem, stream):
        return Plan(PlanStatus.FOUND, np.array([problem.start, problem.target], dtype=np.int32))


@dataclass
class Counter:
    """Counts its calls and remembers the first word of each stream."""

    words: list

    def plan(self, problem, stream):
        self.words.append(tuple(int(word) for word in stream))
        return Plan(PlanStatus.NOT_FOUND)


def test_a_path_that_is_none_is_found_out():
    with pytest.raises(RuntimeError, match="seed 3, trial 0: two successive fields"):
        list(plan_trials(OPEN, shortest_path(OPEN), Liar(), 3, 1))


def test_a_planner_that_gives_no_plan_is_named():
    class Silent:
        def plan(self, problem, stream):
            return None

    with pytest.raises(InputError, match=r"^test_simulation, plan: got None, expected a gapath"):
        list(plan_trials(OPEN, shortest_path(OPEN), Silent(), 3, 1))


def test_every_trial_has_its_own_stream_and_time():
    counter = Counter([])
    trials = list(plan_trials(OPEN, shortest_path(OPEN), counter, 3, 4))
    assert [trial.number for trial in trials] == [0, 1, 2, 3]
    assert all(trial.plan_time_s > 0 for trial in trials)
    warm_up, *streams = counter.words
    assert warm_up == streams[0]
    assert len(set(streams)) == 4


def test_an_infeasible_problem_calls_no_planner():
    weights = np.full((3, 3), 0.5)
    weights[:, 1] = 1.0
    problem = Problem(GridMap("split", weights), (0, 0), (2, 2))
    counter = Counter([])
    trials = list(plan_trials(problem, shortest_path(problem), counter, 0, 2))
    assert counter.words == []
    assert [trial.plan.status for trial in trials] == [PlanStatus.INFEASIBLE] * 2
    assert all(math.isnan(trial.plan_time_s) for trial in trials)


def test_corner_cutting_decides_whether_a_problem_is_feasible():
    from gapath.problem import CornerCutting

    weights = np.array([[0.5, 1.0], [1.0, 0.5]])
    for rule in CornerCutting:
        problem = Problem(GridMap("gap", weights), (0, 0), (1, 1), rule)
        (trial,) = plan_trials(problem, shortest_path(problem), planner(), 0, 1)
        for plan in (shortest_path(problem), trial.plan):
            assert plan.feasible == (rule is CornerCutting.ALLOW)
            assert plan.feasible or plan.status is PlanStatus.INFEASIBLE


@pytest.mark.parametrize("threads", [2, 5])
def test_threads_change_no_plan(threads):
    grid = generate("kg18_test3", 0)
    problem = Problem(grid, grid.start, grid.target)
    ga, optimum = planner(max_epochs=40), shortest_path(problem)
    alone = list(plan_trials(problem, optimum, ga, 3, 60))
    together = list(plan_trials(problem, optimum, ga, 3, 60, threads))
    assert [a.number for a in together] == list(range(60))
    assert [a.plan.cost for a in together] == [a.plan.cost for a in alone]
    for a, b in zip(alone, together, strict=True):
        assert a.plan.evolution.chromosomes.tolist() == b.plan.evolution.chromosomes.tolist()


@given(st.integers(0, 3000), st.integers(1, 9), st.integers(1, 64))
def test_batches_hold_every_trial_once_and_end_small(trials, threads, most):
    found = list(batches(trials, threads, most))
    assert [number for batch in found for number in batch] == list(range(trials))
    sizes = [len(batch) for batch in found]
    assert sizes == sorted(sizes, reverse=True)
    assert all(1 <= size <= most for size in sizes)
    left = 0  # what a batch may make others wait for is little beside what is still to do
    for size in reversed(sizes):
        left += size
        assert size == 1 or 4 * threads * size <= left


def test_a_planner_that_plans_many_is_asked_for_as_many_as_it_likes():
    sizes = []

    class Many(Counter):
        most_at_once = 5

        def plan_many(self, problem, streams):
            sizes.append(len(streams))
            return [self.plan(problem, stream) for stream in streams]

    optimum = shortest_path(OPEN)
    trials = list(plan_trials(OPEN, optimum, Many([]), 3, 100, 2))
    assert max(sizes) == 5 and sum(sizes) == 100
    assert [trial.number for trial in trials] == list(range(100))
    counter = Counter([])
    list(plan_trials(OPEN, optimum, counter, 3, 100))
    many = Many([])
    list(plan_trials(OPEN, optimum, many, 3, 100, 2))
    assert sorted(many.words[1:]) == sorted(counter.words[1:])


def test_a_failure_on_a_thread_ends_all_of_them():
    started = []

    def work(number):
        started.append(number)
        if number == 3:
            raise ValueError("three")
        return number

    results = in_order(work, range(10_000), 2)
    assert [next(results) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="three"):
        next(results)
    assert len(started) < 100

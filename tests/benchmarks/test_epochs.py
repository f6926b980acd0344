"""The libraries' genetic algorithms do as much work as gapath's, on the same fitness."""

import sys

import numpy as np
import pytest

from benchmarks.measure import Quartiles, make_planner, make_problem
from benchmarks.questions.kg18 import epochs
from benchmarks.rivals import visibility_library

ABSENT = "skipped: the bench extra is not installed"


@pytest.fixture
def problem():
    return make_problem(epochs.MAP)


@pytest.fixture(params=epochs.LIBRARIES)
def library(request):
    if why := epochs.why_not(request.param):
        pytest.skip(why)
    return request.param


@pytest.mark.parametrize("name", epochs.PLANNERS)
def test_a_library_does_the_same_work(library, problem, name):
    planner = make_planner(name, max_epochs=20)
    run, objective = epochs.library_run(library), epochs.Objective(problem, planner)
    expected = epochs.run_gapath(problem, planner, 0)().evaluations
    outcome = run(problem, planner, 0)()
    epochs.check_alike(library, outcome, objective, expected)
    genes = np.asarray(outcome.genes)
    assert genes.shape == (2 * planner.control_points - 4,)
    assert (genes == np.floor(genes)).all()
    assert (genes >= 0).all() and (genes <= objective.most).all()


def test_a_library_evolves(library, problem):
    """The best of ten epochs more is better on average, and never worse of one and the same run."""
    run = epochs.library_run(library)
    first, later = (
        [run(problem, make_planner("ga1", max_epochs=number), seed)().value for seed in range(5)]
        for number in (1, 11)
    )
    assert all(after <= before for before, after in zip(first, later, strict=True))
    assert sum(later) < sum(first)


def test_gapath_tells_what_its_best_is_worth(problem):
    planner = make_planner("ga3", max_epochs=7)
    outcome = epochs.run_gapath(problem, planner, 0)()
    assert outcome.evaluations == 100 + 6 * 75
    assert outcome.value == epochs.Objective(problem, planner)(outcome.genes)


def test_other_work_is_noticed(problem):
    planner = make_planner("ga1", max_epochs=10)
    objective = epochs.Objective(problem, planner)
    outcome = epochs.run_gapath(problem, planner, 0)()
    epochs.check_alike("same", outcome, objective, 310)
    with pytest.raises(RuntimeError, match="lazy evaluates 240 chromosomes, not 310"):
        epochs.check_alike("lazy", outcome._replace(evaluations=240), objective, 310)
    with pytest.raises(RuntimeError, match="busy evaluates 400 chromosomes, not 310"):
        epochs.check_alike("busy", outcome._replace(evaluations=400), objective, 310)
    with pytest.raises(RuntimeError, match="wrong: its best is worth"):
        epochs.check_alike("wrong", outcome._replace(value=outcome.value + 1), objective, 310)


def test_a_wrong_library_stops_it(monkeypatch):
    def wrong(library):
        return epochs.run_gapath if library != "deap" else first_epoch

    def first_epoch(problem, planner, seed):
        return epochs.run_gapath(problem, make_planner("ga1", max_epochs=1), seed)

    monkeypatch.setattr(epochs, "why_not", lambda library: None)
    monkeypatch.setattr(epochs, "library_run", wrong)
    with pytest.raises(RuntimeError, match="deap evaluates 40 chromosomes, not 760"):
        epochs.measure(quick=True)


def test_every_library_has_a_row(monkeypatch):
    monkeypatch.setattr(epochs, "PLANNERS", ("ga1",))
    rows = epochs.measure(quick=True)
    assert rows[0]["library"].startswith("gapath ")
    assert rows[0]["library / gapath"] == (1, 1, 1)
    assert {row["library"].split()[0] for row in rows[1:]} == set(epochs.LIBRARIES)
    for row in rows:
        assert row["population"] == 40
        timed = isinstance(row["us an epoch"], Quartiles)
        assert timed == ("library / gapath" in row)
        assert timed or row["us an epoch"].startswith("skipped: ")


def test_absent_libraries_say_why(monkeypatch):
    for module in (epochs, visibility_library):
        monkeypatch.setattr(module, "find_spec", lambda name: None)
    rows = epochs.measure(quick=True)
    assert [row["population"] for row in rows] == [40] * 5 + [100] * 5
    for row in (*rows[1:5], *rows[6:]):
        assert row["us an epoch"] == ABSENT and "library / gapath" not in row


def test_geneticalgorithm2_needs_python_3_11(monkeypatch):
    monkeypatch.setattr(visibility_library, "find_spec", lambda name: True)
    monkeypatch.setattr(sys, "version_info", (3, 12))
    assert epochs.why_not("geneticalgorithm2") == "skipped: geneticalgorithm2 needs Python 3.11"

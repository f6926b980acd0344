"""The device that plans: refused where it cannot, asked for many plans at once where it can."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from simulator import needs_numba_cuda, simulate
from strategies import planner

from gapath.commands import log
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.kg18.evolution import Outcomes, run_evolutions
from gapath.kernels.rng import stream
from gapath.planners import grid_search
from gapath.planning.device import CPU, CUDA, Portable, device_of, on_device
from gapath.planning.shortest_path import shortest_path
from gapath.planning.simulation import plan_trials
from gapath.problem import Problem
from gapath.store.rows import StoredRows
from gapath.tasks import plan

SEARCH = grid_search.Planner(informed=True, minimise="weights")
OPEN = Problem(GridMap("open", np.full((9, 14), 0.5)), (0, 4), (13, 4))


def on_a_card(ga):
    """The planner as a GPU would have it."""
    other = ga.using("scalar")
    object.__setattr__(other, "card", SimpleNamespace(name="a card"))
    return other


@pytest.fixture
def launches(monkeypatch):
    """How many runs each launch has had, done by the processor in place of a GPU."""
    from gapath.kernels.cuda import evolution

    def outcomes(card, table, ends, rule, settings, whole, streams):
        sizes.append(len(streams))
        basis = whole[0] / whole[1][:, None], 0.5 + 0.25 / whole[1]
        found = run_evolutions(table, ends, rule, settings, *basis, streams, planner().evolve)
        return Outcomes(
            np.array([len(each.epochs) for each in found]),
            np.array([each.epochs["key"][-1] for each in found]),
            np.array([each.chromosomes[-1] for each in found]),
        )

    sizes = []
    monkeypatch.setattr(evolution, "outcomes", outcomes)
    return sizes


def test_the_processor_is_no_choice():
    ga = planner()
    assert isinstance(ga, Portable) and device_of(ga) == CPU
    assert on_device(ga, CPU) is ga


@pytest.mark.parametrize(
    ("component", "device", "good"),
    [
        (planner(), "gpu", "cpu or cuda"),
        (SEARCH, CUDA, "cpu, which alone computes grid_search"),
        (plan.Task(SEARCH), CUDA, "cpu, which alone computes grid_search"),
    ],
)
def test_what_cannot_be_is_refused(component, device, good):
    with pytest.raises(InputError, match=f"device: got {device}, expected {good}"):
        on_device(component, device)


@needs_numba_cuda
def test_plans_of_a_card_are_those_of_the_processor(launches):
    ga = planner(max_epochs=30)
    ours, theirs = (np.array([stream(7, trial) for trial in range(9)]) for _ in range(2))
    card = on_a_card(ga)
    assert device_of(plan.Task(card)) == "a card"
    for a, b in zip(card.plan_many(OPEN, ours), ga.plan_many(OPEN, theirs), strict=True):
        assert (a.status, a.cost, a.epochs, a.evaluations) == (
            b.status,
            b.cost,
            b.epochs,
            b.evaluations,
        )
        assert a.path.tolist() == b.path.tolist()
        assert a.lines().tolist() == b.lines().tolist()
        assert a.evolution.chromosomes.tolist() == b.evolution.chromosomes.tolist()
    assert ours.tolist() == theirs.tolist()
    assert launches == [9]


@needs_numba_cuda
def test_a_card_is_asked_for_as_many_plans_as_a_launch_takes(launches, monkeypatch):
    from gapath.kernels.cuda import evolution

    monkeypatch.setattr(evolution, "MOST_RUNS", 40)
    ga, optimum = planner(max_epochs=20), shortest_path(OPEN)
    trials = list(plan_trials(OPEN, optimum, on_a_card(ga), 3, 100, first=5))
    assert launches == [1, 40, 40, 15]  # the first one compiles
    usual = list(plan_trials(OPEN, optimum, ga, 3, 100, first=5))
    assert [trial.number for trial in trials] == list(range(5, 100))
    assert [each.plan.cost for each in trials] == [each.plan.cost for each in usual]


@needs_numba_cuda
def test_a_history_that_ends_elsewhere_than_the_card_said_is_an_error(launches, monkeypatch):
    from gapath.kernels.cuda import evolution

    def wrong(*given):
        found = right(*given)
        return found._replace(keys=found.keys + 1)

    right = evolution.outcomes
    monkeypatch.setattr(evolution, "outcomes", wrong)
    found = on_a_card(planner()).plan(OPEN, stream(0))
    with pytest.raises(RuntimeError, match=r"comes to something else on the processor.*a card"):
        assert found.evolution


def test_threads_have_nothing_to_do_beside_a_card(gapath, tmp_path):
    code, _, error = gapath("device=cuda", "threads=2")
    assert code == 2 and error == "gapath: threads: got 2, expected 1 with device=cuda\n"
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("task", ["drive", "scenario"])
def test_tasks_that_a_card_cannot_do_are_refused(gapath, tmp_path, task):
    code, _, error = gapath("device=cuda", f"task={task}")
    good = f"cpu, which alone computes {task}"
    assert code == 2 and error == f"gapath: device: got cuda, expected {good}\n"
    assert not (tmp_path / "out").exists()


def test_without_the_package_one_line_says_what_to_install(gapath, tmp_path, monkeypatch):
    monkeypatch.setattr("gapath.errors._installed", lambda package: package != "numba-cuda")
    code, _, error = gapath("device=cuda")
    assert code == 2
    assert error == "gapath: device=cuda needs numba-cuda: pip install 'gapath[cuda]'\n"
    assert not (tmp_path / "out").exists()


@needs_numba_cuda
def test_without_a_driver_one_line_says_so(gapath, tmp_path, monkeypatch):
    from gapath.kernels.cuda import compiler

    def missing():
        raise RuntimeError("Error at driver init: \n\nCUDA driver library cannot be found.\n:")

    monkeypatch.setattr(compiler.cuda, "get_current_device", missing)
    compiler.card.cache_clear()
    code, _, error = gapath("device=cuda")
    assert code == 2
    good = "cpu, or a GPU of NVIDIA's with its driver: CUDA driver library cannot be found."
    assert error == f"gapath: device: got cuda, expected {good}\n"
    assert not (tmp_path / "out").exists()


@needs_numba_cuda
def test_a_run_is_the_same_and_says_what_computed_it(gapath, tmp_path):
    words = ["map=kg18_test2", "planner=ga1", "planner.population=8", "planner.max_epochs=6"]
    words += ["trials=6", "recorder=mcap", "provenance=true"]
    assert gapath(*words, "output=usual", output=None)[0] == 0
    done = simulate("-m", "gapath", *words, "device=cuda", "output=card", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (usual,), (card,) = ([*(tmp_path / name / "plan").iterdir()] for name in ("usual", "card"))
    assert usual.name == card.name  # the key
    for name in ("run.mcap", "config.yaml"):
        assert (usual / name).read_bytes() == (card / name).read_bytes()
    one, other = (StoredRows(place / "trials.parquet") for place in (usual, card))
    assert one["feasible"].any() and not one["feasible"].all()
    for name in one:
        if not name.endswith("time_s"):
            np.testing.assert_array_equal(one[name], other[name])
    told = [
        json.loads((place / "manifest.json").read_bytes())["provenance"]["machine"]["device"]
        for place in (usual, card)
    ]
    assert told == ["cpu", "simulator"]
    assert log.main(["verify", str(card / "run.mcap")]) == 0

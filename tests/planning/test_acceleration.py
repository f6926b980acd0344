"""The choice of kernels reaches every planner of a task, and changes no result."""

from dataclasses import dataclass

import pytest
from strategies import planner

from gapath.commands import log as log_cli
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.kernels.jit import JIT
from gapath.kernels.kg18.evolution import KERNELS
from gapath.planning.acceleration import with_kernels
from gapath.tasks.plan import Task

needs_jit = pytest.mark.skipif(not JIT, reason="vectors need the compiler")


@pytest.fixture
def called(monkeypatch):
    """Kernels by name, and the population and genes of those who called them."""

    def watched(name, kernel):
        def evolve(*arguments):
            calls.setdefault(name, set()).add(
                (int(arguments[3]["population"][0]), arguments[8].shape[2])
            )
            kernel(*arguments)

        return evolve

    calls = {}
    for name, kernel in list(KERNELS.items()):
        monkeypatch.setitem(KERNELS, name, watched(name, kernel))
    return calls


RUNS = {
    "a planner in a planner": (["planner=inflated_ga3", "planner.robot_radius=1"], {(100, 10)}),
    "all parts of a navigator": (
        ["task=drive", "navigator=kg18", "map=kg18_enclosed"],
        {(100, 10), (40, 8), (100, 8), (100, 12), (100, 16)},
    ),
}


@needs_jit
@pytest.mark.parametrize(("run", "callers"), RUNS.values(), ids=RUNS)
def test_nested_planners_run_by_the_kernels_that_are_chosen(run, callers, called, gapath, tmp_path):
    ours = [] if any(word.startswith("map=") for word in run) else ["map=kg18_test1"]
    code, _, error = gapath(*ours, *run, "recorder=mcap", "kernels=scalar")
    assert (code, error) == (0, "")
    assert called == {"scalar": callers}
    called.clear()
    (log,) = tmp_path.glob("out/*/*/run.mcap")
    assert log_cli.main(["verify", str(log), "--kernels", "vectors"]) == 0
    assert called == {"vectors": callers}


@dataclass(frozen=True)
class Other:
    """An accelerated planner of a package's, which knows kernels of its own."""

    chosen: str = ""
    kernels = ("cuda", "scalar")

    def using(self, kernels):
        return Other(kernels)


@dataclass(frozen=True)
class Holder:
    """Anything that has planners."""

    planners: object
    sides: object = (1, 2)


def test_each_planner_that_knows_the_name_is_replaced_and_nothing_else():
    ours, search = planner(), build("planner", yaml_values("planner", "astar"), "planner")
    held = Holder([ours, (Holder(Other()), search)], sides=[3, 4])
    scalar, (inner, same) = with_kernels(held, "scalar").planners
    assert scalar == ours and scalar.evolve is KERNELS["scalar"]
    assert inner.planners.chosen == "scalar" and same is search
    first, (inner, _) = with_kernels(held, "cuda").planners
    assert first is ours and inner.planners.chosen == "cuda"
    assert with_kernels(held, "auto") is held
    assert with_kernels(held, "cuda").sides is held.sides


BAD = {
    "of one planner": (Task(planner()), r"one of auto, (vectors, )?scalar$"),
    "of several": (Holder([planner(), Other()]), r"one of auto, (vectors, )?scalar, cuda$"),
    "of none": (Holder([]), "auto: no planner here has others$"),
}


@pytest.mark.parametrize(("component", "good"), BAD.values(), ids=BAD)
def test_a_name_that_no_planner_knows_is_refused(component, good):
    with pytest.raises(InputError, match=f"kernels: got gpu, expected {good}"):
        with_kernels(component, "gpu")


def test_the_command_refuses_it(gapath):
    code, _, error = gapath("task=drive", "navigator=dstar_lite", "kernels=scalar")
    assert code == 2 and "kernels: got scalar, expected auto: no planner here" in error

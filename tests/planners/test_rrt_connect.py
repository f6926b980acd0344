"""RRT-Connect as a planner: its settings, and that it gives up when its iterations are spent."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import problems

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.raster import polyline
from gapath.kernels.rng import stream
from gapath.planning.flaw import flaw
from gapath.problem import PlanStatus, Problem


def make(**values):
    return build("planner", yaml_values("planner", "rrt_connect") | values, "planner")


@given(problems(), st.integers(0, 1000))
def test_a_path_is_its_lines_and_without_flaw(problem, seed):
    plan = make(iterations=200, shortcuts=50).plan(problem, stream(seed))
    if plan.feasible:
        assert flaw(problem, plan.path, plan.cost) is None
        assert plan.path.tolist() == polyline(plan.lines()).tolist()
    else:
        assert plan.status is PlanStatus.NOT_FOUND


def test_spent_iterations_are_no_proof():
    weights = np.full((30, 30), 0.5)
    weights[15, :29] = 1.0
    problem = Problem(GridMap("gap", weights), (2, 2), (2, 28))
    plans = [make(iterations=n).plan(problem, stream(1)) for n in (1, 100_000)]
    assert [plan.status for plan in plans] == [PlanStatus.NOT_FOUND, PlanStatus.FOUND]
    assert plans[0].expansions >= 2


@pytest.mark.parametrize(
    ("name", "value", "right"),
    [
        ("iterations", 0, "an integer from 1 to 10000000"),
        ("iterations", 10**7 + 1, "an integer from 1"),
        ("step", 0, "an integer from 1 to 65536"),
        ("step", 10**6, "an integer from 1"),
        ("shortcuts", -1, "an integer from 0 to 1000000"),
        ("shortcuts", 10**7, "an integer from 0"),
    ],
)
def test_settings_out_of_range_are_refused(name, value, right):
    with pytest.raises(InputError, match=rf"planner\.{name}: got {value}, expected {right}"):
        make(**{name: value})

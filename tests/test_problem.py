"""Problems and plans."""

import numpy as np
import pytest

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.problem import CornerCutting, Plan, PlanStatus, Problem

WEIGHTS = np.full((4, 6), 0.5)
WEIGHTS[1, 2] = 1.0
GRID = GridMap("small", WEIGHTS)


@pytest.mark.parametrize(
    ("start", "target", "message"),
    [
        ((6, 0), (0, 0), r"map.start: got \[6, 0\], expected a field"),
        ((0, 4), (0, 0), "map.start"),
        ((-1, 0), (0, 0), "map.start"),
        ((0, 0), (2, 1), r"map.target: got \[2, 1\], an obstacle, expected a free field"),
        ((0, 0), (1, 2, 3), "map.target: .* two integers"),
        ((0, 0), (0.5, 1), "map.target: .* two integers"),
        ((0, 0), 7, "map.target: .* two integers"),
        ((0, 0), "ab", "map.target: .* two integers"),
    ],
)
def test_ends_that_cannot_be_used_are_refused(start, target, message):
    with pytest.raises(InputError, match=message):
        Problem(GRID, start, target)


def test_ends_may_be_lists_or_numpy_integers():
    problem = Problem(GRID, [0, 0], np.array([5, 3]))
    assert (problem.start, problem.target) == ((0, 0), (5, 3))


def test_a_plan_shows_itself_in_a_notebook():
    html = Plan(PlanStatus.NOT_FOUND, weights=12.5, obstacles=2, vln=1e5, epochs=500)._repr_html_()
    assert "without a feasible path" in html
    assert "200012" in html or "200013" in html


def test_every_status_has_a_sentence():
    assert len({status.sentence for status in PlanStatus}) == len(PlanStatus)


def test_a_corner_rule_is_found_by_its_name_in_lower_case_only():
    assert [CornerCutting.named(rule.name.lower()) for rule in CornerCutting] == [*CornerCutting]
    for name in ("ALLOW", "", None, 0, ["allow"]):
        with pytest.raises(InputError, match=r"corner_cutting: got .* one of allow, one_side"):
            CornerCutting.named(name)

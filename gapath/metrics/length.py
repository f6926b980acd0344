"""Octile length of a path: 1 for a straight step, sqrt(2) for a diagonal one."""

from gapath.planning.path import octile_length
from gapath.problem import Plan, Problem

TITLE = "Length, fields"


def measure(problem: Problem, plan: Plan) -> float:
    """Measure a path.

    Parameters
    ----------
    problem : Problem
        Its map.
    plan : Plan
        Has a path.

    Returns
    -------
    float
        In fields.
    """
    return octile_length(plan.path)

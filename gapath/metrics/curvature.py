"""Curvature of a path: the sum of the absolute changes of heading over its length."""

import math

from gapath.planning.path import heading_changes, octile_length
from gapath.problem import Plan, Problem

TITLE = "Curvature, rad / field"


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
        In radians per field; 0 for a path of one field.
    """
    length = octile_length(plan.path)
    return int(heading_changes(plan.path).sum()) * (math.pi / 4) / length if length else 0.0

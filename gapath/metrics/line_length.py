"""Euclidean length of the straight lines that a path is made of (M22 eq. (7))."""

import math

from gapath.planning.path import polyline_length
from gapath.problem import Plan, Problem

TITLE = "Straight lines, fields"


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
        In fields; NaN for a path that is not made of such lines.
    """
    way_points = plan.lines()
    return polyline_length(way_points) if len(way_points) else math.nan

"""Angle over length of the lines that a path is made of (AOL; Heiden et al. 2021, Bench-MR).

The sum of the absolute turns between the lines over their Euclidean length. A path that is not made
of lines is one of steps: for A* it is the `curvature`. A line drawn field by field turns at nearly
every field, a robot on the line does not turn at all: so here lines count where there are any.
"""

from gapath.planning.path import polyline_length, turning, without_stands
from gapath.problem import Plan, Problem

TITLE = "Angle over length, rad / field"


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
    lines = plan.lines()
    points = without_stands(lines if len(lines) else plan.path)
    length = polyline_length(points)
    return float(turning(points).sum() / length) if length else 0.0

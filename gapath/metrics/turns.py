"""How often a path turns: steps whose heading differs from that of the step before."""

import numpy as np

from gapath.planning.path import heading_changes
from gapath.problem import Plan, Problem

TITLE = "Turns"


def measure(problem: Problem, plan: Plan) -> int:
    """Count the turns of a path.

    Parameters
    ----------
    problem : Problem
        Its map.
    plan : Plan
        Has a path.

    Returns
    -------
    int
        Steps.
    """
    return int(np.count_nonzero(heading_changes(plan.path)))

"""How many times longer a path is than a straight way between its ends would be."""

import numpy as np

from gapath.planning.path import octile_length
from gapath.problem import Plan, Problem

TITLE = "Detour"


def measure(problem: Problem, plan: Plan) -> float:
    """Measure a path: its octile length over the least one that there could be."""
    dx, dy = np.abs(plan.path[-1] - plan.path[0])
    straight = max(dx, dy) - min(dx, dy) + min(dx, dy) * np.sqrt(2)
    return octile_length(plan.path) / float(straight) if straight else 1.0

"""Genetic path planning for mobile robots, as reproducible experiments.

>>> import gapath
>>> grid = gapath.load_map("kg18_test3")
>>> gapath.plan(grid, (0, 24), (98, 24), planner="ga3", seed=7).status.name
'FOUND'
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    __version__: str
    from gapath.api import drive, load_map, plan
    from gapath.driving.retold import Drive
    from gapath.errors import InputError
    from gapath.grid import GridMap
    from gapath.pipelines.reading.library import Run, run, runs
    from gapath.problem import CornerCutting, Plan, PlanStatus, Problem

__all__ = [
    "CornerCutting",
    "Drive",
    "GridMap",
    "InputError",
    "Plan",
    "PlanStatus",
    "Problem",
    "Run",
    "__version__",
    "drive",
    "load_map",
    "plan",
    "run",
    "runs",
]

_HOMES = {
    "CornerCutting": "problem",
    "Drive": "driving.retold",
    "GridMap": "grid",
    "InputError": "errors",
    "Plan": "problem",
    "PlanStatus": "problem",
    "Problem": "problem",
    "Run": "pipelines.reading.library",
    "drive": "api",
    "load_map": "api",
    "plan": "api",
    "run": "pipelines.reading.library",
    "runs": "pipelines.reading.library",
}


def __getattr__(name: str) -> object:
    """Import a public name when it is first used: numba alone takes half a second."""
    if name == "__version__":
        from importlib.metadata import version

        return version("gapath")
    if name not in _HOMES:
        raise AttributeError(f"module 'gapath' has no attribute {name!r}")
    if _HOMES[name].startswith("pipelines."):
        from gapath.errors import require_extra

        require_extra(f"gapath.{name}", "report")
    globals()[name] = found = getattr(import_module(f"gapath.{_HOMES[name]}"), name)
    return found


def __dir__() -> list[str]:
    return __all__

"""Which kernels compute: one choice for all planners of a task, however deep they stand in it."""

from dataclasses import fields, is_dataclass, replace
from operator import is_
from typing import Any, Protocol, TypeVar, runtime_checkable

from gapath.errors import require
from gapath.planning.planner import Planner

AUTO = "auto"
"""The choice of every planner's own default."""

Component = TypeVar("Component")


@runtime_checkable
class Accelerated(Protocol):
    """A planner that several kernels can run, all of them with the same plans."""

    @property
    def kernels(self) -> tuple[str, ...]:
        """Names of those that run here, the default first."""

    def using(self, kernels: str) -> Planner:
        """Give a copy that plans by other kernels.

        Parameters
        ----------
        kernels : str
            One of the names.

        Returns
        -------
        Planner
            A copy with the same settings.

        Raises
        ------
        InputError
            For a name that is none of `kernels`.
        """


def with_kernels(component: Component, kernels: str) -> Component:
    """Give the same component, its planners computed by other kernels.

    Parameters
    ----------
    component : dataclass
        A task, navigator or planner; what is accelerated is looked for in its fields and in
        theirs, in lists, too.
    kernels : str
        `AUTO`, or a name that one of them knows (`Accelerated`); those that do not
        know it stay as they are.

    Returns
    -------
    dataclass
        A copy; the component itself where nothing is chosen.

    Raises
    ------
    InputError
        For a name that none of them knows.
    """
    if kernels == AUTO:
        return component
    known: dict[str, None] = {}
    made: Component = _with_kernels(component, kernels, known)
    good = f"one of {', '.join([AUTO, *known])}" if known else f"{AUTO}: no planner here has others"
    require(kernels in known, "kernels", kernels, good)
    return made


def _with_kernels(part: Any, kernels: str, known: dict[str, None]) -> Any:
    """Do so for one part; the names that it meets are added to the known ones."""
    if isinstance(part, Accelerated):
        known.update(dict.fromkeys(part.kernels))
        return part.using(kernels) if kernels in part.kernels else part
    if type(part) in (list, tuple):
        items = [_with_kernels(item, kernels, known) for item in part]
        return part if all(map(is_, items, part)) else type(part)(items)
    if not is_dataclass(part) or isinstance(part, type):
        return part
    own = {each.name: getattr(part, each.name) for each in fields(part) if each.init}
    made = {name: _with_kernels(value, kernels, known) for name, value in own.items()}
    changed = {name: value for name, value in made.items() if value is not own[name]}
    return replace(part, **changed) if changed else part

"""What varies in an experiment, found from the settings of its runs: its sweeps, and the rest."""

import math
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from gapath.pipelines.papers.names import rank
from gapath.pipelines.reading.names import tried
from gapath.pipelines.sweeps.grids import MANY, changed_together, find_grids
from gapath.running.naming import Method, map_name
from gapath.store.records import RunRecord
from gapath.store.settings import Value, nested


@dataclass(frozen=True)
class Factor:
    """A setting that takes several values, or the choice of the method.

    Parameters
    ----------
    name : str
        Of the setting, or of the group in which methods are chosen.
    levels : tuple
        Its values in order: numbers ascending, methods as in the papers.
    numeric : bool
        Whether all of them are numbers.
    """

    name: str
    levels: tuple[Value, ...]
    numeric: bool

    @property
    def title(self) -> str:
        """What axes and columns call it."""
        inner = self.name.partition(".")[2] or self.name
        return inner.replace("_", " ").replace(".", " ")


@dataclass(frozen=True)
class Sweep:
    """Trials that belong together: what varied on the side of the method, and where.

    Parameters
    ----------
    choice : str
        The group in which methods are chosen: planner, or navigator.
    factors : tuple of Factor
        What varied, the choice of the method before the settings; none of odds and ends.
    methods : DataFrame
        Index: names of the methods; columns: `preset`, the name of the YAML, and each factor's.
    cases : DataFrame
        Its rows of `cases_of`.
    together : tuple of (str, str)
        Settings that changed with a factor, and that factor.
    fixed : tuple of (str, object)
        Settings that are the same here, but vary elsewhere in the experiment, or differ from the
        YAML.
    """

    choice: str
    factors: tuple[Factor, ...]
    methods: pd.DataFrame
    cases: pd.DataFrame
    together: tuple[tuple[str, str], ...] = ()
    fixed: tuple[tuple[str, Value], ...] = ()

    @property
    def settings(self) -> tuple[Factor, ...]:
        """The factors without the choice of the method."""
        return tuple(factor for factor in self.factors if factor.name != self.choice)

    @property
    def presets(self) -> list[str]:
        """The methods' YAMLs, in the papers' order."""
        return sorted(set(self.methods["preset"]), key=rank)

    @property
    def places(self) -> list[str]:
        """The maps, in the papers' order."""
        return sorted(set(self.cases["place"]), key=rank)

    @property
    def what(self) -> str:
        """What varied, as part of a file's name."""
        if not self.factors:
            return "others"
        if not self.settings:
            return self.choice
        names = [factor.name.rpartition(".")[2] for factor in self.settings]
        return "_".join(names) if len(names) <= 3 else f"{len(names)}_settings"

    @property
    def whole(self) -> bool:
        """Whether most combinations of the factors' values are there."""
        every = math.prod(len(factor.levels) for factor in self.factors)
        return len(self.methods) > MANY * every


def cases_of(runs: Sequence[RunRecord]) -> pd.DataFrame:
    """Say of each run what is tried, and on what.

    Parameters
    ----------
    runs : sequence of RunRecord
        The runs of one task, under names that tell them apart.

    Returns
    -------
    DataFrame
        Index: keys; `place`, the map without what tells its problems apart; `problem`, the
        instance, start and target, or all of several; `method`, `preset` and `changes` as the
        manifest has them, and `settings`, a dict of all that belong to the method.
    """
    files = [_file(run) for run in runs]
    places = pd.Series([_place(run) for run in runs], dtype=object)
    several = pd.Series(files).groupby(places).transform("nunique") > 1
    places[several] = [
        f"{place}[content={file[:8]}]"
        for place, file, apart in zip(places, files, several, strict=True)
        if apart
    ]
    return pd.DataFrame(
        {
            "place": places.to_numpy(),
            "problem": [_problem(run) for run in runs],
            "method": [run.known.method for run in runs],
            "preset": [run.known.preset for run in runs],
            "changes": [run.known.changes for run in runs],
            "settings": [_settings(run) for run in runs],
        },
        index=pd.Index([run.folder.name for run in runs], name="key"),
    )


def _problem(run: RunRecord) -> str:
    known = run.known
    return f"{known.map_instance} {known.start} {known.target} {known.queries}"


def _place(run: RunRecord) -> str:
    path = run.settings.get("map.path")
    if path is None:
        return run.known.map
    return map_name(Path(str(path)).stem, nested(run.settings)["map"])


def _file(run: RunRecord) -> str:
    """Give the hash of a map's own file; empty where it is known by its name."""
    path = run.settings.get("map.path")
    return run.known.map_inputs.get(str(path), "") if path is not None else ""


def _settings(run: RunRecord) -> dict[str, Value]:
    """Give what a method is made of: its settings, and the content of its files by its name."""
    found = tried(run)
    others = {key: value for key, value in run.known.changes.items() if "[" not in key}
    return {**{key: value for key, value in others.items() if key not in found}, **found}


def find_sweeps(cases: pd.DataFrame, choice: str) -> list[Sweep]:
    """Find what forms a sweep.

    Methods of one YAML whose settings fill most of a grid are a sweep over these settings; where
    they fill several grids, as settings varied one at a time do, each is one. Sweeps of several
    YAMLs over the same settings are one. What is left is compared method by method where most of
    the methods were tried on the same problems, else it is odds and ends.

    Parameters
    ----------
    cases : DataFrame
        As `cases_of` gives them, of one experiment.
    choice : str
        The group in which methods are chosen.

    Returns
    -------
    list of Sweep
        Those with settings first, by what varies; what is left last, if there is anything.
    """
    methods = cases.drop_duplicates("method").set_index("method")
    settings = pd.DataFrame(list(methods["settings"]), index=methods.index, dtype=object)
    settings = settings.astype(object).where(settings.notna(), None)
    found = _grids(settings, methods["preset"])
    sweeps, used = [], pd.Series(False, index=cases.index)
    for (names, _), grids in sorted(found.items()):
        members = [method for grid in grids for method in grid.methods]
        its = cases[cases["method"].isin(members)]
        its = its[its.groupby("place")["method"].transform("nunique") > 1]
        if not its.empty:
            mine = settings.loc[sorted(set(its["method"]))]
            together = {pair for grid in grids for pair in grid.together}
            others = {name for grid in grids for name in grid.varied}.difference(names)
            fixed = {name: mine[name].iloc[0] for name in others if _same(mine[name])}
            fixed |= _in_all(its["changes"])
            sweeps.append(
                Sweep(
                    choice,
                    _factors(choice, mine[list(names)], methods["preset"]),
                    _columns(choice, mine[list(names)], methods["preset"]),
                    its,
                    tuple(sorted(together)),
                    tuple(sorted(fixed.items())),
                )
            )
            used |= cases.index.isin(its.index)
    rest = cases[~used]
    return sweeps if rest.empty else [*sweeps, _rest(choice, rest)]


class _Grid(NamedTuple):
    """A grid among the methods of one YAML."""

    methods: list[str]
    together: list[tuple[str, str]]
    varied: list[str]
    """All settings that vary among the methods of the YAML."""


def _grids(
    settings: pd.DataFrame, presets: pd.Series
) -> dict[tuple[tuple[str, ...], int], list[_Grid]]:
    """Find grids, those of several YAMLs over the same settings together.

    The largest of each YAML over the same settings go together, then the next.
    """
    found: dict[tuple[tuple[str, ...], int], list[_Grid]] = defaultdict(list)
    for _, mine in settings.groupby(presets, sort=True):
        every = [name for name in sorted(mine) if not _same(mine[name])]
        together = changed_together(mine[every])
        varied = [name for name in every if name not in together]
        seen: Counter[tuple[str, ...]] = Counter()
        for columns, rows in find_grids(_codes(mine[varied])):
            names = tuple(varied[i] for i in columns)
            pairs = [pair for pair in together.items() if pair[1] in names]
            found[names, seen[names]].append(_Grid(list(mine.index[rows]), pairs, varied))
            seen[names] += 1
    return found


def _same(values: pd.Series) -> bool:
    return len(set(values.map(repr))) == 1


def _codes(settings: pd.DataFrame) -> "np.ndarray[tuple[int, int], np.dtype[np.int64]]":
    codes = [pd.factorize(settings[name].map(repr))[0] for name in settings]
    return np.array(codes, dtype=np.int64).reshape(len(codes), len(settings)).T


def _columns(choice: str, settings: pd.DataFrame, presets: pd.Series) -> pd.DataFrame:
    table = settings.copy()
    table.insert(0, "preset", presets)
    table.insert(1, choice, presets)
    return table


def _factors(choice: str, settings: pd.DataFrame, presets: pd.Series) -> tuple[Factor, ...]:
    table = _columns(choice, settings, presets).drop(columns="preset")
    factors = [factor_of(name, table[name]) for name in table]
    return tuple(factor for factor in factors if len(factor.levels) > 1)


def _rest(choice: str, cases: pd.DataFrame) -> Sweep:
    its = cases.drop_duplicates("method").set_index("method")
    fixed = _in_all(its["changes"]) if len(its) > 1 else {}
    methods = its[["preset"]].copy()
    methods[choice] = [
        Method(preset, {k: v for k, v in changes.items() if k not in fixed}).name
        for preset, changes in zip(its["preset"], its["changes"], strict=True)
    ]
    pairs = cases.drop_duplicates(["method", "place", "problem"])
    problems = pairs.drop_duplicates(["place", "problem"])
    several = len(methods) > 1 and 2 * len(pairs) > len(methods) * len(problems)
    names = sorted(methods[choice], key=rank)
    factors = (Factor(choice, tuple(names), numeric=False),) if several else ()
    return Sweep(choice, factors, methods, cases, fixed=tuple(sorted(fixed.items())))


def _in_all(changes: pd.Series) -> dict[str, Value]:
    """Give what differs from the YAML in all methods alike."""
    first, *others = changes
    return {
        key: value
        for key, value in first.items()
        if all(key in each and repr(each[key]) == repr(value) for each in others)
    }


def factor_of(name: str, values: pd.Series) -> Factor:
    """Make a factor of a setting's values: numbers in their order, others as names are."""
    levels: list[Value] = list({repr(value): value for value in values}.values())
    numbers = [level for level in levels if _is_number(level)]
    others = [level for level in levels if not _is_number(level)]
    ascending = sorted({float(str(level)): level for level in numbers}.items())
    ordered = [level for _, level in ascending] + sorted(others, key=lambda v: rank(str(v)))
    return Factor(name, tuple(ordered), numeric=not others)


def _is_number(value: Value) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

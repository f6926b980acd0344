"""Names that tell runs apart: what is one setting, or one map, is decided by data, not by a name.

Two runs may call different things the same: a planner's YAML was edited in between, or two folders
hold a map of one name each. In a table they would be one row.
"""

import dataclasses
import re
from collections import defaultdict
from collections.abc import Callable, Hashable, Mapping, Sequence
from functools import cache
from pathlib import Path

from gapath.running.naming import Method, with_changes
from gapath.store.inputs import Inputs, contents, without_paths
from gapath.store.records import RunRecord
from gapath.store.settings import Value, tabular

NO_METHOD = ("task", "name", "map", "recorder", "seed", "trials")
"""Settings that say nothing of what is tried."""

_GROUP = re.compile(r"[.[]")

Trait = Callable[[RunRecord], Mapping[str, Value]]


def told_apart(runs: Sequence[RunRecord]) -> list[RunRecord]:
    """Give different methods and different maps different names, by what differs.

    Parameters
    ----------
    runs : sequence of RunRecord
        Runs that can be used, all that stand beside each other.

    Returns
    -------
    list of RunRecord
        The same in the same order. Where one name stood for methods with different settings or
        input files, those stand in its changes now; where it stood for maps with other contents,
        starts or targets, behind the map's name.
    """
    methods = _differences(
        runs,
        lambda run: (run.known.task, run.known.method),
        lambda run: (str(_flat(run)), *contents(run.known.method_inputs)),
        (tried, lambda run: _hashes(run.known.method_inputs)),
    )
    maps = _differences(
        runs,
        lambda run: (run.known.map, run.known.map_instance),
        lambda run: (run.known.map_digest, run.known.start, run.known.target, run.known.queries),
        (_map, _ends, _digest, _queries),
    )
    return [_renamed(*each) for each in zip(runs, methods, maps, strict=True)]


def tried(run: RunRecord) -> dict[str, Value]:
    """Give the settings of what a run tries, by their names, without paths and the map's."""
    return tabular(_flat(run))


def tried_with_contents(run: RunRecord) -> dict[str, Value]:
    """Give `tried`, and what input files hold: under the setting that names one, or its name."""
    inputs = run.known.method_inputs
    short = {path: f"{Path(path).name} {digest[:8]}" for path, digest in inputs.items()}
    named = {
        key: short[value]
        for key, value in run.settings.items()
        if isinstance(value, str) and value in short and _is_tried(key)
    }
    others = {path: digest for path, digest in inputs.items() if short[path] not in named.values()}
    return {**tabular({**_flat(run), **named}), **_hashes(others)}


def _flat(run: RunRecord) -> dict[str, Value]:
    settings = without_paths(run.settings, run.known.method_inputs).items()
    return {key: value for key, value in settings if _is_tried(key)}


@cache  # of ten thousand runs the settings have few names
def _is_tried(key: str) -> bool:
    return _GROUP.split(key, 1)[0] not in NO_METHOD


def _map(run: RunRecord) -> dict[str, Value]:
    items = tabular(run.settings).items()
    return {key[4:]: value for key, value in items if key.startswith("map.")}


def _ends(run: RunRecord) -> dict[str, Value]:
    return {"start": run.known.start, "target": run.known.target}


def _digest(run: RunRecord) -> dict[str, Value]:
    return {"content": run.known.map_digest[:8]}


def _queries(run: RunRecord) -> dict[str, Value]:
    return {"problems": run.known.queries[:8] or "one"}


def _hashes(inputs: Inputs) -> dict[str, Value]:
    return {f"content.{Path(path).name}": digest[:8] for path, digest in inputs.items()}


def _differences(
    runs: Sequence[RunRecord],
    name: Callable[[RunRecord], Hashable],
    identity: Callable[[RunRecord], Hashable],
    traits: Sequence[Trait],
) -> list[dict[str, Value]]:
    """Tell for each run what sets it apart from those of another identity but the same name."""
    first: dict[Hashable, dict[Hashable, RunRecord]] = defaultdict(dict)
    pairs = [(name(run), identity(run)) for run in runs]
    for run, (called, known) in zip(runs, pairs, strict=True):
        first[called].setdefault(known, run)
    apart = {called: _apart(alike, traits) for called, alike in first.items()}
    return [apart[called][known] for called, known in pairs]


def _apart(
    alike: Mapping[Hashable, RunRecord], traits: Sequence[Trait]
) -> dict[Hashable, dict[str, Value]]:
    found: dict[Hashable, dict[str, Value]] = {each: {} for each in alike}
    for trait in traits:
        if len({str(changes) for changes in found.values()}) == len(found):
            break
        values = {each: trait(run) for each, run in alike.items()}
        for key in sorted({key for each in values.values() for key in each}):
            if len({str(each.get(key, "none")) for each in values.values()}) > 1:
                for each in found:
                    found[each][key] = values[each].get(key, "none")
    return found


def _renamed(run: RunRecord, method: Mapping[str, Value], grid: Mapping[str, Value]) -> RunRecord:
    if not method and not grid:
        return run
    known = run.known
    changes = {**known.changes, **method}
    manifest = dataclasses.replace(
        known,
        changes=changes,
        method=Method(known.preset, changes).name,
        map=with_changes(known.map, grid.items()),
    )
    return dataclasses.replace(run, manifest=manifest)

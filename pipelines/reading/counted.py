"""Which runs count: of several of one setting only one, or its trials would count twice."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from gapath.store.records import RunRecord


def superseded(runs: Iterable[RunRecord]) -> list[tuple[RunRecord, RunRecord]]:
    """Find the runs of whose setting another counts.

    Of several runs of the same experiment, map, method and seed (made by other versions, or with
    another number of trials) only the newest counts; of those of the same versions the one with
    the most trials. Shards of so many trials are one run (`gapath.running.shards`). A run that
    cannot be used neither counts nor is superseded.

    Parameters
    ----------
    runs : iterable of RunRecord
        The runs.

    Returns
    -------
    list of (RunRecord, RunRecord)
        Each superseded one, and the one that counts; the newest first.
    """
    usable = [run for run in runs if not run.fault]
    original = {id(run): run.folder.name == run.known.key for run in usable}  # not a copy
    usable.sort(key=lambda run: (run.date, original[id(run)], run.name), reverse=True)
    sets: dict[tuple[str, _Cut], dict[int, RunRecord]] = {}
    counts: dict[str, tuple[str, _Cut]] = {}
    for run in usable:
        setting, (shard, shards, trials) = run.known.setting, _shard(run)
        place = (setting, _Cut(shards, trials, str(sorted(run.known.versions.items()))))
        sets.setdefault(place, {}).setdefault(shard, run)
        first = counts.setdefault(setting, place)
        same = first[1].versions == place[1].versions  # the same streams, and others
        if same and _trials(sets[place]) > _trials(sets[first]):
            counts[setting] = place
    pairs = []
    for run in usable:
        chosen = sets[counts[run.known.setting]]
        if all(run is not each for each in chosen.values()):
            pairs.append((run, next(iter(chosen.values()))))
    return pairs


class _Cut(NamedTuple):
    """Into how many shards so many trials are cut, by which versions."""

    shards: int
    trials: int
    versions: str


def _shard(run: RunRecord) -> tuple[int, int, int]:
    """Give which part a run is, of how many, and the trials of all; a whole run is the only one."""
    settings = run.known.settings or {}
    found = [settings.get(name) for name in ("shard", "shards", "trials")]
    shard, shards, trials = (each if isinstance(each, int) else None for each in found)
    if shard is None or shards is None or trials is None:
        return 0, 1, run.known.trials
    return shard, shards, trials


def _trials(runs: Mapping[int, RunRecord]) -> int:
    return sum(run.known.trials for run in runs.values())


def incomplete(runs: Iterable[RunRecord]) -> list[tuple[str, str]]:
    """Find settings of whose shards some are missing.

    Parameters
    ----------
    runs : iterable of RunRecord
        Those that count.

    Returns
    -------
    list of (str, str)
        A run of each, and which are missing.
    """
    found: dict[str, dict[int, RunRecord]] = {}
    for run in runs:
        found.setdefault(run.known.setting, {})[_shard(run)[0]] = run
    told = []
    for mine in found.values():
        run = next(iter(mine.values()))
        shards = _shard(run)[1]
        missing = [str(i) for i in range(shards) if i not in mine]
        if missing:
            what = f"{len(mine)} of {shards} shards of its trials are there"
            told.append((run.name, f"counts, but only {what}; missing: {', '.join(missing[:9])}"))
    return told

"""One setting's trials cut into runs: a shard does some of them, and its rows are those of all."""

from collections.abc import Mapping
from typing import Any

from gapath.errors import require


def span(trials: int, shard: int, shards: int, posing: bool) -> range:
    """Give the trials of a shard: all shards together have each of them once.

    Parameters
    ----------
    trials : int
        Of all shards.
    shard, shards : int
        Which of how many.
    posing : bool
        Whether there are so many trials of each of several problems, which can be chosen instead.

    Returns
    -------
    range
        Their numbers, which say their random streams.

    Raises
    ------
    InputError
        If there is no such shard.
    """
    require(shards == 1 or not posing, "shards", shards, "1: this task's problems can be chosen")
    require(1 <= shards <= trials, "shards", shards, f"an integer from 1 to the trials, {trials}")
    require(0 <= shard < shards, "shard", shard, f"an integer from 0 to {shards - 1}, of {shards}")
    return range(trials * shard // shards, trials * (shard + 1) // shards)


def without_whole(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Leave out of settings that a run is not cut: it is what it was before that could be."""
    cut = settings["shards"] != 1
    return {key: value for key, value in settings.items() if cut or key not in WHOLE}


WHOLE = {"shard": 0, "shards": 1}
"""Settings of a run that is not cut, which those of runs do not have."""

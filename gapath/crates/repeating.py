"""The runs of a crate done again: whether they come to what it says."""

from collections.abc import Iterator
from enum import StrEnum
from pathlib import Path
from typing import NamedTuple

from gapath.crates.reading import PackedRun, unpack
from gapath.recorders import mcap
from gapath.running.verify import Elsewhere, made_with, verify


class Verdict(StrEnum):
    """What doing a run again showed, the best first."""

    REPRODUCED = "reproduced"
    EQUIVALENT = "equivalent"
    INCONCLUSIVE = "inconclusive"
    DIFFERENT = "different"


class Repeated(NamedTuple):
    """A run done again.

    Parameters
    ----------
    run : str
        ``<experiment>/<key>``.
    verdict : Verdict
        What came of it.
    told : str
        The same in a sentence's end.
    messages : int
        How many are equal.
    difference : str
        The first thing that differs, its step and both values; empty if nothing does.
    others : dict of str to (str, str)
        What made it in another version: name -> then, here; empty where there is none.
    """

    run: str
    verdict: Verdict
    told: str
    messages: int = 0
    difference: str = ""
    others: dict[str, tuple[str, str]] = {}  # noqa: RUF012


def repeat(
    place: Path, limits: mcap.Limits = mcap.USUAL, much_work: bool = False
) -> Iterator[Repeated]:
    """Do all runs of a crate again.

    Parameters
    ----------
    place : Path
        The crate's folder.
    limits : Limits
        What a log may take.
    much_work : bool
        Do it also if it takes long.

    Yields
    ------
    Repeated
        Run by run; all files are checked before the first one.

    Raises
    ------
    InputError
        If the crate cannot be used, or the run of a log not be done again although all that it was
        made with is here.
    """
    for run in unpack(place):
        yield _repeated(run, limits, much_work)


def _repeated(run: PackedRun, limits: mcap.Limits, much_work: bool) -> Repeated:
    if run.log is None:
        return Repeated(run.name, Verdict.INCONCLUSIVE, "it has no log, so neither map nor steps")
    try:
        found, given, remarks = verify(run.log, limits, much_work=much_work)
    except Elsewhere as error:
        why = f"{error.where.rpartition(': ')[2]}: {error.value}; {made_with(error.others)}"
        return Repeated(run.name, Verdict.INCONCLUSIVE, why, others=dict(error.others))
    others, count = dict(given), f"{found.messages} messages"
    versions, difference = made_with(others), found.difference
    if difference:
        verdict = Verdict.INCONCLUSIVE if others else Verdict.DIFFERENT
        told = f"after {count} that are equal: {difference}"
    elif found.byte is not None and not others:
        difference = f"byte {found.byte}"
        verdict, told = (
            Verdict.DIFFERENT,
            f"from byte {found.byte} on, though all {count} are equal",
        )
    elif not found.ended or found.lost.messages:
        verdict, told = Verdict.INCONCLUSIVE, f"a log that is not whole, {count} that are equal"
    elif found.byte is None:
        verdict, told = Verdict.REPRODUCED, f"bit for bit, {count}"
    else:
        verdict, told = Verdict.EQUIVALENT, f"every message, {count}"
    told = "; ".join(filter(None, [told, versions, *remarks]))
    return Repeated(run.name, verdict, told, found.messages, difference, others)


def worst(verdicts: list[Verdict]) -> Verdict:
    """Give the verdict on a crate: that of the run that came out worst."""
    return max(verdicts, key=list(Verdict).index)

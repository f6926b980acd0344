"""Which runs count: of several of one setting only one, or its trials would count twice."""

from collections.abc import Iterable

from gapath.store.records import RunRecord


def superseded(runs: Iterable[RunRecord]) -> list[tuple[RunRecord, RunRecord]]:
    """Find the runs of whose setting another counts.

    Of several runs of the same experiment, map, method and seed (made by other versions, or with
    another number of trials) only the newest counts; of those of the same versions the one with
    the most trials. A run that cannot be used neither counts nor is superseded.

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
    counts: dict[str, RunRecord] = {}
    for run in usable:
        first = counts.setdefault(run.known.setting, run)
        more = run.known.trials > first.known.trials  # the same streams, and others
        if more and run.known.versions == first.known.versions:
            counts[run.known.setting] = run
    pairs = [(run, counts[run.known.setting]) for run in usable]
    return [(run, first) for run, first in pairs if run is not first]

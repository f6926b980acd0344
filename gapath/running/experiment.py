"""Seeds, trials and run folders: from a checked run to files on disk."""

import traceback
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, suppress
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import yaml

from gapath.discovery import component_of
from gapath.errors import InputError, printable
from gapath.events import Event, RunFinished, RunStarted
from gapath.planning.device import device_of
from gapath.problem import Plan
from gapath.running.config import Run
from gapath.running.progress import Done, Earlier, Journal, done_of, earlier
from gapath.store.durable import named, write_whole
from gapath.store.inputs import Inputs, Reads, watched
from gapath.store.keys import run_key, setting_hash, versions
from gapath.store.provenance.origin import Origin, origin_of
from gapath.store.records import (
    CONFIG,
    MANIFEST,
    TRIALS,
    FileEntry,
    Manifest,
)
from gapath.store.rows import RowWriter, StoredRows, written_rows
from gapath.store.runfolder import Busy, RunFolder
from gapath.store.settings import Flat, nested, tabular
from gapath.store.status import STATUS, RunState, Status, now
from gapath.store.whole import check_places, files_of, finish, is_finished, is_whole, settle
from gapath.task import Batch, Trial, columns, results


@dataclass(frozen=True)
class Execution:
    """How the execution of a run ended.

    Parameters
    ----------
    folder : Path
        The run folder.
    state : RunState
        DONE, INFEASIBLE, SKIPPED or BUSY.
    files : list of str
        Names of the files that it wrote.
    """

    folder: Path
    state: RunState
    files: list[str]

    @property
    def rows(self) -> StoredRows:
        """The trials of a run that is whole, by column; raises InputError if there are none."""
        return StoredRows(self.folder / TRIALS)


def run_started(run: Run, optimum: Plan) -> RunStarted:
    """Make a run's first event; how it is recorded is no part of what it is."""
    return RunStarted(
        run.experiment,
        run.method.name,
        run.task.name,
        run.problem,
        run.seed,
        run.trials,
        {name: value for name, value in run.settings.items() if not name.startswith("recorder.")},
        versions(),
        optimum.path,
        optimum.cost,
    )


def execute(
    run: Run,
    command: str,
    progress: bool = True,
    tell: Callable[[str], None] = lambda line: None,
    asker: Flat = MappingProxyType({}),
) -> Execution:
    """Do a run and write its folder.

    Parameters
    ----------
    run : Run
        What to do.
    command : str
        The command that does the same, for the manifest.
    progress : bool
        Show a bar while it runs, if the error stream is a terminal.
    tell : callable
        Takes a line that says after which trial a run that was cut short goes on.
    asker : mapping
        Who asked for it, for the manifest: the command that was typed, a job's place in its sweep.

    Returns
    -------
    Execution
        The state is SKIPPED if the folder is whole already and not ``run.force``.

    Raises
    ------
    InputError
        If the folder, or a file in it, cannot be written.
    """
    folder = run_folder(run)
    skipped = Execution(folder.path, RunState.SKIPPED, [])
    if not run.force and is_whole(folder, run.settings):  # also where nothing may be written
        return skipped
    folder.create()
    try:
        with folder.lock():
            settle(folder)
            whole = is_whole(folder, run.settings)
            if whole and not run.force:
                return skipped
            origin = origin_of(asker, device_of(run.task)) if run.provenance else Origin({}, {})
            manifest = replace(_manifest(run, folder, command), provenance=origin.said)
            return _execute_held(run, folder, (manifest, origin), _Watched(progress, tell), whole)
    except Busy:
        return Execution(folder.path, RunState.BUSY, [])


def run_folder(run: Run) -> RunFolder:
    """Give the folder of a run, which is named by its key."""
    key = run_key(run.settings, run.problem, run.inputs)
    return RunFolder(Path(run.output) / run.experiment / key)


class _Watched(NamedTuple):
    """How people see a run."""

    progress: bool
    tell: Callable[[str], None]


def _execute_held(
    run: Run, folder: RunFolder, known: tuple[Manifest, Origin], shown: _Watched, again: bool
) -> Execution:
    """Do a run in a folder that is held; `again`: one is there whole, and stays until this is."""
    manifest, origin = known
    work = folder.work
    told = work if again else folder  # where it is said how far this run is
    status = Status(RunState.RUNNING, now())
    try:
        found = earlier(folder, run)
        folder.begin(found.folder if found.count else None)
        found = replace(found, folder=folder.before)
        before = files_of(folder, Status.read(folder.path).manifest)
        digest = replace(manifest, files=before).write(told)  # what it is, should it be killed
        status = replace(status, manifest=digest)
        status.write(told)
        config = yaml.safe_dump(nested(run.settings), sort_keys=False, allow_unicode=True)
        write_whole(work.path / CONFIG, config.encode())
        for name, diff in origin.files.items():
            write_whole(work.path / name, diff)
        with _written_rows(run, work) as rows, watched() as read:
            optimum = run.task.optimum(run.problem)
            kept = _Kept(folder, found, read, rows)
            taken, late, recorded = _do_trials(run, optimum, kept, shown)
        names = [CONFIG, TRIALS, *recorded, *origin.files]
        files = {name: FileEntry.of(work, name) for name in names}
        came = results(type(run.task), StoredRows(work.path / TRIALS))
        late |= _outside(folder, read)
        said = origin.ended(taken)
        whole = replace(manifest, files=files, late_inputs=late, results=came, provenance=said)
        state = RunState.DONE if optimum.feasible else RunState.INFEASIBLE
        finish(folder, whole, replace(status, state=state, finished=now()))
        return Execution(folder.path, state, [*names, MANIFEST, STATUS])
    except BaseException as error:
        interrupted = isinstance(error, KeyboardInterrupt)
        state = RunState.INTERRUPTED if interrupted else RunState.FAILED
        message = "" if interrupted else traceback.format_exc()
        if not is_finished(folder):
            with suppress(InputError):  # a full disk has no room for this, either
                replace(status, state=state, finished=now(), message=message).write(told)
        error.add_note(f"the traceback is in {told.path / STATUS}")
        raise


class _Kept(NamedTuple):
    """What is kept while trials are done, so that the run can go on if it is cut short."""

    folder: RunFolder
    earlier: Earlier
    read: Reads
    rows: RowWriter


def _outside(folder: RunFolder, read: Inputs) -> dict[str, str]:
    """Leave out what lies in the run's folder: recorders may read what they have written."""
    place = folder.path.resolve()
    return {p: d for p, d in read.items() if not Path(p).resolve().is_relative_to(place)}


def _do_trials(
    run: Run, optimum: Plan, kept: _Kept, shown: _Watched
) -> tuple[int, dict[str, str], list[str]]:
    """Do what is left.

    Gives how many trials an earlier run had done, the files that were read meanwhile, and those
    that recorders wrote.
    """
    from tqdm import tqdm

    work, kinds, late = kept.folder.work, columns(run.task.row), dict[str, str]()
    step = found = 0
    started = run_started(run, optimum)
    what = printable(f"{run.problem.map.name} {run.method.name}")

    def record(event: Event) -> None:
        for recorder in run.recorders:
            recorder.record(event)

    def note(done: Done, journal: Journal) -> None:
        nonlocal step, found
        step, found = step + done.steps, found + done.found
        journal.add(done)
        kept.rows.add(done.values)
        late.update(done.late)

    try:
        taken, trials = _trials(run, optimum, started, kept)
        count = taken.count
        if count:
            last = run.first + count - 1
            shown.tell(f"{what}: goes on after trial {last}, {count} of {run.count} are done")
        with closing(Journal(work, run)) as journal:
            for recorder in run.recorders:
                recorder.open(str(work.path))
            begun = [path.name.removesuffix(".part") for path in work.path.iterdir()]
            check_places(kept.folder, begun)  # sooner than after hours
            record(started)
            for done, events in taken.trials(run):
                for event in events:
                    record(event)
                note(done, journal)
            bar = tqdm(
                trials,
                desc=what,
                total=run.count,
                initial=max(count - 1, 0),
                unit="trial",
                leave=False,
                disable=None if shown.progress else True,
            )
            for trial in bar:
                if run.recorders:
                    for event in trial.events(step):
                        record(event)
                new = kept.read.note()
                note(done_of(trial, _outside(kept.folder, new) if new else {}, kinds), journal)
            record(RunFinished(step, run.trials, found))
        return count, late, [name for recorder in run.recorders for name in recorder.close()]
    except BaseException as error:
        for recorder in run.recorders:
            with suppress(OSError):  # on a full disk a file's last bytes have no room, either
                recorder.abort()
        where = component_of(error)
        if where.startswith("recorder "):
            with named(f"{work.path}, {where}"):
                raise
        raise


def _trials(
    run: Run, optimum: Plan, started: RunStarted, kept: _Kept
) -> tuple[Earlier, Iterator[Trial]]:
    """Do the trials that are left, first the last one once more that an earlier run has done.

    If that one comes to something else now, nothing is taken up, and all trials are left.
    """
    named = (run.experiment, run.method.name, run.problem)
    batch = Batch(*named, run.seed, run.trials, run.threads, run.first)
    if kept.earlier.count:
        first = run.first + kept.earlier.count - 1
        trials = run.task.trials(batch._replace(first=first), optimum)
        trial = next(trials)
        if kept.earlier.agrees(run, trial, started):
            return kept.earlier, chain([trial], trials)
        kept.folder.clear(kept.folder.work)
    return Earlier(kept.folder.before), run.task.trials(batch, optimum)


def _written_rows(run: Run, work: RunFolder) -> AbstractContextManager[RowWriter]:
    """Write the trials' rows, and each setting as a column unless it stands in them already."""
    kinds = columns(run.task.row)
    there = {*kinds, "name"}  # the rows' experiment
    own = {key: value for key, value in tabular(run.settings).items() if key not in there}
    return written_rows(work.path / TRIALS, kinds, own)


def _manifest(run: Run, folder: RunFolder, command: str) -> Manifest:
    """Say what a run is, not yet what came of it."""
    return Manifest(
        key=folder.path.name,
        setting=setting_hash(run.settings, run.problem, run.method_inputs),
        experiment=run.experiment,
        task=run.task.name,
        map=run.problem.map.name,
        map_instance=run.problem.map.instance,
        map_digest=run.problem.map.digest,
        start=str(run.problem.start),
        target=str(run.problem.target),
        method=run.method.name,
        preset=run.method.preset,
        changes=dict(run.method.changes),
        seed=run.seed,
        trials=run.count,
        command=command,
        map_inputs=dict(run.map_inputs),
        method_inputs=dict(run.method_inputs),
        late_inputs={},
        versions=versions(),
        files={},
        settings=dict(run.settings),
        queries="" if run.problem.queries is None else run.problem.queries.digest,
    )

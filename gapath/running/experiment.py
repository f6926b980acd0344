"""Seeds, trials and run folders: from a checked run to files on disk."""

import traceback
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from gapath.discovery import component_of
from gapath.errors import InputError, printable
from gapath.events import Event, RunFinished, RunStarted
from gapath.problem import Plan
from gapath.running.config import Run
from gapath.store.durable import named, write_whole
from gapath.store.inputs import watched
from gapath.store.keys import run_key, setting_hash, versions
from gapath.store.records import (
    CONFIG,
    MANIFEST,
    TRIALS,
    FileEntry,
    Manifest,
)
from gapath.store.rows import parquet
from gapath.store.runfolder import Busy, RunFolder
from gapath.store.settings import nested, tabular
from gapath.store.status import STATUS, RunState, Status, now
from gapath.store.whole import files_of, finish, is_finished, is_whole, settle
from gapath.task import Batch, columns, results


@dataclass(frozen=True)
class Execution:
    """How the execution of a run ended.

    Parameters
    ----------
    folder : Path
        The run folder.
    state : RunState
        DONE, INFEASIBLE, SKIPPED or BUSY.
    rows : list of dataclass
        The trials, of the task's row type; empty if the run was not executed.
    files : list of str
        Names of the files that it wrote.
    """

    folder: Path
    state: RunState
    rows: list[Any]
    files: list[str]


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


def execute(run: Run, command: str, progress: bool = True) -> Execution:
    """Do a run and write its folder.

    Parameters
    ----------
    run : Run
        What to do.
    command : str
        The command that does the same, for the manifest.
    progress : bool
        Show a bar while it runs, if the error stream is a terminal.

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
    skipped = Execution(folder.path, RunState.SKIPPED, [], [])
    if not run.force and is_whole(folder, run.settings):  # also where nothing may be written
        return skipped
    folder.create()
    try:
        with folder.lock():
            settle(folder)
            whole = is_whole(folder, run.settings)
            if whole and not run.force:
                return skipped
            return _execute_held(run, folder, command, progress, whole)
    except Busy:
        return Execution(folder.path, RunState.BUSY, [], [])


def run_folder(run: Run) -> RunFolder:
    """Give the folder of a run, which is named by its key."""
    key = run_key(run.settings, run.problem, run.inputs)
    return RunFolder(Path(run.output) / run.experiment / key)


def _execute_held(
    run: Run, folder: RunFolder, command: str, progress: bool, again: bool
) -> Execution:
    """Do a run in a folder that is held; `again`: one is there whole, and stays until this is."""
    work = folder.work
    told = work if again else folder  # where it is said how far this run is
    status = Status(RunState.RUNNING, now())
    try:
        folder.begin()
        manifest = _manifest(run, folder, command)
        before = files_of(folder, Status.read(folder.path).manifest)
        digest = replace(manifest, files=before).write(told)  # what it is, should it be killed
        status = replace(status, manifest=digest)
        status.write(told)
        config = yaml.safe_dump(nested(run.settings), sort_keys=False, allow_unicode=True)
        write_whole(work.path / CONFIG, config.encode())
        with watched() as read:
            optimum = run.task.optimum(run.problem)
            rows, recorded = _do_trials(run, optimum, work, progress)
        place = folder.path.resolve()  # recorders may read what they have written
        late = {p: d for p, d in read.items() if not Path(p).resolve().is_relative_to(place)}
        values = [row.values() for row in rows]
        write_whole(work.path / TRIALS, _table(run, values))
        names = [CONFIG, TRIALS, *recorded]
        came = results(type(run.task), {name: [row[name] for row in values] for name in values[0]})
        files = {name: FileEntry.of(work, name) for name in names}
        done = replace(manifest, files=files, late_inputs=late, results=came)
        state = RunState.DONE if optimum.feasible else RunState.INFEASIBLE
        finish(folder, done, replace(status, state=state, finished=now()))
        return Execution(folder.path, state, rows, [*names, MANIFEST, STATUS])
    except BaseException as error:
        interrupted = isinstance(error, KeyboardInterrupt)
        state = RunState.INTERRUPTED if interrupted else RunState.FAILED
        message = "" if interrupted else traceback.format_exc()
        if not is_finished(folder):
            with suppress(InputError):  # a full disk has no room for this, either
                replace(status, state=state, finished=now(), message=message).write(told)
        error.add_note(f"the traceback is in {told.path / STATUS}")
        raise


def _do_trials(
    run: Run, optimum: Plan, folder: RunFolder, progress: bool
) -> tuple[list[Any], list[str]]:
    from tqdm import tqdm

    rows: list[Any] = []
    step = found = 0

    def record(event: Event) -> None:
        for recorder in run.recorders:
            recorder.record(event)

    batch = Batch(run.experiment, run.method.name, run.problem, run.seed, run.trials, run.threads)
    bar = tqdm(
        run.task.trials(batch, optimum),
        desc=printable(f"{run.problem.map.name} {run.method.name}"),
        total=run.trials,
        unit="trial",
        leave=False,
        disable=None if progress else True,
    )
    try:
        for recorder in run.recorders:
            recorder.open(str(folder.path))
        record(run_started(run, optimum))
        for trial in bar:
            if run.recorders:
                for event in trial.events(step):
                    record(event)
            step += trial.steps
            found += trial.found
            rows.append(trial.row)
        record(RunFinished(step, run.trials, found))
        return rows, [name for recorder in run.recorders for name in recorder.close()]
    except BaseException as error:
        for recorder in run.recorders:
            with suppress(OSError):  # on a full disk a file's last bytes have no room, either
                recorder.abort()
        where = component_of(error)
        if where.startswith("recorder "):
            with named(f"{folder.path}, {where}"):
                raise
        raise


def _table(run: Run, rows: list[dict[str, Any]]) -> bytes:
    """Give the trials' rows, and each setting as a column unless it stands in them already."""
    types = columns(run.task.row)
    there = {*types, "name"}  # the rows' experiment
    own = {key: value for key, value in tabular(run.settings).items() if key not in there}
    return parquet(types, rows, own)


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
        trials=run.trials,
        command=command,
        map_inputs=dict(run.map_inputs),
        method_inputs=dict(run.method_inputs),
        late_inputs={},
        versions=versions(),
        files={},
        settings=dict(run.settings),
        queries="" if run.problem.queries is None else run.problem.queries.digest,
    )

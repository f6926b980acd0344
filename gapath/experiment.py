"""Seeds, trials and run folders: from a checked run to files on disk."""

import io
import math
import traceback
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np

from gapath.config import Run, planner_from_settings
from gapath.durable import write_whole
from gapath.events import Event, Evolved, RunFinished, RunStarted, TrialFinished, TrialStarted
from gapath.graph import shortest_path
from gapath.metrics import clearances, path_metrics
from gapath.problem import Plan
from gapath.runfolder import MANIFEST, Busy, RunFolder, now, run_key, sha256, versions
from gapath.simulation import Trial, plan_trials


@dataclass(frozen=True)
class TrialRow:
    """A row of ``trials.parquet``; failures are rows too.

    `cost` of a failure is the planner's best fitness, obstacles counted as VLN; `length`
    and what follows describe a path and are NaN (turns: 0) where there is none.
    """

    experiment: str
    map: str
    map_instance: int
    map_source: str
    width: int
    height: int
    corner_cutting: str
    planner: str
    seed: int
    trial: int
    status: str
    feasible: bool
    cost: float
    optimal_cost: float
    optimality_ratio: float
    length: float
    turns: int
    clearance: float
    curvature: float
    epochs: int
    evaluations: int
    expansions: int
    plan_time_s: float


@dataclass(frozen=True)
class Outcome:
    """How the execution of a run ended.

    Parameters
    ----------
    folder : Path
        The run folder.
    state : str
        done, infeasible, skipped (whole already) or busy (another process is at it).
    rows : list of TrialRow
        The trials; empty if the run was not executed.
    files : list of str
        Names of the files in the folder.
    """

    folder: Path
    state: str
    rows: list[TrialRow]
    files: list[str]


def trial_events(trial: Trial, seed: int, step: int) -> Iterator[Event]:
    """Tell a trial as events.

    Parameters
    ----------
    trial : Trial
        The trial.
    seed : int
        The run's seed.
    step : int
        The step at which the trial begins.

    Yields
    ------
    Event
        Its start, its evolution if it has one, its end.
    """
    plan = trial.plan
    yield TrialStarted(step, trial.number, seed)
    if plan.evolution is not None:
        yield Evolved(step, trial.number, 0, plan.evolution)
    yield TrialFinished(
        step + duration(plan) - 1,
        trial.number,
        plan.status,
        plan.cost,
        plan.epochs,
        plan.evaluations,
        plan.expansions,
        plan.path,
    )


def duration(plan: Plan) -> int:
    """Give the number of steps that a trial takes: one an epoch, at least one."""
    return max(plan.epochs, 1)


def run_started(run: Run, optimum: Plan) -> RunStarted:
    """Make a run's first event."""
    return RunStarted(
        run.experiment,
        run.planner_name,
        run.problem,
        run.seed,
        run.trials,
        run.settings,
        versions(),
        optimum.path,
        optimum.cost,
    )


def replay_events(started: RunStarted) -> Iterator[Event]:
    """Do a run again from what its log says of it.

    Parameters
    ----------
    started : RunStarted
        The first event of a log.

    Yields
    ------
    Event
        What the run would emit now, from the second event on.
    """
    planner = planner_from_settings(started.settings)
    optimum = shortest_path(started.problem)
    step = found = 0
    for trial in plan_trials(started.problem, optimum, planner, started.seed, started.trials):
        yield from trial_events(trial, started.seed, step)
        step += duration(trial.plan)
        found += trial.plan.feasible
    yield RunFinished(step, started.trials, found)


def execute(run: Run, command: str, progress: bool = True) -> Outcome:
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
    Outcome
        The state is "skipped" if the folder is whole already and not ``run.force``.

    Raises
    ------
    InputError
        If the folder cannot be written.
    """
    key = run_key(run.settings, run.planner_name, run.problem.map.digest)
    folder = RunFolder(Path(run.output) / run.experiment / key)
    folder.create()
    try:
        with folder.lock():
            if folder.is_whole() and not run.force:
                names = sorted(path.name for path in folder.path.iterdir())
                return Outcome(folder.path, "skipped", [], names)
            return _execute_held(run, folder, key, command, progress)
    except Busy:
        return Outcome(folder.path, "busy", [], [])


def _execute_held(run: Run, folder: RunFolder, key: str, command: str, progress: bool) -> Outcome:
    started = now()
    folder.clear()
    folder.write_status("running", started)
    try:
        write_whole(folder.path / "config.yaml", run.settings.encode())
        rows, recorded = _do_trials(run, folder, progress)
        write_whole(folder.path / "trials.parquet", _parquet(rows))
        names = ["config.yaml", "trials.parquet", *recorded]
        folder.write_json(MANIFEST, _manifest(run, folder, key, command, names))
        infeasible = all(row.status == "infeasible" for row in rows)
        found = sum(row.feasible for row in rows)
        state = "infeasible" if infeasible else "done"
        folder.write_status(state, started, f"{found} of {len(rows)} trials found a path")
        return Outcome(folder.path, state, rows, [*names, MANIFEST, "status.json"])
    except BaseException as error:
        interrupted = isinstance(error, KeyboardInterrupt)
        state = "interrupted" if interrupted else "failed"
        folder.write_status(state, started, "" if interrupted else traceback.format_exc())
        raise


def _do_trials(run: Run, folder: RunFolder, progress: bool) -> tuple[list[TrialRow], list[str]]:
    from tqdm import tqdm

    optimum = shortest_path(run.problem)
    distances = clearances(run.problem.map)
    rows: list[TrialRow] = []
    step = 0

    def record(event: Event) -> None:
        for recorder in run.recorders:
            recorder.record(event)

    bar = tqdm(
        plan_trials(run.problem, optimum, run.planner, run.seed, run.trials),
        desc=f"{run.problem.map.name} {run.planner_name}",
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
                for event in trial_events(trial, run.seed, step):
                    record(event)
            step += duration(trial.plan)
            rows.append(_row(run, trial, optimum, distances))
        record(RunFinished(step, run.trials, sum(row.feasible for row in rows)))
        return rows, [name for recorder in run.recorders for name in recorder.close()]
    except BaseException:
        for recorder in run.recorders:
            recorder.abort()
        raise


def _row(
    run: Run,
    trial: Trial,
    optimum: Plan,
    distances: np.ndarray[tuple[int, ...], np.dtype[np.float64]],
) -> TrialRow:
    grid, plan = run.problem.map, trial.plan
    metrics = path_metrics(grid, plan.path, distances)
    ratio = plan.cost / optimum.cost if plan.feasible and optimum.cost else math.nan
    return TrialRow(
        experiment=run.experiment,
        map=grid.name,
        map_instance=grid.instance,
        map_source=grid.source,
        width=grid.cols,
        height=grid.rows,
        corner_cutting=run.problem.corner_cutting.name.lower(),
        planner=run.planner_name,
        seed=run.seed,
        trial=trial.number,
        status=plan.status.name.lower(),
        feasible=plan.feasible,
        cost=plan.cost,
        optimal_cost=optimum.cost,
        optimality_ratio=ratio,
        length=metrics.length,
        turns=metrics.turns,
        clearance=metrics.clearance,
        curvature=metrics.curvature,
        epochs=plan.epochs,
        evaluations=plan.evaluations,
        expansions=plan.expansions,
        plan_time_s=trial.plan_time_s,
    )


def _parquet(rows: list[TrialRow]) -> bytes:
    import pyarrow as pa
    from pyarrow import parquet

    types = {str: pa.string(), int: pa.int64(), float: pa.float64(), bool: pa.bool_()}
    special = {"seed": pa.uint64()}
    schema = pa.schema(
        [(f.name, special.get(f.name, types[f.type])) for f in fields(TrialRow)]  # type: ignore[index]
    )
    file = io.BytesIO()
    parquet.write_table(pa.Table.from_pylist([asdict(row) for row in rows], schema), file)
    return file.getvalue()


def _manifest(
    run: Run, folder: RunFolder, key: str, command: str, names: list[str]
) -> dict[str, object]:
    listed = {
        name: {
            "sha256": sha256(folder.path / name),
            "bytes": (folder.path / name).stat().st_size,
        }
        for name in names
    }
    return {
        "key": key,
        "experiment": run.experiment,
        "map": run.problem.map.name,
        "map_instance": run.problem.map.instance,
        "planner": run.planner_name,
        "seed": run.seed,
        "trials": run.trials,
        "command": command,
        "versions": versions(),
        "files": listed,
    }

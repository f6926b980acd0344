"""The Hydra application: compose, check, run, print."""

import os
import shlex
import statistics
import sys
import traceback
from typing import NoReturn

from hydra import compose
from hydra import main as hydra_main
from hydra.core.hydra_config import HydraConfig
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.errors import HydraException
from hydra.experimental.callback import Callback
from hydra.types import RunMode
from omegaconf import DictConfig
from omegaconf.errors import OmegaConfBaseException

from gapath.config import Run, conf_folder, make_run
from gapath.errors import InputError
from gapath.experiment import Outcome, TrialRow, execute

BAD_INPUT, FAILED, INTERRUPTED = 2, 1, 130

BAD_CONFIGURATION = (InputError, HydraException, OmegaConfBaseException)


class JobFailed(Exception):
    """A job failed and has said why; carries the exit code."""


def planner_name(choice: str, overrides: list[str]) -> str:
    """Name a planner by its YAML and the values that replace the YAML's.

    Parameters
    ----------
    choice : str
        Name of the YAML in ``conf/planner``.
    overrides : list of str
        Hydra overrides of the job.

    Returns
    -------
    str
        For example "ga3" or "ga3[population=60]".
    """
    values = sorted(o.removeprefix("planner.") for o in overrides if o.startswith("planner."))
    return f"{choice}[{','.join(values)}]" if values else choice


class SweepCheck(Callback):  # type: ignore[misc]
    """Checks every job of a sweep before the first one runs."""

    def on_multirun_start(self, config: DictConfig, **kwargs: object) -> None:
        """Compose and check all jobs; exit with code 2 if any job's settings are wrong.

        Hydra turns a callback's exceptions into warnings, but not an exit.
        """
        from hydra._internal.core_plugins.basic_sweeper import BasicSweeper

        given = [f"{key}={value}" for key, value in (config.hydra.sweeper.params or {}).items()]
        parsed = OverridesParser.create().parse_overrides([*given, *config.hydra.overrides.task])
        try:
            for overrides in BasicSweeper.split_arguments(parsed, None)[0]:
                make_run(compose("config", overrides=overrides), "")
        except BAD_CONFIGURATION as error:
            sys.exit(complain(error))


def job(config: DictConfig) -> None:
    """Do one job: one setting and a batch of trials.

    Parameters
    ----------
    config : DictConfig
        As Hydra composed it.
    """
    hydra = HydraConfig.get()
    sweep = hydra.mode == RunMode.MULTIRUN
    overrides = list(hydra.overrides.task)
    try:
        run = make_run(config, planner_name(hydra.runtime.choices.planner, overrides))
        outcome = execute(run, command(overrides))
    except InputError as error:
        fail(complain(error), sweep)
    except Exception:
        traceback.print_exc()
        fail(FAILED, sweep)
    else:
        print(describe(run, outcome, short=sweep), flush=True)


def command(overrides: list[str]) -> str:
    """Give the command that does the same job, wherever its folder lies."""
    kept = [o for o in overrides if not o.startswith(("output=", "force="))]
    return shlex.join(["gapath", *kept])


def fail(code: int, sweep: bool) -> NoReturn:
    """End a job; in a sweep so that the other jobs go on.

    Raises
    ------
    JobFailed
        In a sweep; Hydra raises it again after the last job.
    SystemExit
        Otherwise.
    """
    if sweep:
        raise JobFailed(code)
    sys.exit(code)


def complain(error: Exception) -> int:
    """Print what is wrong with the input and give the exit code."""
    reason = str(error).partition("\nConfig search path")[0]
    cause = str(error.__cause__ or "").partition("\n")[0]
    print(f"gapath: {reason}{f' ({cause})' if cause else ''}", file=sys.stderr, flush=True)
    return BAD_INPUT


def describe(run: Run, outcome: Outcome, short: bool) -> str:
    """Tell how a run ended.

    Parameters
    ----------
    run : Run
        What was done.
    outcome : Outcome
        What came of it.
    short : bool
        One line instead of a table.

    Returns
    -------
    str
        Text for the terminal.
    """
    grid = run.problem.map
    instance = f"#{grid.instance}" if grid.instance else ""
    what = f"{grid.name}{instance} {run.planner_name}"
    if outcome.state == "skipped":
        return f"{what}: skipped, {outcome.folder} is whole (force=true runs it again)"
    if outcome.state == "busy":
        return f"{what}: skipped, another process is working on {outcome.folder}"
    rows = outcome.rows
    if short:
        found = sum(row.feasible for row in rows)
        return (
            f"{what}: {found} of {len(rows)} found, median {_milliseconds(rows)}, {outcome.folder}"
        )
    marked = f" ({grid.source})" if grid.source == "reconstructed" else ""
    lines: dict[str, object] = {
        "map": f"{grid.name}{instance}{marked}, {grid.cols} x {grid.rows} fields"
    }
    lines["planner"] = run.planner_name
    lines |= _one(rows[0]) if len(rows) == 1 else _many(rows)
    table = "\n".join(f"{name:<14}{value}" for name, value in lines.items())
    files = "\n".join(f"  {outcome.folder / name}" for name in outcome.files)
    return f"{table}\n\nfiles\n{files}"


def _one(row: TrialRow) -> dict[str, object]:
    return {
        "seed": row.seed,
        "status": row.status,
        "cost": f"{row.cost:g}",
        "optimal cost": f"{row.optimal_cost:g}",
        "epochs": row.epochs,
        "evaluations": row.evaluations,
        "expansions": row.expansions,
        "time": _milliseconds([row]),
    }


def _many(rows: list[TrialRow]) -> dict[str, object]:
    found = [row for row in rows if row.feasible]
    lines: dict[str, object] = {
        "trials": len(rows),
        "found": f"{len(found)} ({100 * len(found) / len(rows):.1f} %)",
        "optimal cost": f"{rows[0].optimal_cost:g}",
        "median time": _milliseconds(rows),
    }
    if found:
        lines["median cost"] = f"{statistics.median(row.cost for row in found):g}, of paths found"
        lines["median epochs"] = (
            f"{statistics.median(row.epochs for row in found):g}, of paths found"
        )
    return lines


def _milliseconds(rows: list[TrialRow]) -> str:
    return f"{1000 * statistics.median(row.plan_time_s for row in rows):.3g} ms"


def main() -> None:
    """Run the command ``gapath``; exits with 0, 1 (a job failed) or 2 (bad input)."""
    os.environ.setdefault("HYDRA_FULL_ERROR", "1")  # errors come here instead of being printed
    try:
        hydra_main(version_base="1.3", config_path=conf_folder(), config_name="config")(job)()
    except JobFailed as failure:
        sys.exit(failure.args[0])
    except (*BAD_CONFIGURATION, OSError) as error:
        sys.exit(complain(error))
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)

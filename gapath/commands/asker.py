"""Who asks for a run: the command that was typed, and a job's place in its sweep.

Launchers may do jobs in processes of their own, which know nothing of the command line but what
their environment tells.
"""

import json
import os
import shlex
import sys
from typing import Any

from gapath.store.keys import code_hash, edited
from gapath.store.settings import Flat

_SWEEP = "GAPATH_SWEEP"
"""The variable of the environment that tells jobs of their sweep."""

_MOST = 4000  # characters of a command that is kept


def begin_sweep(jobs: int) -> None:
    """Note a sweep that begins, for all of its jobs, in whatever process they are done."""
    told = {"command": _typed(), "jobs": jobs, "code": code_hash()}
    os.environ[_SWEEP] = json.dumps(told)


def asker() -> Flat:
    """Tell who asks for the run of a command."""
    return {"command": _typed()}


def asker_of_job(number: int, launcher: str) -> Flat:
    """Tell who asks for a job of a sweep.

    Parameters
    ----------
    number : int
        Its number, from 0.
    launcher : str
        Name of what does the jobs.

    Returns
    -------
    mapping
        command; job, from 1 to jobs; launcher.
    """
    sweep = _sweep()
    place = {"job": number + 1, "jobs": sweep.get("jobs")}
    return {"command": sweep.get("command"), **place, "launcher": launcher}


def edited_meanwhile() -> str | None:
    """Say so if the sources are others now than when the sweep began."""
    if not edited(_sweep().get("code", code_hash())):
        return None
    return (
        f"the code was edited since this sweep began; this job does what was loaded, {code_hash()}"
    )


def _sweep() -> dict[str, Any]:
    """Recall what was noted; nothing where a launcher keeps the environment from its jobs."""
    noted: dict[str, Any] = json.loads(os.environ.get(_SWEEP, "{}"))
    return noted


def _typed() -> str:
    """Give the command of this process, of a very long one so much."""
    text = shlex.join(["gapath", *sys.argv[1:]])
    return text if len(text) <= _MOST else f"{text[:_MOST]}... ({len(text) - _MOST} more)"

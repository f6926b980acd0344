"""The command `gapath-report watch`: where sweeps stand, from another terminal."""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from gapath.errors import printable
from gapath.running.sweep import Standing, sweep_files
from gapath.store.records import find_runs

_PAUSE = 1.0  # seconds between looks


def main(argv: Sequence[str]) -> None:
    """Follow the sweeps below a folder until none runs any more.

    Parameters
    ----------
    argv : sequence of str
        The arguments after ``watch``.

    Raises
    ------
    InputError
        If there are neither sweeps nor runs.
    """
    chosen = parser().parse_args(argv)
    bar = sys.stdout.isatty() and not chosen.once
    sweeps: dict[Path, Standing] = {}
    said: list[str] = []
    while True:
        _look(chosen.outputs, sweeps)
        alive = [sweep for sweep in sweeps.values() if sweep.alive]
        if not alive or chosen.once:
            break
        lines = [_line(sweep) for sweep in alive]
        if bar:
            print("\r\x1b[K" + " | ".join(lines), end="", flush=True)
        elif (counts := [sweep.counts() for sweep in alive]) != said:
            print(*lines, sep="\n", flush=True)
            said = counts
        time.sleep(_PAUSE)
    if bar:
        print("\r\x1b[K", end="")
    for sweep in sweeps.values():
        print(_line(sweep) if sweep.alive else _ended(sweep))
    states = Counter(str(run.state) for run in find_runs(chosen.outputs))
    runs = ", ".join(f"{count} {state}" for state, count in sorted(states.items()))
    print(printable(f"runs in {chosen.outputs}: {runs}"))


def parser() -> argparse.ArgumentParser:
    """Make the parser of its arguments."""
    made = argparse.ArgumentParser(
        "gapath-report watch", description="Follow sweeps that are under way, until none is."
    )
    made.add_argument("outputs", type=Path, nargs="?", default=Path("outputs"),
                      help="folder with <experiment>/<key>/ [outputs]")  # fmt: skip
    made.add_argument("--once", action="store_true", help="say where they stand, and end")
    return made


def _look(outputs: Path, sweeps: dict[Path, Standing]) -> None:
    """Read what is new of all sweeps; of one that ended meanwhile its last lines, too."""
    for path in sweep_files(outputs):
        if path not in sweeps:
            with suppress(OSError):
                sweeps[path] = Standing(path)
    for sweep in sweeps.values():
        sweep.read()


def _line(sweep: Standing) -> str:
    spent = max(time.time() - sweep.began, 1e-9)
    parts = [sweep.counts(), f"{len(sweep.running)} running"]
    if sweep.codes:
        parts.append(f"{60 * len(sweep.codes) / spent:.3g} jobs a minute")
        parts.append(f"{sweep.trials / spent:.3g} trials/s")
    left = sweep.seconds_left()
    parts += [] if left is None else [f"about {_time(left)} left"]
    return printable(f"{sweep.path.parent.name}: {', '.join(parts)}")


def _ended(sweep: Standing) -> str:
    how = sweep.unfinished() if sweep.left else f"{sweep.counts()}; it is done"
    return printable(f"{sweep.path.parent.name}: {how}")


def _time(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes}:{seconds:02d}"

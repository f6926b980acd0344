"""What the terminal shows of a sweep while engines do its jobs: one bar, and lines of workers."""

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any, Self

from gapath.running.sweep import Standing

_PAUSE = 0.2  # seconds between looks at the sweep's file


class Shown:
    """Follows the file of a sweep of this process in a thread, as long as jobs are done.

    Parameters
    ----------
    path : Path
        The sweep's file.
    say : callable
        Prints a result; gives an exit code.
    warn : callable
        Tells something on standard error.
    """

    def __init__(
        self, path: Path, say: Callable[[str], int], warn: Callable[[str], object]
    ) -> None:
        self._standing, self._say, self._warn = Standing(path), say, warn
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self.codes: list[int] = []
        """Of results that could not be printed."""

    def __enter__(self) -> Self:
        """Begin to follow it."""
        from tqdm import tqdm

        self._standing.read()  # what earlier batches did is shown already
        self._bar: Any = tqdm(
            total=self._standing.jobs,
            initial=self._standing.ended,
            desc=self._title(),
            bar_format="{desc} |{bar}| {elapsed}, {remaining} left",
            leave=False,
            disable=None,
        )
        self._thread.start()
        return self

    def __exit__(self, *raised: object) -> None:
        """Show what came last, and remove the bar."""
        self._stop.set()
        self._thread.join()
        self._look()
        self._bar.close()

    def _follow(self) -> None:
        while not self._stop.wait(_PAUSE):
            self._look()
            self._bar.refresh()  # the time goes on

    def _look(self) -> None:
        for out, err in self._standing.read():
            for text in err.splitlines():
                self._warn(text.removeprefix("gapath: "))
            if out and (code := self._say(out.rstrip("\n"))):
                self.codes.append(code)
        self._bar.n = self._standing.ended
        self._bar.set_description_str(self._title(), refresh=False)

    def _title(self) -> str:
        standing = self._standing
        failed = f", {standing.failed} failed" if standing.failed else ""
        return f"job {min(standing.ended + 1, standing.jobs)} of {standing.jobs}{failed}"

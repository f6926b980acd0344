"""How long each stage of a planner took: wall times, which no result depends on.

Beside `gapath.planning.simulation` and `gapath.driving.drive` the only clock: what takes time lies
within `plan`.
"""

import time


class Stages:
    """Takes the times of stages that follow one another; the first begins now."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._since = time.perf_counter()

    def end(self, name: str) -> None:
        """Say that a stage has ended; the next one begins."""
        now = time.perf_counter()
        self.seconds[name] = now - self._since
        self._since = now

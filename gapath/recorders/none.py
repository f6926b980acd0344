"""No recording: the recorder that records nothing."""

from dataclasses import dataclass

from gapath.events import Event


@dataclass
class Recorder:
    """Takes events and writes no file."""

    records = False

    def check(self, trials: int) -> None:
        """Accept every run."""

    def open(self, folder: str) -> None:
        """Do nothing."""

    def record(self, event: Event) -> None:
        """Do nothing."""

    def close(self) -> list[str]:
        """Give the names of no files."""
        return []

    def abort(self) -> None:
        """Do nothing."""

"""Counts the events of a run into a text file."""

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from gapath.events import Event
from gapath.store.durable import write_whole


@dataclass
class Recorder:
    """Writes ``counts.txt``: a line for each kind of event.

    Parameters
    ----------
    title : str
        The first line.
    """

    title: str
    _folder: Path = field(init=False, repr=False)
    _counts: Counter[str] = field(init=False, repr=False)

    records = True

    def check(self, trials: int) -> None:
        """Accept every run."""

    def open(self, folder: str) -> None:
        """Begin to count."""
        self._folder, self._counts = Path(folder), Counter()

    def record(self, event: Event) -> None:
        """Count an event."""
        self._counts[type(event).__name__] += 1

    def close(self) -> list[str]:
        """Write the file and give its name."""
        lines = [self.title, *(f"{name} {n}" for name, n in sorted(self._counts.items()))]
        write_whole(self._folder / "counts.txt", ("\n".join(lines) + "\n").encode())
        return ["counts.txt"]

    def abort(self) -> None:
        """Do nothing: no file was begun."""

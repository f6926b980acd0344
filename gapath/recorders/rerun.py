"""Rerun recordings: one ``trial-<n>.rrd`` for each chosen trial.

What a recording shows is made in `gapath.recorders._scene`, which alone imports Rerun:
that takes up to a second, so it waits until a chosen trial has ended. The recording is
made in memory and written here, because Rerun's own file writer loses data on a full disk
without an error.
"""

from dataclasses import dataclass, field
from pathlib import Path

from gapath.durable import part_of, publish, write_part
from gapath.errors import require
from gapath.events import Event, Evolved, RunStarted, TrialFinished, TrialStarted


@dataclass
class Recorder:
    """Record chosen trials for the Rerun viewer.

    Parameters
    ----------
    trials : list of int
        Numbers of the trials to record.

    Raises
    ------
    InputError
        If a number is not a whole one from 0 on; from `record`, if the run has no such
        trial.
    """

    trials: list[int]
    _folder: Path = field(init=False, repr=False)
    _run: RunStarted = field(init=False, repr=False)
    _trial: TrialStarted | None = field(init=False, repr=False, default=None)
    _evolutions: list[Evolved] = field(init=False, repr=False, default_factory=list)
    _names: list[str] = field(init=False, repr=False, default_factory=list)

    def __post_init__(self) -> None:
        good = isinstance(self.trials, list) and all(
            type(trial) is int and trial >= 0 for trial in self.trials
        )
        require(good, "recorder.rerun.trials", self.trials, "a list of trial numbers from 0 on")

    def open(self, folder: str) -> None:
        """Prepare to write files into an existing folder."""
        self._folder = Path(folder)
        self._trial = None
        self._evolutions = []
        self._names = []

    def record(self, event: Event) -> None:
        """Take the next event; a chosen trial's file is written when the trial ends.

        Parameters
        ----------
        event : Event
            In the order in which the run emits them.

        Raises
        ------
        InputError
            If a chosen trial is not one of the run's.
        OSError
            If the file cannot be written.
        """
        match event:
            case RunStarted():
                require(
                    all(trial < event.trials for trial in self.trials),
                    "recorder.rerun.trials",
                    self.trials,
                    f"trials of this run, 0 to {event.trials - 1}",
                )
                self._run = event
            case TrialStarted() if event.trial in self.trials:
                self._trial = event
            case Evolved() if self._trial is not None:
                self._evolutions.append(event)
            case TrialFinished() if self._trial is not None:
                self._write(self._trial, event)
                self._trial = None
                self._evolutions = []

    def _write(self, trial: TrialStarted, finished: TrialFinished) -> None:
        from gapath.recorders._scene import recording

        content = recording(self._run, trial, self._evolutions, finished)
        name = f"trial-{trial.trial}.rrd"
        write_part(self._folder / name, content)
        self._names.append(name)

    def close(self) -> list[str]:
        """Give the files their final names, make those durable, and return them."""
        for name in self._names:
            publish(part_of(self._folder / name), self._folder / name)
        return self._names

    def abort(self) -> None:
        """Forget the trial under way; files already written stay as ``.part``."""
        self._trial = None
        self._evolutions = []

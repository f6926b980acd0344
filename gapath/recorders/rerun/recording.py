"""Rerun recordings: one ``trial-<n>.rrd`` for each chosen trial.

What a recording shows is made by a scene: `gapath.recorders.rerun.drive_scene` for drives,
`gapath.recorders.rerun.scene` for plans, `gapath.recorders.rerun.plain_scene` for all else; a
trial's events decide which, whatever task they come from. Scenes import Rerun, which takes up to
a second, so that waits until a chosen trial has ended. The recording is made in memory and
written here, because Rerun's own file writer loses data on a full disk without an error.
"""

from dataclasses import dataclass, field
from pathlib import Path

from gapath.errors import require, require_extra
from gapath.events import Event, Finished, RunStarted, Surveyed, TrialStarted
from gapath.store.durable import part_of, publish, write_part


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
        If a number is not a whole one from 0 to 999999, or Rerun is not installed; from `record`,
        if the run has no such trial.
    """

    records = True

    trials: list[int]
    _folder: Path = field(init=False, repr=False)
    _run: RunStarted = field(init=False, repr=False)
    _survey: list[Event] = field(init=False, repr=False, default_factory=list)
    _events: list[Event] = field(init=False, repr=False, default_factory=list)
    _names: list[str] = field(init=False, repr=False, default_factory=list)

    def __post_init__(self) -> None:
        require_extra("recorder rerun", "view", "rerun-sdk")
        good = isinstance(self.trials, list) and all(
            type(trial) is int and 0 <= trial < 10**6 for trial in self.trials
        )
        expected = "a list of trial numbers from 0 to 999999"
        require(good, "recorder.rerun.trials", self.trials, expected)

    def check(self, trials: int) -> None:
        """Raise InputError if a chosen trial is not one of a run's."""
        require(
            all(trial < trials for trial in self.trials),
            "recorder.rerun.trials",
            self.trials,
            f"trials of this run, 0 to {trials - 1}",
        )

    def open(self, folder: str) -> None:
        """Prepare to write files into an existing folder."""
        self._folder = Path(folder)
        self._survey, self._events = [], []
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
                self.check(event.trials)
                self._run = event
            case TrialStarted() if event.trial in self.trials:
                self._events = [event]
            case Surveyed():
                self._survey = [event]
            case Finished() if self._events:
                self._write(event.trial, [*self._events, *self._survey, event])
                self._events = []
            case _ if self._events:
                self._events.append(event)

    def _write(self, trial: int, events: list[Event]) -> None:
        from gapath.recorders.rerun.scenes import scene_of

        name = f"trial-{trial}.rrd"
        write_part(self._folder / name, scene_of(events).recording(self._run, events))
        self._names.append(name)

    def close(self) -> list[str]:
        """Give the files their final names, make those durable, and return them."""
        for name in self._names:
            publish(part_of(self._folder / name), self._folder / name)
        return self._names

    def abort(self) -> None:
        """Forget the trial under way; files already written stay as ``.part``."""
        self._events = []

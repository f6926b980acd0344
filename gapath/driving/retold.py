"""A drive as its events tell it, be it just done or read from a log."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gapath.driving.followed import followed
from gapath.driving.sensed import sensed
from gapath.errors import require
from gapath.events import Called, DriveFinished, DriveStarted, Event, Outcome, Stepped
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.pictures.shown import FRAMES, Shown
from gapath.planning.path import without_stands
from gapath.problem import Problem, no_path

if TYPE_CHECKING:
    from gapath.pictures.animation import Animation
    from gapath.pictures.shown import Axes


@dataclass(frozen=True, eq=False)
class Drive(Shown):
    """A drive through an unknown map, of n steps.

    Parameters
    ----------
    problem : Problem
        The true map, start, target and corner-cutting rule.
    events : sequence of Event
        All that happened, from `TrialStarted` to `DriveFinished` (`gapath.events`).
    """

    problem: Problem
    events: Sequence[Event] = field(repr=False)

    @property
    def outcome(self) -> Outcome:
        """How it ended."""
        return self._end.outcome

    @property
    def reached(self) -> bool:
        """True if the robot reached the target."""
        return self.outcome is Outcome.REACHED

    @property
    def steps(self) -> int:
        """How many steps the robot took, those included in which it stood."""
        return self._end.steps

    @cached_property
    def places(self) -> NDArray[np.int32]:
        """(n + 1, 2) the robot's field (x, y) at its first look, then after each step."""
        return np.array([step.place for step in self._steps], dtype=np.int32)

    @cached_property
    def path(self) -> NDArray[np.int32]:
        """(m, 2) the fields (x, y) that it passed, in order."""
        return without_stands(self.places)

    @cached_property
    def calls(self) -> list[Called]:
        """Each time that it called a planner."""
        return [event for event in self.events if isinstance(event, Called)]

    def known(self, step: int | None = None) -> NDArray[np.float64]:
        """Give what the robot knew after a step, 0 its first look; by default at the end.

        Parameters
        ----------
        step : int, optional
            From 0 to n.

        Returns
        -------
        (rows, cols) float64
            Weights as it last saw them, 1 an obstacle; NaN where it had seen nothing.

        Raises
        ------
        InputError
            If there was no such step.
        """
        step = self.steps if step is None else step
        require(0 <= step <= self.steps, "step", step, f"an integer from 0 to {self.steps}")
        known = np.full(self.problem.map.weights.shape, np.nan)
        for x, y in (self.problem.start, self.problem.target):  # known from the start
            known[y, x] = self.problem.map.weights[y, x]
        fields, weights, ends = self._seen
        x, y = fields[: ends[step]].T
        known[y, x] = weights[: ends[step]]  # of one that is there twice the last counts
        return known

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the map and the way gone, tinted what it never saw (`Shown.plot`)."""
        from gapath.pictures.board import draw_path, draw_unknown, drive_legend

        ax, known = self.problem.plot(ax), self.known()
        draw_unknown(ax, np.isnan(known))
        draw_path(ax, self.path, no_path())
        drive_legend(ax)
        told = f"{self.problem.map.name}: {self._end.ending} after {self.steps} steps"
        ax.set_title(told, parse_math=False)
        return ax

    def animate(self, most: int = FRAMES) -> "Animation":
        """Show the drive step by step: the robot, its way, the path that it follows, what it knows.

        Also the border of what its sensor covers, from where it looked before it moved.

        Parameters
        ----------
        most : int
            Pictures at most, spread evenly.

        Returns
        -------
        Animation
            A notebook plays it; its `save` writes a file.
        """
        from gapath.pictures.animation import Animation, chosen
        from gapath.pictures.board import Robot

        weights = self.problem.map.weights

        def scene(ax: "Axes") -> Callable[[int], None]:
            robot = Robot(self.problem.plot(ax), weights.shape)

            def show(step: int) -> None:
                ways = self.places[: step + 1], self._paths[step]
                robot.show(weights, self.known(step), *ways, self._seen_from(step))
                mode = self._steps[step].mode.name.lower()
                ax.set_title(f"step {step} of {self.steps}: {mode}")

            return show

        return Animation(weights.shape, chosen(range(self.steps + 1), most), scene)

    @cached_property
    def _end(self) -> DriveFinished:
        end = self.events[-1]
        assert isinstance(end, DriveFinished)
        return end

    @cached_property
    def _steps(self) -> list[Stepped]:
        return [event for event in self.events if isinstance(event, Stepped)]

    @cached_property
    def _seen(self) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.int64]]:
        """(f, 2) fields that it saw, (f,) their weights, (n + 1,) how many up to each step."""
        fields = np.concatenate([step.fields for step in self._steps])
        entries = np.concatenate([step.entries for step in self._steps])
        weights = np.where(entries >= OBSTACLE, 1.0, entries / SCALE)
        return fields, weights, np.cumsum([len(step.fields) for step in self._steps])

    def _seen_from(self, step: int) -> NDArray[np.float32]:
        """Give the border (n, 2) of what the sensor covers in a step, as (x, y)."""
        (able,) = (event for event in self.events if isinstance(event, DriveStarted))
        border = sensed(able.sensor_range, self._steps[step].heading)
        return np.asarray(border + self.places[max(step - 1, 0)], dtype=np.float32)

    @cached_property
    def _paths(self) -> list[NDArray[np.int32]]:
        """The path that it followed at the end of each step, as far as it knew it to be free."""
        return [each.path for each in followed(self.problem, self.events)]

    def _told(self) -> dict[str, object]:
        return {
            "outcome": self._end.ending,
            "steps": self.steps,
            "fields seen": f"{100 * (~np.isnan(self.known())).mean():.3g} %",
            "calls of planners": len(self.calls),
        }

"""What a recording shows of a population: each polygon, what changed it, what that was worth."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from gapath.history.evolution import Population
from gapath.recorders.rerun.drawing import (
    DARK_PURPLE,
    PURPLE,
    VERMILLION,
    YELLOW,
    Color,
    centres,
    line,
    send_curve,
    texts_view,
)

_COLORS: tuple[Color, ...] = (
    PURPLE,
    YELLOW,
    VERMILLION,
    (0, 114, 178),
    (0, 158, 115),
    (170, 130, 255),
    (190, 190, 120),
    (255, 150, 130),
)
"""Of individuals and of operators, in turn."""

LEGEND = (
    "- **thin lines**: the other individuals, a colour each\n"
    "- **wide dark purple**: the first path, made short\n"
)
"""What the colours mean, in Markdown."""


def log_population(
    stream: rr.RecordingStream, population: Population, epochs: int, first_epoch: int, timeline: str
) -> None:
    """Log the polygons of all individuals, every change, and what each operator gained so far.

    Parameters
    ----------
    stream : RecordingStream
        Where to.
    population : Population
        What it took in.
    epochs : int
        How many its algorithm had.
    first_epoch : int
        The first one's time.
    timeline : str
        In this time.
    """

    def time(moments: object) -> list[rr.TimeColumn]:
        return [rr.TimeColumn(timeline, sequence=first_epoch - 1 + np.asarray(moments))]

    stream.log("map/first_path", line(DARK_PURPLE, 10, draw_order=19), static=True)
    first = rr.LineStrips2D.from_fields(strips=[centres(population.polygon(0))])
    stream.log("map/first_path", first, static=True)
    standing = population.standing(epochs)
    for k, individual in enumerate(np.unique(population.individuals).tolist()):
        entity = f"map/population/{individual}"
        stream.log(entity, line(_color(k), 1.5, draw_order=22), static=True)
        left = np.flatnonzero(np.diff(standing[:, k], prepend=-1))  # epochs from 0 that changed it
        strips = [centres(population.polygon(i)) for i in standing[left, k]]
        stream.send_columns(entity, time(left + 1), rr.LineStrips2D.columns(strips=strips))
    told = zip(
        (first_epoch - 1 + population.epochs).tolist(),
        population.operators.tolist(),
        population.individuals.tolist(),
        population.costs.tolist(),
        population.gains.tolist(),
        strict=True,
    )
    texts = [
        f"#{epoch} {population.names[operator]}, {individual}: {cost:g}"
        + (f", {gain:.3g} less" if gain else "")
        for epoch, operator, individual, cost, gain in told
    ]
    levels = ["INFO" if gain else "DEBUG" for gain in population.gains]
    columns = rr.TextLog.columns(text=texts, level=levels)
    stream.send_columns("changes", time(population.epochs), columns)
    gained = np.zeros((epochs, len(population.names)))
    np.add.at(gained, (population.epochs - 1, population.operators), population.gains)
    for k in np.flatnonzero(gained.any(axis=0)).tolist():
        values, name = gained[:, k].cumsum(), population.names[k]
        send_curve(stream, f"gained/{k}", time(1 + np.arange(epochs)), values, name, _color(k))


def _color(number: int) -> Color:
    return _COLORS[number % len(_COLORS)]


def share_rows(population: Population) -> dict[str, object]:
    """Give what a table says of what found the path, label -> value."""
    (first, cost), *others = zip(population.names, population.shares, strict=True)
    lowered = {f"lowered by {name}": f"{share:.10g}" for name, share in others if share}
    return {f"first path, {first}": f"{cost:.10g}", **lowered}


def gains_views(population: Population) -> list[rrb.View]:
    """Show what each operator gained so far, over all individuals; nothing if none did."""
    if not population.gains.any():
        return []
    return [rrb.TimeSeriesView(origin="gained", name="Cost lowered so far, all individuals")]


def changes_view(timeline: str) -> rrb.View:
    """List the changes."""
    return texts_view("changes", "Changes: epoch, operator, individual, cost", timeline)

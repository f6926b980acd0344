"""What the recordings of plans and of drives have in common.

The centre of field (x, y) is drawn at (x + 0.5, y + 0.5), where the map's image has its
pixel's centre; Rerun's 2D views have y down, as maps have.
"""

import hashlib
from collections.abc import Mapping

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from gapath.events import Posed, RunStarted, TrialStarted
from gapath.grid import GridMap
from gapath.store.settings import text_of

Color = tuple[int, int, int]

_FEW = 50
"""Points of a curve up to which they are large."""

# Colours of Okabe and Ito, told apart with any colour vision, over a map in greys.
OPTIMAL = (86, 180, 233)
ORANGE = (230, 159, 0)
PURPLE = (204, 121, 167)
DARK_PURPLE = (130, 65, 130)
VERMILLION = (213, 94, 0)
GREEN = (0, 220, 130)
GREY = (150, 150, 150)
YELLOW = (240, 228, 66)


def new_stream(run: RunStarted, trial: TrialStarted) -> rr.RecordingStream:
    """Begin a recording that is named the same way whenever the trial is recorded.

    Parameters
    ----------
    run : RunStarted
        What the run's trials share.
    trial : TrialStarted
        Start of the trial.

    Returns
    -------
    RecordingStream
        Without a sink.
    """
    grid = run.problem.map
    # A viewer keeps one layout an application, so with one only a second map would be shown
    # under the first one's name and within its bounds.
    layout = _hash([run.method, title(grid), grid.rows, grid.cols])
    return rr.RecordingStream(
        f"gapath-{layout[:8]}",
        recording_id=_hash([text_of(run.settings), run.method, grid.digest, run.seed, trial.trial])[
            :32
        ],
        send_properties=False,  # would hold the time of day
    )


def _hash(parts: list[object]) -> str:
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def log_problem(stream: rr.RecordingStream, posed: Posed, width: float) -> None:
    """Log start, target and the optimal path, so wide, which never change."""
    for name, place in (("start", posed.start), ("target", posed.target)):
        marker = rr.Points2D(
            centres(np.array([place])),
            colors=[YELLOW],
            labels=[name],
            radii=[rr.Radius.ui_points(6)],
            draw_order=30,
        )
        stream.log(f"map/{name}", marker, static=True)
    if len(posed.optimal_path):
        stream.log("map/optimal_path", line(OPTIMAL, width, draw_order=20), static=True)
        strip = rr.LineStrips2D.from_fields(strips=[centres(posed.optimal_path)])
        stream.log("map/optimal_path", strip, static=True)


def log_map(stream: rr.RecordingStream, grid: GridMap) -> None:
    """Log a map in greys, which never changes."""
    # As in KG18 0 is black and 1 white; squared, or the usual 0.5 would drown the colours.
    grey = np.floor(grid.weights**2 * 255 + 0.5).astype(np.uint8)
    stream.log("map", rr.Image(grey, color_model="L"), static=True)


def centres(fields: NDArray[np.int32]) -> NDArray[np.float32]:
    """Give where fields (..., 2) are drawn."""
    return (fields + 0.5).astype(np.float32)


def line(color: Color, width: float, draw_order: float) -> rr.LineStrips2D:
    """Give the look of a line, `width` in points of the screen so that any map size works."""
    return rr.LineStrips2D.from_fields(
        colors=[color], radii=[rr.Radius.ui_points(width / 2)], draw_order=draw_order
    )


def send_curve(
    stream: rr.RecordingStream,
    entity: str,
    time: list[rr.TimeColumn],
    values: NDArray[np.float64],
    name: str,
    color: Color,
    width: float = 1.5,
) -> None:
    """Send a curve, a point at each time too: a single value has no line."""
    stream.log(entity, rr.SeriesLines(colors=[color], names=[name], widths=[width]), static=True)
    size = width + (0.5 if len(values) > _FEW else 2.5)
    marks = rr.SeriesPoints(colors=[color], names=[name], marker_sizes=[size])
    stream.log(entity, marks, static=True)
    stream.send_columns(entity, time, rr.Scalars.columns(scalars=values))


def problem_rows(run: RunStarted, trial: TrialStarted, posed: Posed) -> dict[str, object]:
    """Give what a table says of the problem, label -> value."""
    problem, grid = run.problem, run.problem.map
    return {
        "map": title(grid),
        "size": f"{grid.cols} by {grid.rows} fields",
        **({} if problem.queries is None else {"problem": posed.number}),
        "start, target": f"{posed.start}, {posed.target}",
        "corner cutting": problem.corner_cutting.name.lower().replace("_", " "),
        "seed, trial": f"{run.seed}, {trial.trial}",
        "experiment": run.experiment,
    }


def document(
    run: RunStarted, sentence: str, rows: Mapping[str, object], legend: str
) -> rr.TextDocument:
    """Write the panel of settings and result, in Markdown."""
    table = [f"| {key} | {value} |" for key, value in rows.items()]
    table.insert(1, "| --- | --- |")
    versions = ", ".join(f"{name} {version}" for name, version in run.versions.items())
    return rr.TextDocument(
        f"# {run.method} on {run.problem.map.name}\n\n{sentence}.\n\n"
        + "\n".join(table)
        + f"\n\n## Legend\n{legend}\n"
        f"## Settings\n```yaml\n{text_of(run.settings).strip()}\n```\n\n{versions}\n",
        media_type="text/markdown",
    )


def title(grid: GridMap) -> str:
    """Name a map, with a mark if it was reconstructed."""
    instance = f", instance {grid.instance}" if grid.instance else ""
    mark = " (reconstructed)" if grid.source == "reconstructed" else ""
    return f"{grid.name}{instance}{mark}"


def map_view(
    grid: GridMap, trails: Mapping[str, rrb.VisibleTimeRanges] | None = None
) -> rrb.Spatial2DView:
    """Show the whole map with a small margin; `trails` are entities whose past is shown too."""
    margin = 0.02 * max(grid.rows, grid.cols)
    bounds = rrb.VisualBounds2D(
        x_range=(-margin, grid.cols + margin), y_range=(-margin, grid.rows + margin)
    )
    return rrb.Spatial2DView(origin="map", name=title(grid), visual_bounds=bounds, overrides=trails)


def texts_view(origin: str, name: str, timeline: str) -> rrb.TextLogView:
    """List texts, each of which begins with its time.

    The viewer has a column for that, but makes it as wide as the first rows need: of "#100" it
    shows "#1...".
    """
    hidden = rrb.encodings.TimelineColumn(timeline, visible=False)
    columns = rrb.TextLogColumns(
        timeline_columns=[hidden], text_log_columns=[rrb.encodings.TextLogColumn("Body")]
    )
    return rrb.TextLogView(origin=origin, name=name, columns=columns)


def blueprint(
    view: rrb.View | rrb.Container, panels: list[rrb.View], timeline: str
) -> rrb.Blueprint:
    """Lay the views out, panels on the right; paused, so that nothing is missed."""
    shares = [2, *[1] * (len(panels) - 1)]  # the text is the longest
    return rrb.Blueprint(
        rrb.Horizontal(view, rrb.Vertical(*panels, row_shares=shares), column_shares=[3, 1]),
        rrb.TimePanel(timeline=timeline, play_state="paused", fps=5, state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_layout=False,
        auto_views=False,
    )

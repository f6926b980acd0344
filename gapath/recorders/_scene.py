"""What a Rerun recording of a trial shows: map, paths, curves, text, and their layout.

The centre of field (x, y) is drawn at (x + 0.5, y + 0.5), where the map's image has its
pixel's centre; Rerun's 2D views have y down, as maps have.
"""

import hashlib

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from gapath.events import Evolved, RunStarted, TrialFinished, TrialStarted
from gapath.grid import GridMap
from gapath.kernels.raster import polyline

TIMELINE = "epoch"

# Colours of Okabe and Ito, told apart with any colour vision, over a map in greys.
OPTIMAL = (86, 180, 233)
BEST = (230, 159, 0)
CONTROL = (204, 121, 167)
FINAL = (0, 220, 130)
MEAN = (150, 150, 150)
ENDS = (240, 228, 66)


def recording(
    run: RunStarted, trial: TrialStarted, evolutions: list[Evolved], finished: TrialFinished
) -> bytes:
    """Make the recording of one trial.

    Parameters
    ----------
    run : RunStarted
        What the run's trials share.
    trial : TrialStarted
        Start of the trial.
    evolutions : list of Evolved
        The trial's genetic algorithms; empty for a planner that is none.
    finished : TrialFinished
        End of the trial.

    Returns
    -------
    bytes
        A whole ``.rrd`` file with its blueprint; equal in content, not in bytes, for equal
        events.
    """
    stream = rr.RecordingStream(
        "gapath",
        recording_id=_recording_id(run, trial),
        send_properties=False,  # would hold the time of day
    )
    memory = stream.memory_recording()
    stream.send_blueprint(_blueprint(run, bool(evolutions)), make_active=False)
    stream.send_recording_name(f"{run.problem.map.name} {run.planner} trial {trial.trial}")
    _log_problem(stream, run)
    for evolved in evolutions:
        _log_evolution(stream, run.problem.map, evolved, evolved.step - trial.step + 1)
    last = max((e.step - trial.step + len(e.evolution.best) for e in evolutions), default=None)
    _log_result(stream, finished, last)
    stream.log("text", _text(run, trial, finished, bool(evolutions)), static=True)
    content: bytes = memory.drain_as_bytes()
    stream.disconnect()
    return content


def _recording_id(run: RunStarted, trial: TrialStarted) -> str:
    """Name the trial the same way whenever it is recorded."""
    key = [run.settings, run.planner, run.problem.map.digest, run.seed, trial.trial]
    return hashlib.sha256(repr(key).encode()).hexdigest()[:32]


def _log_problem(stream: rr.RecordingStream, run: RunStarted) -> None:
    """Log what no epoch changes: map, start, target and the optimal path."""
    problem = run.problem
    # As in KG18 0 is black and 1 white; squared, or the usual 0.5 would drown the colours.
    grey = np.floor(problem.map.weights**2 * 255 + 0.5).astype(np.uint8)
    stream.log("map", rr.Image(grey, color_model="L"), static=True)
    for name, place in (("start", problem.start), ("target", problem.target)):
        marker = rr.Points2D(
            _centres(np.array([place])),
            colors=[ENDS],
            labels=[name],
            radii=[rr.Radius.ui_points(6)],
            draw_order=30,
        )
        stream.log(f"map/{name}", marker, static=True)
    if len(run.optimal_path):
        stream.log("map/optimal_path", _line(OPTIMAL, 6, draw_order=20), static=True)
        strip = rr.LineStrips2D.from_fields(strips=[_centres(run.optimal_path)])
        stream.log("map/optimal_path", strip, static=True)


def _log_evolution(
    stream: rr.RecordingStream, grid: GridMap, evolved: Evolved, first_epoch: int
) -> None:
    """Log the best individual and the fitness of every epoch."""
    evolution = evolved.evolution
    epochs = len(evolution.best)
    time = [rr.TimeColumn(TIMELINE, sequence=np.arange(first_epoch, first_epoch + epochs))]

    paths = [polyline(way_points) for way_points in evolution.way_points]
    _send_strips(stream, "map/best/path", time, paths, _line(BEST, 3, draw_order=23))
    _send_points(stream, "map/best/way_points", time, evolution.way_points, BEST, 4)
    if evolution.genotype == "control_points":
        points = evolution.chromosomes.reshape(epochs, -1, 2)
        _send_strips(
            stream, "map/best/control_polygon", time, list(points), _line(CONTROL, 1, draw_order=22)
        )
        _send_points(stream, "map/best/control_points", time, points, CONTROL, 4)

    with np.errstate(divide="ignore", invalid="ignore"):
        best, mean = np.log10(evolution.best), np.log10(evolution.mean)
    _send_curve(stream, "fitness/mean", time, mean, "mean of the population", MEAN)
    _send_curve(stream, "fitness/best", time, best, "best", BEST)
    obstacles = np.array([_obstacle_fields(grid, path) for path in paths], dtype=np.float64)
    _send_curve(stream, "obstacles/best", time, obstacles, "obstacle fields", BEST)
    # A line at 0, so that the axis starts there.
    _send_curve(stream, "obstacles/none", time, np.zeros(epochs), "none", FINAL)


def _log_result(
    stream: rr.RecordingStream, finished: TrialFinished, last_epoch: int | None
) -> None:
    """Log the final path: at the last epoch, or for good where there are no epochs."""
    if not len(finished.path):
        return
    stream.log("map/final_path", _line(FINAL, 3, draw_order=24), static=True)
    strips = [_centres(finished.path)]
    if last_epoch is None:
        stream.log("map/final_path", rr.LineStrips2D.from_fields(strips=strips), static=True)
    else:  # not `set_time` and `log`, which would add the time of day
        time = [rr.TimeColumn(TIMELINE, sequence=[last_epoch])]
        stream.send_columns("map/final_path", time, rr.LineStrips2D.columns(strips=strips))


def _obstacle_fields(grid: GridMap, path: NDArray[np.int32]) -> int:
    """Count the fields of a path that are obstacles or lie outside the map."""
    x, y = path[:, 0], path[:, 1]
    inside = (x >= 0) & (x < grid.cols) & (y >= 0) & (y < grid.rows)
    return int((~inside).sum() + grid.obstacles[y[inside], x[inside]].sum())


def _centres(fields: NDArray[np.int32]) -> NDArray[np.float32]:
    return (fields + 0.5).astype(np.float32)


def _line(color: tuple[int, int, int], width: float, draw_order: float) -> rr.LineStrips2D:
    """Give the look of a line, `width` in points of the screen so that any map size works."""
    return rr.LineStrips2D.from_fields(
        colors=[color], radii=[rr.Radius.ui_points(width / 2)], draw_order=draw_order
    )


def _send_strips(
    stream: rr.RecordingStream,
    entity: str,
    time: list[rr.TimeColumn],
    strips: list[NDArray[np.int32]],
    look: rr.LineStrips2D,
) -> None:
    stream.log(entity, look, static=True)
    columns = rr.LineStrips2D.columns(strips=[_centres(strip) for strip in strips])
    stream.send_columns(entity, time, columns)


def _send_points(
    stream: rr.RecordingStream,
    entity: str,
    time: list[rr.TimeColumn],
    points: NDArray[np.int32],
    color: tuple[int, int, int],
    width: float,
) -> None:
    """Send (epochs, n, 2) points, n at each epoch."""
    radius = rr.Radius.ui_points(width)
    look = rr.Points2D.from_fields(colors=[color], radii=[radius], draw_order=25)
    stream.log(entity, look, static=True)
    epochs, n, _ = points.shape
    columns = rr.Points2D.columns(positions=_centres(points.reshape(-1, 2)))
    stream.send_columns(entity, time, columns.partition([n] * epochs))


def _send_curve(
    stream: rr.RecordingStream,
    entity: str,
    time: list[rr.TimeColumn],
    values: NDArray[np.float64],
    name: str,
    color: tuple[int, int, int],
) -> None:
    stream.log(entity, rr.SeriesLines(colors=[color], names=[name], widths=[1.5]), static=True)
    # A point at each epoch too: a run that succeeds in its first epoch has no line.
    marks = rr.SeriesPoints(colors=[color], names=[name], marker_sizes=[2])
    stream.log(entity, marks, static=True)
    stream.send_columns(entity, time, rr.Scalars.columns(scalars=values))


def _text(
    run: RunStarted, trial: TrialStarted, finished: TrialFinished, evolved: bool
) -> rr.TextDocument:
    """Write the panel of settings and result, in Markdown."""
    problem, grid = run.problem, run.problem.map
    if evolved:
        effort = {"epochs": finished.epochs, "evaluations": finished.evaluations}
    else:
        effort = {"expansions": finished.expansions}
    rows = {
        "cost": _number(finished.cost),
        "optimal cost": _number(run.optimal_cost),
        "fields of the path": len(finished.path),
        **effort,
        "map": _title(grid),
        "size": f"{grid.cols} by {grid.rows} fields",
        "start, target": f"{problem.start}, {problem.target}",
        "corner cutting": problem.corner_cutting.name.lower().replace("_", " "),
        "seed, trial": f"{run.seed}, {trial.trial}",
        "experiment": run.experiment,
    }
    status = finished.status.name.lower().replace("_", " ")
    table = "\n".join(f"| {key} | {value} |" for key, value in rows.items())
    moving = (
        "- **orange**: best path of the epoch; dots: its way points\n"
        "- **purple**: its control points and their polygon\n"
    )
    versions = ", ".join(f"{name} {version}" for name, version in run.versions.items())
    return rr.TextDocument(
        f"# {run.planner} on {grid.name}\n\n{finished.status.sentence.capitalize()}.\n\n"
        f"| status | {status} |\n| --- | --- |\n{table}\n\n"
        f"## Legend\n{moving if evolved else ''}"
        "- **green**: the path found\n- **blue**: a path of least cost\n"
        "- **map**: the brighter, the dearer; white: obstacle\n\n"
        f"## Settings\n```yaml\n{run.settings.strip()}\n```\n\n{versions}\n",
        media_type="text/markdown",
    )


def _number(value: float) -> str:
    return f"{value:.10g}" if np.isfinite(value) else "none"


def _title(grid: GridMap) -> str:
    instance = f", instance {grid.instance}" if grid.instance else ""
    mark = " (reconstructed)" if grid.source == "reconstructed" else ""
    return f"{grid.name}{instance}{mark}"


def _blueprint(run: RunStarted, evolved: bool) -> rrb.Blueprint:
    """Lay the views out: a large map above two curves, text on the right."""
    grid = run.problem.map
    margin = 0.02 * max(grid.rows, grid.cols)
    view = rrb.Spatial2DView(
        origin="map",
        name=_title(grid),
        visual_bounds=rrb.VisualBounds2D(
            x_range=(-margin, grid.cols + margin), y_range=(-margin, grid.rows + margin)
        ),
    )
    text = rrb.TextDocumentView(origin="text", name="Settings and result")
    if evolved:
        plain = rrb.PlotLegend(visible=False)  # it would hide the best or the worst
        curves = rrb.Horizontal(
            rrb.TimeSeriesView(
                origin="fitness",
                name="log10 of the fitness: best (orange), mean (grey)",
                plot_legend=plain,
            ),
            rrb.TimeSeriesView(
                origin="obstacles", name="Obstacle fields on the best path", plot_legend=plain
            ),
        )
        view = rrb.Vertical(view, curves, row_shares=[2, 1])
    return rrb.Blueprint(
        rrb.Horizontal(view, text, column_shares=[3, 1]),
        rrb.TimePanel(timeline=TIMELINE, play_state="paused", fps=5, state="collapsed"),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_layout=False,
        auto_views=False,
    )

"""What a Rerun recording of a planning trial shows: map, paths, curves, text, their layout."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from gapath.events import (
    Event,
    Evolved,
    Posed,
    RunStarted,
    Surveyed,
    TrialFinished,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.history.evolution import Evolution
from gapath.history.graph import Graph
from gapath.kernels.raster import polyline
from gapath.querying.told import posed_in
from gapath.recorders.rerun.drawing import (
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILLION,
    Color,
    blueprint,
    centres,
    document,
    line,
    log_map,
    log_problem,
    map_view,
    new_stream,
    problem_rows,
    send_curve,
)
from gapath.recorders.rerun.population_scene import (
    LEGEND,
    changes_view,
    gains_views,
    log_population,
    share_rows,
)

NEEDS: frozenset[type[Event]] = frozenset({TrialFinished})
"""Kinds of events that a trial has whose scene this is."""

TIMELINE = "epoch"


def recording(run: RunStarted, events: list[Event]) -> bytes:
    """Make the recording of one trial.

    Parameters
    ----------
    run : RunStarted
        What the run's trials share.
    events : list of Event
        The trial's, from its `TrialStarted` to its `TrialFinished`; in between the genetic
        algorithms, none for a planner that is none, and what the planner made of the map, if it
        says so.

    Returns
    -------
    bytes
        A whole ``.rrd`` file with its blueprint; equal in content, not in bytes, for equal
        events.
    """
    trial, finished = events[0], events[-1]
    assert isinstance(trial, TrialStarted) and isinstance(finished, TrialFinished)
    evolutions = [event for event in events if isinstance(event, Evolved)]
    stream = new_stream(run, trial)
    memory = stream.memory_recording()
    surveys = [event for event in events if isinstance(event, Surveyed)]
    stream.send_blueprint(layout(run, events))
    stream.send_recording_name(f"{run.problem.map.name} {run.method} trial {trial.trial}")
    posed = posed_in(run, events)
    log_problem(stream, posed, 6)
    log_map(stream, run.problem.map)
    for survey in surveys:
        _log_graph(stream, run.problem.map, survey.graph)
    for evolved in evolutions:
        _log_evolution(stream, run.problem.map, evolved, evolved.step - trial.step + 1)
    last = max((e.step - trial.step + len(e.evolution.best) for e in evolutions), default=None)
    _log_result(stream, finished, last)
    stream.log("text", _text(run, (trial, posed, finished), evolutions, bool(surveys)), static=True)
    content: bytes = memory.drain_as_bytes()
    stream.disconnect()
    return content


def _log_graph(stream: rr.RecordingStream, grid: GridMap, graph: Graph) -> None:
    """Log what the planner made of the map: grown obstacles, keypoints, free lines."""
    grown = graph.grown(grid.rows, grid.cols) & ~grid.obstacles
    rim = np.zeros((grid.rows, grid.cols, 4), dtype=np.uint8)
    rim[grown] = (*VERMILLION, 110)
    stream.log("map/grown_obstacles", rr.Image(rim, color_model="RGBA", draw_order=5), static=True)
    stream.log("map/graph", line(PURPLE, 0.7, draw_order=10), static=True)
    strips = rr.LineStrips2D.from_fields(strips=centres(graph.points[graph.edges]))
    stream.log("map/graph", strips, static=True)
    radius = rr.Radius.ui_points(3)
    marks = rr.Points2D(centres(graph.points), colors=[VERMILLION], radii=[radius], draw_order=15)
    stream.log("map/keypoints", marks, static=True)


def _log_evolution(
    stream: rr.RecordingStream, grid: GridMap, evolved: Evolved, first_epoch: int
) -> None:
    """Log the best individual and the fitness of every epoch."""
    evolution = evolved.evolution
    epochs = len(evolution.best)
    time = [rr.TimeColumn(TIMELINE, sequence=np.arange(first_epoch, first_epoch + epochs))]

    paths = [polyline(way_points) for way_points in evolution.way_points]
    _send_strips(stream, "map/best/path", time, paths, line(ORANGE, 3, draw_order=23))
    _send_points(stream, "map/best/way_points", time, evolution.way_points, ORANGE, 4)
    if evolution.genotype == "control_points":
        points = evolution.chromosomes.reshape(epochs, -1, 2)
        _send_strips(
            stream, "map/best/control_polygon", time, list(points), line(PURPLE, 1, draw_order=22)
        )
        _send_points(stream, "map/best/control_points", time, points, PURPLE, 4)

    if evolution.population:
        log_population(stream, evolution.population, epochs, first_epoch, TIMELINE)
    best, mean = evolution.best, evolution.mean
    if _over_many_sizes(evolution):
        with np.errstate(divide="ignore", invalid="ignore"):
            best, mean = np.log10(best), np.log10(mean)
    send_curve(stream, "fitness/mean", time, mean, "mean of the population", GREY)
    # Wider, since the other one lies over it.
    send_curve(stream, "fitness/best", time, best, "best", ORANGE, 3)
    obstacles = np.array([_obstacle_fields(grid, path) for path in paths], dtype=np.float64)
    send_curve(stream, "obstacles/best", time, obstacles, "obstacle fields", ORANGE)
    # A line at 0, so that the axis starts there.
    send_curve(stream, "obstacles/none", time, np.zeros(epochs), "none", GREEN)


def _over_many_sizes(evolution: Evolution) -> bool:
    """Tell whether fitness counts obstacles, which are dearer by far than any path."""
    return evolution.genotype != "keypoints" and evolution.population is None


def _log_result(
    stream: rr.RecordingStream, finished: TrialFinished, last_epoch: int | None
) -> None:
    """Log the final path: at the last epoch, or for good where there are no epochs."""
    if not len(finished.answer.path):
        return
    stream.log("map/final_path", line(GREEN, 3, draw_order=24), static=True)
    strips = [centres(finished.answer.path)]
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


def _send_strips(
    stream: rr.RecordingStream,
    entity: str,
    time: list[rr.TimeColumn],
    strips: list[NDArray[np.int32]],
    look: rr.LineStrips2D,
) -> None:
    stream.log(entity, look, static=True)
    columns = rr.LineStrips2D.columns(strips=[centres(strip) for strip in strips])
    stream.send_columns(entity, time, columns)


def _send_points(
    stream: rr.RecordingStream,
    entity: str,
    time: list[rr.TimeColumn],
    points: NDArray[np.int32],
    color: Color,
    width: float,
) -> None:
    """Send (epochs, n, 2) points, n at each epoch."""
    radius = rr.Radius.ui_points(width)
    look = rr.Points2D.from_fields(colors=[color], radii=[radius], draw_order=25)
    stream.log(entity, look, static=True)
    epochs, n, _ = points.shape
    columns = rr.Points2D.columns(positions=centres(points.reshape(-1, 2)))
    stream.send_columns(entity, time, columns.partition([n] * epochs))


def _text(
    run: RunStarted,
    asked: tuple[TrialStarted, Posed, TrialFinished],
    evolutions: list[Evolved],
    surveyed: bool,
) -> rr.TextDocument:
    """Write the panel of settings and result, in Markdown."""
    trial, posed, finished = asked
    if evolutions:
        effort = {"epochs": finished.answer.epochs, "evaluations": finished.answer.evaluations}
    else:
        effort = {"expansions": finished.answer.expansions}
    populations = [e.evolution.population for e in evolutions if e.evolution.population]
    shares = share_rows(populations[0]) if populations else {}
    rows = {
        "status": finished.answer.status.name.lower().replace("_", " "),
        "cost": _number(finished.answer.cost),
        "optimal cost": _number(posed.optimal_cost),
        "fields of the path": len(finished.answer.path),
        **effort,
        **shares,
        **problem_rows(run, trial, posed),
    }
    moving = ""
    if evolutions:
        moving = "- **orange**: best path of the epoch; dots: its way points\n"
        if evolutions[0].evolution.genotype == "control_points":
            moving += "- **purple**: its control points and their polygon\n"
    if populations:
        moving += LEGEND
    if surveyed:
        moving += "- **red**: obstacles grown by the robot's radius, keypoints\n"
        moving += "- **thin purple**: lines between keypoints that meet no obstacle\n"
    point = " of a robot that is a point" if surveyed else ""
    legend = (
        f"{moving}"
        f"- **green**: the path found\n- **blue**: a path of least cost{point}\n"
        "- **map**: the brighter, the dearer; white: obstacle\n"
    )
    return document(run, finished.answer.status.sentence.capitalize(), rows, legend)


def _number(value: float) -> str:
    return f"{value:.10g}" if np.isfinite(value) else "none"


def layout(run: RunStarted, events: list[Event]) -> rrb.Blueprint:
    """Lay the views out: a large map, above curves if there are any, text on the right."""
    evolutions = [event for event in events if isinstance(event, Evolved)]
    view: rrb.View | rrb.Container = map_view(run.problem.map)
    panels: list[rrb.View] = [rrb.TextDocumentView(origin="text", name="Settings and result")]
    if evolutions:
        evolution = evolutions[0].evolution
        by_length = evolution.genotype == "keypoints"
        cost = "log10 of the cost, obstacles as VLN" if _over_many_sizes(evolution) else "Cost"
        what = "Length of the path" if by_length else cost
        plain = rrb.PlotLegend(visible=False)  # it would hide the best or the worst
        curves: list[rrb.View] = [
            rrb.TimeSeriesView(
                origin="fitness",
                name=f"{what}: best (orange), mean (grey)",
                plot_legend=plain,
            )
        ]
        if evolution.population:
            curves += gains_views(evolution.population)
            panels.append(changes_view(TIMELINE))
        else:
            name = "Obstacle fields on the best path"
            curves.append(rrb.TimeSeriesView(origin="obstacles", name=name, plot_legend=plain))
        if len(evolution.best) > 1:  # of a single epoch the text says all
            view = rrb.Vertical(view, rrb.Horizontal(*curves), row_shares=[2, 1])
    return blueprint(view, panels, TIMELINE)

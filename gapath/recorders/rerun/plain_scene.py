"""What a Rerun recording shows of a trial that no other scene fits: the map, and the way gone."""

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from gapath.events import Event, Finished, PathsChanged, RunStarted, Stepped, TrialStarted
from gapath.querying.told import posed_in
from gapath.recorders.rerun.drawing import (
    GREEN,
    blueprint,
    centres,
    document,
    line,
    log_map,
    log_problem,
    map_view,
    new_stream,
    problem_rows,
)

NEEDS: frozenset[type[Event]] = frozenset()
"""Kinds of events that a trial has whose scene this is."""

TIMELINE = "step"


def recording(run: RunStarted, events: list[Event]) -> bytes:
    """Make the recording of one trial.

    Parameters
    ----------
    run : RunStarted
        What the run's trials share.
    events : list of Event
        The trial's, from its `TrialStarted` to its `Finished`: where a robot stepped is its way,
        else the last path that it followed.

    Returns
    -------
    bytes
        A whole ``.rrd`` file with its blueprint; equal in content, not in bytes, for equal
        events.
    """
    trial, finished = events[0], events[-1]
    assert isinstance(trial, TrialStarted) and isinstance(finished, Finished)
    stream = new_stream(run, trial)
    memory = stream.memory_recording()
    stream.send_blueprint(layout(run, events))
    stream.send_recording_name(f"{run.problem.map.name} {run.method} trial {trial.trial}")
    posed = posed_in(run, events)
    log_problem(stream, posed, 6)
    log_map(stream, run.problem.map)
    steps = [event for event in events if isinstance(event, Stepped)]
    way = np.array([step.place for step in steps], dtype=np.int32).reshape(-1, 2)
    if steps:
        time = [rr.TimeColumn(TIMELINE, sequence=[step.step - trial.step for step in steps])]
        look = rr.Points2D.from_fields(
            colors=[GREEN], radii=[rr.Radius.ui_points(6)], draw_order=29
        )
        stream.log("map/robot", look, static=True)
        stream.send_columns("map/robot", time, rr.Points2D.columns(positions=centres(way)))
    else:
        paths = [event.path for event in events if isinstance(event, PathsChanged)]
        way = paths[-1] if paths else way
    stream.log("map/way", line(GREEN, 3, draw_order=24), static=True)
    stream.log("map/way", rr.LineStrips2D.from_fields(strips=[centres(way)]), static=True)
    rows = {
        "ended": finished.ending,
        "fields of the way": len(way),
        **problem_rows(run, trial, posed),
    }
    legend = (
        "- **green**: the way gone\n- **blue**: what the task is held against\n"
        "- **map**: the brighter, the dearer; white: obstacle\n"
    )
    stream.log("text", document(run, f"Task {run.task}", rows, legend), static=True)
    content: bytes = memory.drain_as_bytes()
    stream.disconnect()
    return content


def layout(run: RunStarted, events: list[Event]) -> rrb.Blueprint:
    """Lay the views out: a large map, text on the right."""
    text = rrb.TextDocumentView(origin="text", name="Settings and result")
    return blueprint(map_view(run.problem.map), [text], TIMELINE)

"""What a Rerun recording of a drive shows: two maps, the robot, paths, modes, curves."""

from typing import NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from gapath.driving.followed import Followed, followed
from gapath.driving.sensed import sensed
from gapath.events import (
    Called,
    DriveFinished,
    DriveStarted,
    Event,
    Mode,
    PathsChanged,
    RunStarted,
    Stepped,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.kernels.field_of_view import HEADING_X, HEADING_Y
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.problem import Answer
from gapath.querying.told import posed_in
from gapath.recorders.rerun.drawing import (
    DARK_PURPLE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILLION,
    YELLOW,
    centres,
    line,
    log_problem,
    new_stream,
    send_curve,
)
from gapath.recorders.rerun.drive_panels import arranged, text

NEEDS: frozenset[type[Event]] = frozenset({DriveStarted, Stepped, DriveFinished})
"""Kinds of events that a trial has whose scene this is."""

TIMELINE = "step"

# A mode has the colour of the part of KG18's step function that belongs to it.
_PARTS = {"A": PURPLE, "B": GREEN, "C": VERMILLION}
_MODES = {Mode.EXPLORE: GREEN, Mode.REPLAN: VERMILLION, Mode.RETURN: PURPLE}

_PICTURES = 1 << 24
"""Bytes of all pictures of the known map: one a step where they fit, else one every few."""


class _Drive(NamedTuple):
    """A drive's events by kind, and the index of each one's step within the drive."""

    run: RunStarted
    trial: TrialStarted
    able: DriveStarted
    steps: list[Stepped]
    calls: list[Called]
    changes: list[PathsChanged]
    finished: DriveFinished

    def time(self, events: list[Stepped] | list[Called] | list[PathsChanged]) -> NDArray[np.int64]:
        return np.array([event.step - self.trial.step for event in events], dtype=np.int64)


def recording(run: RunStarted, events: list[Event]) -> bytes:
    """Make the recording of one drive.

    Parameters
    ----------
    run : RunStarted
        What the run's trials share.
    events : list of Event
        The drive's, from its `TrialStarted` to its `DriveFinished`, a `DriveStarted` among them.

    Returns
    -------
    bytes
        A whole ``.rrd`` file with its blueprint; equal in content, not in bytes, for equal
        events.
    """
    trial, finished = events[0], events[-1]
    assert isinstance(trial, TrialStarted) and isinstance(finished, DriveFinished)
    (able,) = (event for event in events if isinstance(event, DriveStarted))
    steps = [event for event in events if isinstance(event, Stepped)]
    calls = [event for event in events if isinstance(event, Called)]
    changes = [event for event in events if isinstance(event, PathsChanged)]
    drive = _Drive(run, trial, able, steps, calls, changes, finished)
    stream = new_stream(run, trial)
    memory = stream.memory_recording()
    stream.send_blueprint(layout(run, events))
    stream.send_recording_name(f"{run.problem.map.name} {run.method} trial {trial.trial}")
    _log_true_map(stream, run.problem.map)
    log_problem(stream, posed_in(run, events), 2)
    _send_known_map(stream, drive)
    _send_robot(stream, drive, able.sensor_range)
    kept = followed(run.problem, events)
    _send_paths(stream, drive, kept)
    _send_calls(stream, drive)
    _send_modes(stream, drive)
    time = [rr.TimeColumn(TIMELINE, sequence=drive.time(steps))]
    left = np.array([each.left for each in kept])
    send_curve(stream, "cost/left", time, left, "cost left", ORANGE)
    if _timed(events):
        seconds = np.array([step.seconds for step in steps])
        send_curve(stream, "time/step", time, 1000 * seconds, "milliseconds", GREY)
    stream.log("text", text(run, trial, able, calls, finished), static=True)
    content: bytes = memory.drain_as_bytes()
    stream.disconnect()
    return content


def layout(run: RunStarted, events: list[Event]) -> rrb.Blueprint:
    """Lay the views out: a large map above the modes and curves; calls and text beside them."""
    return arranged(run.problem.map, TIMELINE, _timed(events))


def _timed(events: list[Event]) -> bool:
    """Tell whether there is wall time: a log has none."""
    return not all(np.isnan(event.seconds) for event in events if isinstance(event, Stepped))


def _log_true_map(stream: rr.RecordingStream, grid: GridMap) -> None:
    """Log the map that the robot does not know: dark blue, obstacles a little brighter."""
    weights = grid.weights[:, :, np.newaxis] ** 2
    stream.log("map", rr.Image((weights * (62, 74, 130)).astype(np.uint8)), static=True)


def _send_known_map(stream: rr.RecordingStream, drive: _Drive) -> None:
    """Send the known map as pictures of classes: 0 unknown, else 1 + the weight in per cent."""
    grid = drive.run.problem.map
    classes = [rr.AnnotationInfo(0, color=(0, 0, 0, 0))]
    for per_cent in range(101):  # as in the recordings of plans, but black would look unknown
        level = 40 + round(0.02 * per_cent**2)
        classes.append(rr.AnnotationInfo(1 + per_cent, color=(level, level, level)))
    stream.log("map/known", rr.AnnotationContext(classes), static=True)
    size = rr.components.ImageFormat(
        width=grid.cols, height=grid.rows, color_model="L", channel_datatype="U8"
    )
    look = rr.SegmentationImage.from_fields(format=size, opacity=1.0, draw_order=1)
    stream.log("map/known", look, static=True)

    known = np.zeros(grid.weights.shape, dtype=np.uint8)
    ends = np.array([drive.run.problem.start, drive.run.problem.target])
    known[ends[:, 1], ends[:, 0]] = _classes(grid.table[ends[:, 1], ends[:, 0]])
    every = -(-len(drive.steps) * known.size // _PICTURES)
    last, pictures, shown = len(drive.steps) - 1, [], []
    for i, step in enumerate(drive.steps):
        known[step.fields[:, 1], step.fields[:, 0]] = _classes(step.entries)
        if i % every == 0 or i == last:
            pictures.append(known.tobytes())
            shown.append(step)
    time = [rr.TimeColumn(TIMELINE, sequence=drive.time(shown))]
    stream.send_columns("map/known", time, rr.SegmentationImage.columns(buffer=pictures))


def _classes(entries: NDArray[np.int32]) -> NDArray[np.uint8]:
    per_cent = np.minimum(100 * entries.astype(np.int64) // SCALE, 99)
    classes: NDArray[np.uint8] = np.where(entries >= OBSTACLE, 101, 1 + per_cent).astype(np.uint8)
    return classes


def _send_robot(stream: rr.RecordingStream, drive: _Drive, layers: int) -> None:
    """Send where the robot is and was, where it looks, and what it sees."""
    time = [rr.TimeColumn(TIMELINE, sequence=drive.time(drive.steps))]
    places = centres(np.array([step.place for step in drive.steps]))
    before = np.concatenate([places[:1], places[:-1]])
    headings = np.array([step.heading for step in drive.steps])
    forward = np.stack([HEADING_X[headings], HEADING_Y[headings]], axis=1).astype(np.float32)

    point = rr.Points2D.from_fields(colors=[YELLOW], radii=[rr.Radius.ui_points(6)], draw_order=29)
    stream.log("map/robot", point, static=True)
    stream.send_columns("map/robot", time, rr.Points2D.columns(positions=places))
    arrow = rr.Arrows2D.from_fields(
        colors=[YELLOW], radii=[rr.Radius.ui_points(1.5)], draw_order=28
    )
    stream.log("map/robot/heading", arrow, static=True)
    ahead = 2.5 * forward
    arrows = rr.Arrows2D.columns(origins=places, vectors=ahead)
    stream.send_columns("map/robot/heading", time, arrows)
    # A piece of the trail at each step; the view shows all of them up to its time.
    stream.log("map/trail", line(YELLOW, 1.5, draw_order=26), static=True)
    pieces = np.stack([before, places], axis=1)
    stream.send_columns("map/trail", time, rr.LineStrips2D.columns(strips=list(pieces)))
    # It looks before it moves.
    stream.log("map/field_of_view", line(YELLOW, 1, draw_order=23), static=True)
    looks = zip(headings.tolist(), before, strict=True)
    views = [sensed(layers, heading) + place for heading, place in looks]
    stream.send_columns("map/field_of_view", time, rr.LineStrips2D.columns(strips=views))


def _send_paths(stream: rr.RecordingStream, drive: _Drive, kept: list[Followed]) -> None:
    """Send the current path when it changes or is cut, and the way back when it changes."""
    changed = drive.time(drive.changes)
    now = np.union1d(changed, [i for i, each in enumerate(kept) if each.cut]).astype(np.int64)
    stream.log("map/current_path", line(ORANGE, 3, draw_order=25), static=True)
    _send_strips(stream, "map/current_path", now, [[kept[i].path] for i in now])
    stream.log("map/past_path", line(DARK_PURPLE, 7, draw_order=22), static=True)
    pasts = [[event.past] for event in drive.changes]
    _send_strips(stream, "map/past_path", changed, pasts)


def _send_strips(
    stream: rr.RecordingStream,
    entity: str,
    steps: NDArray[np.int64],
    strips: list[list[NDArray[np.int32]]],
) -> None:
    """Send any number of lines for each step; those of a single field are no lines."""
    drawn = [[centres(strip) for strip in row if len(strip) > 1] for row in strips]
    columns = rr.LineStrips2D.columns(strips=[strip for row in drawn for strip in row])
    time = [rr.TimeColumn(TIMELINE, sequence=steps)]
    stream.send_columns(entity, time, columns.partition([len(row) for row in drawn]))


def _send_calls(stream: rr.RecordingStream, drive: _Drive) -> None:
    """Send what each planner answered, for its step only; those adopted are thick."""
    for part in sorted({call.part for call in drive.calls}):
        color = _PARTS.get(part, GREY)
        for adopted, name, width in ((True, "adopted", 5), (False, "not_adopted", 1.5)):
            answers: dict[int, list[NDArray[np.int32]]] = {}
            for call in drive.calls:
                if (call.part, call.adopted) == (part, adopted) and len(call.answer.path):
                    step = call.step - drive.trial.step
                    answers.setdefault(step, []).append(call.answer.path)
                    answers.setdefault(step + 1, [])
            if answers:
                entity = f"map/calls/{part}/{name}"
                stream.log(entity, line(color, width, draw_order=24), static=True)
                steps = sorted(answers)
                strips = [answers[step] for step in steps]
                _send_strips(stream, entity, np.array(steps), strips)
    if drive.calls:
        rows = _listed(drive)
        time = [rr.TimeColumn(TIMELINE, sequence=[row.step for row in rows])]
        texts = [
            f"#{row.step} {row.text}" + (f", {row.times} steps in a row" if row.times > 1 else "")
            for row in rows
        ]
        levels = ["INFO" if row.adopted else "DEBUG" for row in rows]
        stream.send_columns("calls", time, rr.TextLog.columns(text=texts, level=levels))


class _Row(NamedTuple):
    """A call as the list has it, and in how many steps in a row there was the same."""

    step: int
    text: str
    adopted: bool
    times: int


def _listed(drive: _Drive) -> list[_Row]:
    """List the calls: one that comes again step by step, as along a wall, once."""
    rows: list[_Row] = []
    for call, step in zip(drive.calls, drive.time(drive.calls).tolist(), strict=True):
        text = f"{call.part}{call.index} {_told(call.answer)}{', adopted' if call.adopted else ''}"
        last = rows[-1] if rows else None
        if last and (last.text, last.step + last.times) == (text, step):
            rows[-1] = last._replace(times=last.times + 1)
        else:
            rows.append(_Row(step, text, call.adopted, 1))
    return rows


def _told(answer: Answer) -> str:
    told = f"{answer.status.name.lower().replace('_', ' ')}: {answer.cost:g}"
    if answer.epochs:
        return f"{told} in {answer.epochs} epochs"
    return f"{told} from {answer.expansions} fields" if answer.expansions else told


def _send_modes(stream: rr.RecordingStream, drive: _Drive) -> None:
    """Send the mode where it changes, as a band."""
    band = rr.StateConfiguration(
        values=[mode.name.lower() for mode in _MODES],
        colors=list(_MODES.values()),
    )
    stream.log("mode", band, static=True)
    modes = np.array([step.mode for step in drive.steps])
    changed = np.flatnonzero(np.diff(modes, prepend=-1))
    names = [Mode(modes[i]).name.lower() for i in changed]
    time = [rr.TimeColumn(TIMELINE, sequence=drive.time(drive.steps)[changed])]
    stream.send_columns("mode", time, rr.StateChange.columns(state=names))

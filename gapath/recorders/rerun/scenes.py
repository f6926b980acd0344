"""Which scene shows a trial, and two trials beside each other in one recording."""

import hashlib
from pathlib import Path
from typing import Any

import rerun as rr
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from gapath.errors import require
from gapath.events import Event, RunStarted
from gapath.recorders.rerun import drive_scene, plain_scene, scene

Trial = tuple[RunStarted, list[Event]]


def scene_of(events: list[Event]) -> Any:
    """Give the module that makes the recording of a trial with these events."""
    told = {type(event) for event in events}
    return next(each for each in (drive_scene, scene, plain_scene) if told >= each.NEEDS)


def record_two(trials: tuple[Trial, Trial], folder: Path) -> Path:
    """Record two trials beside each other, on one timeline.

    Parameters
    ----------
    trials : two of (RunStarted, list of Event)
        What the run's trials share, and the trial's events.
    folder : Path
        An existing folder of its own, where the recordings are made.

    Returns
    -------
    Path
        The recording, ``two.rrd``: the first trial's entities under ``left``, the other's under
        ``right``.

    Raises
    ------
    InputError
        If one is told in epochs, the other one in steps.
    """
    kinds = [scene_of(events) for _, events in trials]
    times = [kind.TIMELINE for kind in kinds]
    require(times[0] == times[1], "timelines", " and ".join(times), "two plans, or two drives")
    halves, contents = [], []
    for side, kind, (run, events) in zip(("left", "right"), kinds, trials, strict=True):
        (folder / f"{side}.rrd").write_bytes(contents_of := kind.recording(run, events))
        contents.append(contents_of)
        halves.append(_half(kind.layout(run, events).root_container, side, run.method))
    named = hashlib.sha256(b"".join(contents)).hexdigest()
    stream = rr.RecordingStream(
        f"gapath-{named[:8]}", recording_id=named[:32], send_properties=False
    )
    file = folder / "two.rrd"
    stream.save(file)
    time = rrb.TimePanel(timeline=times[0], play_state="paused", fps=5, state="collapsed")
    panels = [kind(state="collapsed") for kind in (rrb.BlueprintPanel, rrb.SelectionPanel)]
    both = rrb.Horizontal(*halves)
    stream.send_blueprint(rrb.Blueprint(both, time, *panels, auto_layout=False, auto_views=False))
    for side in ("left", "right"):
        chunks = RrdReader(str(folder / f"{side}.rrd")).stream()
        stream.send_chunks(
            chunk.with_entity_path(f"/{side}{chunk.entity_path}")
            for chunk in chunks
            if not chunk.entity_path.startswith("/__")  # the recording's own name
        )
    stream.flush()
    stream.disconnect()
    return file


def _half(root: rrb.Container, side: str, method: str) -> rrb.Container:
    """Make one half of a layout out of one that was for the whole window: its panels are below."""
    view, panels = root.contents
    _move(root, side, method)
    return rrb.Vertical(view, rrb.Tabs(*panels.contents), row_shares=[3, 1])


def _move(part: rrb.View | rrb.Container, side: str, method: str) -> None:
    """Let views look at the entities of one side; the map's name says whose it is."""
    if isinstance(part, rrb.Container):
        for each in part.contents:
            _move(each, side, method)
        return
    part.origin = f"{side}/{part.origin}"
    overrides = part.visualizer_overrides
    part.visualizer_overrides = {f"{side}/{name}": how for name, how in overrides.items()}
    if isinstance(part, rrb.Spatial2DView):
        part.name = f"{method}: {part.name}"

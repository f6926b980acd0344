"""The text beside a recorded drive, and the layout of all views."""

import rerun as rr
import rerun.blueprint as rrb

from gapath.events import (
    NEVER_LEFT,
    Called,
    DriveFinished,
    DriveStarted,
    Outcome,
    RunStarted,
    TrialStarted,
)
from gapath.grid import GridMap
from gapath.querying.told import posed_in
from gapath.recorders.rerun.drawing import (
    blueprint,
    document,
    map_view,
    problem_rows,
    texts_view,
)

_SENTENCES = {
    Outcome.REACHED: "The robot reached the target",
    Outcome.RETURNED: "The robot came back to its start",
    Outcome.OVERRAN: "The robot used up its steps",
}


def text(
    run: RunStarted,
    trial: TrialStarted,
    able: DriveStarted,
    calls: list[Called],
    finished: DriveFinished,
) -> rr.TextDocument:
    """Write the panel of settings and outcome."""
    parts = [call.part for call in calls]
    outcome = finished.outcome
    shortest = len(run.optimal_path) - 1
    rows = {
        "outcome": outcome.name.lower(),
        "steps": finished.steps,
        "step limit": able.step_limit,
        "shortest": f"{shortest} steps" if shortest >= 0 else "no way",
        **{f"calls of part {part}": parts.count(part) for part in sorted(set(parts))},
        **problem_rows(run, trial, posed_in(run, ())),
    }
    legend = (
        "- **yellow**: the robot, its trail, its field of view\n"
        "- **orange**: its current path, as far as it knows it to be free\n"
        "- **wide purple**: its way back\n"
        "- **in the step of a call**, thick if adopted: a planner's path in part "
        "A (purple), B (green), C (vermillion)\n"
        "- **blue**: a path of fewest steps on the true map\n"
        "- **map**: greys are known, the brighter, the dearer; white: obstacle; "
        "dark blue is unknown\n"
    )
    sentence = f"The robot {NEVER_LEFT}" if finished.never_left else _SENTENCES[outcome]
    return document(run, sentence, rows, legend)


def arranged(grid: GridMap, timeline: str, timed: bool) -> rrb.Blueprint:
    """Lay the views out: a large map above the modes and curves; calls and text beside them."""
    so_far = rrb.VisibleTimeRanges(
        timeline=timeline,
        start=rrb.TimeRangeBoundary.infinite(),
        end=rrb.TimeRangeBoundary.cursor_relative(seq=0),
    )
    plain = rrb.PlotLegend(visible=False)
    curves = [rrb.TimeSeriesView(origin="cost", name="Cost left", plot_legend=plain)]
    if timed:
        curves.append(rrb.TimeSeriesView(origin="time", name="ms a step", plot_legend=plain))
    view = rrb.Vertical(
        map_view(grid, {"map/trail": so_far}),
        rrb.StateTimelineView(origin="mode", name="Mode"),
        rrb.Horizontal(*curves),
        row_shares=[10, 3, 4],  # the bar of modes lies under a name and a ruler
    )
    panels = [
        rrb.TextDocumentView(origin="text", name="Settings and outcome"),
        texts_view("calls", "Calls: step, part, answer", timeline),
    ]
    return blueprint(view, panels, timeline)

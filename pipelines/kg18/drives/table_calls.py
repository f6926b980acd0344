"""Where KG18's drives spend their evaluations: every call of its planners, from the logs."""

from collections.abc import Iterator, Sequence

import pandas as pd

from gapath.events import Called, Event
from gapath.pipelines.numbers.text import NOTHING, number, percent
from gapath.pipelines.page.section import RECONSTRUCTED, Section, Table
from gapath.pipelines.papers.names import label, rank
from gapath.pipelines.reading.logs import events_of, read_logs, run_start
from gapath.store.records import RunRecord

TASK = "drive"
EXPERIMENT = "drives"
ORDER = 60.5  # explains the table of drives, so it stands right after it

_NAVIGATOR = "kg18"
_MAP = ["map", "map_source"]
_PLANNER = ["part", "planner", "control_points"]


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Make the section on the calls of KG18's planners.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from, with their logs.

    Returns
    -------
    Section or None
        What the calls of each planner came to; None if no run of KG18 has a log with calls.
    """
    mine = [run for run in runs if run.known.method == _NAVIGATOR and not run.known.map_instance]
    read, skipped = read_logs(mine, lambda run: read_calls(events_of(run)))
    calls = pd.concat([calls for _, calls in read], ignore_index=True) if read else pd.DataFrame()
    if calls.empty and not skipped:
        return None
    tables: tuple[Table, ...] = ()
    if len(calls):
        called = trials[trials["key"].isin({run.folder.name for run, _ in read})]
        tables = (_table(summarise_calls(calls)).with_runs(called, _MAP),)
    return Section(
        title="What the planners' calls come to",
        text=(
            "KG18's drives, call by call: part A plans on the way back, part B looks for a better "
            "path, part C for a new one where the path has met an obstacle. The planners of part C "
            "are tried in their order until one finds a path.",
            RECONSTRUCTED,
        ),
        tables=tables,
        remarks=() if calls.empty else _remarks(calls),
        skipped=tuple(skipped),
    )


def read_calls(events: Iterator[Event]) -> pd.DataFrame:
    """Read the planners' calls from a log.

    Parameters
    ----------
    events : iterator of Event
        The events of drives with KG18's navigator, from the run's start on.

    Returns
    -------
    DataFrame
        One row a call: map, map_source, part, planner (its number in the part's list, from
        1), control_points (missing for a planner without), found, adopted, obstacles (fields of
        the best path that are obstacles or outside the map), evaluations.

    Raises
    ------
    InputError
        If the log does not begin with the run's start, or cannot be read.
    """
    start = run_start(events)
    grid = start.problem.map
    calls = [event for event in events if isinstance(event, Called)]
    points = [start.settings.get(f"{_setting(call)}.control_points") for call in calls]
    return pd.DataFrame(
        {
            "map": grid.name,
            "map_source": grid.source,
            "part": [call.part for call in calls],
            "planner": [call.index + 1 for call in calls],
            "control_points": pd.array(points, dtype="Int64"),
            "found": [call.answer.feasible for call in calls],
            "adopted": [call.adopted for call in calls],
            "obstacles": [call.answer.obstacles for call in calls],
            "evaluations": [call.answer.evaluations for call in calls],
        }
    )


def _setting(call: Called) -> str:
    """Name the settings of the planner that was called."""
    parts = {"A": "retreat", "B": "explore"}
    return f"navigator.{parts.get(call.part, f'replan[{call.index}]')}"


def summarise_calls(calls: pd.DataFrame) -> pd.DataFrame:
    """Summarise the calls of each planner on each map.

    Parameters
    ----------
    calls : DataFrame
        As `read_calls` gives them.

    Returns
    -------
    DataFrame
        map, map_source, part, planner, control_points; calls; the rates found and adopted;
        failed, and the rate of those whose best path crosses exactly one obstacle field;
        evaluations, and their share in all of the map's.
    """
    total = calls.groupby(_MAP)["evaluations"].sum()
    rows = []
    for key, group in calls.groupby([*_MAP, *_PLANNER], dropna=False):
        failed = group[~group["found"]]
        spent = int(group["evaluations"].sum())
        rows.append(
            {
                **dict(zip([*_MAP, *_PLANNER], key, strict=True)),
                "calls": len(group),
                "found": group["found"].mean(),
                "adopted": group["adopted"].mean(),
                "failed": len(failed),
                "one_obstacle": (failed["obstacles"] == 1).mean(),
                "evaluations": spent,
                "evaluations_share": spent / total[key[: len(_MAP)]],
            }
        )
    rows.sort(key=lambda row: rank(row["map"]))
    return pd.DataFrame(rows)


def _table(rows: pd.DataFrame) -> Table:
    shown = [
        {
            "Map": label(row["map"], row["map_source"]),
            "Part": row["part"],
            "Planner": _planner(row),
            "Calls": number(row["calls"]),
            "Found, %": percent(row["found"]),
            "Adopted, %": percent(row["adopted"]),
            "Failed at one obstacle, %": percent(row["one_obstacle"]) if row["failed"] else NOTHING,
            "Evaluations, %": percent(row["evaluations_share"]),
        }
        for _, row in rows.iterrows()
    ]
    return Table(
        "drive_calls",
        "Calls of KG18's planners in all drives of a map: part, number in the part's list and "
        "control points of the planner; how often it found a path and how often that became the "
        "current one; of the calls that found none, how many ended at a best path across exactly "
        "one obstacle field; its share of the evaluations of the map's drives. Planners that were "
        "never called are left out.",
        rows,
        pd.DataFrame(shown),
        heads=3,
    )


def _planner(row: pd.Series) -> str:
    """Name a planner by its number in the part's list, and its control points if it has any."""
    points = row["control_points"]
    return str(row["planner"]) if pd.isna(points) else f"{row['planner']} (k = {points})"


def _remarks(calls: pd.DataFrame) -> tuple[str, ...]:
    wasted = calls["evaluations"].where(~calls["found"], 0)
    by_map = calls.assign(wasted=wasted).groupby("map")[["wasted", "evaluations"]].sum()
    shares = ", ".join(
        f"{label(name)} {percent(by_map.loc[name, 'wasted'] / by_map.loc[name, 'evaluations'])} %"
        for name in sorted(by_map.index, key=rank)
    )
    return (
        f"Evaluations spent in calls that found no path: {shares}.",
        "The calls of one drive depend on each other, so the shares have no interval.",
    )

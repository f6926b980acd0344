"""Public maps that were not chosen: what becomes there of what is found on those drawn here."""

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.behind import keys_behind
from gapath.pipelines.numbers.grouped import Groups, grouped
from gapath.pipelines.numbers.summary import expected, rates, rates_within, summarise_by
from gapath.pipelines.numbers.text import NOTHING, number, percent, percent_range, span
from gapath.pipelines.page.section import Section, Table
from gapath.pipelines.papers.names import label
from gapath.pipelines.reading.of_run import of_run
from gapath.running.naming import Method, map_name
from gapath.store.records import RunRecord
from gapath.store.settings import nested

TASK = "plan"
EXPERIMENT = "unseen"
ORDER = 89


class Family(NamedTuple):
    """Maps of one source."""

    title: str
    exact: str
    """YAML of the exact planner that the others are held against."""


_FAMILIES = {
    "movingai": Family("MovingAI", "astar_length"),
    "asciigrid": Family("Tulsa", "astar"),
    "rosmap": Family("pictures of floors", "inflated_astar"),
}
"""By the maps' source."""

_OWN = {
    ("corner_cutting", "forbid"),
    ("corner_cutting", "no_diagonals"),
    ("planner.stop_when_feasible", True),
    ("planner.robot_radius", 0.22),
    ("planner.radius_unit", "metres"),
}
"""What the experiments themselves set, whichever planner they try."""


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section:
    """Make the section on maps that were not chosen.

    Parameters
    ----------
    trials : DataFrame
        The trials of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section
        How often each planner finds a path and what that takes, by family of maps and by map.
    """
    trials = by_problem(trials, runs)
    return Section(
        title="Maps that were not chosen",
        text=(
            "The papers' planners on public maps, each as its tables above have it: KG18's on "
            "problems from MovingAI's benchmarks (Sturtevant 2012), ten a map, spread over the "
            "rows of its scenario; S04's on grids of its own group at the University of Tulsa, "
            "from corner to corner; M22's on floors as robots have them (nav2, TurtleBot3 and the "
            "MRPB benchmark), between ends drawn from the fields where the robot fits.",
        ),
        tables=(_families(trials), _maps(trials)),
        remarks=(
            "Problems on one map are alike, so the interval over a family counts its maps, and "
            "that on a map its problems: Wilson's, with the mean of their rates, which errs on "
            "the wide side. Nobody drew these maps by lot from all there are.",
            "The expected time for a path is dominated by the large maps of a family; the table "
            "by map has each.",
            "A* is that by octile length on MovingAI's maps, without diagonals on Tulsa's, and "
            "among grown obstacles on floors. It has no chance, and is exact.",
            "A planner of a visibility graph whose keypoints do not join start and target has "
            "found nothing, although a path may exist.",
        ),
    )


def by_problem(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> pd.DataFrame:
    """Give trials the columns `family`, `place`, `file`, `problem`, `method` and `exact`.

    Parameters
    ----------
    trials : DataFrame
        One row a trial.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    DataFrame
        A copy; `place` is the map's name and `method` the planner's, without what tells problems
        apart or the experiments set; `file` is the map's, whose content may depend on the start
        (water of MovingAI's); `problem` says where from and to on it; `exact` tells whether the
        planner is the exact one of its family.
    """
    source = trials["map_source"].astype("str")
    file = of_run(trials, runs, lambda run: run.settings.get("map.path", run.known.map))
    method = of_run(trials, runs, _method)
    ends = [file, trials["start"], trials["target"]]
    return trials.assign(
        family=source.replace({name: family.title for name, family in _FAMILIES.items()}),
        place=of_run(trials, runs, _place),
        file=file,
        problem=trials.groupby(ends, observed=True).ngroup(),
        method=method,
        exact=method == source.map({name: family.exact for name, family in _FAMILIES.items()}),
    )


def _place(run: RunRecord) -> str:
    settings = nested(run.settings)["map"]
    return map_name(Path(settings.get("path") or run.known.map).stem, settings)


def _method(run: RunRecord) -> str:
    changes = run.known.changes.items()
    return Method(run.known.preset, {k: v for k, v in changes if (k, v) not in _OWN}).name


def summarise_problems(trials: pd.DataFrame, groups: Groups, unit: str) -> dict[str, Any]:
    """Summarise planners' trials on some problems.

    Parameters
    ----------
    trials : DataFrame
        As `by_problem` gives them.
    groups : Groups
        The planner and the maps of each.
    unit : str
        The column of what is independent of each other: `file`, or `problem`.

    Returns
    -------
    dict
        maps, problems, n (trials); success, the mean of the units' rates, its interval, which
        counts units, or trials where there is one unit only, and is missing for the exact planner,
        and the least and the greatest of them; medians of seconds and of length_ratio; expected
        seconds to a path. A value a group each.
    """
    of, rate = rates_within(trials["feasible"], groups, trials[unit])
    units = np.where(of.sizes > 1, of.sizes, groups.sizes)
    success = rates("success", of.sums(rate), of.sizes, units)
    exact = groups.counts(trials["exact"]) == groups.sizes
    success |= {end: np.where(exact, np.nan, success[end]) for end in _ENDS}
    spread = pd.Series(rate).groupby(of.of)
    seconds = trials["plan_time_s"]
    return {
        "maps": groups.distinct(trials["file"]),
        "problems": groups.distinct(trials["problem"]),
        "n": groups.sizes,
        **success,
        "least": spread.min(),
        "greatest": spread.max(),
        "seconds_median": groups.quartiles(seconds).median,
        "ert_seconds": _expected_seconds(trials, groups),
        "length_ratio_median": groups.quartiles(trials["length_ratio"]).median,
    }


_ENDS = "success_low", "success_high"


def _expected_seconds(trials: pd.DataFrame, groups: Groups) -> Any:
    return expected(groups.sums(trials["plan_time_s"]), groups.counts(trials["feasible"]))


def _summaries(trials: pd.DataFrame, by: list[str], unit: str) -> pd.DataFrame:
    """Summarise each planner within groups, and hold it against the exact one of its group."""
    rows = summarise_by(trials, [*by, "method"], partial(summarise_problems, unit=unit))
    exact = trials[trials["exact"]]
    names, groups = grouped(exact, by)
    taken = names.itertuples(index=False, name=None), _expected_seconds(exact, groups)
    least = dict(zip(*taken, strict=True))
    times = [least.get(row, math.nan) for row in rows[by].itertuples(index=False, name=None)]
    return rows.assign(times_exact=rows["ert_seconds"] / times)


def _families(trials: pd.DataFrame) -> Table:
    rows = _summaries(trials, ["family"], "file")
    maps = _summaries(trials, ["family", "file"], "problem")
    faster = maps["times_exact"].lt(1).groupby([maps["family"], maps["method"]]).sum()
    rows["faster"] = [faster[pair] for pair in zip(rows["family"], rows["method"], strict=True)]
    shown = [
        {
            "Family": row["family"],
            "Planner": label(row["method"]),
            "Maps": number(row["maps"]),
            "Problems": number(row["problems"]),
            **_cells(row),
            "By map, %": span(100 * row["least"], 100 * row["greatest"]),
            "Faster than A*: maps": number(row["faster"]),
        }
        for row in rows.to_dict("records")
    ]
    return Table(
        "unseen",
        "Maps that were not chosen, by family: success with its 95 % interval over maps, on the "
        "worst and on the best map; median time of all trials; expected time: of all trials for "
        "each path found, and how many times A*'s that is (∞: none was found); on how many maps "
        "that is less than A*'s; median octile length above the published, of paths found.",
        rows,
        pd.DataFrame(shown),
    ).with_runs(trials, ["family", "method"])


def _maps(trials: pd.DataFrame) -> Table:
    by = ["family", "place", "file"]
    rows = _summaries(trials, by, "problem")
    shown = [
        {
            "Family": row["family"],
            "Map": row["place"],
            "Planner": label(row["method"]),
            "Problems": number(row["problems"]),
            **_cells(row),
        }
        for row in rows.to_dict("records")
    ]
    return Table(
        "unseen_maps",
        "Maps that were not chosen, one by one; as above, the interval over problems, or over "
        "trials where there is one problem only.",
        rows.drop(columns="file"),
        pd.DataFrame(shown),
        heads=3,
        runs=keys_behind(trials, [*by, "method"], rows),
    )


def _cells(row: Mapping[Any, Any]) -> dict[str, str]:
    ratio = row["times_exact"]
    longer = round(100 * (row["length_ratio_median"] - 1), 2) + 0.0  # lengths have six digits
    return {
        "Trials": number(row["n"]),
        "Found, %": percent(row["success"]),
        "95 % interval": percent_range((row["success_low"], row["success_high"])),
        "Time, ms": number(1000 * row["seconds_median"]),
        "Expected time, ms": number(1000 * row["ert_seconds"]),
        "Expected / A*'s": NOTHING if math.isnan(ratio) else number(ratio),
        "Length above published, %": number(longer),
    }

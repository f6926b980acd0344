"""What each part of the genetic planner is worth: the whole, and without one of them at a time.

On evenly spread problems of MovingAI's maps and on 200 seeds of KG18's fourth known map; times and
costs as of `field_movingai`. "dearer / whole" is the mean of "dearer" over the whole planner's.
"""

from typing import Any

from benchmarks.field import compared, contenders, summary
from benchmarks.measure import Row, make_problem
from benchmarks.posed import NO_DATA, evenly, real_maps, scenario_problems, scenarios
from gapath.problem import CornerCutting, Problem

PLANNERS = ("memetic", "memetic_quality")
PARTS: dict[str, dict[str, Any]] = {
    "whole": {},
    "without GA": {"effort": 0.0},
    "without crossover": {"crossover_probability": 0.0},
    "without reroutes": {"reroute_probability": 0.0},
    "one individual": {"population": 1},
    "one hand": {"hands": "left"},
}
"""Settings that leave a part out."""
PROBLEMS, SEEDS = 40, 200
"""Problems of each map, and seeds."""


def measure(quick: bool) -> list[Row]:
    rows = _of_place("kg18_test4", [make_problem("kg18_test4")] * (2 if quick else SEEDS))
    folder = real_maps()
    if folder is None:
        return [*rows, {"maps": "MovingAI", "problems": NO_DATA}]
    posed: list[Problem] = []
    for path, problems in scenarios(folder / "movingai"):
        those = scenario_problems(path, problems, CornerCutting.ALLOW)
        posed += evenly(those, 1 if quick else PROBLEMS)
    return rows + _of_place("MovingAI", posed)


def _of_place(place: str, problems: list[Problem]) -> list[Row]:
    return [row for name in PLANNERS for row in _of_planner(place, name, problems)]


def _of_planner(place: str, name: str, problems: list[Problem]) -> list[Row]:
    made = contenders(PARTS, {part: {"base": name, **PARTS[part]} for part in PARTS})
    rows: list[Row] = []
    for part, heats in compared(problems, made):
        row: Row = {"maps": place, "planner": name, "part": part}
        rows.append(row | ({"problems": heats} if isinstance(heats, str) else summary(part, heats)))
        whole = rows[0].get("dearer %")
        if whole and "dearer %" in rows[-1]:
            rows[-1]["dearer / whole"] = rows[-1]["dearer %"] / whole
    return rows

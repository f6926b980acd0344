"""MovingAI's maps: who finds a path, how dear it is, and how fast.

Evenly spread problems of each map's `.scen` file, with corners cut and without. Every path is
checked, and its cost held against A*'s, before any time is taken. "dearer" is by how much it costs
more than A*'s, KG18 eq. (5), in per cent: mean, percentiles and most. Times are a thread's own, the
least of three of each call, all planners in turn: "ms" are totals of `Planner.plan`, "kernel ms" of
the kernels alone, where they can be called. A ratio "A* / ..." above 1 says that A* takes longer;
"a problem" is the median of the problems' own ratios.

Maps: Moving AI Lab (Sturtevant 2012), ODC-BY.
"""

from pathlib import Path

from benchmarks.field import Heat, compared, contenders, summary
from benchmarks.measure import Row
from benchmarks.posed import NO_DATA, evenly, real_maps, scenario_problems, scenarios
from gapath.mapio.movingai import ScenarioProblem
from gapath.problem import CornerCutting

PLANNERS = ("memetic", "memetic_quality", "jps")
RULES = (CornerCutting.ALLOW, CornerCutting.FORBID)
PROBLEMS = 100
"""Of a map, at most, for each rule."""
LARGE = 256 * 256


def measure(quick: bool) -> list[Row]:
    folder = real_maps()
    maps = scenarios(folder / "movingai") if folder else []
    if not maps:
        return [{"map": "all", "planner": NO_DATA}]
    rows: list[Row] = []
    every: dict[tuple[str, str, str], list[Heat]] = {}
    for path, problems in maps:
        for rule in RULES:
            rows += _of_map(path, problems, rule, 2 if quick else PROBLEMS, every)
    for (group, rule_name, name), heats in every.items():
        row: Row = {"map": group, "corner_cutting": rule_name, "planner": name}
        rows.append(row | summary(name, heats))
    return rows


def _of_map(
    path: Path,
    problems: list[ScenarioProblem],
    rule: CornerCutting,
    most: int,
    every: dict[tuple[str, str, str], list[Heat]],
) -> list[Row]:
    posed, rows = evenly(scenario_problems(path, problems, rule), most), []
    grid = posed[0].map
    for name, heats in compared(posed, contenders(PLANNERS)):
        row: Row = {"map": grid.name, "corner_cutting": rule.setting, "planner": name}
        row |= {"fields": f"{grid.cols} x {grid.rows}"}
        if isinstance(heats, str):
            rows.append(row | {"problems": heats})
            continue
        rows.append(row | summary(name, heats))
        every.setdefault(("all", rule.setting, name), []).extend(heats)
        if grid.weights.size >= LARGE:
            every.setdefault(("256 x 256 and more", rule.setting, name), []).extend(heats)
    return rows

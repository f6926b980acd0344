"""KG18's fourth known map, which no GA of the paper solves: how many seeds do, and how well.

Times and costs as of `field_movingai`.
"""

from benchmarks.field import compared, contenders, summary
from benchmarks.measure import Row, make_problem

MAP = "kg18_test4"
PLANNERS = ("memetic", "memetic_quality", "ga3")
SEEDS = 1000


def measure(quick: bool) -> list[Row]:
    problem, seeds = make_problem(MAP), 3 if quick else SEEDS
    rows = []
    for name, heats in compared([problem] * seeds, contenders(PLANNERS)):
        row: Row = {"map": MAP, "planner": name}
        rows.append(row | ({"problems": heats} if isinstance(heats, str) else summary(name, heats)))
    return rows

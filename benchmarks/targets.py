"""What the benchmarks are to reach, and whether they do.

A target is met if the median of what was measured is; of several rows the worst counts.
"""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, TypeAlias

from benchmarks.measure import Quartiles, Row

Take: TypeAlias = Callable[[list[Row]], list[Any]]
"""Takes what counts from a question's rows: numbers, `Quartiles`, or text where there are none."""


class Target(NamedTuple):
    """A limit to what a question measures."""

    what: str
    question: str
    sense: str
    """"<=" or ">="."""
    limit: float
    measured: Take
    unit: str = ""
    """Of limit and measurement; none for a ratio."""
    why: str = ""
    """Why it may be missed, where that is known."""


def column(name: str, **where: Any) -> Take:
    """Take a column of the rows that have certain cells; what was skipped gives its reason."""

    def take(rows: list[Row]) -> list[Any]:
        cells = [row.get(name, skipped(row)) for row in rows if where.items() <= row.items()]
        return [cell for cell in cells if cell is not None]

    return take


def epochs_of(library: str) -> Take:
    """Take the ratios of a library of `epochs`, which gives it with its version."""
    ratios = column("library / gapath")
    return lambda rows: ratios([row for row in rows if row["library"].split()[0] == library])


def skipped(row: Row) -> str | None:
    """Give the reason why a row has no measurement."""
    texts = (str(cell) for cell in row.values())
    return next((text for text in texts if text.startswith("skipped: ")), None)


CLASS_1 = {"class": "kg18_test1"}  # no keyword argument can be called class

GA, QUALITY = {"planner": "memetic"}, {"planner": "memetic_quality"}
LARGE_MAPS = "256 x 256 and more"


def large(column_name: str, terrain: bool) -> Take:
    """Take a column of the genetic planner's rows of `field_large`, of weighted maps or others."""
    take = column(column_name, **GA)
    return lambda rows: take([row for row in rows if (row["class"] == "field_terrain") == terrain])


FIELD = (
    Target("every problem that can be solved: found by memetic", "field_found", ">=", 100,
           column("found %", **GA), "%"),
    Target("of these and of those that cannot be: false answers", "field_found", "<=", 0,
           column("false", **GA)),
    Target("test map 4, 1000 seeds: found by memetic", "field_test4", ">=", 100,
           column("found %", **GA), "%"),
    Target("test map 4: memetic dearer than A*", "field_test4", "<=", 5,
           column("dearer %", **GA), "%"),
    Target("test map 4: memetic_quality dearer than A*", "field_test4", "<=", 0.2,
           column("dearer %", **QUALITY), "%"),
    Target("each MovingAI map: A* / memetic", "field_movingai", ">=", 1,
           column("A* / planner", **GA)),
    Target("all MovingAI maps: A* / memetic", "field_movingai", ">=", 10,
           column("A* / planner", **GA, map="all")),
    Target("each MovingAI map, kernels alone: A* / memetic", "field_movingai", ">=", 1,
           column("A* / kernel", **GA)),
    Target("all MovingAI maps, kernels alone: A* / memetic", "field_movingai", ">=", 10,
           column("A* / kernel", **GA, map="all")),
    Target("all MovingAI maps: memetic dearer than A*, mean", "field_movingai", "<=", 0.8,
           column("dearer %", **GA, map="all"), "%"),
    Target("the same, 99th percentile", "field_movingai", "<=", 10,
           column("dearer %, 99th", **GA, map="all"), "%"),
    Target("MovingAI maps of 256 x 256 and more: A* / memetic_quality", "field_movingai", ">=", 2,
           column("A* / planner", **QUALITY, map=LARGE_MAPS)),
    Target("on these: memetic_quality dearer than A*, mean", "field_movingai", "<=", 0.3,
           column("dearer %", **QUALITY, map=LARGE_MAPS), "%"),
    Target("on these: the same, 99th percentile", "field_movingai", "<=", 5,
           column("dearer %, 99th", **QUALITY, map=LARGE_MAPS), "%"),
    Target("each class of large maps: A* / memetic", "field_large", ">=", 20,
           column("A* / planner", **GA)),
    Target("each class of large maps, at the worst: A* / memetic", "field_large", ">=", 0.8,
           column("A* / planner", **GA)),
    Target("each class of large uniform maps: memetic dearer than A*", "field_large", "<=", 1,
           large("dearer %", terrain=False), "%"),
    Target("large weighted maps: memetic dearer than A*", "field_large", "<=", 3,
           large("dearer %", terrain=True), "%"),
    Target("rooms of 512 x 512: jump points / memetic", "field_large", ">=", 1,
           column("jps / planner", **GA, ends="random")),
    Target("streets of 256 x 256: jump points / memetic", "field_movingai", ">=", 1,
           column("jps / planner", **GA, map="Berlin_1_256")),
    Target("drives with memetic: reached", "field_drives", ">=", 100,
           column("reached %", navigator="memetic"), "%"),
    Target("drives on KG18's four maps: steps, memetic / repeated A*", "field_drives", "<=", 1,
           column("steps / replan_astar", navigator="memetic", range=4, fields="100 x 50")),
    *(Target(f"drives on {name}: time, memetic / repeated A*", "field_drives", "<=", limit,
             column("time / replan_astar", navigator="memetic", map=name))
      for name, limit in (("kg18_map1", 2), ("kg18_map2", 2), ("kg18_map3", 1), ("kg18_map4", 1))),
    Target("drives on 1000 x 500, range 8: time, memetic / repeated A*", "field_drives", "<=", 0.2,
           column("time / replan_astar", navigator="memetic", range=8)),
    Target("drives on 1000 x 500, range 8: time, memetic / D* Lite", "field_drives", "<=", 0.5,
           column("time / dstar_lite", navigator="memetic", range=8)),
    Target("drives on 1000 x 500, range 8: steps, memetic / the better", "field_drives", "<=", 1.05,
           column("steps / the better", navigator="memetic", range=8)),
    Target("gapath.plan with memetic beyond its kernel", "field_calls", "<=", 25,
           column("gapath.plan - kernel us", **GA, work="a call"), "us"),
    Target("memory of memetic on noise", "field_calls", "<=", 40,
           column("bytes a field", **GA, work="memory"), "bytes a field"),
)  # fmt: skip
"""Of a genetic planner of gapath's own, beside A* and jump point search."""

TARGETS = (
    Target("100 000 chromosomes evaluated: gapath / C, AVX-512 gathers", "fitness", "<=", 1.1,
           column("gapath / rival", rival="C, AVX-512 gathers")),
    Target("100 000 chromosomes evaluated: gapath / plain C", "fitness", "<=", 0.6,
           column("gapath / rival", rival="plain C")),
    Target("100 000 chromosomes evaluated: gapath / precomputed indices", "fitness", "<=", 2.5,
           column("gapath / rival", rival="precomputed indices")),
    Target("the same, compiled for any processor: gapath / scalar kernel", "fitness", "<=", 1,
           column("gapath / rival", rival="scalar kernel, generic CPU")),
    Target("the same, compiled for AVX2: gapath / scalar kernel", "fitness", "<=", 1,
           column("gapath / rival", rival="scalar kernel, Haswell")),
    Target("a run of GA 1-3 in batches of 20, map 1: textbook kernel / gapath", "ga_run", ">=", 3.5,
           column("textbook / gapath", map="kg18_test1")),
    Target("a run of GA 1-3 in batches of 20, map 4: textbook kernel / gapath", "ga_run", ">=", 4.5,
           column("textbook / gapath", map="kg18_test4")),
    Target("gapath.plan of GA 1, map 1, beyond its planner's call", "ga_run", "<=", 10,
           column("gapath.plan - GA us", map="kg18_test1", planner="ga1"), "us"),
    Target("an epoch of 40 and of 100: geneticalgorithm2 / gapath", "epochs", ">=", 40,
           epochs_of("geneticalgorithm2")),
    Target("an epoch of 40 and of 100: deap / gapath", "epochs", ">=", 40,
           epochs_of("deap")),
    Target("an epoch of 40 and of 100: pygad / gapath", "epochs", ">=", 40,
           epochs_of("pygad")),
    Target("an epoch of 40 and of 100: pymoo / gapath", "epochs", ">=", 40,
           epochs_of("pymoo")),
    Target("1200 runs in any order: one thread / two", "threads", ">=", 1.9,
           column("one / two"),
           why="checks and answers are Python, for one thread at a time; the machine itself "
               "gives what the last row of threads says"),
    Target("class 1, 1000 x 500, the table built: A* / GA 1", "growth", ">=", 40,
           column("A* / GA, table built", **CLASS_1, size="1000 x 500", planner="ga1"),
           why="A* goes straight to the target and fills no array of the map's size"),
    Target("class 1, 4000 x 4000, the table built: A* / GA 1", "growth", ">=", 300,
           column("A* / GA, table built", **CLASS_1, size="4000 x 4000", planner="ga1"),
           why="A* goes straight to the target and fills no array of the map's size"),
    Target("the command, cached, no recorder: whole process", "cold_start", "<=", 1.2,
           column("seconds", process="gapath, cached"), "s"),
    Target("the command, the very first time: compiling", "cold_start", "<=", 7,
           column("seconds", process="gapath, uncached"), "s",
           "numba's own work for some forty functions"),
    Target("a process that imports gapath", "cold_start", "<=", 0.4,
           column("seconds", process="import gapath"), "s"),
    Target("Table 1, 12 000 runs, every epoch logged, past start-up", "sweep", "<=", 12,
           column("total s", map="all", trials=12_000), "s"),
    Target("logging a trial", "logging", "<=", 60,
           column("us a trial", map="fit: a trial (a)"), "us",
           "encoding, checksums and compression of two or three messages"),
    Target("logging an epoch", "logging", "<=", 1,
           column("us a trial", map="fit: an epoch (b)"), "us"),
    Target("a drive on unknown map 1, KG18", "drives", "<=", 2,
           column("drive ms", map="kg18_map1", navigator="kg18"), "ms"),
    Target("a drive on unknown map 1, KG18 fast", "drives", "<=", 1,
           column("drive ms", map="kg18_map1", navigator="kg18_fast"), "ms"),
    Target("400 drives with KG18 and full logs", "drives", "<=", 20,
           column("total s", map="all", drives=400), "s"),
    Target("recording 500 steps of a drive", "drives", "<=", 0.3,
           column("recording s"), "s"),
    Target("a recording of 500 steps of a drive", "drives", "<=", 1,
           column("recording MB"), "MB"),
    Target("10 000 runs, 1 000 000 trials, listed: whole process", "asking", "<=", 3,
           column("seconds", question="list", runs=10_000), "s"),
    Target("the same in groups: whole process", "asking", "<=", 2,
           column("seconds", question="group", runs=10_000), "s"),
    Target("their report, pages of all runs included: whole process", "asking", "<=", 30,
           column("seconds", question="report", runs=10_000), "s"),
    Target("the same by SQL, in groups, listed or reported: memory", "asking", "<=", 1.074,
           column("peak GB", runs=10_000), "GB"),
    Target("a generation of S04, n = 10, 20, 50: DEAP / gapath", "row_column", ">=", 20,
           column("gapath / DEAP")),
    Target("M22, image to path: the paper / gapath", "visibility", ">=", 1000,
           column("rival / gapath", work="image to path", rival="the paper")),
    Target("a generation of M22: geneticalgorithm2 / gapath", "visibility", ">=", 50,
           column("rival / gapath", work="a generation")),
    *FIELD,
)  # fmt: skip


def judge(target: Target, answers: Mapping[str, list[Row]]) -> Row:
    """Hold what was measured against a target.

    Parameters
    ----------
    target : Target
        The target.
    answers : mapping of str to list of dict
        The rows of each question that was asked.

    Returns
    -------
    dict
        A row of the table: what, question, target, measured, and in "met" either "met", "missed"
        with the reason where it is known, or "not measured" with the reason.
    """
    unit = f" {target.unit}" if target.unit else ""
    row = {
        "what": target.what,
        "question": target.question,
        "target": f"{target.sense} {target.limit:g}{unit}",
        "measured": None,
    }
    if target.question not in answers:
        return row | {"met": f"not measured: {target.question} was not run"}
    found = target.measured(answers[target.question])
    reasons = [value for value in found if isinstance(value, str)]
    if reasons or not found:
        return row | {"met": f"not measured: {(reasons or ['not in this form'])[0]}"}
    below = target.sense == "<="
    worst = (max if below else min)(found, key=median)
    met = median(worst) <= target.limit if below else median(worst) >= target.limit
    missed = f"missed: {target.why}" if target.why else "missed"
    return row | {"measured": worst, "met": "met" if met else missed}


def median(value: Any) -> float:
    """Give a measurement's median."""
    return float(value.median if isinstance(value, Quartiles) else value)

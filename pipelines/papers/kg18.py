"""What KG18 printed.

KG18: Kwaśniewski & Gosiewski 2018, DOI 10.2478/ama-2018-0024.
"""

MAPS = ("kg18_test1", "kg18_test2", "kg18_test3", "kg18_test4")
PLANNERS = ("ga1", "ga2", "ga3")
UNKNOWN_MAPS = ("kg18_map1", "kg18_map2", "kg18_map3", "kg18_map4")
NAVIGATORS = ("kg18", "kg18_fast", "kg18_astar")

LABELS = {
    "ga1": "GA 1",
    "ga2": "GA 2",
    "ga3": "GA 3",
    **{name: f"Map {name[-1]}" for name in MAPS},
    **{name: f"Unknown map {name[-1]}" for name in UNKNOWN_MAPS},
    "kg18_enclosed": "Enclosed target",
    "kg18": "KG18",
    "kg18_fast": "KG18 fast",
    "kg18_astar": "KG18 + A*",
}
"""What the paper calls its maps and planners, and what we call its navigator."""

NOT_FOUND = None
"""The paper's "N.F.": no path in 500 epochs."""

SECONDS: dict[tuple[str, str], tuple[float | None, ...]] = {
    ("kg18_test1", "dijkstra"): (43.06, 46.73, 44.02),
    ("kg18_test2", "dijkstra"): (42.51, 42.37, 42.24),
    ("kg18_test3", "dijkstra"): (42.29, 42.73, 47.78),
    ("kg18_test4", "dijkstra"): (41.29, 39.54, 40.06),
    ("kg18_test1", "ga1"): (0.03, 0.03, 0.03),
    ("kg18_test2", "ga1"): (0.21, 0.10, 0.18),
    ("kg18_test3", "ga1"): (1.10, 0.77, NOT_FOUND),
    ("kg18_test4", "ga1"): (NOT_FOUND,) * 3,
    ("kg18_test1", "ga2"): (0.07, 0.08, 0.07),
    ("kg18_test2", "ga2"): (0.07, 0.14, 0.14),
    ("kg18_test3", "ga2"): (3.42, 2.10, 0.77),
    ("kg18_test4", "ga2"): (NOT_FOUND,) * 3,
    ("kg18_test1", "ga3"): (0.08, 0.08, 0.08),
    ("kg18_test2", "ga3"): (0.15, 0.15, 0.15),
    ("kg18_test3", "ga3"): (0.59, 0.59, 1.37),
    ("kg18_test4", "ga3"): (NOT_FOUND,) * 3,
}
"""KG18 Table 1: computing time of three executions, s."""

DRIVE_SECONDS = {
    "kg18_map1": "1.4 to 2.2",
    "kg18_map3": "3 to 11, 189 and 232",
    "kg18_map4": "0 to 140",
}
"""What survives of KG18 Figs 17, 21 and 23: the axes of the computing time of 100 drives, s."""


def found_seconds(map_name: str, planner: str) -> list[float]:
    """Give the paper's times of the executions that found a path, s; none if it has no such cell.

    Parameters
    ----------
    map_name, planner : str
        Names as in the configuration.

    Returns
    -------
    list of float
        In seconds.
    """
    return [time for time in SECONDS.get((map_name, planner), ()) if time is not None]


def implied_epochs(map_name: str, planner: str) -> list[int]:
    """Turn the paper's seconds into epochs.

    On map 1 every execution took one epoch, so the shortest of them is the time of one:
    0.03 s with a population of 40, 0.07 or 0.08 s with 100.

    Parameters
    ----------
    map_name, planner : str
        Names as in the configuration.

    Returns
    -------
    list of int
        Epochs of the executions that found a path; none for a planner without epochs.
    """
    if planner not in PLANNERS:
        return []
    one = min(found_seconds("kg18_test1", planner), default=1.0)
    return [round(time / one) for time in found_seconds(map_name, planner)]

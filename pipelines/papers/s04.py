"""What S04 printed.

S04: Sedighi, Ashenayi, Manikas, Wainwright, Tai 2004.
"""

MAPS = tuple(f"s04_sp{number:02d}" for number in range(1, 9))
PLANNERS = ("geisler", "hermanu", "sedighi")

LABELS = {
    "geisler": "Geisler 2002",
    "hermanu": "Hermanu 2002",
    "sedighi": "Sedighi 2004",
    **{name: f"SPSet{name[-2:]}" for name in MAPS},
}
"""What the paper calls its search spaces, and whose planners it compares."""

RUNS = 15
"""Runs behind each of the paper's rates (Sec. V)."""

SUCCESSES: dict[str, tuple[int, int, int]] = {
    "s04_sp01": (15, 14, 14),
    "s04_sp02": (0, 13, 15),
    "s04_sp03": (11, 13, 15),
    "s04_sp04": (8, 12, 15),
    "s04_sp05": (0, 15, 15),
    "s04_sp06": (0, 3, 15),
    "s04_sp07": (0, 0, 13),
    "s04_sp08": (0, 0, 11),
}
"""S04 Table 1 as counts of `RUNS`, in the order of `PLANNERS`: the paper prints percentages."""


def paper_successes(map_name: str, preset: str) -> int | None:
    """Give the paper's number of successful runs; None if it has no such cell.

    Parameters
    ----------
    map_name, preset : str
        Names as in the configuration; the planner's is that of its YAML.

    Returns
    -------
    int or None
        Of `RUNS`.
    """
    if map_name not in SUCCESSES or preset not in PLANNERS:
        return None
    return SUCCESSES[map_name][PLANNERS.index(preset)]

"""What maps, planners and navigators are called, and in which order they stand."""

from gapath.pipelines.papers import kg18, m22, s04

RIVALS = {
    "astar": "A*",
    "astar_length": "A*, by length",
    "dijkstra": "Dijkstra",
    "jps": "Jump point search",
    "jps_length": "Jump point search, by length",
    "lazy_theta": "Lazy Theta*",
    "rrt_connect": "RRT-Connect",
    "replan_astar": "Repeated A*",
    "dstar_lite": "D* Lite",
    "straight_astar": "Straight or A*",
}
"""What no paper proposes but stands beside their methods."""

LABELS = kg18.LABELS | s04.LABELS | m22.LABELS | RIVALS

ORDER = (
    *kg18.MAPS,
    *s04.MAPS,
    *m22.MAPS,
    m22.CONCAVE,
    *kg18.UNKNOWN_MAPS,
    "kg18_enclosed",
    *kg18.PLANNERS,
    *kg18.NAVIGATORS,
    *s04.PLANNERS,
    *m22.PLANNERS,
    *m22.RIVALS,
    *RIVALS,
)
"""The papers' order, method by method."""


def label(name: str, source: str = "") -> str:
    """Give the name that people read, with the mark that a reconstructed map must carry.

    Parameters
    ----------
    name : str
        Of a map, planner or navigator, as in the configuration; what differs from its YAML
        stands behind it in brackets.
    source : str
        The map's source.

    Returns
    -------
    str
        The paper's name, or the given one if no paper has one.
    """
    base, bracket, changes = name.partition("[")
    text = f"{LABELS.get(base, base)}{' ' if bracket else ''}{bracket}{changes}"
    return f"{text} (reconstructed)" if source == "reconstructed" else text


def rank(name: str) -> tuple[int, str]:
    """Give the place of a map or method in the tables: the papers' order, then the alphabet's.

    Parameters
    ----------
    name : str
        Of a map, planner or navigator, as in the configuration.

    Returns
    -------
    (int, str)
        A key to sort by.
    """
    base = name.partition("[")[0]
    return (ORDER.index(base) if base in ORDER else len(ORDER), name)

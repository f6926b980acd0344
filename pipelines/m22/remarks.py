"""What there is to say of M22's numbers."""

import pandas as pd

from gapath.pipelines.numbers.text import number, percent, tenths
from gapath.pipelines.papers.m22 import IMAGE_SHARE, PAPER


def remarks_of(rows: pd.DataFrame, stages: pd.DataFrame) -> tuple[str, ...]:
    """Say what methods and their stages come to, held against the paper.

    Parameters
    ----------
    rows : DataFrame
        As `table.summarise_methods` gives them.
    stages : DataFrame
        As `table.summarise_stages` gives them.

    Returns
    -------
    tuple of str
        Sentences.
    """
    by, took = rows.set_index("planner"), stages.set_index("planner")
    remarks = []
    if {"visibility_ga", "visibility_ga_unlimited"} <= set(by.index):
        remarks += _of_the_limit(by.loc["visibility_ga"], by.loc["visibility_ga_unlimited"])
    if {"visibility_dijkstra", "visibility_ga"} <= set(by.index):
        exact = took.loc["visibility_dijkstra"].get("search", float("nan"))
        genetic = took.loc["visibility_ga"].get("genetic algorithm", float("nan"))
        remarks.append(
            f"The exact answer takes microseconds: {number(1e6 * exact)} us for Dijkstra on the "
            f"graph, {number(1e6 * genetic)} us for the genetic algorithm. The paper's "
            f"{number(PAPER['visibility_astar'].seconds)} s for A* are those of its "
            "implementation, which compares whole images; it says that "
            f"{100 * IMAGE_SHARE:.0f} % of the genetic algorithm's time goes there, too."
        )
    remarks.append(
        "Here each pair of points is tested once, pixel by pixel along its line, before the search "
        "begins, which then only looks lengths up."
    )
    if {"visibility_ga", "visibility_ga_resized"} <= set(by.index):
        small, full = took.loc["visibility_ga_resized"], took.loc["visibility_ga"]
        image = ["dilation", "keypoints", "graph"]
        saved = full.reindex(image).sum() - small.reindex(image).sum()
        remarks.append(
            "Resizing is part of the paper's further work; f is then only that of paths whose "
            f"lines are free at full size, too. It saves {number(1000 * saved)} ms, and the search "
            f"for the scale takes {number(1000 * small.get('resizing', float('nan')))} ms: it pays "
            "where a scale is kept for many plans."
        )
    if "inflated_ga3" in by.index:
        remarks.append(
            "KG18's planner is what the paper's other further work asks for, a genetic algorithm "
            "over free (x, y) points: it minimises the sum of the weights of the fields, by which "
            "a diagonal step costs no more than a straight one, and stops at its first free path."
        )
    return (*remarks, "The paper's seconds are those of another machine and language.")


def _of_the_limit(limited: pd.Series, unlimited: pd.Series) -> list[str]:
    """Say what the limit of generations without improvement does."""
    remarks = []
    if limited["found"] and unlimited["found"]:
        paper = PAPER["visibility_ga_unlimited"].length / PAPER["visibility_ga"].length
        remarks.append(
            f"Without the limit f is {100 * (1 - unlimited['f'] / limited['f']):.1f} % lower "
            f"(paper: {100 * (1 - paper):.1f} %), and {tenths(100 * unlimited['gap'])} % above the "
            "shortest path of the graph in the mean, "
            f"{tenths(100 * unlimited['worst_gap'])} % at worst."
        )
    if limited["success"] < 1:
        remarks.append(
            f"With the limit {percent(1 - limited['success'])} % of the runs end without any path: "
            "every chromosome with a line that is not free counts the same, so until one is found "
            "by chance nothing leads to it, and 20 generations without one end the run. The paper "
            "reports a path in each of its ten tests."
        )
    return remarks

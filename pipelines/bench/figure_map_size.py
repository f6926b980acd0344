"""How the time of a plan grows with the map: GA 1-3 and A*, one panel a class."""

import pandas as pd
from matplotlib.ticker import NullFormatter

from gapath.pipelines.numbers.text import number, percent
from gapath.pipelines.page.figures import PAPER, legend, looks, panels, render, style
from gapath.pipelines.page.section import Figure
from gapath.pipelines.papers.names import label, rank

QUESTION = "growth"
COLUMNS = ("class", "size", "planner", "found", "GA us", "GA us q1", "GA us q3", "A* us")
ORDER = 10


def figure(rows: pd.DataFrame) -> Figure:
    """Draw the times against the number of fields.

    Parameters
    ----------
    rows : DataFrame
        One row a class, size and genetic algorithm, with the `COLUMNS`.

    Returns
    -------
    Figure
        Logarithmic axes; hollow where the genetic algorithm never found a path.
    """
    sides = rows["size"].str.split(" x ", expand=True).astype(int)
    rows = rows.assign(fields=sides.prod(axis=1))
    classes = sorted(rows["class"].unique(), key=rank)
    look = looks([*rows["planner"], "astar"])
    sentences = []
    with style():
        canvas, axes = panels(len(classes), height=2.2)
        for panel, name in zip(axes, classes, strict=True):
            here = rows[rows["class"] == name].sort_values("fields")
            panel.set_title(label(name, "reconstructed"), fontsize=8)
            panel.set(xscale="log", yscale="log")
            panel.xaxis.set_minor_formatter(NullFormatter())
            for planner, mine in here.groupby("planner"):
                color, dashes = look[planner]
                fields, found = mine["fields"], mine["found"] > 0
                panel.plot(fields, mine["GA us"], color=color, linestyle=dashes)
                panel.fill_between(fields, mine["GA us q1"], mine["GA us q3"], color=color,
                                   alpha=0.2, linewidth=0)  # fmt: skip
                panel.scatter(fields, mine["GA us"], s=18, edgecolor=color, zorder=3,
                              facecolor=[color if each else PAPER for each in found])  # fmt: skip
                sentences.append(
                    f"{label(name)}, {label(planner)}: {number(mine['GA us'].iloc[0])} to "
                    f"{number(mine['GA us'].iloc[-1])} us, found {percent(mine['found'].iloc[-1])} "
                    "% on the largest."
                )
            exact = here.drop_duplicates("fields")
            color, dashes = look["astar"]
            panel.plot(exact["fields"], exact["A* us"], "s", ms=3.5, color=color, linestyle=dashes)
            sentences.append(
                f"{label(name)}, A*: {number(exact['A* us'].iloc[0])} to "
                f"{number(exact['A* us'].iloc[-1])} us."
            )
        canvas.supxlabel("fields of the map", fontsize=10)
        canvas.supylabel("time of a plan, us", fontsize=10)
        legend(canvas, look)
        svg, png = render(canvas)
    return Figure(
        "bench_growth",
        "Median time of a plan, the map's table built, by the number of fields; shaded from the "
        "lower to the upper quartile. Hollow: no run found a path, so its time is that of failing.",
        "Curves on logarithmic axes, a panel for each class, from the smallest map to the "
        "largest. " + " ".join(sentences),
        svg,
        png,
    )

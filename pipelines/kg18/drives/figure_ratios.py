"""How much longer drives are than the shortest possible: the distribution by navigator."""

from collections.abc import Sequence

import pandas as pd

from gapath.pipelines.numbers.text import percent
from gapath.pipelines.page.figures import draw_shares, legend, looks, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.names import label, rank
from gapath.store.records import RunRecord

TASK = "drive"
EXPERIMENT = "drives"
ORDER = 63


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw the distribution of steps / shortest.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        One figure with a panel a map; None if no target was reached.
    """
    trials = trials[trials["map_instance"] == 0]
    arrived = trials.groupby("map")["reached"].transform("any")
    if not arrived.any():
        return None
    return Section(title="Length of drives", figures=(_figure(trials[arrived]),))


def _figure(trials: pd.DataFrame) -> Figure:
    maps = sorted(trials["map"].unique(), key=rank)
    look = looks(trials["navigator"])
    with style():
        canvas, axes = panels(len(maps), height=2.1, same_axes=False)
        for panel, name in zip(axes, maps, strict=True):
            here = trials[trials["map"] == name]
            longest = max(1.1, here["steps_ratio"].max())
            limits = 1 - 0.04 * (longest - 1), longest + 0.04 * (longest - 1)
            panel.set_title(label(name, here["map_source"].iloc[0]), fontsize=9)
            for navigator, its_look in look.items():
                mine = here[here["navigator"] == navigator]
                draw_shares(panel, (mine["steps_ratio"], mine["reached"]), limits, its_look)
            panel.set(xlim=limits, ylim=(-0.04, 1.06))
        canvas.supxlabel("steps / shortest", fontsize=10)
        canvas.supylabel("share of drives at the target", fontsize=10)
        legend(canvas, look)
        svg, png = render(canvas)
    ends_at = trials.groupby(["map", "navigator"])["reached"].mean().reset_index()
    return Figure(
        "drive_ratios",
        "Share of all drives that reached the target within so many times the fewest steps "
        "possible for who knows the map. Each panel has its own scale. A drive that failed never "
        "counts: a curve that ends below 1 is a navigator that failed.",
        "Distributions of steps over the shortest possible, one panel a map. The curves end at: "
        + "; ".join(
            f"{label(name)}, {label(navigator)} {percent(rate)} %"
            for name, navigator, rate in ends_at.itertuples(index=False)
        )
        + ".",
        svg,
        png,
    )

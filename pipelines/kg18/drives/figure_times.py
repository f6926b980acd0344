"""KG18 Figs 17, 19, 21 and 23: histograms of the computing time of drives."""

from collections.abc import Sequence

import numpy as np
import pandas as pd

from gapath.pipelines.numbers.drive_summary import OUTCOMES
from gapath.pipelines.numbers.text import number, span
from gapath.pipelines.page.figures import INK, panels, render, style
from gapath.pipelines.page.section import Figure, Section
from gapath.pipelines.papers.kg18 import DRIVE_SECONDS, UNKNOWN_MAPS
from gapath.pipelines.papers.names import label, rank
from gapath.store.records import RunRecord

TASK = "drive"
EXPERIMENT = "drives"
ORDER = 61

_NAVIGATOR = "kg18"
_BINS = 20
_COLORS = dict(zip(OUTCOMES, ("#0072B2", "#D55E00", INK), strict=True))


def section(trials: pd.DataFrame, runs: Sequence[RunRecord]) -> Section | None:
    """Draw the histograms of KG18's computing time, as the paper does for its four maps.

    Parameters
    ----------
    trials : DataFrame
        The drives of the experiment.
    runs : sequence of RunRecord
        The runs they come from.

    Returns
    -------
    Section or None
        One figure with a panel a map; None without drives of KG18.
    """
    ours = (trials["navigator"] == _NAVIGATOR) & trials["map"].isin(UNKNOWN_MAPS)
    trials = trials[ours & (trials["map_instance"] == 0)]
    if trials.empty:
        return None
    return Section(title="Computing time of drives", figures=(_figure(trials),))


def _figure(trials: pd.DataFrame) -> Figure:
    maps = sorted(trials["map"].unique(), key=rank)
    sentences = []
    with style():
        canvas, axes = panels(len(maps), height=2.1, same_axes=False)
        for panel, name in zip(axes, maps, strict=True):
            here = trials[trials["map"] == name]
            times = {
                outcome: 1000 * here.loc[here["outcome"] == outcome, "compute_time_s"]
                for outcome in OUTCOMES
            }
            everything = np.concatenate(list(times.values()))
            panel.hist(
                list(times.values()),
                bins=np.linspace(0, 1.02 * everything.max(), _BINS + 1).tolist(),
                stacked=True,
                color=[_COLORS[outcome] for outcome in OUTCOMES],
            )
            failed = ", ".join(f"{outcome} {len(times[outcome])}" for outcome in OUTCOMES[1:])
            title = label(name, here["map_source"].iloc[0])
            panel.set_title(f"{title}\n{failed} of {len(here)}", fontsize=8)
            sentences.append(
                f"{label(name)}: {span(everything.min(), everything.max())} ms, median "
                f"{number(float(np.median(everything)))} ms, {failed} of {len(here)}."
            )
        canvas.supxlabel("computing time of a drive, ms", fontsize=10)
        canvas.supylabel("drives", fontsize=10)
        svg, png = render(canvas)
    paper = "; ".join(f"{label(name).lower()} {text} s" for name, text in DRIVE_SECONDS.items())
    return Figure(
        "drive_times",
        "Computing time of KG18's drives, as in its Figs 17, 19, 21 and 23; orange: drives that "
        "returned to the start, the colour of this text: overran. Each panel has axes of its own. "
        f"Of the paper's axes survive: {paper}.",
        "Histograms of computing time, one panel a map. " + " ".join(sentences),
        svg,
        png,
    )

"""How the time of an epoch grows with the population and with the control points."""

import pandas as pd
from matplotlib.ticker import LogLocator, NullFormatter

from gapath.pipelines.numbers.text import number
from gapath.pipelines.page.figures import looks, panels, render, style
from gapath.pipelines.page.section import Figure

QUESTION = "growth_settings"
COLUMNS = ("setting", "value", "us an epoch", "us an epoch q1", "us an epoch q3")
ORDER = 20


def figure(rows: pd.DataFrame) -> Figure:
    """Draw the times against each setting.

    Parameters
    ----------
    rows : DataFrame
        One row a value of a setting, with the `COLUMNS`.

    Returns
    -------
    Figure
        Logarithmic axes, one panel a setting.
    """
    names = list(rows["setting"].unique())
    (look,) = looks(["ga2"]).values()
    sentences = []
    with style():
        canvas, axes = panels(len(names), height=2.0, same_axes=False)
        for panel, name in zip(axes, names, strict=True):
            here = rows[rows["setting"] == name]
            values, times = here["value"], here["us an epoch"]
            panel.plot(values, times, "o", ms=4, color=look.color, linestyle=look.dashes)
            panel.fill_between(values, here["us an epoch q1"], here["us an epoch q3"],
                               color=look.color, alpha=0.2, linewidth=0)  # fmt: skip
            panel.set(xscale="log", yscale="log", xlabel=name.replace("_", " "))
            panel.set_xticks(values[::2], values[::2])
            panel.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
            panel.yaxis.set_major_formatter("{x:g}")
            for axis in (panel.xaxis, panel.yaxis):
                axis.set_minor_formatter(NullFormatter())
            sentences.append(
                f"{name.replace('_', ' ')} {values.iloc[0]} to {values.iloc[-1]}: "
                f"{number(times.iloc[0])} to {number(times.iloc[-1])} us."
            )
        canvas.supylabel("time of an epoch, us", fontsize=10)
        svg, png = render(canvas)
    return Figure(
        "bench_growth_settings",
        "Median time of an epoch by what is varied, the rest as in GA 2; shaded from the lower to "
        "the upper quartile.",
        "Curves on logarithmic axes, a panel for each setting. " + " ".join(sentences),
        svg,
        png,
    )

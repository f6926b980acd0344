"""How every figure looks, and how it becomes the same bytes each time."""

import io
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatterMathtext
from numpy.typing import ArrayLike

from gapath.pipelines.numbers.statistics import share_within
from gapath.pipelines.papers.names import label, rank

WIDTH = 4.6
"""Width of every figure, inches: shrunk to a phone's width its 10 pt stay legible."""

INK, PAPER, GRID = "#000001", "#fffffe", "#e6e6e6"
"""Black, white and grey that a page shows in its own colours: what is drawn in other ones, also in
plain black and white, looks the same on every page."""

BETWEEN = "#767676"
"""Grey that shows on light and on dark: of a line on a map, which looks the same on every page, and
in the legend beside it."""

_STYLE = {
    "figure.facecolor": PAPER,
    "axes.facecolor": PAPER,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.titlesize": 10,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": GRID,
    "axes.axisbelow": True,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "text.parse_math": False,  # names of maps may have dollars
    "svg.hashsalt": "gapath",  # else the ids in the file are drawn at random
}


class Look(NamedTuple):
    """How one planner is drawn: told apart by colour and by dashes."""

    color: str
    dashes: Any


# Okabe and Ito's colours, of which colour-blind people see the differences.
_LOOKS = (
    Look("#0072B2", "-"),
    Look("#D55E00", (0, (5, 1.5))),
    Look("#009E73", (0, (1.5, 1))),
    Look("#CC79A7", (0, (6, 1.5, 1.5, 1.5))),
    Look(BETWEEN, (0, (3, 3))),
    Look("#56B4E9", (0, (8, 2))),
    Look("#E69F00", (0, (4, 1, 1, 1, 1, 1))),
)


def looks(planners: Iterable[str]) -> dict[str, Look]:
    """Give each planner its look, in the papers' order.

    Parameters
    ----------
    planners : iterable of str
        All planners of the experiment, so that each looks the same in all its figures.

    Returns
    -------
    dict of str to Look
        In the order in which to draw them.
    """
    return looks_of(sorted(set(planners), key=rank))


def looks_of(names: Iterable[str]) -> dict[str, Look]:
    """Give names their looks, in the order given."""
    return {name: _LOOKS[i % len(_LOOKS)] for i, name in enumerate(names)}


@contextmanager
def style() -> Iterator[None]:
    """Draw figures in this style, without touching that of the calling program."""
    with matplotlib.style.context(["default", _STYLE]):
        yield


def panels(count: int, height: float, same_axes: bool = True) -> tuple[Canvas, list[Axes]]:
    """Make a figure of panels, two in a row.

    Parameters
    ----------
    count : int
        Number of panels.
    height : float
        Of a panel, inches.
    same_axes : bool
        Whether all have the same axes.

    Returns
    -------
    canvas : matplotlib.figure.Figure
        The figure.
    axes : list of matplotlib.axes.Axes
        Its panels.
    """
    rows, cols = -(-count // 2), min(count, 2)
    canvas = Canvas(figsize=(WIDTH, 0.7 + height * rows), layout="constrained")
    axes = list(canvas.subplots(rows, cols, sharex=same_axes, sharey=same_axes, squeeze=False).flat)
    for empty in axes[count:]:
        empty.set_axis_off()
    return canvas, axes[:count]


def draw_shares(
    panel: Axes, trials: tuple[ArrayLike, ArrayLike], limits: tuple[float, float], look: Look
) -> None:
    """Draw `share_within` of trials as steps, from one limit to the other.

    Parameters
    ----------
    panel : Axes
        Where.
    trials : (n,) float, (n,) bool
        What each trial spent, and whether it succeeded.
    limits : (float, float)
        Ends of the horizontal axis.
    look : Look
        Colour and dashes.
    """
    spent, share = share_within(*trials)
    ends = np.r_[limits[0], spent, limits[1]]
    steps = np.r_[0, share, share[-1:] if share.size else 0]
    panel.step(ends, steps, where="post", color=look.color, linestyle=look.dashes)


def legend(canvas: Canvas, look: dict[str, Look]) -> None:
    """Explain the planners' lines above the panels."""
    handles = [
        Line2D([], [], color=color, linestyle=dashes, label=label(name))
        for name, (color, dashes) in look.items()
    ]
    cols = len(handles) if len(handles) <= 5 else 3
    canvas.legend(handles=handles, loc="outside upper center", ncols=cols, handlelength=2.6)


def render(canvas: Canvas) -> tuple[bytes, bytes]:
    """Write a figure as SVG and PNG, without date or version: the same bytes each time.

    Parameters
    ----------
    canvas : matplotlib.figure.Figure
        A figure made within `style`.

    Returns
    -------
    (svg, png) : bytes
        The two files.
    """
    _raise_powers(canvas)
    files = []
    with matplotlib.rc_context({"text.parse_math": True}):  # of ticks that are made meanwhile
        for kind, metadata in _FILES.items():
            stream = io.BytesIO()
            canvas.savefig(stream, format=kind, dpi=200, metadata=metadata, bbox_inches="tight")
            files.append(stream.getvalue())
    return files[0], files[1]


_FILES = {"svg": {"Date": None, "Creator": None}, "png": {"Software": None}}


def _raise_powers(canvas: Canvas) -> None:
    """Let the powers of ten be formulas that matplotlib writes along logarithmic axes."""
    for axis in (axis for panel in canvas.axes for axis in (panel.xaxis, panel.yaxis)):
        for formatter, ticks in (
            (axis.get_major_formatter(), axis.get_major_ticks),
            (axis.get_minor_formatter(), axis.get_minor_ticks),
        ):
            for tick in ticks():  # elsewhere they are made, before powers are allowed
                tick.label1.set_parse_math(isinstance(formatter, LogFormatterMathtext))


_SCHEME = (
    f"svg{{--i:{INK};--p:#ffffff;--g:{GRID}}}"
    "@media(prefers-color-scheme:dark){svg{--i:#e4e7eb;--p:#15191e;--g:#3a424d}}"
)
_SHORTER = (
    (re.compile(r"<\?xml.*?<svg", re.DOTALL), "<svg"),
    (re.compile(r"<metadata>.*?</metadata>|<!--.*?-->", re.DOTALL), ""),
    (re.compile(r"\s+"), " "),
)
_LINE, _DIGITS = re.compile(r' d="[^"]*"'), re.compile(r"(\.\d\d)\d+")
"""Of a line a hundredth of a point is enough, 7200 of which are an inch."""


def picture_of(svg: bytes) -> str:
    """Write a figure as the address of an image, for a page in light or dark colours.

    Parameters
    ----------
    svg : bytes
        As `render` gives it: on white.

    Returns
    -------
    str
        A data URI to stand between double quotes: its ink, paper and grid are those of the page's
        style sheet, in its light and its dark scheme.
    """
    text = svg.decode()
    for pattern, shorter in _SHORTER:
        text = pattern.sub(shorter, text)
    text = _LINE.sub(lambda line: _DIGITS.sub(r"\1", line[0]), text)
    for color, name in ((INK, "i"), (PAPER, "p"), (GRID, "g")):
        text = text.replace(color, f"var(--{name})")
    text = text.replace("</style>", f"{_SCHEME}</style>", 1)
    for plain, escaped in (("%", "%25"), ("#", "%23"), ("'", "%27"), ('"', "'"), ("&", "&amp;")):
        text = text.replace(plain, escaped)
    return f"data:image/svg+xml,{text}"

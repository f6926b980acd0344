"""What of matplotlib the package draws with. Where it is missing one line names the extra."""

from gapath.errors import Missing

try:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import LineCollection
    from matplotlib.colors import LinearSegmentedColormap, to_rgb, to_rgba
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch
except ModuleNotFoundError as error:
    raise Missing("a picture", "report", ["matplotlib"]) from error

__all__ = [
    "Artist",
    "Axes",
    "AxesImage",
    "Figure",
    "FigureCanvasAgg",
    "Line2D",
    "LineCollection",
    "LinearSegmentedColormap",
    "Patch",
    "new_axes",
    "to_rgb",
    "to_rgba",
]


def new_axes() -> Axes:
    """Give the axes of a new figure, which notebooks show."""
    from matplotlib import pyplot

    return pyplot.subplots(layout="constrained")[1]

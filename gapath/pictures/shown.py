"""What a notebook shows of an object: a picture, and a table beside it."""

import base64
import html
import io
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from gapath.errors import InputError

if TYPE_CHECKING:
    from gapath.pictures.canvas import Axes as Axes

FRAMES = 60
"""Pictures that an animation in a notebook has at most."""


class Shown:
    """What a notebook shows as a picture with a table."""

    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw it, field (x, y) of the map at (x, y), y down.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; by default a new figure, which a notebook shows.

        Returns
        -------
        matplotlib.axes.Axes
            Where it is drawn, to add to.

        Raises
        ------
        InputError
            If there is nothing to draw.
        """
        raise NotImplementedError

    def _told(self) -> Mapping[str, object]:
        """Tell it: label -> value."""
        raise NotImplementedError

    def _repr_html_(self) -> str:
        name = f"gapath.{type(self).__name__}"
        try:
            src = f"data:image/png;base64,{text_of(png_of(self.plot))}"
            picture = f'<img alt="{name}, drawn" src="{src}">'
        except InputError:  # the table says what there is
            picture = ""
        cells = "".join(
            f"<tr><th>{key}</th><td>{html.escape(str(value))}</td></tr>"
            for key, value in self._told().items()
        )
        return f"<div>{picture}<table><caption>{name}</caption>{cells}</table></div>"


def axes_for(ax: "Axes | None") -> "Axes":
    """Give the axes that a user named, or those of a new figure, which notebooks show.

    Parameters
    ----------
    ax : matplotlib.axes.Axes, optional
        Where to draw.

    Returns
    -------
    matplotlib.axes.Axes
        There.
    """
    if ax is not None:
        return ax
    from gapath.pictures.canvas import new_axes

    return new_axes()


def png_of(draw: Callable[["Axes"], object]) -> bytes:
    """Make a picture that no window or notebook shows by itself.

    Parameters
    ----------
    draw : callable
        Draws on the axes that it is given.

    Returns
    -------
    bytes
        PNG.
    """
    from gapath.pictures.canvas import Figure

    figure, stream = Figure(), io.BytesIO()
    draw(figure.subplots())
    figure.savefig(stream, format="png", dpi=90, bbox_inches="tight")
    return stream.getvalue()


def text_of(content: bytes) -> str:
    """Write a file's content as a page can hold it: base64."""
    return base64.b64encode(content).decode("ascii")

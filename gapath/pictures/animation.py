"""Pictures that follow one another, as a notebook plays them."""

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from string import Template
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from gapath.errors import require
from gapath.pictures.board import POINT, draw_path
from gapath.pictures.canvas import Axes, Figure, FigureCanvasAgg, LineCollection
from gapath.pictures.film import ffmpeg, mp4_of
from gapath.pictures.shown import FRAMES, text_of

KINDS = (".webp", ".gif", ".mp4", ".html")
"""Files that an animation can be saved as."""

_WIDTH, _HEIGHT, _DPI = 6.0, 7.0, 90
_ROOM, _LEGEND = 0.75, 0.5
"""Inches of a picture beside and above the map, and below it."""


def chosen(moments: Sequence[int], most: int = FRAMES) -> list[int]:
    """Choose `most` moments at most, evenly, the first and the last among them."""
    if len(moments) <= most:
        return list(moments)
    return [moments[i] for i in np.linspace(0, len(moments) - 1, most).round().astype(int)]


@dataclass(frozen=True, eq=False)
class Animation:
    """A series of pictures; a notebook shows it with a slider.

    Parameters
    ----------
    shape : (rows, cols)
        Of the map, for the size of the pictures.
    moments : sequence of int
        One for each picture.
    scene : callable
        Draws on the axes that it is given what all pictures share, and returns what changes that
        into the picture of a moment.
    rate : float
        Pictures a second.
    """

    shape: tuple[int, int]
    moments: Sequence[int] = field(repr=False)
    scene: Callable[[Axes], Callable[[int], None]] = field(repr=False)
    rate: float = 8.0

    @cached_property
    def frames(self) -> list[Image.Image]:
        """The pictures, drawn when they are first asked for."""
        rows, cols = self.shape
        scale = min((_WIDTH - _ROOM) / cols, (_HEIGHT - _ROOM - _LEGEND) / rows)
        size = (max(cols * scale, 2.5) + _ROOM, max(rows * scale, 0.5) + _ROOM + _LEGEND)
        figure = Figure(size, dpi=_DPI, layout="constrained")
        canvas: Any = FigureCanvasAgg(figure)
        show = self.scene(figure.subplots())
        frames = []
        for moment in self.moments:
            show(moment)
            canvas.draw()
            figure.set_layout_engine("none")  # the first picture's: nothing moves but what does
            image = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")
            frames.append(image.quantize(64))
        return frames

    def save(self, path: str | Path) -> None:
        """Write it as a moving picture, or as a page that needs no other file.

        Parameters
        ----------
        path : str or Path
            A file ``.webp``, ``.gif``, ``.mp4`` (by the program ffmpeg) or ``.html`` in an
            existing folder.

        Raises
        ------
        InputError
            If it is another kind of file, there is no such folder, or no ffmpeg for an ``.mp4``.
        """
        path = Path(path)
        kind = path.suffix.lower()
        require(kind in KINDS, "animation", path.name, f"a file name {', '.join(KINDS)}")
        require(path.parent.is_dir(), "animation", path, "a file in an existing folder")
        if kind == ".mp4":
            path.write_bytes(mp4_of(ffmpeg(), self.frames, self.rate))
        elif kind == ".html":
            path.write_text(f"<!doctype html><meta charset=utf-8>{self._repr_html_()}", "utf-8")
        else:
            first, *others = self.frames
            stream, pause = io.BytesIO(), round(1000 / self.rate)
            how: dict[str, Any] = {"lossless": True} if kind == ".webp" else {}
            first.save(
                stream, kind[1:], save_all=True, append_images=others, duration=pause, loop=0, **how
            )
            path.write_bytes(stream.getvalue())

    def _repr_html_(self) -> str:
        pictures = []
        for frame in self.frames:
            stream = io.BytesIO()
            frame.save(stream, "PNG", optimize=True)
            pictures.append(f"data:image/png;base64,{text_of(stream.getvalue())}")
        listed = ",".join(f'"{picture}"' for picture in pictures)
        last = len(pictures) - 1
        return _PLAYER.substitute(
            first=pictures[0], last=last, pictures=listed, pause=1000 / self.rate
        )


def growing_path(
    begin: Callable[[Axes], object],
    shape: tuple[int, int],
    ways: NDArray[np.int32],
    fitness: NDArray[np.float64],
    crowds: Sequence[Sequence[NDArray[np.int32]]] = (),
    most: int = FRAMES,
) -> Animation:
    """Show how a path grows better: each epoch in which it became another one, and the last.

    With a population's other lines each epoch in which one of these did.

    Parameters
    ----------
    begin : callable
        Draws what lies beneath.
    shape : (rows, cols)
        Of the map.
    ways : (E, n, 2) int32
        The path's way points epoch by epoch, as (x, y).
    fitness : (E,) float64
        Its fitness.
    crowds : sequence of sequence of (n, 2) int32
        The lines of all individuals epoch by epoch; none if they are not shown.
    most : int
        Pictures at most.

    Returns
    -------
    Animation
        Its moments are epochs from 0 on.
    """
    last = len(ways) - 1
    changed = {*(1 + np.flatnonzero((np.diff(ways, axis=0) != 0).any(axis=(1, 2)))).tolist()}
    for epoch, (before, now) in enumerate(pairwise(crowds), 1):
        if len(before) != len(now) or not all(map(np.array_equal, before, now)):
            changed.add(epoch)

    def scene(axes: Axes) -> Callable[[int], None]:
        begin(axes)
        line = draw_path(axes, ways[0], ways[0, :0])
        others = LineCollection([], colors=POINT, linewidths=0.8, zorder=1.5)  # below the path
        axes.add_collection(others, autolim=False)

        def show(epoch: int) -> None:
            line.set_data(*ways[epoch].T)
            others.set_segments(crowds[epoch] if crowds else [])
            axes.set_title(f"epoch {epoch + 1} of {last + 1}: fitness {fitness[epoch]:g}")

        return show

    return Animation(shape, chosen(sorted({0, *changed, last}), most), scene)


_PLAYER = Template(
    """<div>
<img alt="animation" src="$first" style="max-width: 100%"><br>
<button type="button">play</button>
<input type="range" min="0" max="$last" value="0" style="width: 24em; max-width: 70%"
 aria-label="moment">
<script>
(() => {
  const box = document.currentScript.parentElement, pictures = [$pictures];
  const [image, button, slider] = ["img", "button", "input"].map(kind => box.querySelector(kind));
  let timer = 0;
  const show = () => { image.src = pictures[slider.value]; };
  const stop = () => { clearInterval(timer); timer = 0; button.textContent = "play"; };
  slider.oninput = () => { stop(); show(); };
  button.onclick = () => {
    if (timer) { stop(); return; }
    if (slider.value == $last) slider.value = 0;
    button.textContent = "pause";
    timer = setInterval(() => {
      if (slider.value == $last) { stop(); return; }
      slider.value++;
      show();
    }, $pause);
  };
})();
</script>
</div>"""
)

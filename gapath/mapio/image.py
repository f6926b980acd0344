"""Weighted maps as grey images, PNG, PGM or PPM (KG18 Sec. 2's black and white).

A pixel v becomes the weight v / 256, but 255 becomes 1: black 0 is the preferred field
0.0, 128 the base value 0.5 exactly, white 255 the obstacle 1.0, and 254 the dearest field
that can be passed. ``invert`` reads v as 255 - v: obstacles are black. Row 0 is the top.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gapath.grid import GridMap
from gapath.mapio._input import as_field, final
from gapath.mapio._pixels import read_grey

SUFFIXES: tuple[str, ...] = (".png", ".ppm")

UNCLEAR = {
    ".pgm": "the YAML file of this map (ROS, where dark is an obstacle), or map=image for a "
    "picture in which white is one"
}
"""Endings of files that are no map by themselves, and what would be right."""

WEIGHTS = np.append(np.arange(255) / 256, 1.0)
"""Weight of each pixel value, (256,)."""


@dataclass(frozen=True)
class Reader:
    """Reads the pixels of an image as weights.

    Parameters
    ----------
    path : str
        The image: 8-bit grey without alpha.
    start, target : [x, y], optional
        Fields to go from and to.
    invert : bool
        Whether black is the obstacle, and white preferred.
    """

    path: str
    start: list[int] | None
    target: list[int] | None
    invert: bool

    def read(self) -> GridMap:
        """Read the map.

        Returns
        -------
        GridMap
            The map, named after the file.

        Raises
        ------
        InputError
            If the file is not such an image (`gapath.mapio._pixels.read_grey`).
        """
        grey = read_grey(self.path)
        return GridMap(
            name=Path(self.path).stem,
            weights=final((WEIGHTS[::-1] if self.invert else WEIGHTS)[grey]),
            start=as_field("map.start", self.start),
            target=as_field("map.target", self.target),
            source="image",
            inverted=self.invert,
        )

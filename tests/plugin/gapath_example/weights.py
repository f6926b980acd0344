"""Maps as tables of weights: a row of the map a line, numbers parted by commas."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.mapio._input import as_field, read_text

SUFFIXES = (".csv",)


@dataclass(frozen=True)
class Reader:
    """Reads weights in [0, 1].

    Parameters
    ----------
    path : str
        The file.
    start, target : [x, y], optional
        Fields to go from and to.
    """

    path: str
    start: list[int] | None
    target: list[int] | None

    def read(self) -> GridMap:
        """Read the map, named after the file; raises InputError."""
        lines = read_text(self.path).splitlines()
        try:
            weights = np.array([[float(cell) for cell in line.split(",")] for line in lines])
        except ValueError as error:
            raise InputError(self.path, error, "rows of as many numbers each") from error
        start, target = as_field("map.start", self.start), as_field("map.target", self.target)
        return GridMap(Path(self.path).stem, weights, start, target, source="weights")

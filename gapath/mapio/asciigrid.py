"""Square grids as text: the number of rows, then the rows, 0 free and 1 an obstacle.

The format of the grids that go round with S04's kind of planner: from the upper left corner to
the lower right one.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gapath.errors import require
from gapath.grid import MAX_SIDE, GridMap
from gapath.mapio._input import as_field, read_text

SUFFIXES: tuple[str, ...] = (".txt",)


@dataclass(frozen=True)
class Reader:
    """Reads a ``.txt`` grid.

    Parameters
    ----------
    path : str
        The file.
    start, target : [x, y], optional
        Fields to go from and to; otherwise the upper left and the lower right corner.
    free_weight : float
        Weight of free fields, in [0, 1).
    """

    path: str
    start: list[int] | None
    target: list[int] | None
    free_weight: float

    def __post_init__(self) -> None:
        require(
            0 <= self.free_weight < 1, "map.free_weight", self.free_weight, "a number in [0, 1)"
        )

    def read(self) -> GridMap:
        """Read the map.

        Returns
        -------
        GridMap
            The map, named after the file.

        Raises
        ------
        InputError
            If the file cannot be read or is not of the format.
        """
        head, *lines = read_text(self.path).rstrip().split("\n")
        good = head.strip().isascii() and head.strip().isdigit() and len(head.strip()) < 6
        require(good, f"{self.path}, line 1", repr(head[:40]), "the number of rows")
        n = int(head)
        require(1 <= n <= MAX_SIDE, f"{self.path}, line 1", n, f"from 1 to {MAX_SIDE} rows")
        require(len(lines) == n, self.path, f"{len(lines)} rows", f"{n}, as line 1 says")
        for number, line in enumerate(lines, start=2):
            row = line.rstrip()
            where = f"{self.path}, line {number}"
            require(len(row) == n, where, f"{len(row)} characters", f"{n}: the grid is square")
            require(not row.strip("01"), where, repr(row[:40]), "0 (free) and 1 (obstacle) only")
        blocked = np.array([[field == "1" for field in line.rstrip()] for line in lines])
        start, target = as_field("map.start", self.start), as_field("map.target", self.target)
        return GridMap(
            name=Path(self.path).stem,
            weights=np.where(blocked, 1.0, self.free_weight),
            start=start or (0, 0),
            target=target or (n - 1, n - 1),
            source="asciigrid",
        )

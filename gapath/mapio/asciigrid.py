"""Square grids as text: the number of rows, then the rows, 0 free and 1 an obstacle.

The format of the grids that go round with S04's kind of planner: from the upper left corner to
the lower right one.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gapath.errors import Checks, require
from gapath.grid import MAX_FIELDS, GridMap
from gapath.mapio._input import as_field, final, read_text

SUFFIXES: tuple[str, ...] = (".txt",)

MAX_ROWS = math.isqrt(MAX_FIELDS)


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
        check = Checks(self, "map")
        check("free_weight", 0 <= self.free_weight < 1, "a number in [0, 1)")

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
        head, *rows = [line.rstrip() for line in read_text(self.path).rstrip().split("\n")]
        good = head.isascii() and head.isdigit() and len(head) < 6
        require(good, f"{self.path}, line 1", repr(head[:40]), "the number of rows")
        n = int(head)
        require(1 <= n <= MAX_ROWS, f"{self.path}, line 1", n, f"from 1 to {MAX_ROWS} rows")
        require(len(rows) == n, self.path, f"{len(rows)} rows", f"{n}, as line 1 says")
        for number, row in enumerate(rows, start=2):
            where = f"{self.path}, line {number}"
            require(len(row) == n, where, f"{len(row)} characters", f"{n}: the grid is square")
            require(not row.strip("01"), where, repr(row[:40]), "0 (free) and 1 (obstacle) only")
        codes = np.frombuffer("".join(rows).encode(), dtype=np.uint8).reshape(n, n)
        start, target = as_field("map.start", self.start), as_field("map.target", self.target)
        return GridMap(
            name=Path(self.path).stem,
            weights=final(np.where(codes == ord("1"), 1.0, self.free_weight)),
            start=start or (0, 0),
            target=target or (n - 1, n - 1),
            source="asciigrid",
        )

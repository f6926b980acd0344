"""Maps drawn for gapath, kept as text under ``maps``.

S04's eight search spaces: the paper's are lost, all but what its Table 1 says of them: which of
three genotypes can express a path. These are of the same classes, which a test proves
(`gapath.survey.row_column.express`). And a U with the start in it, for which M22 has no figure:
concave obstacles are what it names as its weakness.
"""

from dataclasses import dataclass, replace
from importlib.resources import files

from gapath.errors import require
from gapath.grid import Field, GridMap
from gapath.mapio import movingai

SUFFIXES: tuple[str, ...] = ()

BASE_WEIGHT = 0.5  # as KG18 Sec. 2, so that costs can be compared

SEARCH_SPACES = tuple(f"s04_sp{number:02d}" for number in range(1, 9))

OWN_ENDS: dict[str, tuple[Field, Field]] = {"m22_u": ((100, 60), (190, 60))}
"""Start and target of drawings that no paper has."""

DRAWINGS = (*SEARCH_SPACES, *OWN_ENDS)


@dataclass(frozen=True)
class Reader:
    """Reads a drawing.

    Parameters
    ----------
    drawing : str
        s04_sp01 to s04_sp08, m22_u.
    """

    drawing: str

    def __post_init__(self) -> None:
        require(self.drawing in DRAWINGS, "map.drawing", self.drawing, f"one of {[*DRAWINGS]}")

    def read(self) -> GridMap:
        """Give the map.

        Returns
        -------
        GridMap
            A search space is a square grid, start in the upper left corner, target in the lower
            right one, and marked as reconstructed.
        """
        path = str(files("gapath.maps") / f"{self.drawing}.map")
        grid = movingai.Reader(path, [0, 0], None, BASE_WEIGHT, None, 0).read()
        if self.drawing in OWN_ENDS:
            start, target = OWN_ENDS[self.drawing]
            return replace(grid, start=start, target=target, source="drawn")
        corner = (grid.cols - 1, grid.rows - 1)
        return replace(grid, target=corner, source="reconstructed")

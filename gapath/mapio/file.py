"""Any map file: the reader is found by the file's name, with its YAML's own values."""

from dataclasses import dataclass

from gapath.discovery import load, reader_of, yaml_values
from gapath.grid import GridMap

SUFFIXES: tuple[str, ...] = ()


@dataclass(frozen=True)
class Reader:
    """Reads a map file of any known format.

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
        """Read the map, every other setting as in the YAML of the file's format.

        Returns
        -------
        GridMap
            The map.

        Raises
        ------
        InputError
            If no reader knows the file's ending, or its reader refuses the file.
        """
        kind = reader_of(self.path, "map.path")
        values = yaml_values("map", kind)
        del values["kind"]
        given = {"path": self.path, "start": self.start, "target": self.target}
        grid: GridMap = load("map", kind)(**(values | given)).read()
        return grid

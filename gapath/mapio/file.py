"""Any map file: the reader is found by the file's name, with its YAML's own values."""

import importlib
import pkgutil
from dataclasses import dataclass
from importlib import resources

import yaml

import gapath.mapio
from gapath.errors import InputError
from gapath.grid import GridMap

SUFFIXES: tuple[str, ...] = ()


def kinds() -> dict[str, str]:
    """Tell which reader reads which files.

    Returns
    -------
    dict of str to str
        Names of the modules of `gapath.mapio` by the ending of a file name.
    """
    found: dict[str, str] = {}
    for module in pkgutil.iter_modules(gapath.mapio.__path__):
        if not module.name.startswith("_"):
            reader = importlib.import_module(f"gapath.mapio.{module.name}")
            found |= dict.fromkeys(getattr(reader, "SUFFIXES", ()), module.name)
    return found


def kind_of(path: str, where: str) -> str:
    """Tell which reader reads a file.

    Parameters
    ----------
    path : str
        The file.
    where : str
        The setting that names it, for messages.

    Returns
    -------
    str
        Name of a module of `gapath.mapio`.

    Raises
    ------
    InputError
        If no reader knows the file's ending.
    """
    known = kinds()
    for suffix, kind in known.items():
        if path.lower().endswith(suffix):
            return kind
    raise InputError(where, path, f"a file name ending in {', '.join(known)}")


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
        return self._read_as(kind_of(self.path, "map.path"))

    def _read_as(self, kind: str) -> GridMap:
        text = (resources.files("gapath.conf") / "map" / f"{kind}.yaml").read_text("utf-8")
        settings = yaml.safe_load(text)
        del settings["kind"]
        settings |= {"path": self.path, "start": self.start, "target": self.target}
        grid: GridMap = importlib.import_module(f"gapath.mapio.{kind}").Reader(**settings).read()
        return grid

"""A map in a terminal: what it is, and its fields as halves of characters."""

import sys

import numpy as np
from numpy.typing import NDArray

from gapath.commands.told.topics import chosen, width
from gapath.discovery import yaml_values
from gapath.grid import GridMap

HALVES = " ▀▄█"
"""Nothing, the upper half, the lower half, both."""


def pictured(name: str) -> str:
    """Tell what a map is, and draw it.

    Parameters
    ----------
    name : str
        A YAML of ``conf/map``.

    Returns
    -------
    str
        Its settings, size, start, target, source, and its picture, no wider than the terminal. Of
        a reader of files, which names none, the settings only.

    Raises
    ------
    InputError
        If there is no such map.
    """
    about = chosen("map", name)
    values = yaml_values("map", name)
    if "???" in values.values():
        return f"{about}\n\nIt reads the file that map.path names."
    from gapath.components import build

    grid: GridMap = build("map", values, "map").read()
    picture, side = drawn(grid, width())
    facts = [
        f"size     {grid.cols} x {grid.rows} fields",
        f"start    {grid.start}",
        f"target   {grid.target}",
        f"source   {grid.source}",
        f"picture  a character is {side} x {2 * side} fields, dark where any of them is an "
        "obstacle; S start, T target",
    ]
    return "\n".join([about, "", *facts, "", picture])


def drawn(grid: GridMap, columns: int) -> tuple[str, int]:
    """Draw a map.

    Parameters
    ----------
    grid : GridMap
        The map.
    columns : int
        How wide the picture may be, with its frame.

    Returns
    -------
    str
        Lines of equal length.
    int
        Fields a side of half a character.
    """
    side = -(-grid.cols // max(columns - 2, 1))
    blocks = _blocks(grid.weights >= 1.0, side)
    codes = blocks[::2] + 2 * blocks[1::2]
    halves = HALVES if _can_write(HALVES) else " '.#"
    lines = [[halves[code] for code in row] for row in codes]
    for mark, field in (("S", grid.start), ("T", grid.target)):
        if field is not None:
            lines[field[1] // (2 * side)][field[0] // side] = mark
    edge = f"+{'-' * codes.shape[1]}+"
    return "\n".join([edge, *(f"|{''.join(line)}|" for line in lines), edge]), side


def _blocks(obstacles: NDArray[np.bool_], side: int) -> NDArray[np.int64]:
    """Tell which squares of fields hold an obstacle; there is an even number of rows of them."""
    rows, cols = obstacles.shape
    high, wide = 2 * -(-rows // (2 * side)), -(-cols // side)
    padded = np.zeros((high * side, wide * side), dtype=np.bool_)
    padded[:rows, :cols] = obstacles
    found: NDArray[np.int64] = padded.reshape(high, side, wide, side).any(axis=(1, 3)).astype("i8")
    return found


def _can_write(text: str) -> bool:
    try:
        text.encode(sys.stdout.encoding or "ascii")
    except UnicodeEncodeError:
        return False
    return True

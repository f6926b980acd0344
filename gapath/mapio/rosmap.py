"""Maps of ROS's ``map_server``: a YAML file and its PGM or PNG image.

Pixels become occupancies as nav2's ``map_server`` makes them. With p = 1 - shade (p = shade
under ``negate``), shade in [0, 1] from black to white, the mean of red, green and blue:

- ``trinary``: p > ``occupied_thresh`` is occupied, p < ``free_thresh`` free, else unknown;
  an alpha channel counts as a fourth colour in the mean that is the shade;
- ``scale``: as trinary, but between the thresholds the occupancy rises linearly from 0 to
  100 %, rounded to whole per cents; a pixel that is not opaque is unknown;
- ``raw``: the pixel value is the occupancy in per cent, above 100 unknown; neither
  ``negate`` nor thresholds play a part.

What is both, under an ``occupied_thresh`` below ``free_thresh``, is occupied.

Occupancies become weights: 100 % is the obstacle, 1 exactly; q < 100 % is
``free_weight`` + (1 - ``free_weight``) q / 100, so free is ``free_weight`` and 99 % just
below 1; unknown is a setting. Row 0 is the top, the origin the lower left corner.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gapath.errors import Checks, InputError, require
from gapath.grid import GridMap
from gapath.mapio._input import ROWS, as_field, final, read_text
from gapath.mapio._pixels import Pixels, read_pixels
from gapath.store.settings import MAX_YAML_BYTES, plain_yaml

SUFFIXES: tuple[str, ...] = (".yaml", ".yml")

MODES = ("trinary", "scale", "raw")
OCCUPIED, UNKNOWN = 100.0, -1.0
"""Occupancies as in ``nav_msgs/OccupancyGrid``; 0 to 100 are per cents."""

Levels = NDArray[np.float64]
"""A value for each pair of brightness and alpha, (766, 256); a brightness is red, green and blue
added up."""
NEGATE = {"0": False, "1": True, "false": False, "true": True, "no": False, "yes": True}


@dataclass(frozen=True)
class Description:
    """What the YAML file of a map says.

    Parameters
    ----------
    image : Path
        The image file.
    resolution : float
        Side of a pixel in metres.
    origin : (x, y, yaw)
        Pose of the lower left pixel in metres and radians.
    negate : bool
        Whether white means occupied.
    occupied_thresh, free_thresh : float
        Thresholds of the occupancy, in [0, 1]; without a meaning in mode "raw".
    mode : str
        One of `MODES`.
    """

    image: Path
    resolution: float
    origin: tuple[float, float, float]
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: str


@dataclass(frozen=True)
class Reader:
    """Reads the map that a ``map_server`` YAML file describes.

    Parameters
    ----------
    path : str
        The YAML file.
    start, target : [x, y], optional
        Fields to go from and to.
    free_weight : float
        Weight of free fields, in [0, 1).
    unknown : str or float
        What unknown fields are: ``free``, ``obstacle``, or a weight in [0, 1].
    """

    path: str
    start: list[int] | None
    target: list[int] | None
    free_weight: float
    unknown: str | float

    def __post_init__(self) -> None:
        check = Checks(self, "map")
        check("free_weight", 0 <= self.free_weight < 1, "a number in [0, 1)")
        if isinstance(self.unknown, str):
            known = self.unknown in ("free", "obstacle")
        else:
            known = 0 <= self.unknown <= 1
        check("unknown", known, "free, obstacle, or a number in [0, 1]")

    def read(self) -> GridMap:
        """Read the map.

        Returns
        -------
        GridMap
            The map, named after the YAML file, with its resolution and origin.

        Raises
        ------
        InputError
            If a file cannot be read, a key is missing or of a wrong type or range, or the
            image lies outside the folder of the YAML file.
        """
        description = read_description(self.path)
        pixels = read_pixels(description.image)
        levels = self._weights(occupancy(description, pixels.alpha is not None))
        return GridMap(
            name=Path(self.path).stem,
            weights=final(_look_up(levels, pixels)),
            start=as_field("map.start", self.start),
            target=as_field("map.target", self.target),
            source="rosmap",
            resolution=description.resolution,
            origin=description.origin,
        )

    def _weights(self, per_cent: Levels) -> Levels:
        weights = self.free_weight + (1 - self.free_weight) * per_cent / 100
        weights[per_cent == OCCUPIED] = 1.0  # exactly, whatever the sum rounds to
        named = {"free": self.free_weight, "obstacle": 1.0}
        weights[per_cent == UNKNOWN] = (
            named[self.unknown] if isinstance(self.unknown, str) else self.unknown
        )
        return weights


def _look_up(levels: Levels, pixels: Pixels) -> NDArray[np.float64]:
    channels = pixels.colours.shape[2]
    weights = np.empty(pixels.colours.shape[:2])
    for top in range(0, len(weights), ROWS):
        some = slice(top, top + ROWS)
        brightness = pixels.colours[some].sum(axis=2, dtype=np.intp) * (3 // channels)
        weights[some] = levels[brightness, 255 if pixels.alpha is None else pixels.alpha[some]]
    return weights


def occupancy(description: Description, has_alpha: bool) -> Levels:
    """Give the occupancy of every pixel that there can be.

    Parameters
    ----------
    description : Description
        Mode, thresholds and negation.
    has_alpha : bool
        Whether the image has an alpha channel.

    Returns
    -------
    (766, 256) float64
        By brightness, 0 to 765, and alpha: 0 to 100 in per cent, or `UNKNOWN`.
    """
    brightness, alpha = np.meshgrid(np.arange(766.0), np.arange(256.0), indexing="ij")
    if description.mode == "raw":
        grey = np.rint(brightness / 3)
        return np.where(grey <= OCCUPIED, grey, UNKNOWN)
    counts = has_alpha and description.mode == "trinary"
    mean = (brightness + alpha) / 4 if counts else brightness / 3
    shade = mean / 255
    p = shade if description.negate else 1.0 - shade
    free, occupied = description.free_thresh, description.occupied_thresh
    between = np.full_like(p, UNKNOWN)
    if description.mode == "scale" and free != occupied:
        between = np.rint((p - free) / (occupied - free) * 100)
    per_cent = np.where(p > occupied, OCCUPIED, np.where(p < free, 0.0, between))
    if description.mode == "scale":
        per_cent[alpha < 255] = UNKNOWN
    return per_cent


def read_description(path: str) -> Description:
    """Read and check the YAML file of a map.

    Parameters
    ----------
    path : str
        The file, relative to the current folder.

    Returns
    -------
    Description
        Its content; keys that ``map_server`` does not know are passed over.

    Raises
    ------
    InputError
        If it is no YAML mapping, or a key is missing or of a wrong type or range.
    """
    is_image = Path(path).suffix.lower() in (".pgm", ".png", ".ppm")
    require(not is_image, path, "an image", "the map's YAML file, which names it")
    content = plain_yaml(read_text(path, MAX_YAML_BYTES), path, "a map_server YAML")
    require(isinstance(content, dict), path, _shown(content), "a map_server YAML: keys and values")
    needed = ("image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh")
    for key in needed:
        require(key in content, f"{path}, {key}", "nothing", f"the keys {', '.join(needed)}")

    resolution = _number(f"{path}, resolution", content["resolution"])
    require(resolution > 0, f"{path}, resolution", resolution, "a number of metres > 0")
    origin = content["origin"]
    require(
        isinstance(origin, list) and len(origin) == 3,
        f"{path}, origin",
        _shown(origin),
        "three numbers [x, y, yaw] (metres, metres, radians)",
    )
    x, y, yaw = (_number(f"{path}, origin", value) for value in origin)
    negate = NEGATE.get(_word(content["negate"]))
    if negate is None:
        raise InputError(f"{path}, negate", _shown(content["negate"]), "0 or 1")
    occupied = _number(f"{path}, occupied_thresh", content["occupied_thresh"])
    free = _number(f"{path}, free_thresh", content["free_thresh"])
    mode = _word(content.get("mode", "trinary"))
    require(
        mode in MODES, f"{path}, mode", _shown(content.get("mode")), f"one of {', '.join(MODES)}"
    )
    if mode != "raw":
        for key, value in (("free_thresh", free), ("occupied_thresh", occupied)):
            require(0 <= value <= 1, f"{path}, {key}", value, "a number from 0 to 1")
    image = _image_path(path, content["image"])
    return Description(image, resolution, (x, y, yaw), negate, occupied, free, mode)


def _shown(value: Any) -> str:
    # Of what may be long or nested, the type alone.
    return repr(value) if isinstance(value, str | int | float | None) else type(value).__name__


def _word(value: Any) -> str:
    return str(value).lower() if isinstance(value, str | int) else ""


def _number(where: str, value: Any) -> float:
    # YAML 1.1 takes 1e-05 for text, other YAML libraries write it as a number.
    try:
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    require(math.isfinite(number), where, _shown(value), "a finite number")
    return number


def _image_path(path: str, name: Any) -> Path:
    """Find the image, which must not lie outside the YAML file's folder."""
    where, inside = f"{path}, image", "a file in the folder of the YAML file"
    if not isinstance(name, str) or name == "":
        raise InputError(where, _shown(name), inside)
    folder = Path(path).parent.resolve()
    try:
        found = (folder / name).resolve()
        there = found.is_file()
    except (OSError, ValueError, RuntimeError) as error:  # too long, null byte, ring of symlinks
        raise InputError(where, repr(name[:80]), inside) from error
    require(found.is_relative_to(folder), where, name, inside)
    require(there, where, f"{name}, which is no file", inside)
    return Path(path).parent / name

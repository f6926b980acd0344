"""Pixels of an image file: the only place that decodes images."""

import io
import re
import struct
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gapath.errors import InputError, require
from gapath.grid import MAX_FIELDS
from gapath.mapio._input import ROWS, read_bytes

PALETTE = 3
PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"
PNG_CHANNELS = {0: 1, 2: 3, PALETTE: 1, 4: 2, 6: 4}
"""Channels by colour type: grey, RGB, palette, grey and alpha, RGB and alpha."""
NETPBM_CHANNELS = {b"P2": 1, b"P3": 3, b"P5": 1, b"P6": 3}
"""Channels by kind: as text, P2 grey and P3 RGB; binary, P5 and P6."""
NETPBM_HEADER = re.compile(rb"(P[2356])" + 3 * rb"(?:\s|#[^\r\n]*[\r\n])+(\d{1,9})" + rb"\s")

Channels = NDArray[np.uint8]
"""Samples as they are in the file, (rows, cols, channels)."""


class Pixels(NamedTuple):
    """An 8-bit image, row 0 at the top."""

    colours: Channels
    """(rows, cols, 1 or 3) grey, or red, green and blue; 0 black, 255 white."""
    alpha: NDArray[np.uint8] | None
    """(rows, cols) 0 transparent, 255 opaque; None where the file has no alpha channel."""


def read_pixels(path: str | Path) -> Pixels:
    """Read a PNG, PGM or PPM file.

    Parameters
    ----------
    path : str or Path
        The file, relative to the current folder.

    Returns
    -------
    Pixels
        Its pixels.

    Raises
    ------
    InputError
        If the file is missing, damaged, truncated, larger than `MAX_FIELDS` pixels, of
        another format, or not of 8 bits or fewer a sample.
    """
    data = read_bytes(path)
    if data.startswith(PNG_SIGNATURE):
        channels = _read_png(path, data)
    elif data[:2] in NETPBM_CHANNELS:
        channels = _read_netpbm(path, data)
    else:
        found = f"a file that begins with {data[:8]!r}"
        raise InputError(path, found, "a PNG, PGM (P2, P5) or PPM (P3, P6)")
    if channels.shape[2] in (2, 4):
        return Pixels(channels[:, :, :-1], channels[:, :, -1])
    return Pixels(channels, None)


def read_grey(path: str | Path) -> NDArray[np.uint8]:
    """Read the image of a weight map, see `read_pixels`.

    Parameters
    ----------
    path : str or Path
        The file, relative to the current folder.

    Returns
    -------
    (rows, cols) uint8
        0 black, 255 white.

    Raises
    ------
    InputError
        As `read_pixels`, and if a pixel is coloured or there is an alpha channel.
    """
    colours, alpha = read_pixels(path)
    require(alpha is None, path, "an image with an alpha channel", "one without")
    for top in range(0, len(colours), ROWS):
        some = colours[top : top + ROWS]
        coloured = (some != some[:, :, :1]).any(axis=2)
        if coloured.any():
            y, x = np.argwhere(coloured)[0]
            raise InputError(
                f"{path}, pixel ({x}, {top + y})",
                f"RGB {some[y, x].tolist()}",
                "a shade of grey: equal red, green and blue",
            )
    return colours[:, :, 0]


def _check_size(path: str | Path, cols: int, rows: int) -> None:
    require(
        cols > 0 and rows > 0 and cols * rows <= MAX_FIELDS,
        path,
        f"an image of {cols} x {rows} pixels",
        f"1 to {MAX_FIELDS} pixels",
    )


def _check_depth(path: str | Path, bits: int) -> None:
    require(bits <= 8, path, f"{bits} bits a sample", "an 8-bit grey image")


def _read_netpbm(path: str | Path, data: bytes) -> Channels:
    header = NETPBM_HEADER.match(data)
    if header is None:
        raise InputError(path, f"the header {data[:20]!r}", "width, height and largest value")
    cols, rows, largest = (int(number) for number in header.groups()[1:])
    _check_size(path, cols, rows)
    _check_depth(path, largest.bit_length())
    require(largest == 255, path, f"largest value {largest}", "an image of values 0 to 255")
    raster = memoryview(data)[header.end() :]
    shape = rows, cols, NETPBM_CHANNELS[header.group(1)]
    if header.group(1) in (b"P2", b"P3"):
        raster = memoryview(_values(path, raster))
    # One newline more than the raster: some map savers end their file like a text.
    if len(raster) == np.prod(shape) + 1 and raster[-1] == ord("\n"):
        raster = raster[:-1]
    require(
        len(raster) == np.prod(shape),
        path,
        f"a raster of {len(raster)} bytes",
        f"{np.prod(shape)} bytes for {cols} x {rows} pixels",
    )
    return np.frombuffer(raster, dtype=np.uint8).reshape(shape)


def _values(path: str | Path, text: bytes | memoryview) -> bytes:
    """Give the raster of numbers in text, a byte a number."""
    if _COMMENT.search(text):
        text = _COMMENT.sub(b" ", text)
    found, begin = bytearray(), 0
    while begin < len(text):  # a piece at a time: a number takes eight times the room of a byte
        blank = _BLANK.search(text, begin + _PIECE)
        end = blank.start() if blank else len(text)
        piece, begin = bytes(text[begin:end]), end
        strange = re.search(rb"[^\d\s]+", piece)
        require(strange is None, path, repr(strange and strange[0][:20]), "numbers from 0 to 255")
        values = np.fromstring(piece.decode(), dtype=np.int64, sep=" ")
        most = values.max(initial=0)
        require(most <= 255, path, f"the value {most}", "numbers from 0 to 255")
        found += values.astype(np.uint8).tobytes()
    return bytes(found)


_COMMENT, _BLANK = re.compile(rb"#[^\r\n]*"), re.compile(rb"\s")
_PIECE = 1 << 22


def _read_png(path: str | Path, data: bytes) -> Channels:
    # The header, read before Pillow is: nothing is decoded that is too large or of a
    # kind that Pillow would reduce to 8 bits without a word.
    require(len(data) > 28 and data[12:16] == b"IHDR", path, "no image header", "a whole PNG")
    cols, rows, bits, colour, interlaced = struct.unpack(">IIBBxxB", data[16:29])
    _check_size(path, cols, rows)
    _check_depth(path, bits)
    require(colour in PNG_CHANNELS, path, f"colour type {colour}", "grey, RGB or a palette")
    require(not interlaced, path, "an interlaced PNG", "a PNG that is not interlaced")

    from PIL import Image  # here: planning on other maps does not wait for it

    try:
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            image.verify()  # every chunk whole, each checksum right
        _check_png_raster(path, data, rows, (cols * bits * PNG_CHANNELS[colour] + 7) // 8)
        with Image.open(io.BytesIO(data), formats=["PNG"]) as image:
            image.load()
            require(
                "transparency" not in image.info,
                path,
                "an image with a transparent colour",
                "an image without",
            )
            if colour == PALETTE:
                known = len(image.palette.palette) // 3 if image.palette else 0
                found = int(np.asarray(image).max())
                require(found < known, path, f"colour {found} of {known}", "one of the palette")
                return np.asarray(image.convert("RGB"))
            pixels = image.convert("L") if image.mode == "1" else image
            return np.asarray(pixels).reshape(rows, cols, PNG_CHANNELS[colour])
    except InputError:
        raise
    except Exception as error:  # Pillow lets zlib's, struct's and its own errors through
        raise InputError(path, "a damaged or truncated PNG", "a whole PNG") from error


_SLICE = 1 << 16


def _check_png_raster(path: str | Path, data: bytes, rows: int, row_bytes: int) -> None:
    """Refuse image data of a wrong length, which Pillow fills up with black."""
    expected = rows * (1 + row_bytes)  # one byte before each row names its filter
    inflating, found, place = zlib.decompressobj(), 0, len(PNG_SIGNATURE)
    while place < len(data) and found <= expected:
        length, kind = struct.unpack(">I4s", data[place : place + 8])
        if kind == b"IEND":
            break
        begin, place = place + 8, place + length + 12
        for at in range(begin, begin + length, _SLICE) if kind == b"IDAT" else ():
            some = data[at : min(at + _SLICE, begin + length)]
            while some and found <= expected and not inflating.eof:
                found += len(inflating.decompress(some, _PIECE))
                some = inflating.unconsumed_tail
    found += len(inflating.flush())
    require(found == expected, path, "image data of a wrong length", f"{rows} rows of pixels")

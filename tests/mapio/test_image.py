import io
import struct
import warnings
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from PIL import Image

from gapath.api import load_map, plan
from gapath.errors import InputError
from gapath.grid import MAX_FIELDS
from gapath.mapio.image import Reader

GREY = np.array([[0, 128, 255], [1, 254, 64]], dtype=np.uint8)
WEIGHTS = [[0.0, 0.5, 1.0], [1 / 256, 254 / 256, 0.25]]


def read(path: object):
    return Reader(str(path), start=None, target=None, invert=False).read()


def encode(pixels: np.ndarray, kind: str = "PNG", mode: str | None = None, **more: object) -> bytes:
    file = io.BytesIO()
    image = Image.fromarray(pixels)
    (image.convert(mode) if mode else image).save(file, kind, **more)
    return file.getvalue()


def chunk(kind: bytes, content: bytes) -> bytes:
    return (
        struct.pack(">I", len(content))
        + kind
        + content
        + struct.pack(">I", zlib.crc32(kind + content))
    )


def png(
    cols: int,
    rows: int,
    raster: bytes,
    bits: int = 8,
    colour: int = 0,
    interlaced: int = 0,
    extra: bytes = b"",
) -> bytes:
    header = struct.pack(">IIBBBBB", cols, rows, bits, colour, 0, 0, interlaced)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", header)
        + extra
        + chunk(b"IDAT", zlib.compress(raster))
        + chunk(b"IEND", b"")
    )


ROW = b"\0\1\2\3"
PGM = b"P5\n3 2\n255\n" + GREY.tobytes()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("grey.png", encode(GREY)),
        ("grey_as_colour.png", encode(GREY, mode="RGB")),
        ("two_chunks.png", png(3, 2, b"\0" + GREY[0].tobytes() + b"\0" + GREY[1].tobytes())),
        ("grey.pgm", PGM),
        ("newline.pgm", PGM + b"\n"),
        ("comments.pgm", b"P5 # made by hand\n#3 3\n3\t2\r\n255\n" + GREY.tobytes()),
        ("grey_as_colour.ppm", encode(GREY, "PPM", "RGB")),
        ("palette.png", encode(GREY, mode="P")),
        ("text.pgm", b"P2 3 2 # text\n255 0 128 255# x 7\n001\t254 64"),
        ("text.ppm", b"P3 3 2 255\n0 0 0 128 128 128 255 255 255 1 1 1 254 254 254 64 64 64\n"),
    ],
)
def test_good_images(tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    grid = read(tmp_path / name)
    assert grid.weights.tolist() == WEIGHTS
    assert (grid.name, grid.source) == (name[:-4], "image")


def test_bilevel_and_few_bits(tmp_path):
    (tmp_path / "one.png").write_bytes(png(4, 1, b"\0\xa0", bits=1))
    (tmp_path / "four.png").write_bytes(png(3, 1, b"\0\x08\xf0", bits=4))
    assert read(tmp_path / "one.png").weights.tolist() == [[1.0, 0.0, 1.0, 0.0]]
    assert read(tmp_path / "four.png").weights.tolist() == [[0.0, 8 * 17 / 256, 1.0]]


def test_start_and_target(tmp_path):
    (tmp_path / "m.png").write_bytes(encode(GREY))
    grid = Reader(str(tmp_path / "m.png"), start=[0, 1], target=[1, 0], invert=False).read()
    assert (grid.start, grid.target) == ((0, 1), (1, 0))


def test_inverted_it_is_read_like_its_negative(tmp_path):
    (tmp_path / "m.png").write_bytes(encode(GREY))
    (tmp_path / "negative.png").write_bytes(encode(255 - GREY))
    grid = Reader(str(tmp_path / "m.png"), start=None, target=None, invert=True).read()
    assert grid.weights.tolist() == read(tmp_path / "negative.png").weights.tolist()
    assert (grid.inverted, read(tmp_path / "m.png").inverted) == (True, False)


FLOOR = np.full((5, 9), 255, dtype=np.uint8)
FLOOR[:3, 4] = 0
SHADES = np.where(FLOOR == 255, 200, 60).astype(np.uint8)
SHADES[4, 4:] = 190  # not black and white


@pytest.mark.parametrize(
    ("pixels", "invert", "ends", "planner", "suggested"),
    [
        (FLOOR, False, ((0, 0), (8, 0)), "astar", "map.invert=true"),
        (255 - FLOOR, True, ((0, 0), (8, 0)), "astar", "map.invert=false"),
        (FLOOR, False, ((0, 0), (4, 0)), "astar", None),  # then the target would be an obstacle
        (FLOOR, False, ((4, 0), (8, 0)), "astar", None),
        (255 - FLOOR, False, ((4, 0), (8, 0)), "astar", None),
        (SHADES, False, ((0, 0), (8, 0)), "visibility_astar", "map.invert=true"),
        (SHADES, False, ((0, 0), (4, 0)), "visibility_astar", None),
        (255 - SHADES, False, ((3, 0), (8, 0)), "visibility_astar", None),  # only too near to one
    ],
)
def test_the_other_reading_is_suggested_where_it_would_help(
    tmp_path, pixels, invert, ends, planner, suggested
):
    (tmp_path / "m.png").write_bytes(encode(pixels))
    grid = load_map(tmp_path / "m.png", invert=invert)
    with pytest.raises(InputError) as caught:
        plan(grid, *ends, planner=planner, **({"robot_radius": 1} if "vis" in planner else {}))
    message = str(caught.value)
    assert ("map.invert" in message) == (suggested is not None)
    assert suggested is None or f"map=image and {suggested}" in message
    if suggested:
        other = load_map(tmp_path / "m.png", invert=not invert)
        assert plan(other, *ends, planner="astar").feasible


@given(arrays(np.uint8, array_shapes(min_dims=2, max_dims=2, max_side=9)), st.booleans())
@example(np.array([[10]], dtype=np.uint8), False)
def test_any_image_is_read_pixel_by_pixel(tmp_path_factory, pixels, is_png):
    path = tmp_path_factory.getbasetemp() / "any.image"
    path.write_bytes(encode(pixels, "PNG" if is_png else "PPM"))
    expected = [[1.0 if v == 255 else v / 256 for v in row] for row in pixels.tolist()]
    assert read(path).weights.tolist() == expected


SIXTEEN = (GREY.astype(np.uint16) << 8) + 1
COLOURED = np.stack([GREY, GREY, GREY[::-1]], axis=2)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "0 bytes"),
        (b"GIF89a", "expected a PNG"),
        (b"BM", "expected a PNG"),
        (b"P1\n1 1\n0\n", "expected a PNG, PGM (P2, P5) or PPM (P3, P6)"),
        (b"\xff\xd8\xff\xe0\0\x10JFIF", "expected a PNG, PGM"),
        (b"P2\n1 1\n255\n256\n", "the value 256, expected numbers from 0 to 255"),
        (b"P2\n1 1\n255\n99999999999999999999999\n", "expected numbers from 0 to 255"),
        (b"P2\n2 1\n255\n7 -7\n", "got b'-', expected numbers from 0 to 255"),
        (b"P2\n2 1\n255\n7\n", "a raster of 1 bytes, expected 2 bytes"),
        (b"P2\n2 1\n255\n7 7 7\n", "a raster of 3 bytes"),
        (b"P2\n1 1\n100\n7\n", "largest value 100"),
        (b"P3\n1 1\n255\n7 7 8\n", "pixel (0, 0): got RGB [7, 7, 8], expected a shade of grey"),
        (encode(SIXTEEN), "16 bits a sample, expected an 8-bit grey image"),
        (png(1, 1, b"\0" + b"\7" * 6, bits=16, colour=2), "16 bits a sample"),
        (encode(COLOURED, mode="P"), "expected a shade of grey"),
        (
            png(2, 1, b"\0\0\2", colour=3, extra=chunk(b"PLTE", bytes(range(6)))),
            "colour 2 of 2, expected one of the palette",
        ),
        (png(2, 1, b"\0\0\2", colour=3), "expected one of the palette"),
        (encode(GREY, mode="LA"), "alpha"),
        (encode(GREY, mode="RGBA"), "alpha"),
        (encode(GREY, transparency=7), "transparent colour"),
        (encode(COLOURED), "pixel (0, 0): got RGB [0, 0, 1], expected a shade of grey"),
        (encode(GREY)[:-20], "damaged or truncated"),
        (encode(GREY)[:20], "no image header"),
        (encode(GREY)[:8], "no image header"),
        (png(3, 3, ROW * 2), "wrong length, expected 3 rows"),
        (png(3, 3, ROW * 4), "wrong length, expected 3 rows"),
        (png(3, 3, b"\x09" + ROW[1:] + ROW * 2), "damaged"),
        (png(3, 3, ROW * 3).replace(b"IDAT", b"IDAX"), "damaged"),
        (png(3, 3, ROW * 3, bits=3), "damaged"),
        (png(3, 3, ROW * 3, colour=5), "colour type 5"),
        (png(3, 3, ROW * 3, interlaced=1), "interlaced"),
        (png(0, 3, ROW * 3), "0 x 3 pixels"),
        (
            png(3, 3, ROW * 3, extra=chunk(b"zTXt", b"a\0\0" + zlib.compress(bytes(1 << 22)))),
            "damaged",
        ),
        (png(8193, 8192, ROW), f"8193 x 8192 pixels, expected 1 to {MAX_FIELDS} pixels"),
        (png(2**32 - 1, 2**32 - 1, ROW), "4294967295 x 4294967295"),
        (b"P5\n8193 8192\n255\n", "8193 x 8192 pixels"),
        (b"P5\n3 2\n", "header"),
        (b"P5\n-3 2\n255\n", "header"),
        (b"P5\n0 2\n255\n", "0 x 2"),
        (b"P5\n3 2\n65535\n" + bytes(12), "16 bits a sample"),
        (b"P5\n3 2\n100\n" + bytes(6), "largest value 100"),
        (PGM[:-1], "a raster of 5 bytes, expected 6 bytes for 3 x 2 pixels"),
        (PGM + b"\0", "a raster of 7 bytes"),
        (PGM + b"\n\n", "a raster of 8 bytes"),
        (encode(COLOURED, "PPM"), "expected a shade of grey"),
    ],
)
def test_bad_images(tmp_path, content, message):
    path = tmp_path / "bad.png"
    path.write_bytes(content)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(InputError) as caught:
            read(path)
    assert str(caught.value).startswith(str(path)) and message in str(caught.value)


def test_no_file(tmp_path: Path):
    for path in (tmp_path, tmp_path / "none.png"):
        with pytest.raises(InputError, match=str(path)):
            read(path)


@pytest.mark.parametrize("good", [encode(GREY), PGM], ids=["png", "pgm"])
def test_damage_is_refused_or_harmless(tmp_path, good):
    path = tmp_path / "m.png"
    for place in range(len(good)):
        path.write_bytes(good[:place] + bytes([good[place] ^ 1]) + good[place + 1 :])
        try:
            grid = read(path)
        except InputError:
            continue
        # A PGM has no checksums: a flipped bit in a pixel goes by.
        assert grid.weights.shape == (2, 3)
        assert good is PGM or grid.weights.tolist() == WEIGHTS
    for length in range(len(PGM) if good is PGM else len(good) - 4):  # 4: the end's own checksum
        path.write_bytes(good[:length])
        with pytest.raises(InputError):
            read(path)

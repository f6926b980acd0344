"""Hostile files: whatever lies in a file, a reader gives a map, or one line that says why not.

Readers are found, not listed. Each gets whole small files, altered: bytes, pieces, numbers, words
that mean something to some format, and other formats' pieces; pictures get their checksums anew, so
that more than these is tried. `GAPATH_RELIABILITY=long` tries a million.
"""

import contextlib
import io
import json
import os
import random
import re
import struct
import time
import zlib

import numpy as np
import pytest
from PIL import Image
from scale import rounds

from gapath.components import build
from gapath.discovery import readers, yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.store.settings import plain_yaml

TRIES = rounds(300, 85_000)
"""Altered files for each reader and ending."""

ROS = """image: a.pgm
resolution: 0.05
origin: [-1.0, -2.0, 0.5]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
mode: scale
"""
SDF = """<?xml version="1.0"?><sdf version="1.6"><world name="w"><!-- c --><model name="m">
<pose frame="">-4.425 0.075 0 0 0 0</pose><link name="l"><collision name="c"><geometry><cylinder>
<radius>0.075</radius><length>1</length></cylinder></geometry></collision></link></model></world></sdf>
"""
BARN = {"cylinders_xyr": [[-4.425, 0.075, 0.075]], "start": [-2.25, 3.0], "goal": [-2.25, 13.0]}
MAP = "type octile\nheight 3\nwidth 4\nmap\n.G.S\n@OTW\n....\n"
SCENARIO = "version 1\n0\ta.map\t4\t3\t0\t0\t3\t2\t3.41421356\n1 a.map 4 3 0 0 3 0 3\n"


def picture(kind, pixels):
    file = io.BytesIO()
    Image.fromarray(np.asarray(pixels, dtype=np.uint8)).save(file, kind)
    return file.getvalue()


def path_of_cells():
    file = io.BytesIO()
    np.save(file, np.array([[3, 4], [5, 60]]))
    return file.getvalue()


GREY = [[0, 128, 255], [254, 1, 2]]
PALETTE = io.BytesIO()
Image.fromarray(np.array(GREY, dtype=np.uint8)).convert("P").save(PALETTE, "PNG")
SEEDS = {
    ".map": [MAP.encode()],
    ".scen": [SCENARIO.encode()],
    ".txt": [b"3\n010\n000\n110\n"],
    ".yaml": [ROS.encode(), b"a: &a [1, 2]\nb: *a\nc: {<<: {d: 1}}\n"],
    ".json": [json.dumps(BARN).encode()],
    ".world": [SDF.encode()],
    ".npy": [path_of_cells()],
    ".png": [picture("PNG", GREY), picture("PNG", np.full((2, 3, 4), 7)), PALETTE.getvalue(),
             picture("PNG", np.full((2, 3, 3), 7))],
    ".ppm": [picture("PPM", GREY), b"P2 # c\n3 2\n255\n0 1 2 3 4 255\n", b"P3 1 1 255 1 2 3\n",
             picture("PPM", np.full((2, 3, 3), 7))],
}  # fmt: skip
WORDS = [
    *(b"-1", b"0", b"nan", b"inf", b"1e999", b"-0.0", b"1e-320", b"99999999999999999999", b"1_0"),
    *(b"8193", b"65537", b"1073741824", b"0x10", b"1:30", b"2020-99-99", b"~", b"true", b"[]"),
    *(b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"\r\n", b"\x1b[2J", b"\xf0\x9f\x99\x82", b" " * 70),
    *(b"&a [*a]", b"*a", b"<<: *a", b"!!python/object/apply:os.getcwd []", b"!!binary x", b"? "),
    *(b"[" * 40, b"{" * 40, b"<a>" * 40, b"- " * 40, b"<!DOCTYPE a>", b"<![CDATA[", b"&lt;", b"#"),
    *(b'"', b"'", b"{", b"}", b"null", b"../", b"/etc/passwd", b"%s", b"\\u0000"),
    *(b"9" * 5000, b"0x" + b"9" * 5000),
]


def altered(dice, ending):
    data = dice.choice(SEEDS.get(ending) or dice.choice(list(SEEDS.values())))
    for _ in range(dice.choice((1, 1, 1, 2, 3, 6))):
        data = ALTER[dice.randrange(len(ALTER))](dice, data)
    return resealed(data) if data[:4] == b"\x89PNG" and dice.random() < 0.8 else data


def one_byte(dice, data):
    at = dice.randrange(len(data) + 1)
    return data[:at] + bytes([dice.randrange(256)]) + data[at + dice.randrange(2) :]


def word(dice, data):
    at = dice.randrange(len(data) + 1)
    return data[:at] + dice.choice(WORDS) + data[at + dice.choice((0, 0, 1, 4)) :]


def number(dice, data):
    found = list(re.finditer(rb"[-\d.]+", data))
    if not found:
        return word(dice, data)
    begin, end = dice.choice(found).span()
    return data[:begin] + dice.choice(WORDS) + data[end:]


def piece(dice, data):
    begin, end = sorted(dice.randrange(len(data) + 1) for _ in range(2))
    other = dice.choice(dice.choice(list(SEEDS.values())))
    return data[:begin] + dice.choice((b"", data[begin:end] * 2, data[begin:], other)) + data[end:]


def shorter(dice, data):
    return data[: dice.randrange(len(data) + 1)]


ALTER = (one_byte, one_byte, word, number, number, piece, shorter)


def resealed(png):
    """The same chunks with right checksums, as far as there are whole ones."""
    made, at = [png[:8]], 8
    while at + 12 <= len(png):
        (length,) = struct.unpack(">I", png[at : at + 4])
        body = png[at + 4 : at + 8 + length]
        made += [png[at : at + 4], body, struct.pack(">I", zlib.crc32(body))]
        at += 12 + length
    return b"".join(made)


TARGETS = [(kind, ending, "path") for ending, kind in sorted(readers().items())] + [
    ("movingai", ".scen", "scenario"),
    ("barn", ".npy", "scenario"),
    ("image", ".ppm", "path"),
]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.pgm").write_bytes(picture("PPM", GREY))
    (tmp_path / "a.map").write_text(MAP)
    (tmp_path / "a.json").write_text(json.dumps(BARN))
    return tmp_path


@pytest.mark.filterwarnings("error")  # they would be more than one line
@pytest.mark.parametrize(("kind", "ending", "setting"), TARGETS)
def test_a_reader_gives_a_map_or_one_line(folder, kind, ending, setting):
    dice = random.Random(f"{kind} {ending}")
    values = yaml_values("map", kind) | {"start": [0, 0], "target": [1, 1]}
    if setting == "scenario":
        values |= {"path": "a.map" if kind == "movingai" else "a.json"}
        values |= {"start": None, "target": None}
    values[setting] = f"hostile{ending}"
    reader = build("map", values, "map")
    read = slowest = 0
    for _ in range(TRIES):
        data = altered(dice, ending)
        (folder / values[setting]).write_bytes(data)
        begin = time.monotonic()
        with tried(data):
            grid = reader.read()
            assert isinstance(grid, GridMap) and np.isfinite(grid.weights).all()
            if setting == "scenario" and hasattr(reader, "queries"):
                reader.queries(grid)
            read += 1
        slowest = max(slowest, time.monotonic() - begin)
    print(f"{kind} {ending}: {TRIES} files, {read} maps, 0 uncaught, slowest {slowest:.2f} s")
    assert read < TRIES
    assert slowest < 10


def test_a_yaml_is_plain_data_or_one_line():
    dice = random.Random(0)
    for _ in range(TRIES):
        data = altered(dice, ".yaml").decode("latin-1")
        with tried(data):
            assert len(repr(plain_yaml(data, "a.yaml", "a YAML"))) < 10**6
    print(f"YAML: {TRIES} texts, 0 uncaught")


@contextlib.contextmanager
def tried(data):
    try:
        yield
    except InputError as error:
        assert len(str(error)) < 2000 and "\n" not in str(error)
    except Exception as error:
        raise AssertionError(f"{data!r:.3000} gives {type(error).__name__}") from error


@pytest.mark.parametrize("ending", sorted(readers()))
@pytest.mark.parametrize("what", ["folder", "pipe", "device", "nothing", "ring", "long"])
def test_what_is_no_regular_file_is_one_line_and_nobody_waits(folder, ending, what):
    path = folder / f"a thing{ending}"
    if what == "folder":
        path.mkdir()
    elif what == "pipe":
        os.mkfifo(path)
    elif what in ("device", "ring"):
        path.symlink_to("/dev/zero" if what == "device" else path.name)
    elif what == "long":
        path = folder / f"{'x' * 300}{ending}"
    values = yaml_values("map", readers()[ending]) | {"path": str(path)}
    with pytest.raises(InputError):
        build("map", values, "map").read()

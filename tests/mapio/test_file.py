import os
from dataclasses import fields
from importlib import import_module, resources
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from gapath.components import typed
from gapath.discovery import readers
from gapath.errors import InputError
from gapath.mapio.file import Reader

DATA = Path(os.environ.get("GAPATH_DATA", Path(__file__).parents[3] / "shared" / "data"))
KINDS = ("movingai", "rosmap", "image", "file")


def read(path: object):
    return Reader(str(path), start=[0, 0], target=[1, 1]).read()


def test_every_suffix_has_one_reader():
    assert {
        ".map": "movingai",
        ".yaml": "rosmap",
        ".yml": "rosmap",
        ".png": "image",
        ".pgm": "image",
        ".ppm": "image",
    }.items() <= readers().items()


def test_the_reader_is_found_by_the_suffix(tmp_path):
    Image.fromarray(np.full((2, 2), 128, dtype=np.uint8)).save(tmp_path / "Grey.PNG")
    (tmp_path / "m.map").write_text("type octile\nheight 2\nwidth 2\nmap\n..\n..\n")
    (tmp_path / "r.yml").write_text(
        "{image: Grey.PNG, resolution: 1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.4, "
        "free_thresh: 0.2}"
    )
    for name, source, weight in (
        ("Grey.PNG", "image", 0.5),
        ("m.map", "movingai", 0.5),
        ("r.yml", "rosmap", 1.0),
    ):
        grid = read(tmp_path / name)
        assert (grid.source, grid.start, grid.target) == (source, (0, 0), (1, 1))
        assert (grid.weights == weight).all()


@pytest.mark.parametrize("name", ["m.text", "map", "m.scen", ""])
def test_unknown_suffix(name):
    with pytest.raises(InputError) as caught:
        read(name)
    message = str(caught.value)
    assert message.startswith(f"map.path: got {name}, expected a file name ending in ")
    assert all(suffix in message for suffix in (".map", ".png", ".yaml", ".yml"))


def test_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"none\.map: got no such file"):
        read(tmp_path / "none.map")


@pytest.mark.parametrize("kind", KINDS)
def test_yaml_holds_exactly_the_settings(kind):
    text = (resources.files("gapath.conf") / "map" / f"{kind}.yaml").read_text()
    values = yaml.safe_load(text)
    reader = import_module(f"gapath.mapio.{kind}").Reader
    assert values.pop("kind") == kind
    assert list(values) == [field.name for field in fields(reader)]
    assert list(values)[:3] == ["path", "start", "target"]
    assert all("#" in line for line in text.splitlines() if not line.startswith("kind:"))
    chosen = {"path": "m", "start": [1, 2]}
    assert isinstance(typed(reader, values | chosen, "map"), reader)


@pytest.mark.parametrize("value", ["free", 0.25, 0, 1])
def test_unknown_fields_take_a_word_or_a_weight(value):
    values = {"path": "m", "start": None, "target": None, "free_weight": 0.5, "unknown": value}
    assert typed(import_module("gapath.mapio.rosmap").Reader, values, "map").unknown == value


def test_public_maps():
    names = (
        "ros/turtlebot3/map.yaml",
        "ros/nav2/depot.yaml",
        "movingai/dao/arena.map",
        "ros/nav2/depot.pgm",
    )
    if not (DATA / names[0]).exists():
        pytest.skip(f"no maps in {DATA}")
    shapes = [read(DATA / name).weights.shape for name in names]
    assert shapes == [(384, 384), (307, 604), (49, 49), (307, 604)]

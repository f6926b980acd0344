import os
from dataclasses import fields
from importlib import import_module, resources
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

from gapath.api import load_map
from gapath.commands import run as cli
from gapath.components import build, typed
from gapath.discovery import readers, yaml_values
from gapath.errors import InputError
from gapath.mapio.file import Reader
from gapath.tasks.drive import read_known_map

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
    message, shown = str(caught.value), name or "''"
    assert message.startswith(f"map.path: got {shown}, expected a file name ending in ")
    assert all(suffix in message for suffix in (".map", ".png", ".yaml", ".yml"))


@pytest.mark.parametrize("name", ["map.pgm", "A/MAP.PGM"])
def test_a_pgm_is_not_read_unasked(tmp_path, name):
    """Without its YAML, free floor would be taken for obstacles and walls for floor."""
    for asked in (lambda: read(name), lambda: load_map(name), lambda: read_known_map(name)):
        with pytest.raises(InputError, match=r"got .*, expected the YAML file .* or map=image"):
            asked()
    path = tmp_path / "map.pgm"
    path.write_bytes(b"P5 2 1 255\n\0\xff")
    assert load_map("image", path=str(path)).weights.tolist() == [[0.0, 1.0]]


@pytest.mark.parametrize("ending", ["jpg", "jpeg", "gif", "bmp", "tif", "webp", "pbm"])
def test_other_pictures_are_refused_with_the_endings_that_are_read(ending):
    for asked in (read, load_map):
        with pytest.raises(InputError, match=r"expected a file name ending in .*\.png"):
            asked(f"photo.{ending}")


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


@pytest.mark.parametrize(
    ("group", "name", "setting", "others"),
    [
        ("map", "file", "unknown", "map=rosmap"),
        ("map", "file", "invert", "map=image"),
        ("map", "asciigrid", "scenario", "map=barn or map=movingai"),
        ("map", "rosmap", "inflation", "map=barn"),
        ("planner", "astar", "ga2_profile", "planner=visibility_ga or planner=visibility_ga_c"),
    ],
)
def test_a_setting_of_another_kind_is_named(group, name, setting, others, monkeypatch, capfd):
    values = yaml_values(group, name) | {setting: 1}
    with pytest.raises(InputError) as caught:
        build(group, values, group)
    assert f"{group}.{setting}: got an unknown name, expected one of" in str(caught.value)
    assert f"; it is a setting of {others}" in str(caught.value)
    monkeypatch.setattr("sys.argv", ["gapath", f"{group}={name}", f"{group}.{setting}=1"])
    with pytest.raises(SystemExit) as stop:
        cli.main()
    assert stop.value.code == 2
    line = f"gapath: {group}.{setting}: got an unknown name with this {group}, expected {others}"
    assert capfd.readouterr().err.startswith(line)


def test_a_setting_that_no_kind_has_is_refused_as_before():
    with pytest.raises(InputError, match=r"map\.colour: got an unknown name, expected one of .*t$"):
        build("map", yaml_values("map", "file") | {"colour": 1}, "map")


def test_public_maps():
    names = (
        "ros/turtlebot3/map.yaml",
        "ros/nav2/depot.yaml",
        "movingai/dao/arena.map",
    )
    if not (DATA / names[0]).exists():
        pytest.skip(f"no maps in {DATA}")
    shapes = [read(DATA / name).weights.shape for name in names]
    assert shapes == [(384, 384), (307, 604), (49, 49)]

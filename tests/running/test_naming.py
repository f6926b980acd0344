"""What maps and methods are called in tables."""

import pytest

from gapath.components import build
from gapath.discovery import yaml_values
from gapath.running.naming import Method, map_name, method_of
from gapath.tasks import drive as driving


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        ("world", {"kind": "barn", "path": "a/world.json"}, "world"),
        ("world", {"kind": "barn", "path": "world.json", "inflation": 1}, "world[inflation=1]"),
        ("map", {"kind": "rosmap", "path": "a/office/map.yaml"}, "office"),
        ("map", {"kind": "rosmap", "path": "map.yaml"}, "map"),
        ("map", {"kind": "rosmap", "path": "../map.yaml"}, "map"),
        ("hall", {"kind": "rosmap", "path": "office/hall.yaml"}, "hall"),
        ("map", {"kind": "rosmap", "path": "office/map.yaml", "unknown": "free", "free_weight": 0},
         "office[free_weight=0,unknown=free]"),
        ("arena", {"kind": "movingai", "path": "arena.map", "scenario": "a.scen", "problem": 3},
         "arena"),
        ("kg18_test3", yaml_values("map", "kg18_test3") | {"instance": 4}, "kg18_test3"),
        ("map", {"kind": "file", "path": "office/map.yaml", "start": [0, 0]}, "office"),
    ],
)  # fmt: skip
def test_maps_that_differ_are_called_otherwise(name, values, expected):
    kind = values["kind"]
    usual = {} if kind == "reconstructed" else yaml_values("map", kind)
    assert map_name(name, usual | values) == expected


@pytest.mark.parametrize(
    ("yaml", "values", "expected"),
    [
        ("m22_scene03", {}, "m22_scene03"),
        ("m22_scene03", {"obstacles": 20}, "m22_scene03[obstacles=20]"),
        ("m22_scene03", {"number": 15, "width": 400}, "m22_scene15[width=400]"),
        ("kg18_test3", {"instance": 5}, "kg18_test3"),  # tables have a column for it
        ("s04_sp07", {}, "s04_sp07"),
        ("field_rooms", {"height": 50, "instance": 2}, "field_rooms[height=50]"),
    ],
)
def test_drawn_maps_that_differ_are_called_otherwise(yaml, values, expected):
    settings = yaml_values("map", yaml) | values
    grid = build("map", settings, "map").read()
    assert map_name(grid.name, settings) == expected


def test_what_is_known_beforehand_is_named_by_its_folder():
    drive = {"known_map": "office_without_rooms/map.yaml"}
    config = {"task": "drive", "navigator": yaml_values("navigator", "kg18"), "drive": drive}
    method = method_of(driving.Task, config | {"corner_cutting": "allow"}, {"navigator": "kg18"})
    name = method.name
    assert name == "kg18[known_map=office_without_rooms]"


def test_a_value_is_spelt_as_in_tables_and_yaml():
    changes = {"planner.repair": None, "planner.informed": True, "planner.share": 0.5}
    assert Method("ga3", changes).name == "ga3[informed=true,repair=null,share=0.5]"


@pytest.mark.parametrize(
    ("sides", "expected"),
    [
        ([10, 20, 40], "sedighi"),
        ([10], "sedighi[subsections[1]=none,subsections[2]=none]"),
        ([10, 20, 40, 80], "sedighi[subsections[3]=80]"),
        ([10, 15], "sedighi[subsections[1]=15,subsections[2]=none]"),
    ],
)
def test_a_list_that_is_shorter_is_another(sides, expected):
    navigator = yaml_values("navigator", "sedighi") | {"subsections": sides}
    config = {"task": "drive", "navigator": navigator, "drive": {"known_map": None}}
    config |= {"corner_cutting": "allow"}
    assert method_of(driving.Task, config, {"navigator": "sedighi"}).name == expected

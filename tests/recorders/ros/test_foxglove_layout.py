"""The layout for Foxglove asks for topics and fields that logs have."""

import json
from pathlib import Path

from log_events import example, example_drives, write
from rosbags.rosbag2 import Reader

from gapath.commands import log as log_cli
from gapath.recorders.mcap.format import TYPES

LAYOUT = json.loads((Path(__file__).parents[3] / "examples" / "foxglove.json").read_text())
PANELS = LAYOUT["configById"]


def panels(node):
    """Name the panels of a layout, which is a tree."""
    return {node} if isinstance(node, str) else panels(node["first"]) | panels(node["second"])


def test_every_panel_has_its_place():
    assert panels(LAYOUT["layout"]) == set(PANELS)


def test_what_it_shows_is_there(tmp_path):
    types = {}
    for name, events in (("plan", example()), ("drive", example_drives())):
        folder = tmp_path / name
        folder.mkdir()
        bag = folder / "bag"
        assert log_cli.main(["bag", str(write(events, folder)), str(bag)]) == 0
        for place in (folder, bag):
            with Reader(place) as reader:
                types |= {each.topic: each.msgtype for each in reader.connections}
    assert set(PANELS["3D!map"]["topics"]) <= types.keys()
    assert PANELS["RosOut!log"]["topicToRender"] in types
    plots = [panel for name, panel in PANELS.items() if name.startswith("Plot!")]
    assert len(plots) == 3
    for value in (path["value"] for plot in plots for path in plot["paths"]):
        topic, _, field = value.removesuffix("[:]").partition(".")
        fields = dict(TYPES.fielddefs[types[topic]][1])
        assert field in fields, value
        assert (fields[field][0].name == "SEQUENCE") == value.endswith("[:]")

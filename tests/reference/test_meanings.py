"""Every setting has meaning, unit, range and source, and they are those that checks go by."""

import re
import subprocess
import sys

import pytest

from gapath.components import build
from gapath.discovery import kinds, yaml_names, yaml_values
from gapath.errors import InputError
from gapath.reference.settings import (
    CHOSEN,
    Remarks,
    class_of,
    preset,
    presets,
    remarks,
    root,
    source_of,
)

PRESETS = [root(), *(each for group in CHOSEN for each in presets(group))]
TITLED = ("map.map_class", "map.drawing")
"""What a YAML is called by: its title says what that is."""

SOURCE = re.compile(r"((KG18|S04|M22) (Secs?|Table|Figs?|eq)\.? [(\w.)]+)?(, )?(assumed)?|gapath")


@pytest.mark.parametrize("preset", PRESETS, ids=lambda each: f"{each.group}={each.name}")
def test_every_setting_is_explained(preset):
    assert preset.about
    for setting in preset.settings:
        assert setting.meaning, setting.name
        assert setting.range, setting.name
        assert setting.remark or setting.name in TITLED, setting.name
        assert SOURCE.fullmatch(setting.source), (setting.name, setting.source)
        numeric = re.search("int|float", setting.type)
        assert bool(setting.unit) == bool(numeric), (setting.name, setting.unit)


def test_no_setting_is_left_out():
    for group in CHOSEN:
        told = {each.kind for each in presets(group)}
        assert told == set(kinds(group))
        for name in yaml_names(group):
            prefix = f"{group}.{name}" if group == "recorder" else group
            names = {setting.name for setting in preset(group, name).settings}
            given = yaml_values(group, name).keys() - {"kind"}
            assert names == {f"{prefix}.{key}" for key in given}
    names = {setting.name for setting in root().settings}
    assert {"seed", "drive.sensor.range", "scenario.drawn", "search.objective"} <= names


WHOLE = re.compile(r"an integer from (\d+) to (\d+)$")
BOUNDED = sorted(
    {
        (each.group, each.name, setting.name.rpartition(".")[2])
        for each in PRESETS
        for setting in each.settings
        if each.group and WHOLE.match(setting.range) and each.name == each.kind
    }
)


@pytest.mark.parametrize(("group", "name", "setting"), BOUNDED)
def test_a_range_is_the_one_that_is_checked(group, name, setting):
    told = next(s for s in preset(group, name).settings if s.name.endswith(f".{setting}"))
    least, most = map(int, WHOLE.match(told.range).groups())
    for outside in (least - 1, most + 1):
        values = yaml_values(group, name) | {setting: outside}
        values |= {"path": "world.json"} if "path" in values else {}
        with pytest.raises(InputError) as caught:
            build(group, values, group)
        assert caught.value.expected == told.range


def test_ranges_of_many_kinds_are_read():
    assert len(BOUNDED) > 10
    ranges = {(each.name, s.name): s.range for each in PRESETS for s in each.settings}
    assert ranges["ga3", "planner.min_epochs"] == "an integer from 1 to max_epochs"
    assert ranges["ga3", "planner.mixing"] == "a number in [0, 1]"
    assert ranges["memetic", "planner.hands"] == "one of left, right, both"
    assert ranges["visibility_ga", "planner.element"] == '"reach" or "width"'  # of a base
    assert ranges["jps", "planner.minimise"] == '"weights" or "length"'
    assert ranges["kg18_test3", "map.map_class"].startswith("one of kg18_test1, kg18_test2")
    assert ranges["config", "drive.sensor.occlusion"] == "true or false"
    assert ranges["config", "seed"] == "an integer in [0, 2^64)"


def test_comments_are_read_as_they_stand():
    text = "# @package x\n# What\n# it is.\na: 1 # one # two\n  # more\nb:\n  c: x  # in b\n"
    assert remarks(text) == Remarks("What it is.", {"a": "one # two more", "b.c": "in b"})


def test_a_source_is_a_place_or_an_assumption():
    about = "The planner of KG18, Sec. 3."
    assert source_of("Sec. 3.3; 40 in Table 1", about) == "KG18 Sec. 3.3"
    assert source_of("assumed; Sec. 3.3, part 1", about) == "KG18 Sec. 3.3, assumed"
    assert source_of("as in S04 Table 1", about) == "S04 Table 1"
    assert source_of("folder of the run folders", about) == "gapath"
    assert source_of("", about) == "KG18 Sec. 3"


def test_settings_of_a_preset_are_those_of_the_yaml_it_stands_on_but_its_own():
    own = {s.name: s for s in preset("planner", "visibility_ga_corners").settings}
    base = {s.name: s for s in preset("planner", "visibility_ga").settings}
    assert (base["planner.genes"].value, own["planner.genes"].value) == ("obstacles", 4)
    assert own["planner.genes"].source == "assumed"
    assert own["planner.population"] == base["planner.population"]


def test_nothing_is_compiled_or_imported_for_it():
    code = (
        "import sys; from gapath.reference.settings import *; presets('planner'); root();"
        "print({'numba', 'hydra', 'pandas', 'numpy'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"


def test_a_class_tells_what_it_is():
    assert class_of("planner", "bspline_ga").said.startswith("KG18's planner")

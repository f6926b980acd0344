"""``gapath --help``, ``help``, lists of names, and commands as words of one."""

import subprocess
import sys

import numpy as np
import pytest

from gapath import __main__ as started
from gapath.commands.told import picture, screen
from gapath.commands.told.topics import _all_words, chosen, listed, topic
from gapath.discovery import yaml_names
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.recorders.mcap.format import TOPICS
from gapath.reference.columns import all_columns
from gapath.reference.settings import CHOSEN, presets, root


@pytest.fixture
def command(monkeypatch, capfd):
    """Runs ``gapath`` as it is started: its exit code, and what it wrote."""

    def run(*words):
        monkeypatch.setattr("sys.argv", ["gapath", *words])
        monkeypatch.setattr(started, "_begun", lambda *given: pytest.MonkeyPatch.context())
        code = started.main()
        return code, *capfd.readouterr()

    return run


@pytest.mark.parametrize("words", [["--help"], ["-h"], ["planner=ga1", "--help"], ["-m", "-h"]])
def test_help_is_one_screen(command, words):
    code, text, errors = command(*words)
    assert (code, errors) == (0, "")
    lines = text.splitlines()
    assert 24 <= len(lines) <= 30
    assert max(map(len, lines)) <= 80


def test_the_screen_names_every_word():
    words = {*screen.WORDS} - {"--help"} | {*started._COMMANDS}
    assert [
        word for word in words if f"gapath {word}" not in screen.SCREEN.replace("| ", "gapath ")
    ] == []
    assert {*started._TOLD, "--help"} == {*screen.WORDS}


def test_a_setting_is_told_for_all_that_have_it(command):
    code, text, _ = command("help", "planner.population")
    assert code == 0
    told = [part.partition(":")[0] for part in text.split("\n\n")]
    kinds = {each.kind for each in presets("planner")
             if any(s.name == "planner.population" for s in each.settings)}  # fmt: skip
    assert told == [f"planner.population of {kind}" for kind in dict.fromkeys(
        each.kind for each in presets("planner") if each.kind in kinds)]  # fmt: skip
    assert "100 in ga2, ga3" in text
    assert "individuals; an integer from 4 to 1000000" in text
    assert "KG18 Sec. 3.3; 40 and 100 in Table 1" in text


def test_a_name_is_told_with_all_of_its_settings():
    text = topic("ga3")
    assert text.startswith('planner=ga3: "GA 3" of KG18\'s Table 1.')
    for setting in chosen_settings("planner", "ga3"):
        assert f"  {setting.name} = " in text
    assert topic("planner=ga3") == text


def chosen_settings(group, name):
    return next(each for each in presets(group) if each.name == name).settings


def test_every_word_has_something_to_say():
    for setting in root().settings:
        assert topic(setting.name).startswith(setting.name)
    for group in CHOSEN:
        assert all(name in topic(group) for name in yaml_names(group))
        for name in yaml_names(group):
            assert topic(name)
    assert "drive.sensor.range = 4" in topic("drive")
    for name in {*all_columns()} - {*_all_words()}:
        assert topic(name).startswith(f"{name}, a column of trials.parquet\n      ")
    for name in TOPICS:
        assert topic(name).startswith(f"{name}, messages of run.mcap: {TOPICS[name]}")
    assert "fields: that a graph search expanded" in topic("expansions")
    assert topic("table1").startswith("experiment=table1: KG18 Table 1")


@pytest.mark.parametrize(
    ("words", "near"),
    [
        (["help", "populaton"], "planner.population"),
        (["help", "ga33"], "ga3"),
        (["help", "planner=ga33"], "ga3"),
        (["maps", "kg18_tst4"], "kg18_test4"),
        (["planners", "dijkstr"], "dijkstra"),
        (["navigators", "ga3"], "such as"),
    ],
)
def test_an_unknown_word_is_one_line(command, words, near):
    code, text, errors = command(*words)
    assert (code, text) == (2, "")
    assert len(errors.splitlines()) == 1
    assert errors.startswith("gapath: ")
    assert near in errors


@pytest.mark.parametrize("group", ["map", "planner", "navigator"])
def test_lists_have_a_line_each(command, group):
    code, text, _ = command(f"{group}s")
    lines = text.splitlines()
    assert code == 0
    assert [line.split()[0] for line in lines] == yaml_names(group)
    assert all(len(line.split()) > 2 for line in lines)


def test_lists_fit_a_terminal(monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "60")
    lines = listed("map").splitlines()
    assert len(lines) == len(yaml_names("map"))
    assert max(map(len, lines)) <= 60


def test_a_map_is_told_and_drawn(monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    text = picture.pictured("kg18_test4")
    for fact in ("100 x 50 fields", "(0, 24)", "(98, 24)", "reconstructed", "kg18_test4"):
        assert fact in text
    lines = text.splitlines()
    assert max(map(len, lines[lines.index("") + 6 :])) <= 60
    assert "needs" not in text and "map.path names" in picture.pictured("rosmap")


def test_a_picture_has_every_obstacle():
    weights = np.full((3, 4), 0.5)
    weights[0, 1] = weights[1, 2] = weights[0, 3] = weights[1, 3] = 1.0
    grid = GridMap("drawn", weights, start=(0, 2), target=(0, 0))
    text, side = picture.drawn(grid, 6)
    assert (text, side) == ("+----+\n|T▀▄█|\n|S   |\n+----+", 1)
    small, side = picture.drawn(grid, 4)
    assert (small.splitlines()[1], side) == ("|T▀|", 2)


@pytest.mark.parametrize(("word", "name"), [("log", "log"), ("report", "report")])
def test_other_commands_are_words(command, monkeypatch, word, name):
    given = []
    monkeypatch.setitem(started._COMMANDS, name, lambda: given.append(sys.argv) or 7)
    assert command(word, "info", "--help")[0] == 7
    assert given == [["gapath", "info", "--help"]]


def test_run_is_the_plain_command(command, monkeypatch):
    given = []
    monkeypatch.setattr(started, "_run", lambda: given.append(sys.argv))
    command("run", "map=kg18_test3")
    command("map=kg18_test3")
    assert given == 2 * [["gapath", "map=kg18_test3"]]


def test_nothing_slow_is_imported():
    code = (
        "import sys, gapath.__main__ as m;"
        "sys.argv = ['gapath', 'help', 'ga3']; m.main();"
        "sys.argv = ['gapath', 'maps']; m.main();"
        "print({'numba', 'hydra', 'pandas', 'numpy'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "set()"


def test_a_wrong_name_of_a_group_is_refused():
    with pytest.raises(InputError, match="planner: got ga9"):
        chosen("planner", "ga9")

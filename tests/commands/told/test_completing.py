"""Tab completion: what it offers, and that a shell gets it soon."""

import os
import subprocess
import sys

import pytest

from gapath import __main__ as started
from gapath.commands import log as log_cli
from gapath.commands.told.completing import OTHER, completions
from gapath.discovery import kinds, yaml_names


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("gapath task=", [f"task={name}" for name in kinds("task")]),
        ("gapath map=", [f"map={name}" for name in yaml_names("map")]),
        ("gapath -m planner=ga1,ga", [f"planner=ga1,ga{number}" for number in (1, 2, 3)]),
        ("gapath planner.sam", ["planner.sampling="]),
        ("gapath planner=memetic planner.ha", ["planner.hands="]),
        ("gapath planner=memetic planner.sam", []),
        ("gapath ++planner.sam", ["++planner.sampling="]),
        ("gapath planner.sampling=", ["planner.sampling=curve", "planner.sampling=span"]),
        ("gapath planner=memetic planner.hands=l", ["planner.hands=left"]),
        ("gapath dri", ["drive."]),
        ("gapath drive.sensor.r", ["drive.sensor.range="]),
        ("gapath force=", ["force=false", "force=true"]),
        ("gapath recorder=[none] recorder.", []),
        ("gapath hydra/launcher=j", ["hydra/launcher=joblib"]),
        ("gapath pla", ["planner.", "planner=", "planners"]),
        ("gapath seed=1 pla", ["planner.", "planner="]),
        ("gapath help planner.pop", ["planner.population"]),
        ("gapath help ga", ["ga1", "ga2", "ga3"]),
        ("gapath planners ast", ["astar", "astar_length"]),
        ("gapath log v", ["verify", "view"]),
        ("gapath log info ", []),
    ],
)
def test_a_word_is_completed(line, expected):
    assert completions(line) == expected


def test_files_are_completed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "floors").mkdir()
    (tmp_path / "floors" / "office.yaml").touch()
    assert completions("gapath map=file map.path=fl") == ["map.path=floors/"]
    found = ["map.path=floors/office.yaml"]
    assert completions("gapath map=file map.path=floors/") == found
    assert completions("gapath map=file map.path=nowhere/") == []


def test_every_word_of_another_command_is_one():
    assert {*OTHER} == {*started._COMMANDS}
    (commands,) = log_cli._parser()._subparsers._group_actions
    assert OTHER["log"].split() == [*commands.choices]


def test_a_shell_is_answered_without_hydra_and_soon():
    line = "gapath planner=memetic planner."
    code = (
        "import sys; sys.argv = ['gapath', '-sc', 'query=bash'];"
        "import gapath.__main__ as m; m.main();"
        "print({'numba', 'hydra', 'numpy'} & set(sys.modules))"
    )
    environment = {**os.environ, "COMP_LINE": f"{line}xyz", "COMP_POINT": str(len(line))}
    before = os.times().children_user
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True,
                          env=environment)  # fmt: skip
    offered, modules = done.stdout.splitlines()
    assert "planner.hands=" in offered.split()
    assert modules == "set()"
    assert os.times().children_user - before < 0.5

"""Experiments on public maps: what they need, and that their problems follow the stated rules."""

import re
import shutil
import subprocess
from dataclasses import fields
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf
from skimage.measure import label

from gapath.discovery import yaml_values
from gapath.mapio.movingai import read_scenario
from gapath.mapio.rosmap import Reader
from gapath.pipelines.report.report import make_report
from gapath.problem import Problem
from gapath.running.config import conf_folder
from gapath.survey.obstacle_image import Clearance, dilate

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "conf" / "experiment"
UNSEEN = sorted(
    path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.glob("unseen/*/*.yaml")
)


def of(family):
    names = [name for name in UNSEEN if name.startswith(f"unseen/{family}/")]
    assert names
    return pytest.mark.parametrize("experiment", names)


def composed(experiment):
    """Its settings, resolved, and what it sweeps over."""
    with initialize_config_dir(conf_folder(), version_base="1.3"):
        given = [f"experiment={experiment}"]
        config = compose("config", overrides=given, return_hydra_config=True)
        params = OmegaConf.to_container(config.hydra.sweeper.params, resolve=True)
        OmegaConf.set_struct(config, False)
        del config["hydra"]
        return OmegaConf.to_container(config, resolve=True), params


@of("movingai")
def test_ten_problems_are_spread_over_the_rows(data, monkeypatch, experiment):
    monkeypatch.setenv("GAPATH_DATA", str(data))
    settings, params = composed(experiment)
    rows = len(read_scenario(settings["map"]["scenario"]))
    first, end, step = map(int, re.findall(r"\d+", params["map.problem"]))
    assert (first, end, step) == (rows // 10 // 2, rows, rows // 10)
    assert len(range(first, end, step)) == 10
    assert Path(settings["map"]["path"]).stem in Path(settings["map"]["scenario"]).name
    assert Path(settings["map"]["path"]).is_file()


@of("pictures")
def test_ends_are_those_drawn(data, monkeypatch, experiment):
    monkeypatch.setenv("GAPATH_DATA", str(data))
    settings, params = composed(experiment)
    values = settings["map"]
    grid = Reader(values["path"], None, None, values["free_weight"], values["unknown"]).read()
    starts, targets = (
        [(int(x), int(y)) for x, y in re.findall(r"\[(\d+),(\d+)\]", params[f"map.{name}"])]
        for name in ("start", "target")
    )
    known = yaml_values("planner", "inflated_astar") | settings["planner"]
    clearance = Clearance(**{each.name: known[each.name] for each in fields(Clearance)})
    growth = clearance.growth(Problem(grid, starts[0], targets[0]))
    regions = label(~dilate(grid.obstacles, growth), connectivity=2)
    rows, cols = np.nonzero(regions == np.bincount(regions[regions > 0]).argmax())
    drawn = np.random.SFC64(0).random_raw(5) % len(rows)
    assert [*starts, *targets] == [(cols[i], rows[i]) for i in drawn]
    assert (len(starts), len(targets)) == (2, 3)


def test_every_grid_is_there_once(data, monkeypatch):
    monkeypatch.setenv("GAPATH_DATA", str(data))
    texts = {path.read_text().strip() for path in data.glob("tulsa/*.txt")}
    for experiment in ("unseen/tulsa/astar", "unseen/tulsa/genotypes"):
        _, params = composed(experiment)
        paths = params["map.path"].replace("${oc.env:GAPATH_DATA}", str(data)).split(", ")
        assert len(paths) == len(texts)
        assert {Path(path).read_text().strip() for path in paths} == texts


@pytest.mark.parametrize(
    "experiment", ["unseen/movingai/arena", "unseen/pictures/depot", "unseen/tulsa/astar"]
)
def test_without_the_data_one_line_names_the_variable(gapath, tmp_path, monkeypatch, experiment):
    monkeypatch.delenv("GAPATH_DATA", raising=False)
    code, text, errors = gapath(f"experiment={experiment}")
    assert (code, text) == (2, "")
    (line,) = errors.splitlines()
    assert line.startswith("gapath: map.path: got ") and "'GAPATH_DATA' not found" in line
    assert "environment variables that are set" in line
    assert list(tmp_path.iterdir()) == []


def test_experiments_make_the_section(data, gapath, tmp_path, monkeypatch):
    monkeypatch.setenv("GAPATH_DATA", str(data))
    ends = "map.start=[187,163]", "map.target=[187,206]"
    grid = "map.path=${oc.env:GAPATH_DATA}/tulsa/Kamran08.txt"
    for experiment, *given in (
        ("movingai/arena", "map.problem=8,24", "planner=ga3,astar_length"),
        ("pictures/turtlebot3", *ends, "planner=inflated_astar"),
        ("tulsa/genotypes", grid, "planner=sedighi"),
        ("tulsa/astar", grid),
    ):
        code, _, errors = gapath(f"experiment=unseen/{experiment}", *given, "trials=2")
        assert (code, errors) == (0, "")
    make_report(tmp_path / "out", tmp_path / "report")
    rows = pd.read_csv(tmp_path / "report" / "unseen.csv")
    assert list(zip(rows["family"], rows["method"], rows["problems"], rows["n"], strict=True)) == [
        ("MovingAI", "ga3", 2, 4),
        ("MovingAI", "astar_length", 2, 4),
        ("Tulsa", "sedighi", 1, 2),
        ("Tulsa", "astar", 1, 2),
        ("pictures of floors", "inflated_astar", 1, 2),
    ]
    page = (tmp_path / "report" / "index.html").read_text()
    assert "Other trials" not in page
    # one line for four jobs, here and with the metrics
    assert page.count("experiment=unseen/movingai/arena") == 2


@pytest.mark.skipif(shutil.which("make") is None, reason="no make")
def test_only_make_unseen_does_them():
    def recipe(target):
        said = subprocess.run(["make", "-n", target], cwd=ROOT, capture_output=True, text=True)
        assert said.returncode == 0, said.stderr
        return said.stdout

    assert re.findall(r"unseen/[\w/-]+", recipe("unseen")) == UNSEEN
    assert "unseen" not in recipe("paper")

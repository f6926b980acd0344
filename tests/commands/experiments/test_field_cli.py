"""Experiments on many problems a map: what they need is there, what their comments say is so."""

import re
from pathlib import Path

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from gapath.mapio.movingai import read_scenario
from gapath.running.config import conf_folder

FOLDER = Path(__file__).parents[3] / "conf" / "experiment"
FIELD = sorted(
    path.relative_to(FOLDER).with_suffix("").as_posix() for path in FOLDER.glob("field/*/*.yaml")
)


def composed(experiment):
    """Its settings, resolved, and what it sweeps over."""
    with initialize_config_dir(conf_folder(), version_base="1.3"):
        given = [f"experiment={experiment}"]
        if experiment in FIELD and "movingai" not in experiment and "large" not in experiment:
            given.append("map.path=x")
        config = compose("config", overrides=given, return_hydra_config=True)
        params = OmegaConf.to_container(config.hydra.sweeper.params, resolve=True)
        OmegaConf.set_struct(config, False)
        del config["hydra"]
        return OmegaConf.to_container(config, resolve=True), params


@pytest.mark.parametrize("experiment", ["field", *FIELD])
def test_all_of_them_are_one_experiment_of_the_same_task(data, monkeypatch, experiment):
    monkeypatch.setenv("GAPATH_DATA", str(data))
    settings, params = composed(experiment)
    assert (settings["name"], settings["task"]) == ("field", "scenario")
    assert set(settings["recorder"]) == {"none"}
    assert "astar" in params["planner"].split(",")
    paths = params.get("map.path", settings["map"].get("path", ""))
    for path in filter(None, re.split(r", *", paths)):
        assert Path(path.replace("${oc.env:GAPATH_DATA}", str(data))).is_file()


@pytest.mark.parametrize("experiment", [name for name in FIELD if "/movingai/" in name])
def test_the_number_of_problems_is_what_the_comment_says(data, monkeypatch, experiment):
    monkeypatch.setenv("GAPATH_DATA", str(data))
    settings, _ = composed(experiment)
    said = (FOLDER / f"{experiment}.yaml").read_text().splitlines()[1]
    rows = len(read_scenario(settings["map"]["scenario"]))
    assert int(re.search(r"(\d+) problems", said)[1]) == rows
    assert settings["scenario"]["every"] == (10 if "Every tenth" in said else 1)
    assert Path(settings["map"]["path"]).stem in Path(settings["map"]["scenario"]).name


def test_without_the_data_one_line_names_the_variable(gapath, tmp_path, monkeypatch):
    monkeypatch.delenv("GAPATH_DATA", raising=False)
    code, text, errors = gapath("experiment=field/movingai/arena")
    assert (code, text) == (2, "")
    (line,) = errors.splitlines()
    assert "'GAPATH_DATA' not found" in line and list(tmp_path.iterdir()) == []


def test_the_one_that_needs_no_data_asks_every_problem(gapath, tmp_path):
    code, text, errors = gapath("experiment=field", "planner=astar", "scenario.drawn=4")
    assert (code, errors) == (0, "")
    lines = text.splitlines()
    assert len(lines) == 5 and all(": 4 of 4 found, 4 problems" in line for line in lines)

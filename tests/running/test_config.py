"""What a command line comes to: one value, one key."""

import pytest
from hydra import compose, initialize_config_dir
from omegaconf import OmegaConf

from gapath.running.config import conf_folder, make_run
from gapath.store.keys import run_key
from gapath.store.settings import text_of


def run_of(*overrides):
    with initialize_config_dir(conf_folder(), version_base="1.3"):
        config = compose("config", overrides=list(overrides), return_hydra_config=True)
    choices = dict(config.hydra.runtime.choices)
    OmegaConf.set_struct(config, False)
    del config["hydra"]
    return make_run(config, choices)


@pytest.mark.parametrize(
    ("first", "second"),
    [
        (["map=image", "map.path=m.png", "map.start=[0,0]", "map.target=[1,1]"],
         ["map=image", "map.path=m.png", 'map.start=["0",0.0]', "map.target=[1,'1']"]),
        (["map.instance=3"], ["map.instance='3'"]),
        (["planner=visibility_ga", "planner.genes=4", "planner.threshold=1"],
         ["planner=visibility_ga", "planner.genes='4'", "planner.threshold='1.0'"]),
        (["planner.population=120", "seed=7"], ["planner.population='120'", "seed=7.0"]),
        (["planner.vln=1000"], ["planner.vln=1000.0"]),
        (["planner=ga3"], ["planner.population=100.0", "planner.control_points='5'"]),
        (["recorder.rerun.trials=[0]"], ["recorder.rerun.trials=[0.0]"]),
        (["task=drive"],
         ["task=drive", "drive.sensor.range='4'", "drive.changes.every=0.0", "trials=1.0"]),
        (["task=drive", "drive.step_limit=2000"],
         ["task=drive", "navigator.explore.population='40'", "navigator.return_penalty=0",
          "drive.step_limit='2000'"]),
        (["task=drive", "navigator=sedighi"],
         ["task=drive", "navigator=sedighi", "navigator.planner.max_epochs='100'"]),
        (["planner=inflated_ga3"], ["planner=inflated_ga3", "planner.robot_radius=5.0"]),
        (["planner=visibility_ga", "planner.radius_tolerance=0"],
         ["planner=visibility_ga", "planner.radius_tolerance=-0.0"]),
        (["planner=visibility_ga", "planner.radius_tolerance=0"],
         ["planner=visibility_ga", "planner.radius_tolerance='-0'"]),
        (["map=movingai", "map.path=m.map", "map.free_weight=0", "map.start=[0,0]",
          "map.target=[1,1]"],
         ["map=movingai", "map.path=m.map", "map.free_weight=-0.0", "map.start=[-0.0,0]",
          "map.target=[1,1]"]),
        (["task=drive"], ["task=drive", "navigator.return_penalty=-0.0"]),
    ],
)  # fmt: skip
def test_one_value_has_one_key(first, second, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "m.png").write_bytes(grey())
    (tmp_path / "m.map").write_text("type octile\nheight 2\nwidth 2\nmap\n..\n..\n")
    one, other = run_of(*first), run_of(*second)
    assert text_of(one.settings) == text_of(other.settings)
    assert one.method == other.method
    keys = {run_key(run.settings, run.problem, {}) for run in (one, other)}
    assert len(keys) == 1


def grey():
    import io

    import numpy as np
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.full((2, 2), 128, dtype=np.uint8)).save(file, "PNG")
    return file.getvalue()


def test_a_planner_among_settings_keeps_its_name(tmp_path):
    run = run_of("task=drive", "navigator.retreat.population='77'")
    assert run.method.name == "kg18[retreat.population=77]"
    assert run.settings["navigator.retreat.population"] == 77
    assert run.settings["navigator.retreat.kind"] == "bspline_ga"

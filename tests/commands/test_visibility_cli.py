"""M22's planners through the command: photographs, robots that do not fit, bad pictures."""

import json

import numpy as np
import pyarrow.parquet as pq
import pytest
from PIL import Image

from gapath.api import load_map
from gapath.commands import run as cli
from gapath.recorders import mcap
from gapath.survey.obstacle_image import dilate


def row_of(tmp_path):
    (path,) = tmp_path.glob("out/plan/*/trials.parquet")
    return pq.read_table(path).to_pylist()[0]


ENDS = ["map.start=[5,95]", "map.target=[194,30]"]


def photograph(folder, name="room.png"):
    """Light obstacles on a dark floor, neither of one shade; true where they are."""
    random = np.random.default_rng(3)
    light = np.zeros((120, 200), dtype=np.bool_)
    y, x = np.ogrid[:120, :200]
    for u, v, radius in [(60, 70, 12), (110, 40, 14), (150, 80, 10)]:
        light |= (x - u) ** 2 + (y - v) ** 2 <= radius**2
    grey = np.where(light, 200, 60) + random.integers(-25, 26, light.shape)
    Image.fromarray(grey.astype(np.uint8)).save(folder / name)
    return light


@pytest.mark.parametrize("planner", ["visibility_ga", "visibility_ga_resized", "visibility_astar"])
def test_a_photograph_is_parted_by_otsus_method(gapath, tmp_path, planner):
    light = photograph(tmp_path)
    code, text, errors = gapath(
        "map=file", "map.path=room.png", *ENDS, f"planner={planner}", "planner.robot_radius=3"
    )
    assert (code, errors) == (0, "")
    assert "status        found" in text
    assert "fields in straight lines" in text
    row = row_of(tmp_path)
    assert row["feasible"] and row["map"] == "room"
    assert np.hypot(189, 65) <= row["line_length"] < 1.2 * np.hypot(189, 65)
    stages = json.loads(row["stage_times_s"])
    assert {"dilation", "keypoints", "graph"} < set(stages)
    (folder,) = (tmp_path / "out" / "plan").iterdir()
    assert (folder / "trial-0.rrd").is_file()

    # no map reader took the light ones for obstacles: the planner did
    assert not load_map(tmp_path / "room.png").obstacles.any()
    *_, finished, _ = mcap.read_events(folder / "run.mcap")
    grown = dilate(light, 4)
    assert not grown[finished.answer.path[:, 1], finished.answer.path[:, 0]].any()


def test_without_a_threshold_a_photograph_is_nothing_but_dear_floor(gapath, tmp_path):
    photograph(tmp_path)
    run = ["map=file", "map.path=room.png", *ENDS, "planner=visibility_astar"]
    assert gapath(*run, "planner.threshold=1.0")[0] == 0
    assert row_of(tmp_path)["line_length"] == pytest.approx(np.hypot(189, 65))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["map.start=[60,70]", "map.target=[194,30]"],
            "gapath: map.start: got [60, 70], within an obstacle grown by 6 pixels, expected a "
            "point where the robot fits; the nearest is [60, 51]\n",
        ),
        (
            ["map.start=[5,95]", "map.target=[127,40]"],
            "gapath: map.target: got [127, 40], within an obstacle grown by 6 pixels, expected a "
            "point where the robot fits; the nearest is [131, 40]\n",
        ),
        (
            [*ENDS, "planner.robot_radius=500"],
            "gapath: map.start: got [5, 95], within an obstacle grown by 550 pixels, expected a "
            "map with room for the robot; this one has none, or planner.robot_radius and "
            "planner.threshold that leave some\n",
        ),
        (
            [*ENDS, "planner.robot_radius=5000"],
            "gapath: planner.robot_radius: got 5000.0 pixels, 5500 pixels with its tolerance, "
            "expected at most 4096 pixels\n",
        ),
    ],
)
@pytest.mark.parametrize("planner", ["visibility_ga", "visibility_dijkstra", "inflated_astar"])
def test_a_robot_that_does_not_fit_is_one_clear_error(
    gapath, tmp_path, planner, arguments, message
):
    photograph(tmp_path)
    code, text, errors = gapath("map=file", "map.path=room.png", f"planner={planner}", *arguments)
    assert (code, text, errors) == (cli.BAD_INPUT, "", message)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["map.path=coloured.png"], "coloured.png, pixel (0, 0): got RGB [9, 0, 0]"),
        (["map.path=alpha.png"], "alpha.png: got an image with an alpha channel"),
        (["map.path=deep.png"], "deep.png: got 16 bits a sample"),
        (["map.path=huge.png"], "huge.png: got an image of 2147483647 x 2147483647 pixels"),
        (["map.path=cut.png"], "cut.png: got a damaged or truncated PNG"),
        (["map.path=room.png", "planner.threshold=dark"], "planner.threshold: got dark"),
        (["map.path=room.png", "planner.threshold=0"], "planner.threshold: got 0"),
        (["map.path=room.png", "planner.element=disc"], "planner.element: got disc"),
        (["map.path=room.png", "planner.robot_radius=-1"], "planner.robot_radius: got -1"),
        (["map.path=room.png", "planner.robot_radius=nan"], "planner.robot_radius: got nan"),
        (["map.path=room.png", "planner.robot_radius=wide"], "planner.robot_radius: got 'wide'"),
        (["map.path=room.png", "planner.genes=many"], "planner.genes: got many"),
        (["map.path=room.png", "planner.genes=2.5"], "planner.genes"),
        (["map.path=room.png", "planner.ga2_profile=v1"], "planner.ga2_profile: got v1"),
        (["map.path=room.png", "planner.max_stagnation=0"], "planner.max_stagnation: got 0"),
        (["map.path=room.png", "planner.push_out=maybe"], "planner.push_out"),
        (["map.path=dots.png", "planner.robot_radius=0"], "map: got 6480 keypoints, expected at"),
        (
            ["map.path=room.png", "planner.genes=1000", "planner.max_epochs=1000000"],
            "planner.max_epochs: got 1000000 with 1000 genes: 18.7 GiB",
        ),
    ],
)
def test_bad_input_is_one_clear_error(gapath, tmp_path, arguments, named):
    photograph(tmp_path)
    whole = (tmp_path / "room.png").read_bytes()
    size = (120, 200)
    Image.fromarray(np.full((*size, 3), (9, 0, 0), np.uint8)).save(tmp_path / "coloured.png")
    Image.fromarray(np.full((*size, 2), 90, np.uint8), "LA").save(tmp_path / "alpha.png")
    Image.fromarray(np.zeros(size, np.uint16)).save(tmp_path / "deep.png")
    (tmp_path / "huge.png").write_bytes(whole[:16] + b"\x7f\xff\xff\xff" * 2 + whole[24:])
    (tmp_path / "cut.png").write_bytes(whole[:3000])
    dots = np.zeros(size, np.uint8)
    dots[2:110:3, 1:135:3] = 255
    Image.fromarray(dots).save(tmp_path / "dots.png")
    code, text, errors = gapath("map=file", *ENDS, "planner=visibility_ga", *arguments)
    assert code == cli.BAD_INPUT
    assert named in errors
    assert errors.startswith("gapath: ") and "Traceback" not in errors
    assert text == ""
    assert not (tmp_path / "out").exists()

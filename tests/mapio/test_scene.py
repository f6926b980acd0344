"""Scenes of convex obstacles: frozen, and of the kind that M22 describes."""

from importlib.resources import as_file, files

import numpy as np
import pytest

from gapath.api import load_map
from gapath.errors import InputError
from gapath.kernels.lines import ONE_OBSTACLE, line_key
from gapath.kernels.units import ALLOW
from gapath.mapio import scene
from gapath.mapio.image import Reader as ImageReader
from gapath.planning.shortest_path import shortest_path
from gapath.problem import Problem
from gapath.survey.keypoints import label
from gapath.survey.obstacle_image import dilate

NUMBERS = range(1, 11)
GROWTH = 6
"""Of conf/planner/visibility_ga.yaml: 5 pixels and a tenth, rounded up."""


def reader(**values):
    return scene.Reader(**{"number": 1, "obstacles": 6, "width": 800, "height": 600, **values})


@pytest.mark.parametrize("number", NUMBERS)
def test_the_committed_picture_is_the_scene(number):
    drawn = load_map(f"m22_scene{number:02d}")
    with as_file(files("gapath.maps") / f"m22_scene{number:02d}.png") as path:
        read = ImageReader(str(path), None, None, invert=False).read()
    assert (read.obstacles == drawn.obstacles).all()
    assert set(np.unique(read.weights)) == {0.0, 1.0}
    assert set(np.unique(drawn.weights)) == {0.5, 1.0}
    assert (drawn.name, drawn.source) == (f"m22_scene{number:02d}", "reconstructed")
    assert (drawn.cols, drawn.rows) == (800, 600)


@pytest.mark.parametrize("number", [*NUMBERS, 11, 5000, 2**32 - 1])
def test_scenes_are_of_the_papers_kind(number):
    grid = reader(number=number).read()
    problem = Problem(grid, grid.start, grid.target)
    assert grid.start == (20, 579)
    assert grid.target[0] == 799 and 75 <= grid.target[1] <= 300
    assert label(grid.obstacles)[1] == 6
    grown = dilate(grid.obstacles, GROWTH)
    framed = np.pad(grown, 1, constant_values=True)
    assert label(framed)[1] == 6 + 1  # apart from one another and from the border
    assert not grown[grid.start[1], grid.start[0]]
    assert not grown[grid.target[1], grid.target[0]]
    assert line_key(grid.table, *grid.start, *grid.target, ALLOW) >= ONE_OBSTACLE
    assert shortest_path(problem).feasible


def test_scenes_differ():
    assert len({reader(number=number).read().digest for number in range(1, 31)}) == 30


def test_obstacles_are_convex():
    """Between any two pixels of an obstacle lie, but for rounding, pixels of it."""
    for number in NUMBERS:
        labels, count = label(reader(number=number).read().obstacles)
        for one in range(1, count + 1):
            pixels = np.argwhere(labels == one)
            pairs = np.random.default_rng(one).integers(0, len(pixels), (200, 2))
            middles = pixels[pairs].mean(axis=1)
            near = [labels[int(y) : int(y) + 2, int(x) : int(x) + 2] for y, x in middles]
            assert all((block == one).any() for block in near)


@pytest.mark.parametrize(
    ("obstacles", "width", "height"),
    [(1, 800, 600), (2, 300, 300), (12, 800, 600), (60, 800, 600), (6, 100, 100), (20, 1600, 400)],
)
def test_other_counts_and_sizes(obstacles, width, height):
    for number in (1, 2, 3):
        grid = reader(number=number, obstacles=obstacles, width=width, height=height).read()
        assert (grid.cols, grid.rows) == (width, height)
        assert label(grid.obstacles)[1] == obstacles
        assert line_key(grid.table, *grid.start, *grid.target, ALLOW) >= ONE_OBSTACLE
        assert shortest_path(Problem(grid, grid.start, grid.target)).feasible


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("number", 0),
        ("number", -1),
        ("number", 2**32),
        ("obstacles", 0),
        ("obstacles", 1001),
        ("width", 99),
        ("width", 8193),
        ("height", 0),
        ("height", 10**9),
    ],
)
def test_settings_out_of_range_are_refused(field, value):
    with pytest.raises(InputError, match=f"^map.{field}: got {value}, expected an integer from "):
        reader(**{field: value})


def test_more_obstacles_than_fit_are_refused(monkeypatch):
    """One as large as the area is wide does not fit; nor do so many that none can be smaller."""
    with pytest.raises(InputError) as caught:
        reader(obstacles=1, width=100, height=8192).read()
    assert str(caught.value) == (
        "map.obstacles: got 1, expected as many as fit on 100 x 8192 pixels, between start and end"
    )
    monkeypatch.setattr(scene, "MAX_DRAWS", 5)
    with pytest.raises(InputError, match=r"^map\.obstacles: got 1000, expected as many as fit"):
        reader(obstacles=1000, width=100, height=100).read()

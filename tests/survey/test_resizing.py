"""A smaller picture loses no obstacle and no gap that the robot fits through."""

import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage
from visibility_strategies import draw_picture, make, map_of, pictures

import gapath
from gapath.api import load_map
from gapath.problem import PlanStatus
from gapath.survey.obstacle_image import dilate
from gapath.survey.resizing import coarsest_scale, growth_at, shrunk


@given(pictures(), st.integers(1, 50))
def test_a_block_is_an_obstacle_if_any_of_its_pixels_is(picture, scale):
    rows, cols = picture.shape
    small = shrunk(picture, scale)
    assert small.shape == (-(-rows // scale), -(-cols // scale))
    for y in range(small.shape[0]):
        for x in range(small.shape[1]):
            block = picture[y * scale : (y + 1) * scale, x * scale : (x + 1) * scale]
            assert small[y, x] == block.any()


@pytest.mark.parametrize(
    ("scale", "growth", "blocks"),
    [(1, 6, 6), (2, 6, 3), (4, 6, 2), (5, 6, 2), (6, 6, 1), (3, 0, 0)],
)
def test_growth_is_rounded_up(scale, growth, blocks):
    assert growth_at(scale, growth) == blocks


def parts_of_floor(picture):
    return ndimage.label(~picture)  # pixels that share a side


def obstacles_with_border(picture):
    return ndimage.label(np.pad(picture, 1, constant_values=True), np.ones((3, 3)))[1]


def closes_no_gap(picture, growth, scale, ends):
    """No end is lost, no two obstacles merge, no part of the floor is cut in two."""
    fine = twin.dilated(picture, growth)
    coarse = twin.dilated(shrunk(picture, scale), growth_at(scale, growth))
    if any(coarse[y // scale, x // scale] for x, y in ends):
        return False
    if obstacles_with_border(coarse) != obstacles_with_border(fine):
        return False
    floor, _ = parts_of_floor(fine)
    parts, count = parts_of_floor(np.kron(coarse, np.ones((scale, scale)))[: len(floor)] > 0)
    parts = parts[:, : floor.shape[1]]
    within = [set(floor[parts == number].tolist()) for number in range(1, count + 1)]
    assert all(len(one) == 1 and 0 not in one for one in within)  # no block covers an obstacle
    return len(set.union(set(), *within)) == count


@st.composite
def pictures_with_ends(draw):
    """Some rectangles and discs, a radius, and two places where the robot fits if it can."""
    rows, cols = draw(st.integers(5, 45)), draw(st.integers(5, 45))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    picture = draw_picture(random, rows, cols, draw(st.integers(0, 5)), draw(st.integers(0, 5)))
    growth = draw(st.integers(0, 7))
    free = np.argwhere(~dilate(picture, growth))[:, ::-1]
    if not len(free):
        free = np.array([[0, 0]])
    ends = tuple(tuple(free[random.integers(len(free))].tolist()) for _ in range(2))
    return picture, growth, ends


@settings(max_examples=150)
@given(pictures_with_ends())
def test_the_scale_is_the_coarsest_that_closes_no_gap(case):
    picture, growth, ends = case
    scale = coarsest_scale(picture, dilate(picture, growth), growth, ends)
    good = [s for s in range(2, growth + 1) if closes_no_gap(picture, growth, s, ends)]
    assert scale == max(good, default=1)
    assert type(scale) is int


@settings(max_examples=150)
@given(pictures_with_ends())
def test_where_the_robot_could_go_it_still_can(case):
    picture, growth, (start, target) = case
    fine, _ = parts_of_floor(dilate(picture, growth))
    scale = coarsest_scale(picture, dilate(picture, growth), growth, (start, target))
    coarse = dilate(shrunk(picture, scale), growth_at(scale, growth))
    covered = np.kron(coarse, np.ones((scale, scale)))[: fine.shape[0], : fine.shape[1]] > 0
    assert (covered | (fine > 0)).all()  # what was an obstacle still is
    parts, _ = parts_of_floor(coarse)
    (x, y), (u, v) = start, target
    if fine[y, x] and fine[v, u]:
        joined = parts[y // scale, x // scale] == parts[v // scale, u // scale]
        assert joined == (fine[y, x] == fine[v, u])


def wall_with_gap(top, width, cols=40, rows=60):
    picture = np.zeros((rows, cols), dtype=np.bool_)
    picture[:, 18:22] = True
    picture[top : top + width, 18:22] = False
    return picture


@pytest.mark.parametrize("growth", [3, 4, 6])
@pytest.mark.parametrize("top", range(20, 27))
def test_a_gap_as_wide_as_the_robot_is_not_closed(growth, top):
    """Of so many pixels one is left free; the same gap one pixel narrower is closed."""
    planner = make(
        "visibility_dijkstra", keypoints="corners", resize=True, robot_radius=growth,
        radius_tolerance=0, corner_tolerance=1.0,
    )  # fmt: skip
    width = 2 * growth + 1
    ends = (8, 30), (32, 30)
    for wide, status in ((width, PlanStatus.FOUND), (width - 1, PlanStatus.INFEASIBLE)):
        picture = wall_with_gap(top, wide)
        assert dilate(picture, growth)[:, 20].all() == (wide < width)
        scale = coarsest_scale(picture, dilate(picture, growth), growth, ends)
        coarse = dilate(shrunk(picture, scale), growth_at(scale, growth))
        assert coarse[:, 20 // scale].all() == (wide < width)
        assert gapath.plan(map_of(picture), *ends, planner).status is status


def test_floors_that_touch_at_a_corner_are_two():
    """Between walls from above and from below, which touch at a corner once they are grown."""
    picture = np.zeros((41, 60), dtype=np.bool_)
    picture[:17, 18:20] = picture[25:, 28:30] = True
    ends = (3, 20), (50, 20)
    assert parts_of_floor(dilate(picture, 4))[1] == 2
    scale = coarsest_scale(picture, dilate(picture, 4), 4, ends)
    assert scale == max(s for s in range(2, 5) if closes_no_gap(picture, 4, s, ends)) > 1


def test_where_nothing_works_it_stays_as_it_is():
    free = np.zeros((20, 20), dtype=np.bool_)
    ends = (0, 0), (19, 19)
    for growth in (0, 1):
        assert coarsest_scale(free, dilate(free, growth), growth, ends) == 1
    assert coarsest_scale(free, dilate(free, 6), 6, ends) == 6
    tight = wall_with_gap(21, 7)  # a corridor of one pixel between blocks of any size
    assert coarsest_scale(tight, dilate(tight, 3), 3, ((0, 0), (39, 59))) == 1


def test_scenes_become_smaller():
    for number in range(1, 11):
        grid = load_map(f"m22_scene{number:02d}")
        ends = grid.start, grid.target
        assert 2 <= coarsest_scale(grid.obstacles, dilate(grid.obstacles, 6), 6, ends) <= 6

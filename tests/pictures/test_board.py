"""What is drawn is what the arrays hold."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.figure import Figure

from gapath.pictures import board
from gapath.pictures.board import (
    Robot,
    draw_lines,
    draw_map,
    draw_path,
    draw_picture,
    draw_unknown,
    map_legend,
    mark_ends,
)

WEIGHTS = np.array([[0.0, 0.5, 1.0], [0.5, 1.0, 0.25]])


@pytest.fixture
def axes():
    return Figure().subplots()


def test_a_map_is_its_weights_with_obstacles_apart(axes):
    image = draw_map(axes, WEIGHTS)
    shown = image.get_array()
    assert shown.mask.tolist() == (WEIGHTS == 1).tolist()
    assert shown.data[~shown.mask].tolist() == WEIGHTS[WEIGHTS < 1].tolist()
    assert tuple(image.get_extent()) == (-0.5, 2.5, 1.5, -0.5)
    assert (axes.get_xlim(), axes.get_ylim()) == ((-0.5, 2.5), (1.5, -0.5))


@given(
    arrays(np.float64, st.tuples(st.integers(1, 9), st.integers(1, 9)), elements=st.floats(0, 1))
)
def test_of_a_large_map_each_point_is_the_dearest_field_of_a_square(weights):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(board, "_MOST", 4)
        axes = Figure().subplots()
        image = draw_map(axes, weights)
    rows, cols = weights.shape
    side = 1 if max(rows, cols) <= 4 else 2 if max(rows, cols) <= 8 else 3
    squares = [
        [weights[y : y + side, x : x + side].max() for x in range(0, cols, side)]
        for y in range(0, rows, side)
    ]
    assert np.ma.getdata(image.get_array()).tolist() == squares
    left, right, bottom, top = image.get_extent()
    assert (right - left) / len(squares[0]) == (bottom - top) / len(squares) == side
    assert (axes.get_xlim(), axes.get_ylim()) == ((-0.5, cols - 0.5), (rows - 0.5, -0.5))


def test_what_is_unknown_is_tinted_and_nothing_else(axes):
    unknown = np.array([[True, False], [False, True]])
    shown = draw_unknown(axes, unknown).get_array()
    assert (shown[..., 3] > 0).tolist() == unknown.tolist()


@pytest.mark.parametrize(
    ("weights", "labels"),
    [
        (WEIGHTS, ["obstacle (weight 1)", "free (weight 0.25)", "free (weight 0.5)"]),
        (np.full((2, 2), 0.5), ["free (weight 0.5)"]),
        (np.array([[0.1, 0.2, 0.3, 0.4]]), ["free (weight 0.1)", "free (weight 0.4)"]),
    ],
)
def test_a_legend_names_what_there_is(weights, labels):
    assert [handle.get_label() for handle in map_legend(weights)] == labels


@pytest.mark.parametrize(
    ("ends", "shown"),
    [
        (((0, 1), (2, 0)), {"S": (0, 1), "T": (2, 0)}),
        ((None, (2, 0)), {"T": (2, 0)}),
        ((None, None), {}),
    ],
)
def test_ends_are_marked_where_they_are(axes, ends, shown):
    mark_ends(axes, *ends)
    assert {text.get_text(): text.get_position() for text in axes.texts} == shown


def test_a_path_is_its_fields_and_its_way_points_are_marked(axes):
    path = np.array([[0, 0], [1, 1], [2, 1]], dtype=np.int32)
    draw_path(axes, path, path[[0, 2]])
    line, points = axes.lines
    assert line.get_xydata().tolist() == path.tolist()
    assert points.get_xydata().tolist() == path[[0, 2]].tolist()
    draw_path(axes, path, path[:0])
    assert len(axes.lines) == 3


def test_a_picture_shows_what_obstacles_grew_by(axes):
    obstacles = np.array([[True, False, False]])
    draw_picture(axes, obstacles, np.array([[True, True, False]]))
    (image,) = axes.images
    white, grown, free = image.get_array()[0].tolist()
    assert (white, free) == ([1, 1, 1], [0, 0, 0])
    assert grown not in (white, free)


def test_a_graph_has_a_line_for_each_edge(axes):
    points = np.array([[0, 0], [3, 0], [3, 3]], dtype=np.int32)
    draw_lines(axes, points, np.array([[0, 2]], dtype=np.int32))
    edge, dots = axes.lines
    assert edge.get_xydata().tolist() == [[0, 0], [3, 3]]
    assert dots.get_xydata().tolist() == points.tolist()


def test_a_robot_shows_what_it_knows_over_what_is_there(axes):
    draw_map(axes, WEIGHTS)
    robot = Robot(axes, WEIGHTS.shape)
    known = np.array([[0.0, 1.0, np.nan], [np.nan, np.nan, 0.25]])
    places = np.array([[0, 0], [0, 1]], dtype=np.int32)
    border = np.array([[0.5, 0.5], [1.5, 2.0], [0.5, 0.5]], dtype=np.float32)
    robot.show(WEIGHTS, known, places, places[:0], border)
    beneath, tint = axes.images
    assert beneath.get_array().filled(1.0).tolist() == [[0.0, 1.0, 1.0], [0.5, 1.0, 0.25]]
    assert (tint.get_array()[..., 3] > 0).tolist() == np.isnan(known).tolist()
    path, way, place, sensor = (line.get_xydata().tolist() for line in axes.lines)
    assert (path, way, place) == ([], [[0, 0], [0, 1]], [[0, 1]])
    assert sensor == border.tolist()

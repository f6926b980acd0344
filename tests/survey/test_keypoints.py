"""Main axes of shapes whose axes are known, and of any shape by scikit-image; corners."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from skimage import measure
from visibility_strategies import picture_of, pictures

from gapath.survey.keypoints import axis_ends, corners, label, place


def axes(picture):
    """The ends of the axes of the only obstacle, as (points, directions), major axis first."""
    labels, count = label(picture)
    assert count == 1
    points, directions = zip(*axis_ends(labels), strict=True)
    return np.array(points), np.array(directions)


def ellipse(a, b, angle, side=101):
    y, x = np.mgrid[:side, :side] - side // 2
    along = x * math.cos(angle) + y * math.sin(angle)
    across = y * math.cos(angle) - x * math.sin(angle)
    return (along / a) ** 2 + (across / b) ** 2 <= 1


@pytest.mark.parametrize(("a", "b"), [(30, 12), (45, 44), (20, 8), (12, 30), (15, 40)])
def test_an_ellipse_has_its_own_axes(a, b):
    points, directions = axes(ellipse(a, b, 0))
    right, down = np.array([1, 0]), np.array([0, 1])
    if a > b:
        expected, halves = np.array([right, -right, down, -down]), [[a], [a], [b], [b]]
    else:
        expected, halves = np.array([down, -down, -right, right]), [[b], [b], [a], [a]]
    assert (directions == expected).all()
    assert np.abs(points - (50 + expected * halves)).max() < 0.3


@pytest.mark.parametrize("degrees", [10, 30, 45, 60, 89, 100, 135, 170])
def test_a_turned_ellipse_has_turned_axes(degrees):
    angle = math.radians(degrees)
    points, directions = axes(ellipse(40, 15, angle))
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    assert abs(directions[0] @ along) > math.cos(math.radians(0.5))
    assert abs(directions[2] @ across) > math.cos(math.radians(0.5))
    assert np.allclose(np.abs((points - 50) @ along), [40, 40, 0, 0], atol=0.2)
    assert np.allclose(np.abs((points - 50) @ across), [0, 0, 15, 15], atol=0.2)


@pytest.mark.parametrize(("w", "h"), [(30, 10), (10, 30), (7, 5), (2, 1), (1, 9), (50, 49)])
def test_a_rectangles_axes_are_longer_than_its_sides(w, h):
    """The variance of w pixels in a row is (w^2 - 1) / 12, and a half axis twice its root."""
    picture = np.zeros((60, 60), dtype=np.bool_)
    picture[3 : 3 + h, 5 : 5 + w] = True
    points, _ = axes(picture)
    middle = np.array([5 + (w - 1) / 2, 3 + (h - 1) / 2])
    halves = np.sqrt([(w * w - 1) / 3, (h * h - 1) / 3])
    across, down = np.diag(halves)
    ends = [across, -across, down, -down] if w > h else [down, -down, -across, across]
    assert np.allclose(points, middle + ends, atol=1e-9)


@pytest.mark.parametrize(
    "text", ["#", "## ##", ".#. ### .#.", "...#... .#####. .#####. ####### .#####. .#####. ...#..."]
)
def test_what_has_no_longer_axis_has_those_of_the_picture(text):
    points, directions = axes(picture_of(text))
    assert directions.tolist() == [[1, 0], [-1, 0], [0, 1], [0, -1]]
    half = points[0, 0] - points[:, 0].mean()
    assert np.allclose(points - points.mean(axis=0), half * directions)
    assert half == 0 if text == "#" else half > 0


def test_a_diagonal_has_no_width():
    points, directions = axes(np.eye(9, dtype=np.bool_))
    half = math.sqrt((81 - 1) / 3)
    assert np.allclose(points, [[4 + half] * 2, [4 - half] * 2, [4, 4], [4, 4]])
    assert np.allclose(np.abs(directions), math.sqrt(0.5))


def test_eq_2_takes_the_second_axis_at_a_right_angle():
    _, directions = axes(ellipse(40, 15, 0.3))
    for sign in (1, -1):
        assert np.allclose(directions[0] * sign, directions[1] * -sign)
    assert abs(directions[0] @ directions[2]) < 1e-12
    assert np.allclose(np.linalg.norm(directions, axis=1), 1)


@settings(max_examples=150)
@given(pictures(most=40))
def test_axes_equal_those_of_scikit_image(picture):
    labels, count = label(picture)
    ends = axis_ends(labels)
    regions = measure.regionprops(measure.label(picture, connectivity=2))
    assert len(regions) == count and len(ends) == 4 * count
    for i, region in enumerate(regions):
        points = np.array([point for point, _ in ends[4 * i : 4 * i + 4]])
        directions = np.array([away for _, away in ends[4 * i : 4 * i + 4]])
        y, x = region.centroid
        major, minor = region.axis_major_length, region.axis_minor_length
        assert np.allclose(points.mean(axis=0), (x, y), atol=1e-9)
        lengths = np.linalg.norm(points - (x, y), axis=1)
        assert np.allclose(2 * lengths, [major, major, minor, minor], atol=1e-6)
        assert np.allclose(points, (x, y) + lengths[:, None] * directions)
        if major - minor > 1e-3:  # a circle's direction is anybody's choice
            sin, cos = math.sin(region.orientation), math.cos(region.orientation)
            assert abs(directions[0] @ (sin, cos)) > 1 - 1e-6
            assert abs(directions[2] @ (cos, -sin)) > 1 - 1e-6


def test_pixels_that_touch_at_a_corner_are_one_obstacle():
    labels, count = label(picture_of("#.. .#. ... ..# #.."))
    assert count == 3
    assert (labels > 0).sum() == 4
    assert label(np.zeros((3, 3), dtype=np.bool_))[1] == 0
    assert axis_ends(np.zeros((3, 3), dtype=np.int32)) == []


def framed(text, by):
    """A shape of text, every character a block of pixels, with room around it."""
    blocks = np.kron(picture_of(text), np.ones((by, by), dtype=np.bool_))
    return np.pad(blocks, 5)


def near(found, expected):
    """As many points as expected, each within a pixel of another one of them."""
    assert len(found) == len(expected), found
    points = [point for point, _ in found]
    for x, y in expected:
        assert min(math.hypot(u - x, v - y) for u, v in points) < 1.0


def test_a_square_has_four_corners():
    found = corners(framed("#", 10), 1.0)
    near(found, [(5, 5), (14, 5), (5, 14), (14, 14)])
    for (x, y), (dx, dy) in found:
        assert math.isclose(math.hypot(dx, dy), 1)
        assert dx * (x - 9.5) > 0 and dy * (y - 9.5) > 0  # they point outwards
        assert abs(abs(dx) - abs(dy)) < 0.2


@pytest.mark.parametrize("tolerance", [1.0, 2.0, 3.0])
def test_a_u_has_six_corners_that_point_outwards(tolerance):
    """Eight corners, but the two within it are never on a shortest way."""
    found = corners(framed("#.# #.# ###", 10), tolerance)
    near(found, [(5, 5), (14, 5), (25, 5), (34, 5), (5, 34), (34, 34)])


def test_corners_of_a_hole():
    """A square hole has none that a way could turn at; a tooth that stands in it has two."""
    outside = [(5, 5), (54, 5), (5, 54), (54, 54)]
    near(corners(framed("##### #...# #...# #...# #####", 10), 1.0), outside)
    with_tooth = framed("##### #.#.# #...# #...# #####", 10)
    near(corners(with_tooth, 1.0), [*outside, (25, 24), (34, 24)])


def test_a_disc_has_more_corners_the_less_they_may_miss():
    counts = [len(corners(ellipse(40, 40, 0), tolerance)) for tolerance in (0.5, 2, 8, 50)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 12 and counts[-1] == 4  # no fewer than three, whatever it may miss
    for (x, y), (dx, dy) in corners(ellipse(40, 40, 0), 2.0):
        assert abs(math.hypot(x - 50, y - 50) - 40) < 1.5
        assert (dx * (x - 50) + dy * (y - 50)) / math.hypot(x - 50, y - 50) > 0.95


@pytest.mark.parametrize("tolerance", [1.0, 2.0, 4.0])
def test_sides_miss_an_outline_by_no_more_than_the_tolerance(tolerance):
    """All corners of a convex obstacle are found, in the order of its outline."""
    shape = ellipse(45, 25, 0.4)
    points = np.array([point for point, _ in corners(shape, tolerance)])
    (outline,) = measure.find_contours(shape.astype(float), 0.5)
    ends = np.stack((points, np.roll(points, -1, axis=0)), axis=1)
    worst = max(min(distance_to_side(point, a, b) for a, b in ends) for point in outline[:, ::-1])
    assert tolerance / 3 < worst <= tolerance + 1e-9


def distance_to_side(point, a, b):
    along = np.clip((point - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
    return math.hypot(*(point - a - along * (b - a)))


@given(pictures(), st.sampled_from([0.3, 1.0, 2.0, 10.0]))
def test_corners_lie_on_outlines_and_point_away(picture, tolerance):
    """Half a pixel beside an obstacle; further out is none."""
    rows, cols = picture.shape
    padded = np.pad(picture, 3)
    for (x, y), (dx, dy) in corners(picture, tolerance):
        assert -1 < x < cols and -1 < y < rows
        u, v = math.floor(x) + 3, math.floor(y) + 3
        assert padded[v : v + 2, u : u + 2].any()
        u, v = math.floor(x + 1.5 * dx + 0.5) + 3, math.floor(y + 1.5 * dy + 0.5) + 3
        assert not padded[v, u]


def test_points_are_rounded_half_up_and_those_outside_left_out():
    free = np.zeros((4, 6), dtype=np.bool_)
    ends = [(0.49, 0.5), (-0.5, -0.5), (-0.51, 0), (5.49, 3.49), (5.5, 0), (0, 3.5), (2.5, 1.5)]
    placed = place([(point, (1.0, 0.0)) for point in ends], free, True)
    assert placed.tolist() == [[0, 1], [0, 0], [5, 3], [3, 2]]
    assert placed.dtype == np.int32
    assert place([], free, True).shape == (0, 2)


def test_points_within_an_obstacle_are_pushed_out_along_their_axis():
    wall = picture_of("........ ..####.. ..####.. ..####.. ........")
    right, up, diagonal = (1.0, 0.0), (0.0, -1.0), (math.sqrt(0.5), math.sqrt(0.5))
    ends = [((4, 2), right), ((4, 2), up), ((4, 2), diagonal), ((7, 2), right)]
    assert place(ends, wall, True).tolist() == [[6, 2], [4, 0], [6, 4], [7, 2]]
    assert place(ends, wall, False).tolist() == [[4, 2], [4, 2], [4, 2], [7, 2]]


def test_points_that_are_pushed_out_of_the_picture_are_left_out():
    wall = picture_of("...### ...###")
    ends = [((4, 0), (1.0, 0.0)), ((4, 0), (-1.0, 0.0)), ((4, 1), (0.0, 1.0))]
    assert place(ends, wall, True).tolist() == [[2, 0]]


@given(pictures(), st.booleans())
def test_keypoints_are_in_the_picture_and_on_free_pixels(picture, by_axes):
    rows, cols = picture.shape
    found = axis_ends(label(picture)[0]) if by_axes else corners(picture, 1.0)
    pushed = place(found, picture, True)
    assert not picture[pushed[:, 1], pushed[:, 0]].any()
    left = place(found, picture, False)
    inside = [(math.floor(x + 0.5), math.floor(y + 0.5)) for (x, y), _ in found]
    assert left.tolist() == [[x, y] for x, y in inside if 0 <= x < cols and 0 <= y < rows]
    assert len(pushed) <= len(left)
    moved = {tuple(point) for point in left.tolist()}
    assert {p for p in moved if not picture[p[1], p[0]]} <= {tuple(p) for p in pushed.tolist()}


@pytest.mark.parametrize("thickness", [1, 2, 3])
def test_thin_walls_have_corners_too(thickness):
    """However far the sides may miss the outline: without corners nothing leads around it."""
    wall = np.zeros((60, 60), dtype=np.bool_)
    wall[30 : 30 + thickness, 10:50] = True
    for tolerance in (1.0, 2.0, 20.0):
        found = np.array([point for point, _ in corners(wall, tolerance)])
        assert len(found) >= 3
        assert found[:, 0].min() < 11 and found[:, 0].max() > 48
    single = np.zeros((9, 9), dtype=np.bool_)
    single[4, 4] = True
    assert len(corners(single, 2.0)) >= 3

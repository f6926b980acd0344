"""What an obstacle is, and how far it grows."""

import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from visibility_strategies import CLEARANCE, map_of, picture_of, pictures

from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.problem import Problem
from gapath.survey.obstacle_image import MAX_RADIUS, Clearance, dilate


def clearance(**values):
    return Clearance(**{**CLEARANCE, **values})


def problem_on(weights, start=(0, 0), target=None, **values):
    weights = np.asarray(weights, dtype=np.float64)
    target = target or (weights.shape[1] - 1, weights.shape[0] - 1)
    return Problem(GridMap("floor", weights, **values), start, target)


FLOOR = problem_on(np.full((4, 5), 0.5))


@pytest.mark.parametrize(
    ("robot_radius", "tolerance", "radius"),
    [
        (5, 0.1, 6),  # 5.5
        (10, 0.1, 11),  # exactly 11, which in floating point is more
        (10.0, 0.1, 11),
        (20, 0.1, 22),
        (30, 0.1, 33),
        (10, 0, 10),
        (10, 0.01, 11),
        (0, 0.1, 0),
        (0.0, 10, 0),
        (1e-9, 0, 1),
        (0.3, 0.1, 1),
        (1.1, 0.1, 2),
        (10 / 1.1, 0.1, 10),  # as decimals: 9.09... and a tenth is just below 10
        (7, 1, 14),
    ],
)
def test_eq_1_by_hand(robot_radius, tolerance, radius):
    one = clearance(robot_radius=robot_radius, radius_tolerance=tolerance)
    assert one.radius(FLOOR) == one.growth(FLOOR) == radius


@given(st.integers(0, 300000), st.sampled_from(["0.1", "0.0", "0.25", "0.07"]))
def test_eq_1_is_exact(hundredths, tolerance):
    radius = f"{hundredths // 100}.{hundredths % 100:02d}"
    one = clearance(robot_radius=float(radius), radius_tolerance=float(tolerance))
    assert one.radius(FLOOR) == twin.radius(radius, tolerance)


@pytest.mark.parametrize(
    ("metres", "resolution", "pixels"),
    [(0.5, 0.05, 11), (0.5, 0.1, 6), (0.15, 0.05, 4), (2, 1.0, 3), (0.1, 0.01, 11), (0, 0.05, 0)],
)
def test_metres_are_divided_by_the_resolution(metres, resolution, pixels):
    problem = problem_on(np.full((4, 5), 0.5), resolution=resolution)
    assert clearance(robot_radius=metres, radius_unit="metres").radius(problem) == pixels
    assert clearance(robot_radius=metres).radius(problem) == twin.radius(str(metres))


@pytest.mark.parametrize(("radius", "growth"), [(0, 0), (1, 0), (2, 1), (3, 1), (10, 5), (11, 5)])
def test_an_element_r_wide_grows_by_half_of_it(radius, growth):
    """Rounded down: the square has a pixel in its middle."""
    one = clearance(robot_radius=radius, radius_tolerance=0, element="width")
    assert one.radius(FLOOR) == radius
    assert one.growth(FLOOR) == growth
    assert clearance(robot_radius=radius, radius_tolerance=0).growth(FLOOR) == radius
    picture = np.zeros((31, 31), dtype=np.bool_)
    picture[15, 15] = True
    assert dilate(picture, growth).sum() == (2 * growth + 1) ** 2


def test_a_radius_has_a_limit():
    assert clearance(robot_radius=MAX_RADIUS, radius_tolerance=0).radius(FLOOR) == MAX_RADIUS
    with pytest.raises(InputError) as caught:
        clearance(robot_radius=4000).radius(FLOOR)
    assert str(caught.value) == (
        "planner.robot_radius: got 4000 pixels, 4400 pixels with its tolerance, expected at most "
        "4096 pixels"
    )
    with pytest.raises(InputError, match=r"^planner.robot_radius: got 1000000 metres, "):
        clearance(robot_radius=10**6, radius_unit="metres").growth(FLOOR)
    with pytest.raises(InputError, match=r"^planner.robot_radius: got 1e\+300, "):
        clearance(robot_radius=1e300)


@settings(max_examples=100)
@given(pictures(most=16), st.integers(0, 20))
def test_dilation_equals_the_twin(picture, growth):
    before = picture.copy()
    assert (dilate(picture, growth) == twin.dilated(picture, growth)).all()
    assert (picture == before).all()


def test_the_largest_dilation_of_a_small_picture():
    picture = np.zeros((20, 30), dtype=np.bool_)
    assert not dilate(picture, MAX_RADIUS).any()
    picture[3, 4] = True
    assert dilate(picture, MAX_RADIUS).all()


def threshold_map(threshold, weights, **values):
    return clearance(threshold=threshold).obstacles(problem_on(weights, **values)).tolist()


def test_a_map_of_two_shades_is_taken_as_it_is():
    """Only what no planner may enter; start and target of another shade make no map grey."""
    weights = np.full((3, 4), 0.5)
    weights[1, 1:3] = 1.0
    expected = (weights == 1.0).tolist()
    assert threshold_map("otsu", weights) == expected
    weights[0, 0], weights[2, 3] = 0.0, 0.999
    assert threshold_map("otsu", weights) == expected
    assert threshold_map("otsu", np.full((1, 2), 0.5)) == [[False, False]]
    assert threshold_map("otsu", np.array([[0.25, 0.5]])) == [[False, False]]


def test_otsus_method_parts_two_clear_levels():
    """A photograph: a dark floor and light obstacles, neither of one shade."""
    random = np.random.default_rng(0)
    light = np.zeros((40, 60), dtype=np.bool_)
    light[10:20, 15:30] = light[25:38, 40:50] = True
    weights = np.where(light, 0.8, 0.15) + random.uniform(-0.1, 0.1, light.shape)
    assert threshold_map("otsu", weights) == light.tolist()
    weights[light] = 1.0  # white ones all the same
    assert threshold_map("otsu", weights) == light.tolist()
    weights[5, 5] = 0.0
    assert threshold_map("otsu", weights) == light.tolist()


def otsu(values):
    """The value up to which pixels are dark: the means of both classes differ most (Otsu 1979)."""

    def between(threshold):
        dark = [value for value in values if value <= threshold]
        light = [value for value in values if value > threshold]
        apart = sum(dark) / len(dark) - sum(light) / len(light)
        return len(dark) * len(light) * apart**2

    return max(sorted(set(values))[:-1], key=between)


@given(st.integers(0, 2**32 - 1), st.integers(2, 9))
def test_otsus_method_equals_the_twin(seed, shades):
    """On any few shades; start and target are as dark as the rest."""
    random = np.random.default_rng(seed)
    weights = random.choice(random.choice(255, shades, replace=False), (8, 9)) / 256
    problem = problem_on(weights)
    inner = weights.copy()
    inner[0, 0] = inner[-1, -1] = inner[0, 1]
    if len(np.unique(inner)) > 1:
        expected = weights > otsu(weights.ravel().tolist())
        assert (clearance().obstacles(problem) == expected).all()


def test_a_number_is_a_threshold():
    """From this weight on; what no planner may enter is an obstacle with any."""
    weights = np.array([[0.0, 0.25, 0.5, 0.75, 1.0, 0.1]])
    for threshold, blocked in [
        (0.5, [2, 3, 4]),
        (0.50001, [3, 4]),
        (0.25, [1, 2, 3, 4]),
        (1e-9, [1, 2, 3, 4, 5]),
        (1, [4]),
        (1.0, [4]),
    ]:
        (row,) = threshold_map(threshold, weights)
        assert [x for x, is_one in enumerate(row) if is_one] == blocked, threshold


def test_start_and_target_must_have_room():
    picture = picture_of("........ ........ ...##... ........ ........")
    grid = map_of(picture)
    one = clearance(robot_radius=1, radius_tolerance=0)
    one.check(Problem(grid, (0, 0), (7, 4)))
    with pytest.raises(InputError) as caught:
        one.check(Problem(grid, (3, 1), (7, 4)))
    assert str(caught.value) == (
        "map.start: got [3, 1], within an obstacle grown by 1 pixels, expected a point where the "
        "robot fits; the nearest is [3, 0]"
    )
    with pytest.raises(InputError, match=r"^map.target: .* by 2 pixels, .*; the nearest is \[7, 4"):
        clearance(robot_radius=2, radius_tolerance=0).check(Problem(grid, (0, 0), (6, 4)))


def test_where_the_robot_fits_nowhere_that_is_said():
    picture = picture_of("..... ..#.. .....")
    with pytest.raises(InputError) as caught:
        clearance(robot_radius=2).check(Problem(map_of(picture), (0, 0), (4, 2)))
    assert str(caught.value) == (
        "map.start: got [0, 0], within an obstacle grown by 3 pixels, expected a map with room for "
        "the robot; this one has none, or planner.robot_radius and planner.threshold that leave "
        "some"
    )


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("robot_radius", -1, "a number from 0 to 1000000"),
        ("robot_radius", -1e-9, "a number from 0 to 1000000"),
        ("robot_radius", 1000000.5, "a number from 0 to 1000000"),
        ("robot_radius", float("inf"), "a number from 0 to 1000000"),
        ("robot_radius", float("nan"), "a number from 0 to 1000000"),
        ("radius_unit", "feet", '"pixels" or "metres"'),
        ("radius_tolerance", -0.1, "a number from 0 to 10"),
        ("radius_tolerance", 10.5, "a number from 0 to 10"),
        ("radius_tolerance", float("nan"), "a number from 0 to 10"),
        ("element", "disc", '"reach" or "width"'),
        ("threshold", "mean", '"otsu" or a weight in (0, 1]'),
        ("threshold", "0.5", '"otsu" or a weight in (0, 1]'),
        ("threshold", 0, '"otsu" or a weight in (0, 1]'),
        ("threshold", 1.001, '"otsu" or a weight in (0, 1]'),
        ("threshold", -0.5, '"otsu" or a weight in (0, 1]'),
        ("threshold", float("nan"), '"otsu" or a weight in (0, 1]'),
    ],
)
def test_settings_out_of_range_are_refused(field, value, expected):
    with pytest.raises(InputError) as caught:
        clearance(**{field: value})
    assert str(caught.value) == f"planner.{field}: got {value}, expected {expected}"

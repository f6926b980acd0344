"""From a map to a graph: points, lengths, and what becomes of them on the map."""

import naive
import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import RULES
from visibility_strategies import CLEARANCE, GRAPH, map_of, picture_problems

import gapath
from gapath.components import build
from gapath.discovery import yaml_values
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.m22.graph import BLOCKED
from gapath.kernels.rng import stream
from gapath.kernels.units import SCALE
from gapath.mapio import scene
from gapath.planning.path import polyline_length
from gapath.planning.stages import Stages
from gapath.problem import CornerCutting, PlanStatus, Problem
from gapath.survey.keypoints import axis_ends, label
from gapath.survey.visibility_graph import MAX_POINTS, Surveyor


def surveyor(**values):
    return Surveyor(**{**CLEARANCE, **GRAPH, **values})


def survey(problem, **values):
    return surveyor(**values).survey(problem, Stages())


def one_block():
    """A block of 3 x 3 pixels in the middle of 11 x 9; the robot's radius is 1."""
    picture = np.zeros((9, 11), dtype=np.bool_)
    picture[3:6, 4:7] = True
    return Problem(map_of(picture), (0, 4), (10, 4))


def test_a_graph_by_hand():
    """Grown to 5 x 5 the half axes are sqrt(8) = 2.83: all four ends lie just outside."""
    graph = survey(one_block(), radius_tolerance=0)
    assert graph.obstacles.sum() == 25 and graph.obstacles[2:7, 3:8].all()
    assert (graph.scale, graph.obstacle_count) == (1, 1)
    start, end, right, left, down, up = graph.points.tolist()
    assert (start, end) == ([0, 4], [10, 4])
    assert (right, left, down, up) == ([8, 4], [2, 4], [5, 7], [5, 1])
    free = (graph.lengths != BLOCKED).tolist()
    # the start sees itself and the left end; lines to and from above and below graze the corners
    assert free[0] == [True, False, False, True, False, False]
    assert free[1] == [False, True, True, False, False, False]
    assert graph.lengths[0, 3] == graph.lengths[1, 2] == 2 * SCALE
    assert graph.drawn(one_block()).edges.tolist() == [[0, 3], [1, 2]]
    assert not len(graph.shortest(informed=True)[0])


def test_corners_are_keypoints_too():
    """Of the block grown to 5 x 5, each beside it."""
    graph = survey(one_block(), radius_tolerance=0, keypoints="corners", corner_tolerance=1.0)
    found = graph.points[2:]
    assert len(found) == 4
    for corner in ([2, 1], [2, 7], [8, 1], [8, 7]):
        assert np.abs(found - corner).max(axis=1).min() <= 1
    assert not graph.obstacles[graph.points[:, 1], graph.points[:, 0]].any()
    indices, _ = graph.shortest(informed=True)
    lines = graph.on_map(one_block())[indices]
    assert len(lines) == 4
    assert (graph.straight(indices, one_block()) == lines).all()


def test_without_push_out_no_line_reaches_a_keypoint_within():
    """The ends of a disc's axes are pixels of the disc."""
    y, x = np.mgrid[:61, :121]
    disc = (x - 60) ** 2 + (y - 30) ** 2 <= 100
    problem = Problem(map_of(disc), (0, 30), (120, 30))
    left, pushed = (survey(problem, robot_radius=0, push_out=out) for out in (False, True))
    assert left.points[2:].tolist() == [[70, 30], [50, 30], [60, 40], [60, 20]]
    assert pushed.points[2:].tolist() == [[71, 30], [49, 30], [60, 41], [60, 19]]
    assert (left.lengths[2:] == BLOCKED).all()
    assert not len(left.shortest(informed=True)[0])
    assert pushed.shortest(informed=True)[0].tolist() in ([0, 4, 1], [0, 5, 1])


def test_an_empty_floor_has_start_and_end_only():
    problem = Problem(GridMap("floor", np.full((30, 40), 0.5)), (1, 2), (38, 25))
    for resize in (False, True):
        graph = survey(problem, robot_radius=5, resize=resize)
        assert graph.obstacle_count == 0
        assert graph.scale == (6 if resize else 1)
        assert graph.on_map(problem).tolist() == [[1, 2], [38, 25]]
        assert graph.drawn(problem).edges.tolist() == [[0, 1]]


def test_stages_are_those_of_the_paper():
    for resize in (False, True):
        stages = Stages()
        surveyor(resize=resize).survey(one_block(), stages)
        names = ["resizing"] * resize + ["dilation", "keypoints", "graph"]
        assert [*stages.seconds] == names
        assert min(stages.seconds.values()) >= 0


@settings(max_examples=80)
@given(
    picture_problems(most=24),
    st.integers(0, 4),
    st.booleans(),
    st.booleans(),
    st.sampled_from(["axes", "corners"]),
)
def test_graphs_equal_the_twin(problem, radius, resize, push_out, keypoints):
    graph = survey(
        problem, robot_radius=radius, resize=resize, push_out=push_out, keypoints=keypoints
    )
    growth = twin.radius(str(radius))
    if not resize:
        assert graph.scale == 1
        grown = twin.dilated(problem.map.obstacles, growth)
        assert (graph.obstacles == grown).all()
        if keypoints == "axes" and not push_out:
            ends = [point for point, _ in axis_ends(label(grown)[0])]
            rounded = np.floor(np.array(ends).reshape(-1, 2) + 0.5).astype(int).tolist()
            inside = [p for p in rounded if problem.map.contains(p)]
            assert graph.points[2:].tolist() == inside
    assert graph.obstacle_count == label(graph.obstacles)[1]
    rule = RULES[problem.corner_cutting]
    points = [tuple(point) for point in graph.points.tolist()]
    expected = twin.graph_lengths(graph.obstacles, points, rule)
    found = [[None if v == BLOCKED else v for v in row] for row in graph.lengths.tolist()]
    assert found == expected

    indices, _ = graph.shortest(informed=True)
    length = twin.shortest(expected)
    assert (length is None) == (not len(indices))
    drawn = graph.drawn(problem)
    assert drawn.block == graph.scale
    assert [*drawn.points[0]] == [*problem.start] and [*drawn.points[1]] == [*problem.target]
    cols, rows = problem.map.cols, problem.map.rows
    assert ((drawn.points >= 0) & (drawn.points < (cols, rows))).all()
    assert (drawn.points // graph.scale == graph.points).all()
    assert drawn.edges.dtype == drawn.points.dtype == np.int32
    assert {tuple(edge) for edge in drawn.edges.tolist()} == {
        (i, j) for j in range(len(points)) for i in range(j) if expected[i][j] is not None
    }


def test_too_many_keypoints_are_refused():
    """Single pixels, four keypoints each."""
    picture = np.zeros((130, 130), dtype=np.bool_)
    picture[1::3, 1::3] = True
    problem = Problem(map_of(picture), (0, 0), (129, 129))
    with pytest.raises(InputError) as caught:
        survey(problem, robot_radius=0)
    assert str(caught.value) == (
        f"map: got {4 * 43**2} keypoints, expected at most {MAX_POINTS - 2}: a larger "
        "planner.corner_tolerance or robot_radius, or a smaller map"
    )
    assert len(survey(problem, robot_radius=1).points) == 2  # one obstacle fills the picture
    with pytest.raises(InputError, match=r"^map: got 7396 keypoints, expected at most"):
        gapath.plan(problem.map, (0, 0), (129, 129), "visibility_ga", robot_radius=0)


def test_a_path_of_blocks_keeps_to_them():
    """A line between far points could enter blocks that the small line does not."""
    picture = np.zeros((91, 119), dtype=np.bool_)
    picture[40:52, 50:70] = True
    for rule in CornerCutting:
        problem = Problem(map_of(picture), (1, 47), (117, 45), rule)
        graph = survey(problem, robot_radius=6, resize=True, keypoints="corners")
        assert graph.scale > 1
        indices, _ = graph.shortest(informed=True)
        if rule is CornerCutting.NO_DIAGONALS:
            assert not len(indices)
            continue
        path = graph.through(indices, problem)
        blocks = {tuple(p) for p in (path // graph.scale).tolist()}
        lines = [tuple(p) for p in graph.points[indices].tolist()]
        assert blocks == set(naive.polyline(lines))


@pytest.mark.parametrize("resize", [False, True])
def test_without_diagonals_only_straight_lines_along_the_axes(resize):
    """Start and target may lie anywhere within their blocks."""
    grid = GridMap("floor", np.full((40, 60), 0.5))
    for start, target in [((4, 20), (54, 22)), ((31, 2), (33, 38)), ((7, 7), (8, 8))]:
        plan = gapath.plan(
            grid, start, target, "visibility_ga_resized" if resize else "visibility_ga",
            corner_cutting="no_diagonals",
        )  # fmt: skip
        assert plan.feasible == resize
        steps = np.abs(np.diff(plan.path, axis=0)).sum(axis=1)
        assert (steps == 1).all()


def test_lines_have_a_length():
    points = np.array([[0, 0], [3, 4], [3, 4], [3, 0]], dtype=np.int32)
    assert polyline_length(points) == 9.0
    assert polyline_length(points[:1]) == polyline_length(points[:0]) == 0.0
    assert polyline_length(np.array([[0, 0], [-65536, 65536]], dtype=np.int32)) == 65536 * 2**0.5


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("keypoints", "centres", '"axes" or "corners"'),
        ("corner_tolerance", 0, "a number of pixels in (0, 100]"),
        ("corner_tolerance", -1, "a number of pixels in (0, 100]"),
        ("corner_tolerance", 100.5, "a number of pixels in (0, 100]"),
        ("corner_tolerance", float("nan"), "a number of pixels in (0, 100]"),
        ("robot_radius", -1, "a number from 0 to 1000000"),
        ("element", "disc", '"reach" or "width"'),
    ],
)
def test_settings_out_of_range_are_refused(field, value, expected):
    with pytest.raises(InputError) as caught:
        surveyor(**{field: value})
    assert str(caught.value) == f"planner.{field}: got {value}, expected {expected}"


def test_outlines_that_are_too_long_are_refused_before_they_are_followed():
    picture = np.zeros((400, 400), dtype=np.bool_)
    picture[::2, ::2] = True
    with pytest.raises(InputError, match=r"^map: got 1\d+ sides of pixels between obstacles and"):
        survey(Problem(map_of(picture), (1, 1), (399, 399)), robot_radius=0, keypoints="corners")


def test_what_a_robot_comes_to_know_on_its_way_is_no_bad_input():
    """`check` has seen another map; the navigator's next planner is asked."""
    picture = np.zeros((130, 130), dtype=np.bool_)
    picture[1::3, 1::3] = True
    problem = Problem(map_of(picture), (0, 0), (129, 129))
    for name in ("visibility_ga", "visibility_dijkstra"):
        planner = build("planner", yaml_values("planner", name) | {"robot_radius": 0}, "planner")
        with pytest.raises(InputError):
            planner.check(problem)
        assert planner.plan(problem, stream(0)).status is PlanStatus.NOT_FOUND


def test_lines_of_a_small_picture_that_graze_an_obstacle_of_the_map_are_no_lines():
    """Both kinds of path keep their distance; only the straight one has lines."""
    kinds = set()
    for number in range(1, 6):
        grid = scene.draw(number, 6, 800, 600)
        problem = Problem(grid, grid.start, grid.target)
        graph = survey(problem, resize=True)
        indices, _ = graph.shortest(informed=True)
        straight = graph.straight(indices, problem)
        kinds.add(straight is None)
        if straight is not None:
            fields = np.array(naive.polyline([tuple(p) for p in straight.tolist()]))
            assert not graph.full[fields[:, 1], fields[:, 0]].any()
        through = graph.through(indices, problem)
        assert not graph.full[through[:, 1], through[:, 0]].any()
    assert False in kinds

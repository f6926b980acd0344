"""A* and Dijkstra on the visibility graph: the exact answer, and paths that keep their distance."""

import naive
import naive_visibility as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from strategies import RULES
from visibility_strategies import make, map_of, picture_problems, search

import gapath
from gapath.api import load_map
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels import rng
from gapath.kernels.units import SCALE
from gapath.planning.flaw import flaw
from gapath.planning.path import polyline_length
from gapath.problem import PlanStatus, Problem
from gapath.survey.obstacle_image import dilate

SCENES = [f"m22_scene{number:02d}" for number in range(1, 11)]


def keeps_its_distance(problem, plan, growth):
    """No pixel of the path within so many pixels of an obstacle, to any side."""
    grown = dilate(problem.map.obstacles, growth)
    return not grown[plan.path[:, 1], plan.path[:, 0]].any()


def keeps_to_its_lines(plan):
    """The path is that of its lines; only one through blocks of a small picture has none."""
    if not len(plan.lines()):
        return plan.survey().block > 1
    lines = [tuple(point) for point in plan.lines().tolist()]
    return plan.path.tolist() == [list(field) for field in naive.polyline(lines)]


@pytest.mark.parametrize("scene", SCENES)
def test_exact_planners_agree_on_every_scene(scene):
    grid = load_map(scene)
    problem = Problem(grid, grid.start, grid.target)
    plans = [
        gapath.plan(grid, planner=f"visibility_{name}", **{"keypoints": keypoints})
        for keypoints in ("axes", "corners")
        for name in ("astar", "dijkstra")
    ]
    for plan in plans:
        assert plan.feasible
        assert flaw(problem, plan.path, plan.cost) is None
        assert keeps_its_distance(problem, plan, 6)
        assert polyline_length(plan.lines()) >= np.hypot(*np.subtract(grid.start, grid.target))
        assert [*plan.stages] == ["dilation", "keypoints", "graph", "search"]
        assert plan.evolution is None and plan.epochs == plan.evaluations == 0
    for star, dijkstra in (plans[:2], plans[2:]):
        assert polyline_length(star.lines()) == pytest.approx(polyline_length(dijkstra.lines()))
        assert 0 < star.expansions <= dijkstra.expansions
        assert star.survey().edges.tolist() == dijkstra.survey().edges.tolist()


@pytest.mark.parametrize("scene", SCENES)
def test_on_resized_scenes_the_shortest_path_over_corners_is_hardly_longer(scene):
    grid = load_map(scene)
    full, small = (
        polyline_length(gapath.plan(grid, planner="visibility_dijkstra_corners", resize=r).lines())
        for r in (False, True)
    )
    assert full <= small < 1.01 * full


def test_where_discs_stand_closely_a_resized_path_may_be_much_longer():
    """What the pages say: resizing closes no gap, but it is not free."""
    y, x = np.ogrid[:120, :160]
    discs = ((96, 78, 15), (129, 96, 9), (72, 32, 13), (130, 44, 10), (61, 84, 17), (32, 30, 17))
    blocked = np.any([(x - a) ** 2 + (y - b) ** 2 <= r**2 for a, b, r in discs], axis=0)
    grid = GridMap("discs", np.where(blocked, 1.0, 0.5))
    full, small = (
        gapath.plan(
            grid, (2, 60), (157, 60), "visibility_dijkstra_corners", resize=r, robot_radius=4
        )
        for r in (False, True)
    )
    assert small.survey().block == 3
    assert 1.5 < polyline_length(small.lines()) / polyline_length(full.lines()) < 1.6


@pytest.mark.parametrize("scene", SCENES)
def test_resized_scenes_have_valid_paths_nearly_as_short(scene):
    grid = load_map(scene)
    problem = Problem(grid, grid.start, grid.target)
    full, small = (gapath.plan(grid, planner="visibility_astar", resize=r) for r in (False, True))
    assert flaw(problem, small.path, small.cost) is None
    assert keeps_its_distance(problem, small, 6)
    assert keeps_to_its_lines(small)
    assert small.survey().block > 1
    assert polyline_length(small.lines()) < 1.1 * polyline_length(full.lines())
    assert "resizing" in small.stages


@settings(max_examples=150)
@given(
    picture_problems(most=24),
    st.sampled_from([0, 0.5, 1, 2, 3, 5]),
    st.booleans(),
    st.sampled_from(["axes", "corners"]),
    st.booleans(),
)
def test_paths_are_shortest_and_keep_their_distance(problem, radius, resize, keypoints, informed):
    """Also those of a smaller picture: no pixel within the radius at full size."""
    planner = search(
        informed, robot_radius=radius, resize=resize, keypoints=keypoints, corner_tolerance=1.0
    )
    plan = planner.plan(problem, rng.stream(0))
    grown = twin.dilated(problem.map.obstacles, twin.radius(str(radius)))
    graph = plan.survey()
    points = [tuple(point) for point in (graph.points // graph.block).tolist()]
    lengths = twin.graph_lengths(graph.obstacles, points, RULES[problem.corner_cutting])
    shortest = twin.shortest(lengths)
    if shortest is None:
        assert plan.status is PlanStatus.INFEASIBLE
        assert not len(plan.path) and not len(plan.lines())
        return
    assert flaw(problem, plan.path, plan.cost) is None
    assert not grown[plan.path[:, 1], plan.path[:, 0]].any()
    assert keeps_to_its_lines(plan)
    if graph.block == 1:
        pieces = zip(plan.lines()[:-1].tolist(), plan.lines()[1:].tolist(), strict=True)
        assert sum(twin.line_length(a, b) for a, b in pieces) == shortest
        assert polyline_length(plan.lines()) == pytest.approx(shortest / SCALE, abs=1e-3)


def resized(radius):
    return search(robot_radius=radius, resize=True, keypoints="corners", corner_tolerance=0.5)


@settings(max_examples=200)
@given(st.integers(0, 2**32 - 1), st.integers(2, 8), st.booleans())
def test_resized_paths_keep_their_distance_at_full_size(seed, radius, axes):
    """One or two rectangles in a room with space, so that pictures do become smaller."""
    random = np.random.default_rng(seed)
    rows, cols = random.integers(60, 100, 2)
    picture = np.zeros((rows, cols), dtype=np.bool_)
    for _ in range(random.integers(1, 3)):
        x, y = random.integers(15, cols - 15), random.integers(15, rows - 15)
        w, h = random.integers(0, 14, 2)
        picture[y : y + h + 1, x : x + w + 1] = True
    free = np.argwhere(~dilate(picture, radius + 1))[:, ::-1]
    start, target = (tuple(free[random.integers(len(free))].tolist()) for _ in range(2))
    problem = Problem(map_of(picture), start, target)
    planner = search(robot_radius=radius, resize=True) if axes else resized(radius)
    plan = planner.plan(problem, rng.stream(0))
    if plan.feasible:
        assert flaw(problem, plan.path, plan.cost) is None
        assert keeps_its_distance(problem, plan, twin.radius(str(radius)))
        assert keeps_to_its_lines(plan)


def floor(rows=30, cols=40):
    return np.zeros((rows, cols), dtype=np.bool_)


def planned(picture, start, target, **values):
    problem = Problem(map_of(picture), start, target)
    plan = search(**{"robot_radius": 2, "radius_tolerance": 0, **values}).plan(
        problem, rng.stream(0)
    )
    assert not plan.feasible or flaw(problem, plan.path, plan.cost) is None
    return plan


@pytest.mark.parametrize("resize", [False, True])
def test_without_obstacles_it_goes_straight(resize):
    plan = planned(floor(), (1, 2), (38, 25), resize=resize)
    assert plan.lines().tolist() == [[1, 2], [38, 25]]
    assert plan.expansions == 1
    here = planned(floor(), (7, 8), (7, 8))
    assert here.path.tolist() == [[7, 8]] and here.cost == 0.5


def test_an_obstacle_at_the_border_is_passed_on_its_other_side():
    """The end of its axis that lies outside the picture is no keypoint; the others are."""
    picture = floor(60, 60)
    y, x = np.mgrid[:60, :60]
    picture[(x - 30) ** 2 / 9 + y**2 / 400 <= 1] = True
    plan = planned(picture, (2, 30), (57, 30))
    assert plan.feasible
    points = plan.survey().points
    assert len(points) == 2 + 3 and (points >= 0).all() and (points < 60).all()
    assert plan.path[:, 1].max() > 20


def test_an_obstacle_from_border_to_border_parts_the_floor():
    picture = floor()
    picture[:, 20] = True
    for keypoints in ("axes", "corners"):
        plan = planned(picture, (2, 2), (38, 25), keypoints=keypoints)
        assert plan.status is PlanStatus.INFEASIBLE
        assert plan.expansions >= 1 and len(plan.survey().points) >= 2


def test_where_all_but_the_ends_is_an_obstacle():
    picture = ~floor()
    picture[3, 4] = picture[20, 30] = False
    for radius in (0, 2):
        plan = planned(picture, (4, 3), (30, 20), robot_radius=radius)
        assert plan.status is PlanStatus.INFEASIBLE
        assert plan.survey().obstacles.all() == (radius > 0)


@pytest.mark.parametrize(("start", "target"), [((19, 10), (38, 25)), ((2, 2), (22, 12))])
def test_an_end_where_the_robot_does_not_fit_has_no_line(start, target):
    """As a plan of its own; before a run such a problem is refused."""
    picture = floor()
    picture[12:15, 18:21] = True
    plan = planned(picture, start, target)
    assert plan.status is PlanStatus.INFEASIBLE
    with pytest.raises(InputError, match=r"^map\.(start|target): .*; the nearest is \["):
        gapath.plan(map_of(picture), start, target, "visibility_astar", robot_radius=2)


def test_metres_on_a_map_with_a_resolution():
    picture = floor(60, 80)
    picture[20:35, 30:45] = True
    grid = GridMap("metres", np.where(picture, 1.0, 0.5), resolution=0.05)
    settings = {"keypoints": "corners", "corner_tolerance": 1.0}
    by_metres = gapath.plan(
        grid, (3, 28), (76, 28), "visibility_astar", robot_radius=0.3, radius_unit="metres",
        **settings,
    )  # fmt: skip
    by_pixels = gapath.plan(grid, (3, 28), (76, 28), "visibility_astar", robot_radius=6, **settings)
    assert by_metres.path.tolist() == by_pixels.path.tolist() != []
    assert by_metres.survey().obstacles.sum() == (15 + 2 * 7) ** 2


def test_the_stream_is_not_used():
    stream = rng.stream(3)
    before = stream.copy()
    grid = load_map("m22_scene03")
    plan = make("visibility_astar").plan(Problem(grid, grid.start, grid.target), stream)
    assert plan.feasible
    assert (stream == before).all()

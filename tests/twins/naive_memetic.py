"""What the memetic planner's kernels do, in plain Python: a path is a list of fields (x, y)."""

import itertools
from math import floor

import naive
import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from gapath.grid import GridMap
from gapath.problem import CornerCutting, Problem

STEPS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]
STRAIGHT = STEPS[::2]


def plus(place, step):
    return place[0] + step[0], place[1] + step[1]


def weight(weights, place):
    return floor(weights[place[1], place[0]] * 65536 + 0.5)


def cost(weights, path):
    """All but the first field."""
    return sum(weight(weights, place) for place in path[1:])


def may(weights, a, b, rule):
    """A step of a path: to a free neighbour, by the rule."""
    apart = max(abs(a[0] - b[0]), abs(a[1] - b[1]))
    return (
        apart == 1
        and not naive.is_obstacle(weights, *b)
        and not naive.forbidden(weights, a, b, rule)
    )


def flaw_of(weights, path, rule):
    """The first step that is none, whatever the ends."""
    for a, b in itertools.pairwise(path):
        if not may(weights, a, b, rule):
            return a, b
    return None


def ray(weights, a, b, rule):
    """The first step that is not free, or 0, and the fields before it, those beside included."""
    path, at = [a], a
    for i, there in enumerate(naive.polyline([a, b])[1:], 1):
        (x, y), (u, v) = at, there
        if naive.is_obstacle(weights, u, v):
            return i, path
        if rule == "no_diagonals" and x != u and y != v:
            flat = abs(b[0] - a[0]) >= abs(b[1] - a[1])
            beside = [(u, y), (x, v)] if flat else [(x, v), (u, y)]
            beside = [place for place in beside if not naive.is_obstacle(weights, *place)]
            if not beside:
                return i, path
            path.append(min(beside, key=lambda place: weight(weights, place)))
        elif naive.forbidden(weights, at, there, rule):
            return i, path
        path.append(there)
        at = there
    return 0, path


def is_free(weights, a, b, rule):
    return ray(weights, a, b, rule)[0] == 0


def fields(weights, points, rule):
    """The fields of a polygon whose rays are free."""
    path = [points[0]]
    for a, b in itertools.pairwise(points):
        path += ray(weights, a, b, rule)[1][1:]
    return path


def ray_costs(weights, points, rule):
    rays = [ray(weights, a, b, rule) for a, b in itertools.pairwise(points)]
    assert not any(blocked for blocked, _ in rays), "a ray is not free"
    return [cost(weights, path) for _, path in rays]


def region(start, joined, steps):
    """All places that steps lead to from one."""
    seen, todo = {start}, [start]
    while todo:
        place = todo.pop()
        for there in (plus(place, step) for step in steps):
            if there not in seen and joined(there):
                seen.add(there)
                todo.append(there)
    return seen


def beside(weights, place, blocked, rule):
    """The fields of a place's region beside one of its obstacles: all that it is not, in one piece.

    Without corners cut the region holds together by its sides, and the obstacle by corners, too.
    """
    rows, cols = weights.shape
    here, there = (STEPS, STRAIGHT) if rule == "allow" else (STRAIGHT, STEPS)
    own = region(place, lambda f: not naive.is_obstacle(weights, *f), here)
    wall = region(
        blocked,
        lambda f: -1 <= f[0] <= cols and -1 <= f[1] <= rows and f not in own,
        there,
    )
    return {f for f in own if any(plus(f, step) in wall for step in there)}


def cut_loops(weights, path, rule):
    short = [path[0]]
    at = max(i for i, place in enumerate(path) if place == path[0])
    while at < len(path) - 1:
        at = max(i for i in range(at + 1, len(path)) if may(weights, path[at], path[i], rule))
        short.append(path[at])
    return short


def look_aside(weights, path, apart, reach, least_gain):
    """Fields along the axes up to the next obstacle; of equal gains the first."""
    at, short = 0, [path[0]]
    while at < len(path) - 1:
        ways = []
        for step in STRAIGHT if at % apart == 0 else ():
            way = [path[at]]
            for _ in range(reach):
                way.append(plus(way[-1], step))
                if naive.is_obstacle(weights, *way[-1]):
                    break
                to = path.index(way[-1]) if way[-1] in path else -1
                gain = to - at - (len(way) - 1)
                if gain > least_gain and cost(weights, way) <= cost(weights, path[at : to + 1]):
                    ways.append((gain, to, way[1:]))
        _, at, way = max(ways, key=lambda each: each[0]) if ways else (0, at + 1, [path[at + 1]])
        short += way
    return short


def cross(weights, first, second):
    """The child, and how many pieces are the second's: the cheaper piece between common fields."""
    places = {place: i for i, place in enumerate(first)}
    child, at, met, pieces = [first[0]], 0, 0, 0
    for j, place in enumerate(second):
        i = places.get(place, -1)
        if j and i > at:
            old, new = first[at : i + 1], second[met : j + 1]
            if cost(weights, new) < cost(weights, old):
                old, pieces = new, pieces + 1
            child += old[1:]
            at, met = i, j
    return child, pieces


def same_side(weights, first, second, rule, rungs):
    ladders = [naive.polyline(points) for points in (first, second)]
    for rung in range(1, rungs):
        a, b = (ladder[(len(ladder) - 1) * rung // rungs] for ladder in ladders)
        if not is_free(weights, a, b, rule):
            return False
    return True


def wandering(weights, start, rule, steps, random):
    """A path that goes anywhere, here again, too."""
    path = [start]
    for _ in range(steps):
        ways = [plus(path[-1], step) for step in STEPS]
        ways = [place for place in ways if may(weights, path[-1], place, rule)]
        if not ways:
            break
        path.append(ways[random.integers(len(ways))])
    return path


def winding(weights, start, rule, random):
    """A long path that comes to no field twice: the deepest of a search in depth."""
    path, seen, longest = [start], {start}, [start]
    while path:
        ways = [plus(path[-1], step) for step in STEPS]
        ways = [f for f in ways if f not in seen and may(weights, path[-1], f, rule)]
        if ways:
            path.append(ways[random.integers(len(ways))])
            seen.add(path[-1])
            longest = max(longest, path, key=len)[:]
        else:
            path.pop()
    return longest


def packed(path):
    return np.array([(y << 16) + x for x, y in path], dtype=np.uint32)


def unpacked(path):
    return [(int(place) & 0xFFFF, int(place) >> 16) for place in path]


def vertices(points):
    return np.array(points, dtype=np.int32).reshape(-1, 2)


def places(points):
    return [tuple(point) for point in np.asarray(points).tolist()]


@st.composite
def walled_problems(draw, most=20):
    """Noise, walls with gaps, or nothing in the way; now and then one row or column."""
    rule = draw(st.sampled_from(list(CornerCutting)))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rows, cols = np.where(random.random(2) < 0.1, 1, random.integers(2, most + 1, 2)).tolist()
    ground = [[0.0], [0.5], [0.0, 0.25, 0.999], [0.25, 1 / 3, 0.7]][random.integers(4)]
    values = random.choice(ground, (rows, cols))
    kind = draw(st.sampled_from(["noise", "walls", "nothing"]))
    if kind == "noise":
        values[random.random((rows, cols)) < random.choice([0.05, 0.1, 0.3, 0.45])] = 1.0
    if kind == "walls":
        for _ in range(random.integers(1, 9)):
            wall = values if random.integers(2) else values.T
            row = wall[random.integers(len(wall))]
            gap = random.integers(len(row))
            row[:gap], row[gap + 1 :] = 1.0, 1.0
    start, target = (tuple(random.integers(0, (cols, rows)).tolist()) for _ in range(2))
    if random.random() < 0.05:
        target = start
    for x, y in (start, target):
        values[y, x] = random.choice([0.0, 0.5])
    return Problem(GridMap("walled", values), start, target, rule)


@st.composite
def rays(draw):
    """A problem, and the end of a ray from its start: any field."""
    problem = draw(walled_problems())
    cells = problem.map.weights.size
    x, y = np.divmod(draw(st.integers(0, 2**32 - 1)) % cells, problem.map.rows)
    return problem, (int(x), int(y))


@st.composite
def paths(draw, most=20, steps=120, twice=True):
    """A problem, and a path from its start: one that winds, or may come to a field twice."""
    problem = draw(walled_problems(most))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    weights, rule = problem.map.weights, problem.corner_cutting.name.lower()
    if twice and draw(st.booleans()):
        return problem, wandering(weights, problem.start, rule, draw(st.integers(0, steps)), random)
    return problem, winding(weights, problem.start, rule, random)


@st.composite
def polygons(draw, most=20, least=1):
    """A problem, and vertices whose rays are free, the first one its start."""
    problem, path = draw(paths(most))
    weights, rule = problem.map.weights, problem.corner_cutting.name.lower()
    points, at = [path[0]], 0
    while at < len(path) - 1:
        free = [i for i in range(at + 1, len(path)) if is_free(weights, path[at], path[i], rule)]
        at = draw(st.sampled_from(free))
        points.append(path[at])
    assume(len(points) >= least)
    return problem, points


@st.composite
def two_polygons(draw):
    """A problem, and two polygons with the same ends, the second one's vertices the first one's."""
    problem, first = draw(polygons())
    weights, rule = problem.map.weights, problem.corner_cutting.name.lower()
    second = [first[0]]
    while second[-1] != first[-1]:
        at = max(i for i, point in enumerate(first) if point == second[-1])
        free = [i for i in range(at + 1, len(first)) if is_free(weights, first[at], first[i], rule)]
        second.append(first[draw(st.sampled_from(free))])
    return problem, first, second

"""Rays against rasterised lines that are checked step by step."""

import naive
import numpy as np
from hypothesis import given
from naive_memetic import cost, packed, rays, unpacked, weight
from naive_memetic import ray as slow_ray

from gapath.grid import GridMap
from gapath.kernels.memetic.rays import append_ray, field_at, ray
from gapath.kernels.units import ALLOW, NO_DIAGONALS


def appended(problem, end, steps):
    path = packed([(9, 9), problem.start] + [(0, 0)] * (2 * steps))
    table, rule = problem.map.table, int(problem.corner_cutting)
    count = append_ray(table, *problem.start, *end, steps, rule, path, 2)
    assert unpacked(path[:1]) == [(9, 9)]
    return unpacked(path[1:count])


@given(rays())
def test_rays_equal_lines_checked_step_by_step(drawn):
    problem, end = drawn
    weights, rule = problem.map.weights, problem.corner_cutting
    blocked, path = slow_ray(weights, problem.start, end, rule.name.lower())
    found = ray(problem.map.table, *problem.start, *end, int(rule))
    assert found == (blocked, cost(weights, path))
    steps = len(naive.polyline([problem.start, end])) - 1
    assert appended(problem, end, blocked - 1 if blocked else steps) == path


@given(rays())
def test_the_way_back_is_as_free_and_costs_the_same(drawn):
    problem, end = drawn
    weights, table, rule = problem.map.weights, problem.map.table, int(problem.corner_cutting)
    if naive.is_obstacle(weights, *end):
        return
    there, back = (ray(table, *problem.start, *end, rule), ray(table, *end, *problem.start, rule))
    assert (there[0] == 0) == (back[0] == 0)
    if there[0] == 0:
        ends = weight(weights, problem.start), weight(weights, end)
        assert there[1] + ends[0] == back[1] + ends[1]


@given(rays())
def test_fields_of_a_ray_are_those_of_the_line(drawn):
    problem, end = drawn
    fields = naive.polyline([problem.start, end])
    assert [field_at(*problem.start, *end, i) for i in range(len(fields))] == fields


def test_without_diagonals_it_goes_by_way_of_the_cheaper_field_beside():
    weights = np.array([[0.5, 0.25, 0.5], [0.125, 0.5, 0.25], [0.5, 0.25, 0.5]])
    table = GridMap("beside", weights).table
    diagonal, straight = (ray(table, 0, 0, 2, 2, rule)[1] for rule in (ALLOW, NO_DIAGONALS))
    assert (diagonal, straight) == (65536, 65536 + 65536 // 8 + 65536 // 4)
    path = packed([(0, 0)] * 9)
    count = append_ray(table, 0, 0, 2, 2, 2, NO_DIAGONALS, path, 1)
    assert unpacked(path[:count]) == [(0, 0), (0, 1), (1, 1), (2, 1), (2, 2)]

"""Polygons: vertices replaced as in a list, and fields as rays are drawn."""

import naive_memetic as slow
import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from naive_memetic import places, polygons, unpacked, vertices

from gapath.kernels.memetic.polygon import fields_of, splice

FIELD = st.tuples(st.integers(0, 9), st.integers(0, 9))


@given(st.lists(FIELD, min_size=2, max_size=12), st.lists(FIELD, max_size=6), st.data())
def test_vertices_are_replaced_as_in_a_list(points, new, data):
    size, costs = len(points), list(range(100, 100 + len(points) - 1))
    i = data.draw(st.integers(0, size - 2))
    j = data.draw(st.integers(i + 1, size - 1))
    new_costs = list(range(len(new) + 1))
    room = np.full((size + len(new), 2), -1, dtype=np.int32)
    room[:size] = points
    paid = np.array(costs + [-1] * (len(new) + 1), dtype=np.int64)
    count = splice(
        room, paid, size, i, j, vertices([*new, (7, 7)]), np.array([*new_costs, 7]), len(new)
    )
    assert places(room[:count]) == points[: i + 1] + new + points[j:]
    assert paid[: count - 1].tolist() == costs[:i] + new_costs + costs[j:]


@given(polygons())
def test_the_fields_of_a_polygon_are_those_of_its_rays(drawn):
    problem, points = drawn
    name, rule = problem.corner_cutting.name.lower(), int(problem.corner_cutting)
    for backward in (False, True):
        order = points[::-1] if backward else points
        expected = slow.fields(problem.map.weights, order, name)
        for room in (1, 2 * len(expected)):
            count, path = fields_of(
                problem.map.table, vertices(points), len(points), backward, rule,
                np.empty(room, dtype=np.uint32),
            )  # fmt: skip
            assert unpacked(path[:count]) == expected

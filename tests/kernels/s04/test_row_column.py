"""S04's genotype: paths worked by hand, and the slow twin."""

import naive
import naive_row_column as twin
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from row_column_strategies import as_rows, draw_chromosomes
from strategies import problems

from gapath.grid import GridMap
from gapath.kernels.lines import KEY_BITS, ONE_OBSTACLE, Ends
from gapath.kernels.raster import polyline
from gapath.kernels.s04.genotype import (
    MAX_SIDE,
    Chromosomes,
    Measures,
    decode,
    empty_chromosomes,
    empty_measures,
    empty_sums,
    empty_walk,
    fitness,
    measure,
    run,
    running_sums,
    share,
)
from gapath.kernels.units import OBSTACLE, SCALE
from gapath.planning.path import heading_changes, octile_length, path_weights
from gapath.problem import Problem
from gapath.survey.row_column import SquareView


def measured(view, chromosomes):
    n, size = chromosomes.location.shape
    sums, measures, walk = empty_sums(n), empty_measures(size), empty_walk(size)
    running_sums(view.table, *view.flips, sums)
    for _ in range(2):  # the second time on memory that is used
        measure(chromosomes, view.ends, sums, measures, walk)
    return measures


def one(flag, location, direction, switch):
    """A chromosome on its own; locations of the inner vertices only."""
    genes = [0, *location, 0], direction, switch
    return Chromosomes(
        np.array([flag], dtype=np.int32),
        *(np.array(part, dtype=np.int32).reshape(-1, 1) for part in genes),
    )


def in_a_corner_of(n):
    return SquareView.of(Problem(GridMap("free", np.full((n, n), 0.5)), (0, 0), (n - 1, n - 1)))


NONE = [5, 5]
ROW_WISE = [(0, 0), (4, 1), (3, 2), (1, 3), (2, 4), (5, 5)]
COLUMN_WISE = [(y, x) for x, y in ROW_WISE]


@pytest.mark.parametrize(
    ("flag", "switch", "vertices"),
    [
        (0, NONE, ROW_WISE),
        (1, NONE, COLUMN_WISE),
        (0, [1, 3], ROW_WISE[:2] + COLUMN_WISE[2:4] + ROW_WISE[4:]),
        (0, [3, 1], ROW_WISE[:2] + COLUMN_WISE[2:4] + ROW_WISE[4:]),
        (1, [1, 3], COLUMN_WISE[:2] + ROW_WISE[2:4] + COLUMN_WISE[4:]),
        (0, [2, 5], ROW_WISE[:3] + COLUMN_WISE[3:]),
        (0, [5, 2], ROW_WISE[:3] + COLUMN_WISE[3:]),
        (0, [2, 2], ROW_WISE[:3] + COLUMN_WISE[3:]),  # i = j, not n: one switching point
        (1, [3, 3], COLUMN_WISE[:4] + ROW_WISE[4:]),
        (0, [0, 5], COLUMN_WISE),  # after the start, so from the first vertex on
        (0, [4, 5], ROW_WISE),  # after the last but one: only the target is left
    ],
)
def test_vertices_by_hand(flag, switch, vertices):
    chromosome = one(flag, [4, 3, 1, 2], [1] * 5, switch)
    (points,) = decode(as_rows(chromosome), Ends(0, 0, 5, 5))
    assert points[::2].tolist() == [list(vertex) for vertex in vertices]


@pytest.mark.parametrize(
    ("flag", "direction", "switch", "points", "length", "turns"),
    [
        # right 2, down; down, left; right 2 (back), down
        (0, [1, 0, 1], [3, 3], "00 20 21 22 12 32 33", 8, 4),
        # down, right 2; left, down; down, right 2
        (0, [0, 1, 0], [3, 3], "00 01 21 11 12 13 33", 8, 4),
        # the first one mirrored: down 2, right; right, up; down 2 (back), right
        (1, [0, 1, 0], [3, 3], "00 02 12 22 21 23 33", 8, 4),
        # right 2, down; column-wise from there, so to the same field; right, down 2
        (0, [1, 0, 1], [1, 3], "00 20 21 21 21 31 33", 6, 3),
    ],
)
def test_a_path_by_hand(flag, direction, switch, points, length, turns):
    """Two inner vertices on 4 x 4 fields, at locations 2 and 1."""
    chromosome = one(flag, [2, 1], direction, switch)
    view = in_a_corner_of(4)
    expected = [[int(digit) for digit in point] for point in points.split()]
    assert decode(as_rows(chromosome), view.ends)[0].tolist() == expected
    found = measured(view, chromosome)
    assert (found.lengths[0], found.turns[0]) == (length, turns)
    assert found.keys[0] == (length + 1) * SCALE // 2  # every entered field weighs one half


def test_obstacles_count_as_often_as_they_are_entered():
    """There and back along the upper row, over one obstacle; down beside it, over none."""
    weights = np.full((4, 4), 0.5)
    weights[0, 1] = 1.0
    view = SquareView.of(Problem(GridMap("one", weights), (0, 0), (3, 3)))
    for direction, obstacles in (([1, 1, 0], 1), ([0, 0, 0], 0)):
        key = int(measured(view, one(0, [2, 0], direction, [3, 3])).keys[0])
        assert key >> KEY_BITS == obstacles
    across = one(1, [0, 3], [1, 1, 1], [3, 3])  # right through it to (2, 0), then down
    assert int(measured(view, across).keys[0]) >> KEY_BITS == 1


@settings(max_examples=300)
@given(problems(most=9, least=1), st.integers(0, 2**32 - 1), st.integers(1, 40))
def test_paths_and_measures_equal_the_twin(problem, seed, size):
    view = SquareView.of(problem)
    n = view.side
    chromosomes = draw_chromosomes(np.random.default_rng(seed), size, n)
    rows = as_rows(chromosomes)
    weights, mirror = twin.mirrored(problem.map.weights, (problem.start, problem.target))
    start, target = mirror(problem.start), mirror(problem.target)
    assert view.ends == (*start, *target)

    paths = [twin.corners(twin.Chromosome.of(row), start, target) for row in rows]
    assert decode(rows, view.ends).tolist() == [[list(point) for point in path] for path in paths]
    on_the_map = [[list(mirror(point)) for point in path] for path in paths]
    assert view.paths(rows).tolist() == on_the_map

    expected = [twin.measure(weights, twin.walk(path)) for path in paths]
    found = measured(view, chromosomes)
    keys = [(collisions << KEY_BITS) + cost for (collisions, cost), _, _ in expected]
    assert found.keys.tolist() == keys
    assert found.lengths.tolist() == [length for _, length, _ in expected]
    assert found.turns.tolist() == [turns for _, _, turns in expected]


@given(problems(most=9, least=1), st.integers(0, 2**32 - 1))
def test_measures_are_those_of_the_fields_of_the_path(problem, seed):
    """Counted as `gapath.planning.path` counts, on the map padded to a square."""
    view = SquareView.of(problem)
    n = view.side
    weights, _ = twin.mirrored(problem.map.weights, (problem.start, problem.target))
    beyond = (0, n - problem.map.rows), (0, n - problem.map.cols)
    padded = GridMap("padded", np.pad(weights, beyond, constant_values=1.0))
    chromosomes = draw_chromosomes(np.random.default_rng(seed), 20, n)
    found = measured(view, chromosomes)
    for i, points in enumerate(decode(as_rows(chromosomes), view.ends)):
        fields = polyline(points)
        assert naive.polyline([tuple(map(int, point)) for point in points]) == [
            tuple(field) for field in fields.tolist()
        ]
        assert octile_length(fields) == found.lengths[i]
        assert np.count_nonzero(heading_changes(fields)) == found.turns[i]
        obstacles, cost = found.keys[i] >> KEY_BITS, found.keys[i] & (ONE_OBSTACLE - 1)
        assert path_weights(padded, fields) * SCALE == obstacles * OBSTACLE + cost


def test_the_longest_path_of_the_largest_map_fits_a_key():
    """From side to side in every row of nothing but obstacles."""
    n = MAX_SIDE
    chromosomes = empty_chromosomes(1, n)
    chromosomes.location[:, 0] = [(n - 1) * (row % 2) for row in range(n)]
    chromosomes.direction[:] = 1
    view = SquareView(
        np.full((n, n), OBSTACLE, dtype=np.int32), Ends(0, 0, n - 1, n - 1), (False,) * 2
    )
    found = measured(view, chromosomes)
    fields = int(found.lengths[0]) + 1
    assert fields == n * n - (n - 1)  # the last row is entered at its end
    assert found.keys[0] == fields << KEY_BITS


def test_running_sums_by_hand():
    """The lower right field is an obstacle, and so is the row that the map lacks."""
    table = np.array([[1, 2, 3], [4, 5, OBSTACLE]], dtype=np.int32)
    sums = empty_sums(3)
    running_sums(table, False, False, sums)
    one_more = 9 + ONE_OBSTACLE
    assert sums.rows.tolist() == [
        *(0, 1, 3, 6),
        *(0, 4, 9, one_more),
        *(0, ONE_OBSTACLE, 2 * ONE_OBSTACLE, 3 * ONE_OBSTACLE),
    ]
    assert sums.cols.tolist() == [
        *(0, 1, 5, 5 + ONE_OBSTACLE),
        *(0, 2, 7, 7 + ONE_OBSTACLE),
        *(0, 3, 3 + ONE_OBSTACLE, 3 + 2 * ONE_OBSTACLE),
    ]
    assert run(sums.rows, 7, 5) == run(sums.rows, 5, 7) == 5 + ONE_OBSTACLE
    running_sums(table, True, True, sums)
    assert sums.rows[:4].tolist() == [0, ONE_OBSTACLE, 5 + ONE_OBSTACLE, 9 + ONE_OBSTACLE]


def rated(collisions, lengths, turns, length_weight=1.0, turns_weight=2.0):
    measures = Measures(
        np.array(collisions, dtype=np.int64) << KEY_BITS,
        np.array(lengths, dtype=np.int32),
        np.array(turns, dtype=np.int32),
    )
    values = np.empty(len(collisions))
    fitness(measures, length_weight, turns_weight, values)
    return values.tolist()


def test_fitness_by_hand():
    """Eqs (1) and (2) with L = 1, T = 2."""
    first, second, third, fourth = rated([0, 2, 4, 1], [10, 14, 20, 20], [3, 1, 5, 2])
    assert first == pytest.approx(1 * (1 * 1 + 2 * 0.5) * 100 / 3)
    assert second == pytest.approx(0.1 * (0.5 * (1 * 0.6 + 2 * 1) * 100 / 3) / 2**2)
    assert third == 0
    assert fourth == pytest.approx(0.1 * (0.75 * (1 * 0 + 2 * 0.75) * 100 / 3) / 1**2)


def test_fitness_lies_between_0_and_100():
    assert rated([0, 1], [5, 9], [1, 3]) == [100, 0]


def test_where_all_have_the_same_value_it_is_1():
    """The 0 / 0 that the paper leaves open."""
    assert share(3, 3, 3) == 1
    assert rated([0, 0], [7, 7], [2, 2]) == [100, 100]
    assert rated([0], [7], [2]) == [100]
    assert rated([2, 2], [7, 7], [2, 2]) == pytest.approx([0.1 * 100 / 4] * 2)
    assert rated([0, 0], [7, 9], [2, 2]) == pytest.approx([100, 200 / 3])


def test_the_weights_weigh():
    assert rated([0, 0], [5, 9], [3, 1], 1.0, 0.0) == [100, 0]
    assert rated([0, 0], [5, 9], [3, 1], 0.0, 1.0) == [0, 100]


def test_a_colliding_path_is_fitter_than_a_free_one_that_is_nearly_the_worst():
    """As the equations have it: eq. (2) leaves a tenth, shares go down to 0."""
    free, colliding, _ = rated([0, 1, 9], [14, 5, 20], [6, 1, 9])
    assert free > colliding
    free, colliding, _ = rated([0, 1, 9], [19, 5, 20], [9, 1, 9])
    assert free < colliding


numbers = st.integers(0, 2**19 - 1)


@given(
    st.lists(st.tuples(numbers, numbers, numbers), min_size=1, max_size=30),
    st.sampled_from([1.0, 0.0, 0.3, 1e6, 1e-300]),
    st.sampled_from([2.0, 0.7, 1e6, 1 / 3]),
)
def test_fitness_equals_the_twin_to_the_last_bit(found, length_weight, turns_weight):
    expected = twin.fitness(
        [((collisions, 0), length, turns) for collisions, length, turns in found],
        length_weight,
        turns_weight,
    )
    ours = rated(*zip(*found, strict=True), length_weight, turns_weight)
    assert ours == expected
    assert all(0 <= value <= 100 * (1 + 1e-12) for value in ours)

"""What vectors compute, against one number after the other."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.kernels.jit import JIT, kernel
from gapath.kernels.kg18.bspline import basis, way_point
from gapath.kernels.kg18.field_lanes import FIELDS, FRACTION, READ, store_fields, sum_entries
from gapath.kernels.kg18.lanes import (
    ACROSS,
    ALONG,
    BASE,
    CHROMOSOMES,
    GENES,
    LINE,
    SLOPE,
    STEPS,
    chromosome_matrix,
    join_way_points,
    place_way_points,
    turn,
    width,
)
from gapath.kernels.raster import COORDINATE_LIMIT, SHIFT, slope

pytestmark = pytest.mark.skipif(not JIT, reason="vectors need the compiler")

ONE = 1 << FRACTION
coordinates = st.integers(-COORDINATE_LIMIT, COORDINATE_LIMIT)
points = st.lists(st.tuples(coordinates, coordinates), min_size=2, max_size=2)


@kernel
def call_turn(chromosomes, first, column, genes):
    turn(chromosomes, first, column, genes)


@kernel
def call_place(genes, gene, points, point, rounding, weights):
    place_way_points(genes, gene, points, point, rounding, weights[0], weights[1], weights[2])


@kernel
def call_join(points, j, lines, slopes, rows, cols):
    join_way_points(points, j, lines, slopes, rows, cols)


@kernel
def call_store(indices, at, numbers):
    store_fields(indices, at, *numbers)


@kernel
def call_sum(flat, indices, count):
    return sum_entries(flat, indices, count)


def rows_of(numbers, n, kind=np.int32):
    """Rows of memory, guarded by a row on each side."""
    memory = np.full((n + 2, CHROMOSOMES), -7, dtype=kind)
    memory[1 : n + 1] = numbers
    return memory


@pytest.mark.parametrize(("first", "column", "width"), [(0, 0, 16), (5, 0, 16), (3, 16, 48)])
def test_a_turned_matrix_is_the_transpose(first, column, width):
    chromosomes = np.arange(30 * width, dtype=np.int32).reshape(30, width)
    genes = rows_of(0, width)
    call_turn(chromosomes, first, column, genes[1:].reshape(-1))
    turned = genes[1 + column :][:CHROMOSOMES]
    rows = chromosomes[first : first + CHROMOSOMES, column : column + CHROMOSOMES]
    assert (turned == rows.T).all()
    assert (genes[0] == -7).all() and (genes[-1] == -7).all()
    assert not genes[1 : 1 + column].any()


@given(st.integers(3, 12), st.integers(2, 9), st.booleans(), st.data())
def test_way_points_are_those_of_one_chromosome(k, w, per_span, data):
    splines = basis(k, w, per_span)
    random = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    far = data.draw(st.sampled_from([1, 50, COORDINATE_LIMIT]))
    chromosomes = random.integers(-far, far + 1, (CHROMOSOMES, 2 * k)).astype(np.int32)
    j = data.draw(st.integers(0, len(splines.rounding) - 1))
    first = min(int(np.argmax(splines.weights[j] != 0)), k - 3)
    found = rows_of(0, 2)
    for axis in range(2):
        genes = np.ascontiguousarray(chromosomes.T).reshape(-1)
        weights = splines.weights[j, first : first + 3]
        call_place(
            genes, 2 * first + axis, found.reshape(-1), 1 + axis, splines.rounding[j], weights
        )
    expected = [[way_point(row, splines, j, axis) for row in chromosomes] for axis in range(2)]
    assert found[1:3].tolist() == expected
    assert (found[0] == -7).all() and (found[-1] == -7).all()


@given(st.lists(points, min_size=1, max_size=CHROMOSOMES), st.integers(1, 2**16), st.data())
def test_lines_are_described_as_by_hand(ends, cols, data):
    rows = data.draw(st.integers(1, 2**26 // cols))
    ends = np.array((ends * CHROMOSOMES)[:CHROMOSOMES], dtype=np.int32)  # (lane, end, axis)
    lines, slopes = rows_of(0, LINE), rows_of(0, 1, np.float64)
    memory = np.ascontiguousarray(ends.transpose(1, 2, 0)).reshape(-1)
    call_join(memory, 0, lines[1:].reshape(-1), slopes[1:].reshape(-1), rows, cols)
    for lane, ((x0, y0), (x1, y1)) in enumerate(ends.tolist()):
        steps, along, across, coarse, base = lines[1 : LINE + 1, lane].tolist()
        dx, dy = x1 - x0, y1 - y0
        n = max(abs(dx), abs(dy))
        inside = all(0 <= x < cols and 0 <= y < rows for x, y in ((x0, y0), (x1, y1)))
        assert steps == (n if inside else -n)
        if n == 0:
            continue
        wide = abs(dx) == n
        longer, other = (dx, dy) if wide else (dy, dx)
        assert along == (1 if wide else cols) * (1 if longer > 0 else -1)
        assert across == (cols if wide else 1)
        if inside:
            assert base == y0 * cols + x0
        exact = other * ONE / n
        assert exact <= coarse <= exact + 1 + 2.0**-8
        assert slope(other, n) <= np.floor(slopes[1, lane]) + 1 <= slope(other, n) + 1
    assert (lines[0] == -7).all() and (lines[-1] == -7).all()


def test_the_rows_of_a_line_are_in_their_order():
    assert (STEPS, ALONG, ACROSS, SLOPE, BASE) == (0, 1, 2, 3, 4)


@given(st.integers(0, 9), st.integers(0, 2**26), st.integers(1, 2**16), st.data())
def test_fields_are_those_of_one_step_after_the_other(at, base, cols, data):
    part, rise = data.draw(st.integers(0, ONE)), data.draw(st.integers(-ONE, ONE + 1))
    along = data.draw(st.sampled_from([1, -1, cols, -cols]))
    across = 1 if abs(along) == cols else cols
    indices = np.full(at + FIELDS + 1, -7, dtype=np.int32)
    call_store(indices, at, (base, along, across, part, rise))
    for step in range(1, FIELDS + 1):
        place = base + step * along + (part + step * rise) // ONE * across
        assert indices[at + step - 1] == place
    assert (indices[:at] == -7).all() and indices[-1] == -7


def test_positions_fit_32_bits():
    assert ONE + FIELDS * (ONE + 1) < 2**31


def test_no_line_is_long_enough_for_the_excess_to_matter():
    """FIELDS + 1 units of the coarse position, and n of the fine one, stay below 1 / (2 n)."""
    n = 2 * COORDINATE_LIMIT
    assert (FIELDS * 1.01 + 1) / ONE + n * 1.01 / 2**SHIFT < 1 / (2 * n)


@given(st.integers(0, 255), st.integers(0, 2**32 - 1))
def test_entries_are_added_up(count, seed):
    random = np.random.default_rng(seed)
    flat = random.choice([0, 1, 65536, 1 << 24], 50).astype(np.int32)
    indices = np.full(255 + READ + 1, -7, dtype=np.int32)
    indices[:count] = random.integers(0, 50, count)
    expected = int(flat[indices[:count]].astype(np.int64).sum())
    assert call_sum(flat, indices, count) == expected
    assert indices[-1] == -7


def test_as_many_obstacles_as_32_bits_hold():
    flat = np.full(1, 1 << 24, dtype=np.int32)
    assert call_sum(flat, np.zeros(255 + READ, dtype=np.int32), 255) == 255 << 24


def test_genes_divide_the_columns_of_a_matrix():
    assert CHROMOSOMES % GENES == 0


@pytest.mark.parametrize("genes", range(6, 66, 2))
def test_a_matrix_has_whole_vectors_behind_its_genes(genes):
    assert width(genes) % CHROMOSOMES == 0
    last = max(range(2, genes - 2, GENES))
    assert width(genes) >= max(last + GENES, genes)


def test_a_matrix_of_chromosomes_can_be_read_in_whole_vectors():
    for count, genes in ((1, 6), (40, 8), (100, 64)):
        rows, columns = chromosome_matrix(count, genes).shape
        assert rows >= count - 1 + CHROMOSOMES and columns == width(genes)

"""The fields of a line, many at a time, against one after the other."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gapath._jit import kernel
from gapath.kernels.lanes import FRACTION, LANES, read, store_fields
from gapath.kernels.raster import COORDINATE_LIMIT, SHIFT

ONE = 1 << FRACTION
slopes = st.integers(-ONE, ONE + 1)


@kernel
def call_store_fields(indices, at, numbers):
    store_fields(indices, at, *numbers)


@kernel
def call_read(flat, index):
    return read(flat, index)


@given(st.integers(0, 9), st.integers(0, 2**26), st.integers(1, 2**16), st.data())
def test_all_lanes_equal_one_after_the_other(at, base, cols, data):
    x, y = data.draw(st.integers(0, ONE)), data.draw(st.integers(0, ONE))
    slope_x, slope_y = data.draw(slopes), data.draw(slopes)
    indices = np.full(at + LANES + 1, -7, dtype=np.int32)
    call_store_fields(indices, at, (base, x, y, slope_x, slope_y, cols))
    for lane in range(LANES):
        right, down = (x + lane * slope_x) // ONE, (y + lane * slope_y) // ONE
        assert indices[at + lane] == base + down * cols + right
    assert (indices[:at] == -7).all()
    assert indices[-1] == -7


def test_positions_fit_32_bits():
    assert ONE + (LANES - 1) * (ONE + 1) < 2**31


def test_no_line_is_long_enough_for_the_excess_to_matter():
    """LANES units of the coarse position, and n of the fine one, stay below 1 / (2 n)."""
    n = 2 * COORDINATE_LIMIT
    assert LANES / 2**FRACTION + n * 1.002 / 2**SHIFT < 1 / (2 * n)


def test_read_gives_the_entry():
    flat = np.array([5, 1 << 24, 0, -3], dtype=np.int32)
    assert [call_read(flat, i) for i in range(4)] == flat.tolist()

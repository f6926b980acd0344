"""Thirty-two fields of a line at once: the only place that knows about lanes.

A processor adds and shifts sixteen integers as fast as one, but it reads fields from all over
a map one by one; where it has an instruction that gathers them, that is often the slower way.
So `store_fields` computes the places of the next fields side by side and stores them, and
`read` fetches the entries one after another::

    lane                   0       1       2       3     ...     31
    (x, y) + lane * slope    25 fractional bits
    whole fields        (0, 0)  (1, 0)  (2, 1)  (3, 1)   ...  (31, 13)   from the first one
    stored as           base    base+1  base+cols+2      ...             at indices[at + lane]

A line that ends in between leaves places behind its end, which the next line overwrites.
Without the JIT the same is done by the functions that follow, one lane after the other.
"""

from typing import Any

import numpy as np
from llvmlite import ir
from numpy.typing import NDArray

from gapath._jit import JIT, intrinsic, types

LANES = 32
FRACTION = 25
"""Fractional bits: so many that `LANES` steps fit 31 bits with a sign. Rounded up, position
and slope together lie at most LANES / 2**FRACTION too high, less than 1 / (2 n) for lines of
n <= 2**18 fields: no field changes (`gapath.kernels.raster`)."""


def store_fields(
    indices: NDArray[np.int32],
    at: int,
    base: int,
    x: int,
    y: int,
    slope_x: int,
    slope_y: int,
    cols: int,
) -> None:
    """Store the places of the next fields of a line in the flattened table, `LANES` of them.

    Parameters
    ----------
    indices : (n,) int32
        Overwritten from `at` on; n >= at + LANES.
    at : int
        Where to store the first one.
    base : int
        Place of the first field.
    x, y : int
        Position within the first field, `FRACTION` fractional bits.
    slope_x, slope_y : int
        From field to field.
    cols : int
        Fields in a row of the table.
    """
    for lane in range(LANES):
        right, down = (x + lane * slope_x) >> FRACTION, (y + lane * slope_y) >> FRACTION
        # what lies behind the end of a line may be anywhere
        indices[at + lane] = np.int64(base + down * cols + right).astype(np.int32)


def read(flat: NDArray[np.int32], index: int) -> int:
    """Read one entry.

    Parameters
    ----------
    flat : (n,) int32
        The flattened table.
    index : int
        From 0 to n - 1; not checked.

    Returns
    -------
    int
        The entry.
    """
    return int(flat[index])


_I32, _I64 = ir.IntType(32), ir.IntType(64)
_VECTOR = ir.VectorType(_I32, LANES)


def _vector(values: list[int]) -> Any:
    return ir.Constant(_VECTOR, values)


def _in_all_lanes(builder: Any, number: Any) -> Any:
    nothing = ir.Constant(_VECTOR, ir.Undefined)
    first = builder.insert_element(nothing, builder.trunc(number, _I32), _I32(0))
    return builder.shuffle_vector(first, nothing, _vector([0] * LANES))


def _store_fields(
    _: Any, indices: Any, at: Any, base: Any, x: Any, y: Any, slope_x: Any, slope_y: Any, cols: Any
) -> Any:
    """Give signature and code of `store_fields`."""

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        base, x, y, slope_x, slope_y, cols = (_in_all_lanes(builder, arg) for arg in args[2:])
        lane, shift = _vector(list(range(LANES))), _vector([FRACTION] * LANES)
        right = builder.ashr(builder.add(x, builder.mul(slope_x, lane)), shift)
        down = builder.ashr(builder.add(y, builder.mul(slope_y, lane)), shift)
        fields = builder.add(base, builder.add(builder.mul(down, cols), right))
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        first = builder.gep(data, [args[1]])
        builder.store(fields, builder.bitcast(first, ir.PointerType(_VECTOR)), align=4)
        return context.get_dummy_value()

    return types.void(indices, *[types.int64] * 7), code


def _read(_: Any, flat: Any, index: Any) -> Any:
    """Give signature and code of `read`.

    An atomic load is a plain load to the processor, but the compiler leaves it alone: it would
    otherwise turn a loop of loads into vectors, put together element by element.
    """

    def code(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        data = context.make_array(signature.args[0])(context, builder, args[0]).data
        entry = builder.load_atomic(builder.gep(data, [args[1]]), "monotonic", 4)
        return builder.sext(entry, _I64)

    return types.int64(flat, types.int64), code


if JIT:
    store_fields = intrinsic(_store_fields)
    read = intrinsic(_read)

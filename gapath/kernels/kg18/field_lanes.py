"""Vectors of the fields of a line: where they stand in the table, and what stands there.

- `store_fields`: the next `FIELDS` fields of a line side by side. Along its longer axis a line
  takes one field a step, so only the other axis needs a fraction::

      lane l         0       1       2       3       4
      along          1       2       3       4       5     l + 1
      across       0.7     1.1     1.5     1.9     2.3     1/2 + (l + 1) slope, here slope 0.4 and
                                                           start at 0.3; what follows the point is
                     0       1       1       1       2     cut off
      place        base + (l + 1) * stride along + (across, cut off) * stride across

  They go to memory one line after the other; what lies behind the end of a line is overwritten.
- `sum_entries`: what stands in the table at those places, one entry after the other. Where a
  processor has an instruction that gathers entries from all over a table, it is often slower.
"""

from typing import Any

from llvmlite import ir

from gapath.kernels.jit import intrinsic, types
from gapath.kernels.kg18.vectors import I32, I64, Code, Vector

FIELDS = 32

READ = 8
"""`sum_entries` reads so many entries at a time: there must be room for so many places more."""

FRACTION = 25
"""Fractional bits across: so many that `FIELDS` steps fit 31 bits with a sign. Rounded up, position
and slope together lie at most (FIELDS + 1) / 2**FRACTION too high, and where a block of fields
starts n / 2**SHIFT; that is less than 1 / (2 n) for lines of n <= 2**18 fields: no field changes
(`gapath.kernels.raster`)."""


@intrinsic
def store_fields(
    _: Any, indices: Any, at: Any, base: Any, along: Any, across: Any, part: Any, slope: Any
) -> Any:
    """Store the places of the next `FIELDS` fields of a line in the flattened table.

    Parameters
    ----------
    indices : (n,) int32
        Overwritten from `at` on; n >= at + FIELDS.
    at : int
        Where to store the first one.
    base : int
        Place of the field before the first.
    along, across : int
        Strides of the table along the line's longer and its other axis.
    part : int
        Position across within the field before, `FRACTION` fractional bits.
    slope : int
        Likewise, from field to field.
    """

    def code(*given: Any) -> Any:
        c = Code(*given)
        base, along, across, part, slope = (c.all_lanes(k, FIELDS) for k in range(2, 7))
        steps = ir.Constant(ir.VectorType(I32, FIELDS), list(range(1, FIELDS + 1)))
        step = Vector(c.builder, steps)
        places = base + along * step + (part + slope * step >> FRACTION) * across
        c.store(places, 0, c.args[1])
        return c.done()

    return types.void(indices, *[types.int64] * 6), code


@intrinsic
def sum_entries(_: Any, flat: Any, indices: Any, count: Any) -> Any:
    """Add up entries of the table.

    Two places are read at once, as one number of 64 bits, and the entries go to two sums, which
    need not wait for one another. An atomic load is a plain load to the processor, but the
    compiler leaves it alone: it would otherwise put vectors together element by element.

    Parameters
    ----------
    flat : (n,) int32
        The flattened table.
    indices : (m,) int32
        Places in it; m >= count + READ, those behind the last are overwritten.
    count : int
        How many to add up.

    Returns
    -------
    int
        The sum, if it is below 2**32.
    """

    def code(*given: Any) -> Any:
        c = Code(*given)
        builder, count = c.builder, c.args[2]
        # behind the last stands the first entry of the table, which is taken off again
        c.store(Vector(builder, ir.Constant(ir.VectorType(I32, READ), [0] * READ)), 1, count)
        before = builder.block
        loop, after = builder.append_basic_block("read"), builder.append_basic_block("read_all")
        builder.branch(loop)
        builder.position_at_end(loop)
        at, *begun = builder.phi(I64), builder.phi(I32), builder.phi(I32)
        sums = list(begun)
        for k in range(READ // 2):
            pair = builder.load(c.pointer(1, builder.add(at, I64(2 * k)), I64), align=4)
            for place in (builder.and_(pair, I64(2**32 - 1)), builder.lshr(pair, I64(32))):
                entry = builder.load_atomic(c.pointer(0, place, I32), "monotonic", 4)
                sums[k % 2] = builder.add(sums[k % 2], entry)
        following = builder.add(at, I64(READ))
        for phi, start, end in zip((at, *begun), (I64, I32, I32), (following, *sums), strict=True):
            phi.add_incoming(start(0), before)
            phi.add_incoming(end, loop)
        builder.cbranch(builder.icmp_signed("<", following, count), loop, after)
        builder.position_at_end(after)
        more = builder.trunc(builder.sub(following, count), I32)
        extra = builder.mul(more, builder.load(c.pointer(0, I64(0), I32)))
        return builder.zext(builder.sub(builder.add(*sums), extra), I64)

    return types.int64(flat, indices, types.int64), code

"""Vectors of chromosomes and of genes in a processor's registers.

A processor adds and multiplies sixteen numbers as fast as one. The functions here and in
`gapath.kernels.kg18.field_lanes`, the only ones that make vectors, do so in LLVM's intermediate
language: with the lanes that the processor has, on any processor.

- `turn`, `place_way_points`, `join_way_points`: `CHROMOSOMES` chromosomes side by side. Every gene,
  coordinate and number of a line has a row of memory, one lane a chromosome.
- `vary_genes`: `GENES` genes of a child side by side.

`evaluation` and `population` call these in their loops and know how many lanes there are; whoever
else makes a matrix of chromosomes asks `chromosome_matrix`. A lane that holds no chromosome, field
or gene is computed, too, and read by nobody.

Rounding down is done by shifting to positive numbers and cutting off, which every processor can.
"""

from typing import Any, TypeAlias

import numpy as np
from llvmlite import ir
from numpy.typing import NDArray

from gapath.kernels.jit import intrinsic, kernel, types
from gapath.kernels.kg18.field_lanes import FRACTION
from gapath.kernels.kg18.vectors import F64, I64, Code, Vector
from gapath.kernels.raster import COORDINATE_LIMIT, SHIFT

Way: TypeAlias = bool | None
SIDE_BY_SIDE, ONE_BY_ONE = None, True
"""Ways of computing the same: as vectors, or one number after the other. numba drops a branch on
``way is None`` by the argument's type, before it compiles: what was not chosen costs nothing."""

CHROMOSOMES, GENES = 16, 8

EXCESS = 1.0 / 1024
"""Lifts a slope above what its roundings take off; less than one unit is left of it."""

STEPS, ALONG, ACROSS, SLOPE, BASE, LINE = range(6)
"""Rows of a line, and how many: steps, negative if it leaves the map; strides of the table along
the longer and the other axis; slope across with `FRACTION` fractional bits; place of its start."""


@kernel
def width(genes: int) -> int:
    """Give the columns of a matrix of chromosomes with so many genes: whole vectors of any kind."""
    last = 2 + (genes - 4 + GENES - 1) // GENES * GENES  # `vary_genes` begins at the third gene
    return (max(genes, last) + CHROMOSOMES - 1) // CHROMOSOMES * CHROMOSOMES


@kernel
def chromosome_matrix(count: int, genes: int) -> NDArray[np.int32]:
    """Make room for chromosomes, one a row, such that whole vectors of them can be read.

    Parameters
    ----------
    count : int
        Chromosomes.
    genes : int
        2 k.

    Returns
    -------
    (n, m) int32
        Not filled; rows from `count` on, and columns from `genes` on, mean nothing.
    """
    return np.empty((count + CHROMOSOMES, width(genes)), dtype=np.int32)


def _row(c: Code, number: Any, offset: int = 0) -> Any:
    """Give the place of a row of `CHROMOSOMES` numbers."""
    return c.builder.mul(c.builder.add(number, I64(offset)), I64(CHROMOSOMES))


@intrinsic
def turn(_: Any, chromosomes: Any, first: Any, column: Any, genes: Any) -> Any:
    """Turn chromosomes, one a row, into genes, one a row.

    Rows exchange numbers, lowest bit of the number of a lane first::

        a0 a1 a2 a3      a0 b0 a2 b2      a0 b0 c0 d0
        b0 b1 b2 b3      a1 b1 a3 b3      a1 b1 c1 d1
        c0 c1 c2 c3  ->  c0 d0 c2 d2  ->  a2 b2 c2 d2
        d0 d1 d2 d3      c1 d1 c3 d3      a3 b3 c3 d3

    Parameters
    ----------
    chromosomes : (n, m) int32
        Chromosomes with room behind them: n >= first + CHROMOSOMES, m >= column + CHROMOSOMES.
    first, column : int
        The first chromosome and its first gene; so many genes of so many are turned.
    genes : (p,) int32
        Rows `column` and those that follow are overwritten.
    """

    def code(*given: Any) -> Any:
        c = Code(*given)
        n, shuffle = CHROMOSOMES, c.builder.shuffle_vector
        first, column = c.args[1:3]
        rows = []
        for i in range(n):
            row = c.builder.add(first, I64(i))
            rows.append(c.load(0, c.place(0, row, column), n).value)
        for bit in [2**k for k in range(n.bit_length() - 1)]:
            low = ir.Constant(rows[0].type, [j + (n - bit if j & bit else 0) for j in range(n)])
            high = ir.Constant(rows[0].type, [j + (n if j & bit else bit) for j in range(n)])
            for i in range(n):
                if not i & bit:
                    a, b = rows[i], rows[i + bit]
                    rows[i], rows[i + bit] = shuffle(a, b, low), shuffle(a, b, high)
        for i, row in enumerate(rows):
            c.store(Vector(c.builder, row), 3, _row(c, column, i))
        return c.done()

    return types.void(chromosomes, types.int64, types.int64, genes), code


@intrinsic
def place_way_points(
    _: Any,
    genes: Any,
    gene: Any,
    points: Any,
    point: Any,
    rounding: Any,
    first: Any,
    second: Any,
    third: Any,
) -> Any:
    """Compute one coordinate of a way point: `gapath.kernels.kg18.bspline.way_point`.

    Parameters
    ----------
    genes : (n,) int32
        Genes, one a row.
    gene : int
        The row of the first that counts; the others are the second and the fourth behind it.
    points : (m,) int32
        Coordinates, one a row.
    point : int
        The row to overwrite.
    rounding, first, second, third : float
        What to add, and the weights of the three genes.
    """

    def code(*given: Any) -> Any:
        c = Code(*given)
        shift = 2 * COORDINATE_LIMIT
        total = c.all_lanes(4, CHROMOSOMES, F64) + float(shift)
        for k in range(3):
            coordinate = c.load(0, _row(c, c.args[1], 2 * k), CHROMOSOMES).real()
            total += coordinate * c.all_lanes(5 + k, CHROMOSOMES, F64)
        c.store(total.whole() - shift, 2, _row(c, c.args[3]))
        return c.done()

    reals = [types.float64] * 4
    return types.void(genes, types.int64, points, types.int64, *reals), code


@intrinsic
def join_way_points(
    _: Any, points: Any, j: Any, lines: Any, slopes: Any, rows: Any, cols: Any
) -> Any:
    """Describe the lines from one way point to the next.

    Parameters
    ----------
    points : (n,) int32
        Coordinates, one a row: x and y of a way point follow one another.
    j : int
        Number of the line and of the way point at its start.
    lines : (m,) int32
        `LINE` rows a line, overwritten.
    slopes : (p,) float64
        A row a line, overwritten with its slope across, in units of 1 / 2**SHIFT.
    rows, cols : int
        Size of the map.
    """

    def code(*given: Any) -> Any:
        c = Code(*given)
        point = c.builder.mul(c.args[1], I64(2))
        line = c.builder.mul(c.args[1], I64(LINE))
        rows, cols = (c.all_lanes(k, CHROMOSOMES) for k in (4, 5))
        x0, y0, x1, y1 = (c.load(0, _row(c, point, k), CHROMOSOMES) for k in range(4))

        dx, dy = x1 - x0, y1 - y0
        tall = dx.size() < dy.size()
        longer, other = tall.choose(dy, dx), tall.choose(dx, dy)
        steps, stride = longer.size(), tall.choose(cols, 1)
        leaves = x0.outside(cols) | y0.outside(rows) | x1.outside(cols) | y1.outside(rows)
        slope = other.real() * (steps < 1).choose(steps + 1, steps).real().divide(2.0**SHIFT)
        slope += EXCESS
        shift = 2 << FRACTION
        coarse = (slope * 2.0 ** (FRACTION - SHIFT) + float(shift)).whole() - (shift - 1)

        c.store(slope, 3, _row(c, c.args[1]))
        c.store(leaves.choose(steps.negative(), steps), 2, _row(c, line, STEPS))
        c.store((longer < 0).choose(stride.negative(), stride), 2, _row(c, line, ALONG))
        c.store(cols + 1 - stride, 2, _row(c, line, ACROSS))
        c.store(coarse, 2, _row(c, line, SLOPE))
        c.store(y0 * cols + x0, 2, _row(c, line, BASE))
        return c.done()

    return types.void(points, types.int64, lines, slopes, types.int64, types.int64), code


@intrinsic
def vary_genes(
    _: Any,
    parents: Any,
    fitter: Any,
    other: Any,
    share: Any,
    rest: Any,
    rounding: Any,
    words: Any,
    word: Any,
    half: Any,
    threshold: Any,
    changes: Any,
    limits: Any,
    children: Any,
    child: Any,
    gene: Any,
) -> Any:
    """Make the next `GENES` genes of a child: `gapath.kernels.kg18.population.vary`.

    Parameters
    ----------
    parents, children : (n, m) int32
        A chromosome a row; m >= gene + GENES.
    fitter, other, child : int
        Rows of the parents, and the row to overwrite.
    share, rest, rounding : float
        Shares of the parents, and what to add before rounding down.
    words : (p,) uint64
        Random words.
    word : int
        The one for the first gene; p >= word + GENES.
    half : int
        Bits to skip of a word: 0 or 32.
    threshold : uint64
        A gene changes if the upper half of its word is below.
    changes : (2, m) int32
        Values that a change has, and what the least is below 0.
    limits : (2, m) int32
        The least and the greatest value of each gene.
    gene : int
        The first gene.
    """

    def code(*given: Any) -> Any:
        c = Code(*given)
        gene, shift = c.args[14], 2 * COORDINATE_LIMIT
        mixed = c.all_lanes(5, GENES, F64) + float(shift)
        for parent, share in ((1, 3), (2, 4)):
            value = c.load(0, c.place(0, c.args[parent], gene), GENES).real()
            mixed += value * c.all_lanes(share, GENES, F64)
        spans, lows, least, greatest = (
            c.load(k, c.place(k, I64(bound), gene), GENES) for k in (10, 11) for bound in (0, 1)
        )
        word = c.load(6, c.args[7], GENES, I64)
        mask = 2**32 - 1
        wide = Vector(c.builder, c.builder.zext(spans.value, word.kind))
        upper = Vector(c.builder, c.builder.lshr(word.value, word._like(32)))
        drawn = Vector(c.builder, c.builder.lshr(word.value, c.all_lanes(8, GENES, I64).value))
        drawn = (((drawn & mask) * wide) >> 32).short() - lows
        happens = upper < c.all_lanes(9, GENES, I64)
        value = mixed.whole() - shift + happens.choose(drawn, 0)
        value = (value < least).choose(least, value)
        value = (greatest < value).choose(greatest, value)
        c.store(value, 12, c.place(12, c.args[13], gene))
        return c.done()

    whole, real = types.int64, types.float64
    ints = [whole, whole]
    signature = types.void(
        parents,
        *ints,
        real,
        real,
        real,
        words,
        *ints,
        types.uint64,
        changes,
        limits,
        children,
        *ints,
    )
    return signature, code

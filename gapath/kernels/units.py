"""The fixed point in which weights and costs are counted, exact on every machine; corner rules."""

SCALE = 65536
"""A cost of 1.0 is 65536 units, so weights are rounded to 1 / 65536."""

OBSTACLE_BITS = 24
"""The upper bits of a table entry count one obstacle field."""

OBSTACLE = 1 << OBSTACLE_BITS
"""A table entry of a field that cannot be passed: above every weight's."""

ALLOW, ONE_SIDE, FORBID, NO_DIAGONALS = range(4)
"""Corner-cutting rules as kernels take them: the values of `gapath.problem.CornerCutting`."""

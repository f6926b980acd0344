"""What the memetic algorithm is set to, and what it tells: places in the arrays for both."""

POPULATION, HANDS, EFFORT, TOLERANCE, CROSSOVER_THRESHOLD, REROUTE_THRESHOLD, ASK = range(7)
"""What the kernel is set to: EFFORT and TOLERANCE in units of 1 / `UNIT`, probabilities as
`gapath.kernels.rng.probability_threshold` gives them; ASK is 1 to end as soon as the first path
is found to be `UNEVEN` or `CROWDED`. (numba takes long to look at a record.)"""

UNIT = 1024

WALLS, LOOPS, ASIDE, PULLING, SEARCH, NEWCOMER, CROSSOVER, REROUTE, VERTICES = range(9)
"""What finds a path and makes it cheaper; from VERTICES on the four of `mutations`."""
OPERATORS = VERTICES + 4
"""How many there are."""

(STATUS, BEST, LOWER, START, INDIVIDUAL, MEMBERS, EPOCHS, EVALUATIONS, READ, CHANGES, POINTS,
 SHARES) = range(12)  # fmt: skip
NUMBERS = SHARES + OPERATORS
"""What comes out besides: the fields of the first path, or what it is instead
(`gapath.kernels.memetic.walls.NO_WAY`); the sum of the best path's weights, its start left out;
what no path can undercut; the start's weight; which individual is best, and of how many; epochs;
how many newcomers, crossovers and mutations were tried, and the fields that they read; what the
diary holds; and how much each operator lowered the cost of the best individual, of WALLS what the
first path costs."""

UNEVEN, CROWDED = -3, -4
"""STATUS where nothing but a first path was made, since others say more than walls do: UNEVEN where
the first path pays more than the least weight somewhere, CROWDED where obstacles bend it every few
fields, or leave corridors of a field or two."""

"""The memetic algorithm: first paths, crossed and mutated, each made short before it counts.

Moscato 1989 calls such an evolution memetic: its individuals are the local optima that a search of
their own makes of them. Here that is wall following, loops cut off, looks aside and strings
pulled. What costs time is counted in fields that are read; newcomers, crossovers and mutations
together may read so many times the fields of the first path.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.account import (
    ASK,
    CROSSOVER,
    CROSSOVER_THRESHOLD,
    CROWDED,
    EFFORT,
    EPOCHS,
    EVALUATIONS,
    HANDS,
    INDIVIDUAL,
    LOOPS,
    LOWER,
    MEMBERS,
    NUMBERS,
    POPULATION,
    READ,
    REROUTE,
    REROUTE_THRESHOLD,
    SHARES,
    START,
    STATUS,
    TOLERANCE,
    UNEVEN,
    UNIT,
    VERTICES,
    WALLS,
)
from gapath.kernels.memetic.mutations import INSERT, propose, replace
from gapath.kernels.memetic.polygon import fields_of, is_crowded, length_of
from gapath.kernels.memetic.population import (
    Diary,
    Individuals,
    finished,
    individuals,
    noted,
    opened,
    put,
    with_room,
)
from gapath.kernels.memetic.rays import ray
from gapath.kernels.memetic.rerouting import Room, crossed, first_walk, newcomers, reroute
from gapath.kernels.memetic.shortening import FIXED, SHORTENING, cut_loops, running_cost, shortened
from gapath.kernels.rng import Stream, fill, happens, high, low


@kernel
def evolve(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    least: int,
    settings: NDArray[np.int64],
    known: NDArray[np.uint32],
    stream: Stream,
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Run the memetic algorithm.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    start_x, start_y, target_x, target_y : int
        Free fields.
    rule : int
        Corner-cutting rule.
    least : int
        The least weight of any free field but start and target.
    settings : (7,) int64
        POPULATION and what follows.
    known : (n,) uint32
        A path from start to target that is known already, instead of the walls'; or nothing.
    stream : (4,) uint64
        A random stream, advanced in place.

    Returns
    -------
    told : (n,) int64
        STATUS and what follows, NUMBERS of them; then the diary, `CHANGES` rows of its changes and
        `POINTS` vertices, each in one number, y * 2**X_BITS + x.
    path : (m, 2) int32
        Fields (x, y) of the best path; none without one.
    """
    ends = (np.int64(start_x), np.int64(start_y), np.int64(target_x), np.int64(target_y))
    numbers = np.zeros(NUMBERS, dtype=np.int64)
    nothing = np.empty((0, 2), dtype=np.int32)
    apart = max(abs(target_x - start_x), abs(target_y - start_y))
    if apart > 0:
        numbers[LOWER] = least * (apart - 1) + table[target_y, target_x]
    numbers[START] = table[start_y, start_x]
    numbers[MEMBERS] = numbers[EPOCHS] = numbers[EVALUATIONS] = 1
    content = numbers[LOWER]
    if settings[TOLERANCE] > 0:  # of a field less nobody should wait
        content += max(content * settings[TOLERANCE] // UNIT, np.int64(least))
    blocked, straight = ray(table, start_x, start_y, target_x, target_y, rule)
    if blocked == 0 and straight <= content:
        numbers[STATUS], numbers[SHARES + WALLS] = 2, straight
        line, cost = np.empty((2, 2), dtype=np.int32), np.full(1, straight)
        line[0, 0], line[0, 1], line[1, 0], line[1, 1] = ends
        members = put(individuals(1, 2), 0, line, cost, 2, straight)
        diary = noted(opened(2), members, 1, 0, WALLS, 0)
        return finished(table, rule, members, diary, numbers, np.empty(0, dtype=np.uint32))

    searched = known.shape[0] > 0
    if searched:
        count, walked, path = known.shape[0], np.int64(0), known.copy()
    else:
        count, walked, path = first_walk(table, ends, rule, settings, stream)
    numbers[STATUS] = count
    if count < 0:
        return numbers, nothing
    cost = running_cost(table, path, count)[count - 1]
    numbers[SHARES + WALLS] = cost
    if settings[ASK] and cost > least * (count - 2) + table[target_y, target_x]:
        numbers[STATUS] = UNEVEN
        return numbers, nothing
    order = np.empty(table.size, dtype=np.int32)
    size, total, points, costs = shortened(
        table, path, count, rule, content, True, order, numbers[SHARES:]
    )
    if settings[ASK] and total > content and is_crowded(points, size):
        numbers[STATUS] = CROWDED
        return numbers, nothing

    # Walls lead nobody to the like of a path that was searched.
    population = settings[POPULATION] if total > content and not searched else 1
    members = put(individuals(population, size), 0, points, costs, size, total)
    diary = noted(opened(size), members, 1, 0, WALLS, 0)
    # The more a path winds, the less may be gained by another one as long.
    budget = (walked + SHORTENING * count) * settings[EFFORT] // UNIT
    budget = budget * apart // max(length_of(points, size), 1)
    room = Room(order, path, np.empty(0, dtype=np.uint32), np.empty(0, dtype=np.uint32))
    if total > content and budget > 0:
        members, diary, room = newcomers(
            table, ends, rule, settings, content, budget, members, diary, numbers, room, stream
        )
        members, diary, room = generations(
            table, rule, least, settings, content, budget, members, diary, numbers, room, stream
        )
    return finished(table, rule, members, diary, numbers, room.path)


@kernel(inner=True)
def generations(
    table: NDArray[np.int32],
    rule: int,
    least: int,
    settings: NDArray[np.int64],
    content: int,
    budget: int,
    members: Individuals,
    diary: Diary,
    numbers: NDArray[np.int64],
    room: Room,
    stream: Stream,
) -> tuple[Individuals, Diary, Room]:
    """Cross and mutate, an evaluation an individual in each epoch.

    What is taken and given is that of `newcomers`.
    """
    n = numbers[MEMBERS]
    pairs = n * (n - 1) // 2 if settings[CROSSOVER_THRESHOLD] else 0
    first, bent = numbers[EVALUATIONS], False
    words = np.empty(5, dtype=np.uint64)
    while numbers[READ] < budget and members.totals[numbers[INDIVIDUAL]] > content:
        before = members.totals[numbers[INDIVIDUAL]]
        tried = numbers[EVALUATIONS] - first
        numbers[EPOCHS] = 2 + tried // n
        fill(stream, words)
        # Each pair is crossed once before chance decides.
        crossing = happens(words[0], np.uint64(settings[CROSSOVER_THRESHOLD]))
        if tried < pairs or (n > 1 and crossing):
            row, other = pair(tried, n) if tried < pairs else drawn_pair(words, n)
            operator = CROSSOVER
            row, gain, fields, members, room = crossover(
                table, row, other, rule, numbers[LOWER], members, room
            )
        else:
            row, other = high(words[1], n), low(words[1], n)
            if members.totals[other] < members.totals[row]:
                row = other
            operator, gain, fields, members, room = mutation(
                table, row, rule, least, settings, words, members, room, stream
            )
        numbers[READ] += FIXED + fields
        numbers[EVALUATIONS] += 1
        if gain > 0 or (gain == 0 and operator >= VERTICES):  # as cheap, with fewer vertices
            diary = noted(diary, members, numbers[EPOCHS], row, operator, gain)
        bent |= gain > 0 and operator >= VERTICES
        if members.totals[row] < before:
            numbers[SHARES + operator] += before - members.totals[row]
            numbers[INDIVIDUAL] = row
    if bent:
        return unlooped(table, rule, members, diary, numbers, room)
    return members, diary, room


@kernel(inner=True)
def pair(k: int, n: int) -> tuple[int, int]:
    """Give the k-th pair of n individuals: (0, 1), (0, 2), ..., (1, 2), ..."""
    row, other = 0, k + 1
    while other >= n:
        row += 1
        other += row + 1 - n
    return row, other


@kernel(inner=True)
def drawn_pair(words: NDArray[np.uint64], n: int) -> tuple[int, int]:
    """Draw two of n individuals."""
    row = high(words[1], n)
    other = high(words[2], n - 1)
    return row, other + int(other >= row)


@kernel(inner=True)
def crossover(
    table: NDArray[np.int32],
    row: int,
    other: int,
    rule: int,
    lower: int,
    members: Individuals,
    room: Room,
) -> tuple[int, int, int, Individuals, Room]:
    """Cross two individuals; the child takes the cheaper one's place if it is cheaper still.

    Gives which that is, what it became cheaper by, the fields that were read, population and room.
    """
    if members.totals[other] < members.totals[row]:
        row, other = other, row
    count, cost, fields, room = crossed(
        table, members.points[row], members.sizes[row],
        members.points[other], members.sizes[other], rule, room,
    )  # fmt: skip
    gain = members.totals[row] - cost
    if gain > 0:
        none = np.empty(0, dtype=np.int64)
        size, total, points, costs = shortened(
            table, room.child, count, rule, lower, False, room.order, none
        )
        gain = members.totals[row] - total
        members = put(members, row, points, costs, size, total)
    return row, gain, fields, members, room


@kernel(inner=True)
def mutation(
    table: NDArray[np.int32],
    row: int,
    rule: int,
    least: int,
    settings: NDArray[np.int64],
    words: NDArray[np.uint64],
    members: Individuals,
    room: Room,
    stream: Stream,
) -> tuple[int, int, int, Individuals, Room]:
    """Mutate an individual: reroute it past some vertices, or change a vertex.

    Gives the operator, what the individual became cheaper by (-1 if it stays as it was), the fields
    that were read, population and room.
    """
    rows, cols = table.shape
    size = members.sizes[row]
    # What pays the least weight everywhere can only become cheaper elsewhere.
    bent = members.totals[row] > least * length_of(members.points[row], size)
    reroutes = np.uint64(settings[REROUTE_THRESHOLD])
    if size > 2 and reroutes and (not bent or happens(words[0], reroutes)):
        gain, fields, members, room = reroute(
            table, members, row, least, rule, settings[HANDS], words[2:], room, stream
        )
        return REROUTE, gain, fields, members, room
    kind = low(words[0], 4) if size > 2 else INSERT
    members = with_room(members, size + 2)
    new = np.empty((2, 2), dtype=np.int32)
    i, j, count = propose(kind, members.points[row], size, rows, cols, words[1:], new)
    fields = length_of(members.points[row, i : j + 1], j + 1 - i)
    gain, members.sizes[row] = replace(
        table, members.points[row], members.costs[row], size, i, j, new, count, rule
    )
    members.totals[row] -= max(gain, 0)
    return VERTICES + kind, gain, fields, members, room


@kernel(inner=True)
def unlooped(
    table: NDArray[np.int32],
    rule: int,
    members: Individuals,
    diary: Diary,
    numbers: NDArray[np.int64],
    room: Room,
) -> tuple[Individuals, Diary, Room]:
    """Cut spurs off the best individual: vertices that moved may leave a way there and back."""
    best = numbers[INDIVIDUAL]
    count, path = fields_of(
        table, members.points[best], members.sizes[best], False, rule, room.path
    )
    short = cut_loops(table, path, count, room.order, rule)
    if short < count:
        none = np.empty(0, dtype=np.int64)
        size, total, points, costs = shortened(
            table, path, short, rule, numbers[LOWER], False, room.order, none
        )
        gain = members.totals[best] - total
        members = put(members, best, points, costs, size, total)
        diary = noted(diary, members, numbers[EPOCHS], best, LOOPS, gain)
        numbers[SHARES + LOOPS] += gain
    return members, diary, Room(room.order, path, room.other, room.child)

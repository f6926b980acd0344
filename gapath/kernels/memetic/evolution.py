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
    BEST,
    CHANGES,
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
    NEWCOMER,
    NUMBERS,
    POINTS,
    POPULATION,
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
from gapath.kernels.memetic.polygon import cornered, fields_of, is_crowded, length_of
from gapath.kernels.memetic.population import (
    Diary,
    Individuals,
    individuals,
    noted,
    opened,
    put,
    same_side,
    with_room,
)
from gapath.kernels.memetic.rays import ray
from gapath.kernels.memetic.rerouting import Room, crossed, reroute, walked_path
from gapath.kernels.memetic.shortening import FIXED, SHORTENING, cut_loops, running_cost, shortened
from gapath.kernels.memetic.steps import STEP_X, STEP_Y, X_BITS, X_MASK, is_free
from gapath.kernels.memetic.walls import GIVEN_UP
from gapath.kernels.rng import Stream, fill, happens, high, low

EARLY, FOREVER = 8, 1 << 40
"""Steps along walls for each row and column after which to look whether corridors are narrow."""

SAMPLES = 16
"""Rows, and columns, of fields that are looked at for that."""


@kernel
def is_narrow(table: NDArray[np.int32]) -> bool:
    """Tell whether most free fields, of some all over the map, have at most three free neighbours.

    There a search sees about as many fields as hands do, and is the faster.
    """
    rows, cols = table.shape
    free, narrow = 0, 0
    for i in range(SAMPLES * SAMPLES):
        y, x = (2 * (i // SAMPLES) + 1) * rows // (2 * SAMPLES), (i % SAMPLES) * cols // SAMPLES
        x = (x + i // SAMPLES) % cols  # not all in one column of what repeats itself
        if not is_free(table, x, y):
            continue
        around = 0
        for k in range(8):
            around += is_free(table, x + STEP_X[k], y + STEP_Y[k])
        free += 1
        narrow += around <= 3
    return 2 * narrow > free


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
    rows, cols = table.shape
    hands = settings[HANDS]
    none = np.empty(0, dtype=np.int64)
    numbers = np.zeros(NUMBERS, dtype=np.int64)
    shares = numbers[SHARES:]
    words = np.empty(5, dtype=np.uint64)
    lower = np.int64(table[target_y, target_x])
    if start_x == target_x and start_y == target_y:
        lower = np.int64(0)
    else:
        lower += least * (max(abs(target_x - start_x), abs(target_y - start_y)) - 1)
    content = lower
    if settings[TOLERANCE] > 0:  # of a field less nobody should wait
        content += max(lower * settings[TOLERANCE] // UNIT, np.int64(least))
    numbers[LOWER], numbers[START] = lower, table[start_y, start_x]
    blocked, straight = ray(table, start_x, start_y, target_x, target_y, rule)
    if blocked == 0 and straight <= content:
        members = individuals(1, 2)
        members.points[0, 0, 0], members.points[0, 0, 1] = start_x, start_y
        members.points[0, 1, 0], members.points[0, 1, 1] = target_x, target_y
        members.sizes[0], members.totals[0] = 2, straight
        numbers[STATUS], shares[WALLS] = 2, straight
        diary = noted(opened(2), members, 1, 0, WALLS, 0)
        return finished(table, rule, members, 0, 1, 1, diary, numbers, np.empty(0, dtype=np.uint32))
    order = np.empty(table.size, dtype=np.int32)
    if known.shape[0]:
        count, walked, path = known.shape[0], np.int64(0), known.copy()
    else:
        path = np.empty(256, dtype=np.uint32)
        budget = np.int64(EARLY * (rows + cols) if settings[ASK] else FOREVER)
        for _ in range(2):
            count, walked, path = walked_path(
                table, start_x, start_y, target_x, target_y, rule, hands,
                budget, False, False, path, stream,
            )  # fmt: skip
            if count != GIVEN_UP or is_narrow(table):
                break
            budget = np.int64(FOREVER)
    numbers[STATUS] = count
    if count == GIVEN_UP:
        numbers[STATUS] = CROWDED
    if count < 0:
        return numbers, np.empty((0, 2), dtype=np.int32)
    fields = walked + SHORTENING * count
    cost = running_cost(table, path, count)[count - 1]
    shares[WALLS] = cost
    if settings[ASK] and cost > least * (count - 2) + table[target_y, target_x]:
        numbers[STATUS] = UNEVEN
        return numbers, np.empty((0, 2), dtype=np.int32)
    if known.shape[0] and settings[EFFORT] == 0:
        size, total, points, costs = cornered(table, path, count)
    else:
        size, total, points, costs = shortened(
            table, path, count, rule, content, True, order, shares
        )
    # The more a path winds, the less may be gained by another one as long.
    apart = max(abs(target_x - start_x), abs(target_y - start_y))
    budget = fields * settings[EFFORT] // UNIT * apart // max(length_of(points, size), 1)
    population = settings[POPULATION]
    if total <= content or known.shape[0]:
        population = 1  # walls lead nobody to the like of a path that was searched
    if settings[ASK] and total > content and is_crowded(points, size):
        numbers[STATUS] = CROWDED
        return numbers, np.empty((0, 2), dtype=np.int32)
    members = put(individuals(population, size), 0, points, costs, size, total)
    diary = noted(opened(size), members, 1, 0, WALLS, 0)
    n, best, epoch, evaluations = 1, 0, 1, 1
    spent = np.int64(0)
    if total <= content or budget == 0:
        return finished(table, rule, members, best, epoch, evaluations, diary, numbers, path)

    room = Room(order, path, np.empty(256, dtype=np.uint32), np.empty(512, dtype=np.uint32))
    for k in range(1, 2 * members.sizes.shape[0]):
        if (
            n == members.sizes.shape[0]
            or members.totals[best] <= content
            or spent + FIXED >= budget
        ):
            break
        count, walked, path = walked_path(
            table, start_x, start_y, target_x, target_y, rule, hands,
            budget - spent, k > 1, k & 1 == 1, room.path, stream,
        )  # fmt: skip
        evaluations += 1
        room = Room(order, path, room.other, room.child)
        spent += FIXED + walked + SHORTENING * max(count, 0)
        if count < 0:
            continue
        size, total, points, costs = shortened(table, path, count, rule, content, True, order, none)
        row = n
        for other in range(n):
            if same_side(table, members.points[other], members.sizes[other], points, size, rule):
                row = other
                break
        if row < n and total >= members.totals[row]:
            continue
        before = members.totals[best]
        members = put(members, row, points, costs, size, total)
        diary = noted(diary, members, 1, row, NEWCOMER, 0)
        n = max(n, row + 1)
        if total < before:
            best = row
            shares[NEWCOMER] += before - total

    pairs = n * (n - 1) // 2  # each is crossed once before chance decides
    if settings[CROSSOVER_THRESHOLD] == 0:
        pairs = 0
    first, bent_once = evaluations, False
    while spent < budget and members.totals[best] > content:
        tried = evaluations - first
        epoch = 2 + tried // n
        fill(stream, words)
        before = members.totals[best]
        if tried < pairs or (n > 1 and happens(words[0], np.uint64(settings[CROSSOVER_THRESHOLD]))):
            operator = CROSSOVER
            row = high(words[1], n)
            other = high(words[2], n - 1)
            other += other >= row
            if tried < pairs:
                row, other = 0, tried + 1
                while other >= n:
                    row += 1
                    other += row + 1 - n
            if members.totals[other] < members.totals[row]:
                row, other = other, row
            count, cost, fields, room = crossed(
                table, members.points[row], members.sizes[row],
                members.points[other], members.sizes[other], rule, room,
            )  # fmt: skip
            gain = members.totals[row] - cost
            if gain > 0:
                size, total, points, costs = shortened(
                    table, room.child, count, rule, lower, False, room.order, none
                )
                gain = members.totals[row] - total
                members = put(members, row, points, costs, size, total)
        else:
            row, other = high(words[1], n), low(words[1], n)
            if members.totals[other] < members.totals[row]:
                row = other
            size = members.sizes[row]
            # What pays the least weight everywhere can only become cheaper elsewhere.
            bent = members.totals[row] > least * length_of(members.points[row], size)
            reroutes = np.uint64(settings[REROUTE_THRESHOLD])
            if size > 2 and reroutes and (not bent or happens(words[0], reroutes)):
                operator = REROUTE
                gain, fields, members, room = reroute(
                    table, members, row, least, rule, hands, words[2:], room, stream
                )
            else:
                kind = low(words[0], 4) if size > 2 else INSERT
                operator = VERTICES + kind
                members = with_room(members, size + 2)
                new = np.empty((2, 2), dtype=np.int32)
                i, j, count = propose(kind, members.points[row], size, rows, cols, words[1:], new)
                length = length_of(members.points[row, i : j + 1], j + 1 - i)
                gain, members.sizes[row] = replace(
                    table, members.points[row], members.costs[row], size, i, j, new, count, rule
                )
                members.totals[row] -= max(gain, 0)
                bent_once |= gain > 0
                fields = length
        spent += FIXED + fields
        evaluations += 1
        if gain > 0 or (gain == 0 and operator >= VERTICES):  # as cheap, with fewer vertices
            diary = noted(diary, members, epoch, row, operator, gain)
        if members.totals[row] < before:
            shares[operator] += before - members.totals[row]
            best = row

    if bent_once:  # vertices that moved may leave a spur, which the path goes there and back
        count, path = fields_of(
            table, members.points[best], members.sizes[best], False, rule, room.path
        )
        short = cut_loops(table, path, count, order, rule)
        if short < count:
            size, total, points, costs = shortened(
                table, path, short, rule, lower, False, order, none
            )
            gain = members.totals[best] - total
            members = put(members, best, points, costs, size, total)
            diary = noted(diary, members, epoch, best, LOOPS, gain)
            shares[LOOPS] += gain
        room = Room(order, path, room.other, room.child)
    return finished(table, rule, members, best, epoch, evaluations, diary, numbers, room.path)


@kernel
def finished(
    table: NDArray[np.int32],
    rule: int,
    members: Individuals,
    best: int,
    epoch: int,
    evaluations: int,
    diary: Diary,
    numbers: NDArray[np.int64],
    path: NDArray[np.uint32],
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """Give what `evolve` does, of the best individual; ``path`` is room for its fields."""
    numbers[BEST], numbers[INDIVIDUAL] = members.totals[best], best
    numbers[EPOCHS], numbers[EVALUATIONS] = epoch, evaluations
    numbers[CHANGES], numbers[POINTS] = diary.counts[0], diary.counts[1]
    count, path = fields_of(table, members.points[best], members.sizes[best], False, rule, path)
    fields = np.empty((count, 2), dtype=np.int32)
    for k in range(count):
        fields[k, 0], fields[k, 1] = path[k] & X_MASK, path[k] >> X_BITS
    n, m = diary.counts[0], diary.counts[1]
    told = np.empty(NUMBERS + 6 * n + m, dtype=np.int64)
    told[:NUMBERS] = numbers
    told[NUMBERS : NUMBERS + 6 * n] = diary.changes[:n].ravel()
    for k in range(m):
        point = (np.int64(diary.vertices[k, 1]) << X_BITS) + diary.vertices[k, 0]
        told[NUMBERS + 6 * n + k] = point
    return told, fields

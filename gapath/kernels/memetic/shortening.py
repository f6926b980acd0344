"""What makes a path of fields shorter: loops cut off, looks aside, strings pulled."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel
from gapath.kernels.memetic.account import ASIDE, LOOPS, PULLING, WALLS
from gapath.kernels.memetic.polygon import fields_of, is_crowded
from gapath.kernels.memetic.rays import ray
from gapath.kernels.memetic.steps import STEP_X, STEP_Y, X_BITS, X_MASK, may_step
from gapath.kernels.units import NO_DIAGONALS, OBSTACLE

APART, REACH, LEAST_GAIN = 8, 128, 8
"""Fields from one look aside to the next, that it reaches, that it has to save."""

FIXED, SHORTENING = 64, 4
"""What an evaluation takes, and what it takes to make a path shorter, a field: in steps along
walls."""

LONG = 48
"""Fields of a path from which on looks aside are worth their time."""


@kernel
def cut_loops(
    table: NDArray[np.int32],
    path: NDArray[np.uint32],
    count: int,
    order: NDArray[np.int32],
    rule: int,
) -> int:
    """Go on from each field with the last of its neighbours on the path.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`); changed in place.
    count : int
        How many it has, at least 1.
    order : (rows * cols,) int32
        Anything; overwritten where the path is.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        How many it has then, no field twice.
    """
    rows, cols = table.shape
    for i in range(count):
        order[np.int64(path[i] >> X_BITS) * cols + np.int64(path[i] & X_MASK)] = i  # the last time
    at = np.int64(order[np.int64(path[0] >> X_BITS) * cols + np.int64(path[0] & X_MASK)])
    short = 1
    turn = 2 if rule == NO_DIAGONALS else 1
    while at < count - 1:
        x, y = np.int64(path[at] & X_MASK), np.int64(path[at] >> X_BITS)
        inside = 0 < x < cols - 1 and 0 < y < rows - 1
        last = at + 1
        for k in range(0, 8, turn):
            u, v = x + STEP_X[k], y + STEP_Y[k]
            if not inside and not (0 <= u < cols and 0 <= v < rows):
                continue
            # What was never written may hold any number; of a field on the path the path says so.
            i = np.int64(order[np.uint64(v * cols + u)])
            there = last < i < count and path[np.uint64(i)] == (v << X_BITS) + u
            if there and may_step(table, x, y, u, v, rule):
                last = i
        path[short] = path[last]
        short += 1
        at = last
    return short


@kernel
def look_aside(
    table: NDArray[np.int32],
    path: NDArray[np.uint32],
    count: int,
    sums: NDArray[np.int64],
    order: NDArray[np.int32],
    short: NDArray[np.uint32],
) -> int:
    """Look along the axes from some fields of a path, and go straight to the latest of it seen.

    So a path gets out of a dead end that it followed all round: `pull` only looks along it.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`), none twice.
    count : int
        How many.
    sums : (n,) int64
        As `running_cost` gives them.
    order : (rows * cols,) int32
        Anything; overwritten where the path is.
    short : (n,) uint32
        Overwritten with the path that comes out, which is not dearer.

    Returns
    -------
    int
        How many fields it has.
    """
    rows, cols = table.shape
    for i in range(count):
        order[np.int64(path[i] >> X_BITS) * cols + np.int64(path[i] & X_MASK)] = i
    at, n = 0, 1
    short[0] = path[0]
    while at < count - 1:
        if at % APART == 0:
            x, y = np.int64(path[at] & X_MASK), np.int64(path[at] >> X_BITS)
            gain, to, way, steps = LEAST_GAIN, 0, 0, 0
            for k in range(0, 8, 2):
                u, v = x, y
                cost = np.int64(0)
                for s in range(1, REACH + 1):
                    u += STEP_X[k]
                    v += STEP_Y[k]
                    if not (0 <= u < cols and 0 <= v < rows) or table[v, u] >= OBSTACLE:
                        break
                    cost += table[v, u]
                    i = np.int64(order[v * cols + u])
                    there = at < i < count and path[i] == (v << X_BITS) + u
                    if there and i - at - s > gain and cost <= sums[i] - sums[at]:
                        gain, to, way, steps = i - at - s, i, k, s
            if steps:
                for _ in range(steps):
                    x += STEP_X[way]
                    y += STEP_Y[way]
                    short[n] = (y << X_BITS) + x
                    n += 1
                at = to
                continue
        at += 1
        short[n] = path[at]
        n += 1
    return n


@kernel
def running_cost(
    table: NDArray[np.int32], path: NDArray[np.uint32], count: int
) -> NDArray[np.int64]:
    """Give what a path costs up to each of its fields, the first one left out.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`).
    count : int
        How many, at least 1.

    Returns
    -------
    (count,) int64
        In units of 1 / SCALE.
    """
    sums = np.empty(count, dtype=np.int64)
    sums[0] = 0
    for i in range(1, count):
        sums[i] = sums[i - 1] + table[path[i] >> X_BITS, path[i] & X_MASK]
    return sums


@kernel
def pull(
    table: NDArray[np.int32],
    path: NDArray[np.uint32],
    count: int,
    sums: NDArray[np.int64],
    rule: int,
    points: NDArray[np.int32],
    costs: NDArray[np.int64],
) -> tuple[int, int]:
    """Pull a path straight: a polygon of rays, each as far as it is free and no dearer.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`), each a neighbour of the one before.
    count : int
        How many.
    sums : (n,) int64
        As `running_cost` gives them.
    rule : int
        Corner-cutting rule.
    points : (n, 2) int32
        Overwritten with the vertices as (x, y).
    costs : (n,) int64
        Overwritten with what each vertex's ray to the next one costs.

    Returns
    -------
    vertices : int
        How many.
    cost : int
        The sum of the costs.
    """
    at, n, total = 0, 1, np.int64(0)
    points[0, 0], points[0, 1] = path[0] & X_MASK, path[0] >> X_BITS
    while at < count - 1:
        x, y = np.int64(points[n - 1, 0]), np.int64(points[n - 1, 1])
        good, cost = at + 1, sums[at + 1] - sums[at]
        bad, reach = count, 4
        while bad - good > 1:
            to = min(at + reach, count - 1) if bad == count else (good + bad) >> 1
            u, v = np.int64(path[to] & X_MASK), np.int64(path[to] >> X_BITS)
            blocked, through = ray(table, x, y, u, v, rule)
            if blocked == 0 and through <= sums[to] - sums[at]:
                good, cost = to, through
            else:
                bad = to
            reach *= 2
        points[n, 0], points[n, 1] = path[good] & X_MASK, path[good] >> X_BITS
        costs[n - 1] = cost
        total += cost
        n += 1
        at = good
    return n, total


@kernel
def pull_there_and_back(
    table: NDArray[np.int32],
    points: NDArray[np.int32],
    costs: NDArray[np.int64],
    size: int,
    rule: int,
    path: NDArray[np.uint32],
) -> tuple[int, int, NDArray[np.int32], NDArray[np.int64], NDArray[np.uint32]]:
    """Pull a polygon from the target back to the start, and from there again.

    The first pull leaves vertices where the path ran along the outer side of a bend; pulled from
    the other end they come to its inner side.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    points : (n, 2) int32
        Vertices; overwritten, or others are made where they need room.
    costs : (n,) int64
        What their rays cost, likewise.
    size : int
        How many vertices there are.
    rule : int
        Corner-cutting rule.
    path : (m,) uint32
        Room for fields; another one is made if it is too small.

    Returns
    -------
    size, total : int
        How many vertices there are now, and the sum of the costs.
    points, costs, path : arrays
        Where they are now.
    """
    total = np.int64(0)
    for _ in range(2):
        count, path = fields_of(table, points, size, True, rule, path)
        if count > points.shape[0]:
            points = np.empty((count, 2), dtype=np.int32)
            costs = np.empty(count, dtype=np.int64)
        sums = running_cost(table, path, count)
        size, total = pull(table, path, count, sums, rule, points, costs)
    return size, total, points, costs, path


@kernel
def shortened(
    table: NDArray[np.int32],
    path: NDArray[np.uint32],
    count: int,
    rule: int,
    enough: int,
    aside: bool,
    order: NDArray[np.int32],
    shares: NDArray[np.int64],
) -> tuple[int, int, NDArray[np.int32], NDArray[np.int64]]:
    """Make a polygon of a path, as short as it can be without going round an obstacle otherwise.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    path : (n,) uint32
        Fields (`gapath.kernels.memetic.steps`); changed in place.
    count : int
        How many.
    rule : int
        Corner-cutting rule.
    enough : int
        A cost that is low enough to stop at.
    aside : bool
        Look aside, too.
    order : (rows * cols,) int32
        Anything; overwritten.
    shares : (OPERATORS,) int64
        Overwritten with the path's cost, and with what each step takes off; or of no length.

    Returns
    -------
    size, total : int
        How many vertices, and what it costs.
    points, costs : arrays
        Its vertices, and what their rays cost.
    """
    told = shares.shape[0] > 0
    if told:
        shares[WALLS] = running_cost(table, path, count)[count - 1]
    count = cut_loops(table, path, count, order, rule)
    sums = running_cost(table, path, count)
    looped = sums[count - 1]
    if aside and count > LONG and looped > enough:
        short = np.empty(count, dtype=np.uint32)
        n = look_aside(table, path, count, sums, order, short)
        if n < count:
            path, count, sums = short, n, running_cost(table, short, n)
    seen = sums[count - 1]
    points, costs = np.empty((count, 2), dtype=np.int32), np.empty(count, dtype=np.int64)
    size, total = pull(table, path, count, sums, rule, points, costs)
    pulled = total + 1
    hopeless = told and is_crowded(points, size)  # others will do that
    while enough < total < pulled and size > 2 and not hopeless:
        pulled = total
        size, total, points, costs, path = pull_there_and_back(
            table, points, costs, size, rule, path
        )
    if told:
        shares[LOOPS] = shares[WALLS] - looped
        shares[ASIDE], shares[PULLING] = looped - seen, seen - total
    return size, total, points, costs

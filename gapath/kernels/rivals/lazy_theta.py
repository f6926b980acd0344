"""Lazy Theta* (Nash, Koenig & Tovey 2010): A* whose paths leave the grid's eight directions.

A field's parent is not the neighbour from which it was reached but that one's parent, if a
straight line leads on from there. Whether one does is asked when the field is expanded, once,
not at each of the up to eight times that it is reached; if not, its parent is the best neighbour
expanded before. Where fields differ in weight the line has to be no dearer, either (as in Choi &
Yu 2011), and until it is read it is taken for as heavy as the way that it shortens.
"""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.graph_search import NO_PATH, STEP_X, STEP_Y
from gapath.kernels.jit import kernel
from gapath.kernels.lines import too_narrow
from gapath.kernels.rivals.line_costs import FINE, IN_THE_WAY, euclidean, line_cost
from gapath.kernels.rivals.queue import (
    EMPTY,
    LAST,
    USED,
    empty_buckets,
    is_full,
    more,
    put,
    take,
)
from gapath.kernels.units import ALLOW, OBSTACLE

LENGTHS = np.sqrt(np.float64(STEP_X**2 + STEP_Y**2))
"""Of steps."""


@kernel(inner=True)
def step_cost(weight: int, step: int) -> int:
    """Give the cost of a step to a field of a weight, in units of the table.

    It is rounded up: one line must not seem dearer than itself in two pieces.
    """
    return np.int64(np.float64((weight + 1) * FINE) * LENGTHS[step]) + 1


@kernel(inner=True)
def leads_on(weights: NDArray[np.int32], cols: int, place: int, step: int, rule: int) -> bool:
    """Tell whether a step on the map leads to a free field and may be made."""
    if weights[np.uint64(place + STEP_Y[step] * cols + STEP_X[step])] >= OBSTACLE:
        return False
    if rule == ALLOW or step < 4:
        return True
    walls = np.int64(weights[np.uint64(place + STEP_Y[step] * cols)] >= OBSTACLE)
    walls += weights[np.uint64(place + STEP_X[step])] >= OBSTACLE
    return not too_narrow(walls, rule)


@kernel(inner=True)
def settle(
    table: NDArray[np.int32],
    costs: NDArray[np.int64],
    parents: NDArray[np.int32],
    place: int,
    rule: int,
) -> int:
    """Read the line to a field, or find the neighbour by which to come to it.

    Neighbours are asked only if the line is dearer than was thought, or in fact none: what was
    thought is no dearer than the way by the neighbour from which the field was reached.

    Parameters
    ----------
    table : (rows, cols) int32
        `GridMap.table`.
    costs : (rows * cols,) int64
        1 + cost of each field reached, negative once it is expanded, 0 of others.
    parents : (rows * cols,) int32
        Number of each one's parent; changed in place.
    place : int
        Number of a field that is not expanded yet.
    rule : int
        Corner-cutting rule.

    Returns
    -------
    int
        1 + cost of the field.
    """
    rows, cols = table.shape
    weights = table.ravel()
    y, x = place // cols, place % cols
    parent = np.int64(parents[place])
    cost = line_cost(table, parent % cols, parent // cols, x, y, rule)
    if cost != IN_THE_WAY:
        cost -= costs[parent]
        if cost <= costs[place]:
            return cost
    own = np.int64(table[y, x])
    for step in range(8):
        x0, y0 = x - STEP_X[step], y - STEP_Y[step]
        if not (0 <= x0 < cols and 0 <= y0 < rows):
            continue
        before = y0 * cols + x0
        if costs[before] >= 0 or not leads_on(weights, cols, before, step, rule):
            continue
        through = step_cost(own, step) - costs[before]
        if cost == IN_THE_WAY or through < cost:
            cost = through
            parents[place] = before
    return cost


@kernel
def lazy_theta(
    table: NDArray[np.int32],
    start_x: int,
    start_y: int,
    target_x: int,
    target_y: int,
    rule: int,
    least: int,
    costs: NDArray[np.int64],
    parents: NDArray[np.int32],
    expansions: NDArray[np.int64],
) -> int:
    """Find a path of straight lines, short but seldom the shortest.

    What is to come is estimated as a straight line over fields of the least weight. That is no
    bound of the next estimate, as the line to a field may be shorter than was thought: what would
    have had its turn already is next.

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
    costs : (rows * cols,) int64
        Zeros; overwritten.
    parents : (rows * cols,) int32
        Overwritten where a field was reached: the number (y * cols + x) of the field from which a
        straight line leads to it; the start's own of the start.
    expansions : (1,) int64
        Overwritten with the number of fields expanded.

    Returns
    -------
    int
        Way points from start to target; NO_PATH.
    """
    rows, cols = table.shape
    weights = table.ravel()
    begin, end = start_y * cols + start_x, target_y * cols + target_x
    items, buckets = np.empty((256, 2), dtype=np.int64), empty_buckets()
    marks = np.zeros(3, dtype=np.int64)
    marks[USED] = 1
    rate = np.float64((least + 1) * FINE)
    costs[begin], parents[begin] = 1, begin
    put(items, buckets, marks, begin, 0)
    expansions[0] = 0
    while True:
        place = take(items, buckets, marks)
        if place == EMPTY:
            return np.int64(NO_PATH)
        if costs[place] < 0:
            continue  # it was put in again when a cheaper way was found
        if place != begin:
            costs[place] = settle(table, costs, parents, place, rule)
        if place == end:
            break
        expansions[0] += 1
        cost = costs[place]
        costs[place] = -cost
        y, x = place // cols, place % cols
        parent = np.int64(parents[place])
        x0, y0 = parent % cols, parent // cols
        far, behind = euclidean(x - x0, y - y0), abs(costs[parent])
        for step in range(8):
            x1, y1 = x + STEP_X[step], y + STEP_Y[step]
            if not (0 <= x1 < cols and 0 <= y1 < rows):
                continue
            there = y1 * cols + x1
            if costs[there] < 0 or not leads_on(weights, cols, place, step, rule):
                continue
            own = step_cost(np.int64(weights[there]), step)
            shorter = euclidean(x1 - x0, y1 - y0) / (far + LENGTHS[step])
            through = behind + np.int64(np.float64(cost - behind + own) * shorter)
            if costs[there] != 0 and through >= costs[there]:
                continue
            costs[there], parents[there] = through, parent
            if is_full(items, marks):
                items = more(items, 2)
            ahead = np.int64(rate * euclidean(target_x - x1, target_y - y1))
            put(items, buckets, marks, there, max(through + ahead, marks[LAST]))
    count = 1
    while place != begin:
        place = parents[place]
        count += 1
    return count


@kernel
def way_points_to(
    parents: NDArray[np.int32], cols: int, target_x: int, target_y: int, count: int
) -> NDArray[np.int32]:
    """Follow the parents back from the target.

    Parameters
    ----------
    parents : (rows * cols,) int32
        As `lazy_theta` left them.
    cols : int
        Width of the map.
    target_x, target_y, count : int
        As in the search, and what it gave.

    Returns
    -------
    (count, 2) int32
        Way points (x, y) from start to target.
    """
    way_points = np.empty((count, 2), dtype=np.int32)
    place = target_y * cols + target_x
    for i in range(count - 1, -1, -1):
        way_points[i, 0], way_points[i, 1] = place % cols, place // cols
        place = np.int64(parents[place])
    return way_points

"""Jump point search field by field, and what its pruning rests on from the definition."""

import heapq
import itertools
import math

import naive

STEPS = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]


def plus(place, step):
    return place[0] + step[0], place[1] + step[1]


def may(weights, place, step, rule):
    there = plus(place, step)
    return not naive.is_obstacle(weights, *there) and not naive.forbidden(
        weights, place, there, rule
    )


def order(steps, rule):
    """Less is better: steps, then diagonal ones, then how late these, or horizontal ones, come."""
    diagonal = [dx != 0 and dy != 0 for dx, dy in steps]
    vertical = [dy != 0 for _, dy in steps]
    late = vertical if rule == "no_diagonals" else [not each for each in diagonal]
    return len(steps), sum(diagonal), late


def worth_by_definition(weights, place, step, rule):
    """Possible steps to which no better way leads from the field before, but through this one."""
    before = (place[0] - step[0], place[1] - step[1])
    worth = set()
    for after in STEPS:
        goal = plus(place, after)
        if not may(weights, place, after, rule) or goal == before:
            continue
        ways = [[first] for first in STEPS] + [list(two) for two in itertools.product(STEPS, STEPS)]
        better = False
        for way in ways:
            at, free = before, True
            for i, move in enumerate(way):
                free = free and may(weights, at, move, rule)
                at = plus(at, move)
                free = free and (at != place or i == len(way) - 1)
            if free and at == goal and order(way, rule) < order([step, after], rule):
                better = True
        if not better:
            worth.add(after)
    return worth


def worth(weights, place, step, rule):
    """The same from the published rules, steps that are not possible among them."""
    (x, y), (dx, dy) = place, step
    beside = rule in ("allow", "one_side")
    steps = {step}
    if dx and dy:
        steps |= {(dx, 0), (0, dy)}
        if beside and naive.is_obstacle(weights, x - dx, y):
            steps.add((-dx, dy))
        if beside and naive.is_obstacle(weights, x, y - dy):
            steps.add((dx, -dy))
        return steps
    for side in ((dy, dx), (-dy, -dx)):
        if beside and naive.is_obstacle(weights, *plus(place, side)):
            steps.add(plus(step, side))
        if not beside and naive.is_obstacle(weights, x - dx + side[0], y - dy + side[1]):
            steps |= {side, plus(step, side)} if rule == "forbid" else {side}
    return steps


def jumps(weights, place, step, target, rule):
    """Where jumps with a first step lead, with the last step of each."""
    (dx, dy), spreads = step, ()
    if dx and dy:
        spreads = ((0, dy), (dx, 0))
    elif rule == "no_diagonals" and dx:
        spreads = ((0, -1), (0, 1))
    while may(weights, place, step, rule):
        x, y = place
        place = plus(place, step)
        if place == target:
            yield place, step
            return
        if spreads:
            beside = [naive.is_obstacle(weights, x + dx, y), naive.is_obstacle(weights, x, y + dy)]
            turns = any(beside)
        else:
            others = worth(weights, place, step, rule) - {step}
            turns = any(may(weights, place, other, rule) for other in others)
        if turns:
            yield place, step
            return
        for spread in spreads:
            yield from jumps(weights, place, spread, target, rule)


def search(problem, straight, diagonal):
    """Length of a shortest path, the fields where it turns, and how many were expanded."""
    weights, rule = problem.map.weights, problem.corner_cutting.name.lower()
    start, target = problem.start, problem.target

    def length(a, b):
        dx, dy = abs(a[0] - b[0]), abs(a[1] - b[1])
        if rule == "no_diagonals":
            return (dx + dy) * straight
        return abs(dx - dy) * straight + min(dx, dy) * diagonal

    usual = STEPS[:4] if rule == "no_diagonals" else STEPS
    costs, before, worth_it, tried = {start: 0}, {}, {start: set(usual)}, {start: set()}
    queue, number, expanded = [(0, 0, start)], 0, 0
    while queue:
        place = heapq.heappop(queue)[2]
        if place == target:
            path = [place]
            while path[0] != start:
                path.insert(0, before[path[0]])
            return costs[target], path, expanded
        todo = worth_it[place] - tried[place]
        if not todo:
            continue
        expanded += 1
        tried[place] |= todo
        signs = [(a > b) - (a < b) for a, b in zip(target, place, strict=True)]
        towards = sorted(STEPS, key=lambda step: step[0] * signs[0] + step[1] * signs[1])
        for step in towards:
            if step not in todo:
                continue
            for there, last in jumps(weights, place, step, target, rule):
                cost = costs[place] + length(place, there)
                steps = worth(weights, there, last, rule)
                if cost > costs.get(there, math.inf):
                    continue
                if cost == costs.get(there):
                    if steps <= worth_it[there]:
                        continue
                    worth_it[there] |= steps
                else:
                    worth_it[there], tried[there] = steps, set()
                costs[there], before[there] = cost, place
                number += 1
                heapq.heappush(queue, (cost + length(there, target), -number, there))
    return None, [], expanded

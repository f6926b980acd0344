"""Obvious slow twins of the drive: the sensor, and KG18's step function as Sec. 4 describes it."""

from types import SimpleNamespace

import naive
import numpy as np

from gapath.kernels.rng import stream
from gapath.kernels.units import OBSTACLE, SCALE

HEADINGS = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)]


def layer(place, heading, number):
    """The fields of one layer of the view, on the map or not."""
    x, y = place
    ahead, down = HEADINGS[heading]
    fields = set()
    for dx in range(-number, number + 1):
        for dy in range(-number, number + 1):
            if ahead and down:
                inside = dx * ahead >= 0 and dy * down >= 0
                distance = max(abs(dx), abs(dy))
            else:
                distance = dx * ahead + dy * down
                inside = abs(dx * down + dy * ahead) <= distance
            if inside and distance == number:
                fields.add((x + dx, y + dy))
    return fields


def view(table, place, heading, layers, occlusion):
    """The fields that the robot sees."""
    rows, cols = table.shape
    fields = set()
    for number in range(layers + 1):
        for u, v in layer(place, heading, number):
            if not (0 <= u < cols and 0 <= v < rows):
                continue
            between = naive.polyline([place, (u, v)])[1:-1]
            if occlusion and any(table[y, x] == OBSTACLE for x, y in between):
                continue
            fields.add((u, v))
    return fields


def heading_of(dx, dy):
    """Along an axis if the other component is less than half as long, else diagonal."""

    def sign(a, other):
        return 0 if 2 * abs(a) < abs(other) else (a > 0) - (a < 0)

    return HEADINGS.index((sign(dx, dy), sign(dy, dx)))


def simplified(past):
    """KG18 Sec. 4.6, point by point."""
    past = list(past)
    i = 0
    while i < len(past):
        for j in range(len(past) - 1, i, -1):
            if past[j] == past[i]:
                del past[i:j]
                break
        i += 1
    return tuple(past)


def kg18_drive(problem, navigator, sensor, seed, trial, step_limit, unknown_weight):
    """KG18 Figs 10-14 on a map that does not change.

    Returns the outcome and, step by step, place, heading, mode, path, past path and the
    planners' paths that were adopted.
    """
    true, start, target = problem.map.table, problem.start, problem.target
    rule = problem.corner_cutting.name.lower()
    known = np.full(true.shape, round(unknown_weight * 65536), dtype=np.int32)
    for x, y in (start, target):
        known[y, x] = true[y, x]
    place, mode, path, past = start, "explore", None, [start]
    passed = due = 0
    walked_back, steps = [], []

    def look(heading):
        for x, y in view(true, place, heading, sensor.range, sensor.occlusion):
            known[y, x] = true[y, x]

    def passable(table, a, b):
        as_weights = np.where(table == OBSTACLE, 1.0, 0.5)
        return as_weights[b[1], b[0]] != 1 and not naive.forbidden(as_weights, a, b, rule)

    def plan(step, planner, part, index, dearer=()):
        table = known.copy()
        for x, y in set(dearer):
            table[y, x] += round(navigator.return_penalty * SCALE)
        grid = SimpleNamespace(table=table, rows=table.shape[0], cols=table.shape[1])
        query = SimpleNamespace(
            map=grid, start=place, target=target, corner_cutting=problem.corner_cutting
        )
        answer = planner.plan(query, stream(seed, trial, step + 1 << 16 | part << 8 | index))
        return [tuple(map(int, field)) for field in answer.path]

    def draw(step):
        least, most = navigator.retreat_interval
        words = naive.Words(seed, trial, step + 1 << 16 | 3 << 8)
        return least + naive.high(words.take(), most - least + 1)

    heading = heading_of(target[0] - start[0], target[1] - start[1])
    look(heading)
    for step in range(step_limit):
        if place == target:
            return "REACHED", steps
        if place == start and mode == "return":
            return "RETURNED", steps
        new, shown = [], None
        moves = list(zip(path or [], (path or [])[1:], strict=False))
        if mode == "return":
            if passed >= due:
                new = plan(step, navigator.retreat, 0, 0, walked_back)
                shown = "explore"
                if not new:
                    passed, due = 0, draw(step)
        elif path and all(passable(known, a, b) for a, b in moves):
            if passed and passed % navigator.explore_interval == 0:
                new = plan(step, navigator.explore, 1, 0)
                shown = "explore"
                if new and sum(known[y, x] for x, y in new) >= sum(known[y, x] for x, y in path):
                    new = []
        else:
            for i, planner in enumerate(navigator.replan):
                new = new or plan(step, planner, 2, i)
            shown = "replan"
            if not new:
                mode, path, passed, due = "return", None, 0, draw(step)
                past, walked_back = list(simplified(past)), []
        if new:
            mode, path, passed, walked_back = "explore", new, 0, []
        passed += 1
        before = list(past)
        following = past[-2] if mode == "return" and len(past) > 1 else place
        if mode == "explore":
            following = path[1]
        dx, dy = following[0] - place[0], following[1] - place[1]
        if dx or dy:
            heading = HEADINGS.index((dx, dy))
        look(heading)
        said = mode if mode == "return" else (shown if new else "explore")
        ahead = path
        if (dx or dy) and passable(true, place, following):
            if mode == "return":
                walked_back.append(past.pop())
            else:
                past.append(following)
                path = path[1:]
            place = following
        elif mode == "explore":
            passed -= 1
        steps.append((place, heading, said, ahead, tuple(before), new))
    ended = "REACHED" if place == target else "OVERRAN"
    return "RETURNED" if place == start and mode == "return" else ended, steps

"""Lazy Theta* and RRT-Connect in plain Python."""

import itertools
import math

import naive

STEPS = [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]


def line_cost(weights, a, b, rule):
    """None if something is in the way."""
    fields = naive.polyline([a, b])
    obstacles, cost = naive.fitness(weights, fields, rule)
    if obstacles:
        return None
    n = len(fields) - 1
    if n == 0:
        return 0
    entered = cost - naive.fitness(weights, fields[:1])[1] + n
    return int(entered * 1024 * math.sqrt((b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2) / n)


def lazy_theta(problem):
    """Way points and how many fields were expanded."""
    weights, rule = problem.map.weights, problem.corner_cutting.name.lower()
    start, target = problem.start, problem.target
    rate = (problem.map.least_weight(start, target) + 1) * 1024
    costs, parents, closed = {start: 0}, {start: start}, {}
    queue, last, number = [(0, 0, start)], 0, 0
    while queue:
        queue.sort()
        last, _, place = queue.pop(0)
        if place in closed:
            continue
        x, y = place
        if place != start:
            parent = parents[place]
            line = line_cost(weights, parent, place, rule)
            enough = line is not None and closed[parent] + line <= costs[place]
            best = math.inf if line is None else closed[parent] + line
            for dx, dy in STEPS:
                before = (x - dx, y - dy)
                if before in closed and not enough:
                    step = line_cost(weights, before, place, rule)
                    if step is not None and closed[before] + step + 1 < best:
                        best, parents[place] = closed[before] + step + 1, before
            costs[place] = best
        if place == target:
            points = [target]
            while points[0] != start:
                points.insert(0, parents[points[0]])
            return points, len(closed)
        closed[place] = costs[place]
        parent = parents[place]
        for dx, dy in STEPS:
            there = (x + dx, y + dy)
            if naive.is_obstacle(weights, *there) or there in closed:
                continue
            step = line_cost(weights, place, there, rule)
            if step is None:
                continue
            way = math.dist(parent, place) + math.dist(place, there)
            known = closed[place] - closed[parent] + step + 1
            through = closed[parent] + int(known * (math.dist(parent, there) / way))
            if through >= costs.get(there, math.inf):
                continue
            costs[there], parents[there] = through, parent
            number += 1
            priority = through + int(rate * math.dist(there, target))
            queue.append((max(priority, last), -number, there))
    return None, len(closed)


def field_of_line(a, b, i):
    return naive.polyline([a, b])[i]


def rrt_connect(weights, start, target, rule, iterations, step, words):
    """Way points, or None; and the fields of both trees, in the order in which they grew."""
    rows, cols = weights.shape
    trees = [{start: None}, {target: None}]
    grew = [start, target]

    def grow(tree, near, goal):
        reach = min(step, max(abs(goal[0] - near[0]), abs(goal[1] - near[1])))
        while reach:
            there = field_of_line(near, goal, reach)
            if line_cost(weights, near, there, rule) is not None:
                tree[there] = near
                grew.append(there)
                return there
            reach //= 2
        return None

    def nearest(tree, goal):
        return min(tree, key=lambda f: (f[0] - goal[0]) ** 2 + (f[1] - goal[1]) ** 2)

    for iteration in range(iterations):
        own, other = trees if iteration % 2 == 0 else trees[::-1]
        word = words.take()
        goal = (naive.high(word, cols), naive.low(word, rows))
        new = grow(own, nearest(own, goal), goal)
        if new is None:
            continue
        at = nearest(other, new)
        while at is not None and at != new:
            at = grow(other, at, new)
        if at == new:
            halves = []
            for tree in trees:
                half = [new]
                while tree[half[-1]] is not None:
                    half.append(tree[half[-1]])
                halves.append(half)
            return halves[0][::-1] + halves[1][1:], grew
    return None, grew


def shorten(weights, points, rule, tries, words):
    points = list(points)
    for _ in range(tries):
        word, fields, lines = words.take(), [points[0]], [1]
        for i in range(1, len(points)):
            inner = naive.polyline(points[i - 1 : i + 1])[1:]
            fields += inner
            lines += [i] * len(inner)
        one, another = sorted((naive.high(word, len(fields)), naive.low(word, len(fields))))
        begin, end = lines[one], lines[another]
        if begin == end:
            continue
        new = [points[begin - 1], fields[one], fields[another], points[end]]
        costs = [line_cost(weights, a, b, rule) for a, b in itertools.pairwise(new)]
        old = itertools.pairwise(points[begin - 1 : end + 1])
        if None in costs or sum(costs) >= sum(line_cost(weights, a, b, rule) for a, b in old):
            continue
        kept = [new[0]] + [b for a, b in itertools.pairwise(new) if b != a]
        points[begin - 1 : end + 1] = kept
    return points

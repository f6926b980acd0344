"""The changing world: seeded, never on the robot, and as before when all has vanished."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from strategies import weights

from gapath.driving.world import Changes, World
from gapath.errors import InputError
from gapath.grid import GridMap
from gapath.kernels.units import OBSTACLE


def walk(world, steps, robot=lambda step: (1, 1)):
    tables = []
    for step in range(steps):
        world.advance(step, robot(step))
        tables.append(world.table.copy())
    return tables


def test_a_static_world_is_the_map_itself():
    grid = GridMap("w", np.full((6, 6), 0.5))
    world = World(grid, Changes(0, 1, 1), ((0, 0), (5, 5)), 0, 0)
    walk(world, 5)
    assert world.table is grid.table


@given(weights(), st.integers(1, 5), st.integers(1, 9), st.integers(1, 6), st.integers(0, 99))
def test_changes(values, every, lifetime, side, seed):
    grid = GridMap("w", values)
    ends = ((0, 0), (grid.cols - 1, grid.rows - 1))
    robots = np.random.default_rng(seed).integers(0, (grid.cols, grid.rows), (30, 2))

    def robot(step):
        return int(robots[step, 0]), int(robots[step, 1])

    make = (grid, Changes(every, lifetime, side), ends, seed, 3)
    tables, again = walk(World(*make), 30, robot), walk(World(*make), 30, robot)
    for step, (table, same) in enumerate(zip(tables, again, strict=True)):
        assert (table == same).all()
        appeared = table != grid.table
        assert (table[appeared] == OBSTACLE).all()
        for x, y in ends:
            assert not appeared[y, x]
        most = -(-lifetime // every) * side**2
        assert appeared.sum() <= most
        if step % every == 0:
            x, y = robot(step)
            assert not appeared[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2].any()


def test_squares_appear_and_vanish():
    grid = GridMap("w", np.full((40, 40), 0.5))
    world = World(grid, Changes(10, 4, 3), ((0, 0), (39, 39)), 1, 0)
    blocked = [(table == OBSTACLE).sum() for table in walk(world, 40)]
    assert all(0 < n <= 9 for n in (blocked[0], blocked[3], blocked[10], blocked[13]))
    assert not any(blocked[4:10]) and not any(blocked[14:20])


def test_other_trials_have_other_squares():
    grid = GridMap("w", np.full((40, 40), 0.5))
    tables = [
        walk(World(grid, Changes(5, 9, 3), ((0, 0), (39, 39)), *keys), 20)[-1]
        for keys in ((1, 0), (1, 1), (2, 0))
    ]
    assert (tables[0] != tables[1]).any() and (tables[0] != tables[2]).any()


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ((-1, 1, 1), "every: got -1, expected an integer from 0 to 1000000"),
        ((10**6 + 1, 1, 1), "every: got 1000001, expected an integer from 0 to 1000000"),
        ((1, 0, 1), "lifetime: got 0, expected an integer from 1 to 1000000"),
        ((1, 10**6 + 1, 1), "lifetime: got 1000001, expected an integer from 1 to 1000000"),
        ((1, 1, 0), "side"),
        ((1, 1, 1001), "side"),
    ],
)
def test_bad_changes(values, field):
    with pytest.raises(InputError, match=f"^drive.changes.{field}"):
        Changes(*values)

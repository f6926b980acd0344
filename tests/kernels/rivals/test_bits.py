"""Scans along lines of bits against one field by field, and which tiles they ask for."""

import naive
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gapath.grid import GridMap
from gapath.kernels.rivals.bits import COLUMNS, NOWHERE, ROWS, make_tile, no_tiles, scan
from gapath.problem import CornerCutting


def scanned(wall, at, step, goal, rule):
    """Where it leads, from whether there is an obstacle on the line and on the two beside it."""
    beside = rule in ("allow", "one_side")
    here, ends = at, False
    while not wall(here, 0) and not ends:
        here += step
        for side in (-1, 1):
            before = wall(here - step, side) and not (beside and here - step == at)
            ends |= before and not wall(here, side)
    last = here - step if beside or wall(here, 0) else here
    if goal in range(at + step, last + step, step):
        return goal
    return None if wall(here, 0) and not (rule == "allow" and ends) else last


@st.composite
def scans(draw):
    """A long map or a small one, a free field on it, and where to go from there."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rows, cols = (draw(st.sampled_from([1, 2, 5, 62, 63, 64, 66, 127, 140])) for _ in range(2))
    weights = np.full((rows, cols), 0.5)
    for _ in range(draw(st.integers(0, 40))):  # bars, whose ends may be far apart
        x, y, *size = random.integers(0, [cols, rows, 90, 4])
        width, height = random.permutation(size)
        weights[y : y + height, x : x + width] = 1.0
    x, y = random.integers(0, [cols, rows]).tolist()
    weights[y, max(x - 70, 0) : x + 70 : draw(st.sampled_from([1, 3, 200]))] = 0.5
    weights[y, x] = 0.5
    lines, step = draw(st.sampled_from([ROWS, COLUMNS])), draw(st.sampled_from([-1, 1]))
    rule = draw(st.sampled_from(list(CornerCutting)))
    at, most = (x, cols) if lines == ROWS else (y, rows)
    goal = draw(st.none() | st.integers(0, most - 1))
    return weights, lines, x, y, step, None if goal == at else goal, rule


@given(scans())
def test_scans_stop_where_one_field_by_field_does_and_make_no_tile_in_vain(drawn):
    weights, lines, x, y, step, goal, rule = drawn
    table = GridMap("bars", weights).table
    at, line = (x, y) if lines == ROWS else (y, x)

    def wall(along, side):
        place = (along, y + side) if lines == ROWS else (x + side, along)
        return naive.is_obstacle(weights, *place)

    expected = scanned(wall, at, step, goal, rule.name.lower())
    words, across, down = no_tiles(*weights.shape)
    for k in range(130 * across * down):
        found = scan(
            words, across, down, lines, line + 1, at + 1, step,
            NOWHERE if goal is None else goal + 1, int(rule),
        )  # fmt: skip
        if found >= 0:
            break
        tile = -1 - found
        near = tile // across, tile % across  # the line's, or of one beside it
        if lines == COLUMNS:
            near = near[::-1]
        assert near[0] in (line >> 6, (line + 2) >> 6)
        assert words[128 * across * down + tile] == 0
        assert k < 2 * max(across, down)
        make_tile(table, words, across, down, tile)
    assert found == (NOWHERE if expected is None else expected + 1)

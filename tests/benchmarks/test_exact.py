"""The exact planners of other libraries find the same cost, or say why they are not there."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from strategies import problems

from benchmarks.questions import exact
from gapath.grid import GridMap
from gapath.problem import CornerCutting, Problem

ABSENT = "skipped: the bench extra is not installed"


def posed(problem, zeros):
    """Pose a problem with KG18's rule; without `zeros` only its ends may have a weight of 0."""
    weights = problem.map.weights.copy()
    if not zeros:
        inner = np.ones_like(weights, dtype=bool)
        for x, y in (problem.start, problem.target):
            inner[y, x] = False
        weights[inner & (weights == 0)] = 0.25
    grid = GridMap("random", weights)
    return Problem(grid, problem.start, problem.target, CornerCutting.ALLOW)


@pytest.mark.parametrize("name", [name for name in exact.PEERS if name != exact.OURS])
def test_a_peer_agrees_on_random_maps(name):
    peer = exact.PEERS[name]
    if peer.extra:
        pytest.importorskip(peer.extra, reason="the bench extra is not installed")

    @settings(max_examples=40)
    @given(problems(), st.booleans())
    def agree(problem, zeros):
        problem = posed(problem, zeros and peer.zeros)
        optimum = exact.shortest_path(problem)
        assume(optimum.feasible and problem.start != problem.target)
        assert exact.why_not(peer, problem) is None
        _, _, cost = exact.once(peer, problem)
        # fixed point against floats: a weight is rounded by at most 1 / 131072
        assert cost == pytest.approx(optimum.cost, abs=problem.map.weights.size / 131072)

    agree()


def test_every_peer_has_a_row(monkeypatch):
    monkeypatch.setattr(exact, "MAPS", exact.MAPS[2:3])
    rows = exact.measure(quick=True)
    assert [row["peer"] for row in rows] == list(exact.PEERS)
    for row in rows:
        if row["solve us"] != ABSENT:
            assert row["cost"] == 49.5
            assert row["set-up us"].lower > 0 and row["solve us"].lower > 0
    assert rows[0]["solve / gapath A*"] == (1, 1, 1)


def test_absent_peers_say_why(monkeypatch):
    monkeypatch.setattr(exact, "MAPS", exact.MAPS[:1])
    monkeypatch.setattr(exact, "find_spec", lambda name: None)
    for row in exact.measure(quick=True):
        if exact.PEERS[row["peer"]].extra:
            assert row == {"map": "kg18_test1", "peer": row["peer"], "solve us": ABSENT}
        else:
            assert row["solve us"].median > 0


def test_fields_of_weight_0_are_a_reason():
    weights = np.full((3, 4), 0.5)
    weights[0, 0] = 0
    free = Problem(GridMap("free", weights), (0, 0), (3, 2))
    other = Problem(GridMap("other", weights), (1, 0), (3, 2))
    peer = exact.Peer(exact.scipy_csgraph, zeros=False)
    assert exact.why_not(peer, free) is None
    assert exact.why_not(peer, other) == "skipped: fields of weight 0"


def test_another_cost_is_noticed(monkeypatch):
    dearer = exact.Prepared(lambda: 48.75, lambda found: found)
    monkeypatch.setattr(exact, "MAPS", exact.MAPS[:1])
    peers = {exact.OURS: exact.PEERS[exact.OURS], "wrong": exact.Peer(lambda problem: dearer)}
    monkeypatch.setattr(exact, "PEERS", peers)
    with pytest.raises(RuntimeError, match=r"kg18_test1: wrong finds \{48\.75\}, not 48\.5"):
        exact.measure(quick=True)


def test_the_ends_of_a_path_count():
    weights = np.full((2, 3), 0.5)
    weights[0, 0] = weights[1, 2] = 0
    problem = Problem(GridMap("ends", weights), (0, 0), (2, 1))
    path = [0, 1, 5]
    assert exact.numbers_of_ends(problem) == (path[0], path[-1])
    assert exact.cost_of_numbers(problem)(path) == exact.shortest_path(problem).cost == 0.5
    ordinary, least = exact.with_ordinary_ends(problem)
    assert least == 0.5 and (ordinary == 0.5).all()
    assert weights[0, 0] == 0

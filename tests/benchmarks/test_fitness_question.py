"""The fitness in C is gapath's wherever it may be asked, and what cannot be measured says why."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.questions.kg18 import fitness
from gapath.kernels.jit import JIT
from gapath.kernels.units import OBSTACLE

pytestmark = pytest.mark.skipif(not JIT, reason="of compiled kernels")


@pytest.fixture(scope="module")
def library():
    found = fitness.compiled()
    if isinstance(found, str):
        pytest.skip(found)
    return found


@pytest.fixture(params=fitness.IN_C)
def rival(request, library):
    if fitness.IN_C[request.param] == "gathers" and not hasattr(library, "gathers"):
        pytest.skip("the processor has no AVX-512")
    return request.param


def draw(seed, rows, cols, blocked):
    random = np.random.default_rng(seed)
    table = random.integers(0, 65537, (rows, cols)).astype(np.int32)
    table[random.random((rows, cols)) < blocked] = OBSTACLE
    return fitness.draw(table, 300)


def check(library, rival, work, changed):
    """Evaluate work with gapath, and what may have been changed of it in C."""
    found = fitness.by_kernels(work) | {
        rival: fitness.in_c(library, rival, changed, *fitness.places(work))
    }
    fitness.check_identical({name: call() for name, call in found.items()})


def test_c_agrees_on_random_maps(library, rival):
    @settings(max_examples=30)
    @given(
        st.integers(0, 2**32 - 1),
        st.integers(1, fitness.SIDE),
        st.integers(1, fitness.SIDE),
        st.sampled_from([0, 0.2, 1]),
    )
    def agree(seed, rows, cols, blocked):
        work = draw(seed, rows, cols, blocked)
        check(library, rival, work, work)

    agree()


@pytest.mark.parametrize("entry", [65536, OBSTACLE])
def test_c_agrees_at_its_limits(library, rival, entry):
    """Lines from corner to corner of the largest map, all over the heaviest fields."""
    table = np.full((fitness.SIDE, fitness.SIDE), entry, dtype=np.int32)
    work = fitness.draw(table, 1000)
    far = np.random.default_rng(1).integers(0, 2, (1000, 10)) * (fitness.SIDE - 1)
    work.chromosomes[:1000, :10] = far
    check(library, rival, work, work)


def test_another_entry_is_noticed(library, rival):
    work = draw(0, 50, 100, 0.2)
    table = work.table.copy()
    table[25, 50] ^= 1
    with pytest.raises(RuntimeError, match=rf"{rival}: \d+ of 300 keys are not gapath's"):
        check(library, rival, work, work._replace(table=table))


def measured():
    return {row["rival"]: row for row in fitness.measure(quick=True)}


def timed(rows, names):
    return all(
        rows[name]["ns a chromosome"].lower > 0
        and (name == fitness.OURS or rows[name]["gapath / rival"].lower > 0)
        for name in names
    )


def test_every_rival_has_a_row(library):
    rows = measured()
    here = [fitness.OURS, fitness.SCALAR, *fitness.IN_C]
    compiled_for = [f"{name}, {cpu}" for cpu in fitness.CPUS.values() for name in here[:2]]
    assert list(rows) == here + compiled_for
    assert all(95 < row["fields a chromosome"] < 105 for row in rows.values())
    there = hasattr(library, "gathers")
    assert timed(rows, [name for name in here if there or fitness.IN_C.get(name) != "gathers"])
    assert "gapath / rival" not in rows[fitness.OURS]
    for name in compiled_for:
        assert rows[name]["ns a chromosome"].startswith("skipped: ")


def test_without_a_compiler_the_rows_say_why(monkeypatch):
    monkeypatch.setattr(fitness.shutil, "which", lambda name: None)
    rows = measured()
    for name in fitness.IN_C:
        assert rows[name]["ns a chromosome"] == "skipped: no C compiler (cc)"
        assert "gapath / rival" not in rows[name]
    assert timed(rows, [fitness.OURS, fitness.SCALAR])


def test_without_wide_vectors_their_row_says_why():
    work = draw(0, 5, 5, 0)
    found = fitness.in_c(SimpleNamespace(plain=print), "C, AVX-512 gathers", work)
    assert found == "skipped: the processor has no AVX-512"


def test_processors_of_another_architecture_are_left_out(monkeypatch):
    monkeypatch.setattr(fitness.platform, "machine", lambda: "arm64")
    assert fitness.why_not("generic", quick=False) is None
    why = "skipped: the processor has another architecture"
    assert fitness.why_not("haswell", quick=False) == fitness.why_not("haswell", quick=True) == why


def in_full(monkeypatch, digest):
    """Measure in full, but a few chromosomes, and no other processor."""
    times = {fitness.OURS: [1.0, 1.0], fitness.SCALAR: [4.0, 2.0]}

    def elsewhere(cpu, count, rounds):
        return times, digest

    monkeypatch.setattr(fitness, "FULL", (200, 2))
    monkeypatch.setattr(fitness, "time_elsewhere", elsewhere)
    monkeypatch.setattr(fitness.platform, "machine", lambda: "x86_64")
    return {row["rival"]: row for row in fitness.measure(quick=False)}


def test_other_processors_are_timed_against_themselves(monkeypatch):
    _, keys = fitness.time_kernels(200, 1)
    rows = in_full(monkeypatch, keys)
    for cpu in fitness.CPUS.values():
        assert rows[f"{fitness.SCALAR}, {cpu}"]["gapath / rival"].median == (1 / 4 + 1 / 2) / 2
        assert rows[f"{fitness.OURS}, {cpu}"]["ns a chromosome"].median == 5


def test_other_keys_of_other_processors_are_noticed(monkeypatch):
    with pytest.raises(RuntimeError, match="generic CPU: the keys are others than here"):
        in_full(monkeypatch, "another")


def test_another_process_gives_the_same_keys():
    times, keys = fitness.time_elsewhere("generic", 200, 2)
    assert keys == fitness.time_kernels(200, 1)[1]
    assert {name: len(sample) for name, sample in times.items()} == {
        fitness.OURS: 2,
        fitness.SCALAR: 2,
    }

"""The log's file: the same bytes as the MCAP library writes, and large maps are not copied."""

import io
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st
from log_events import example, example_drives, write
from mcap.data_stream import RecordBuilder
from mcap.records import Attachment

from gapath.errors import InputError
from gapath.events import RunFinished
from gapath.grid import GridMap
from gapath.problem import Problem
from gapath.recorders import mcap
from gapath.recorders.mcap import description
from gapath.recorders.mcap.file.stored import Stored
from gapath.recorders.mcap.format import LOG_VERSION, Form, earlier
from gapath.recorders.mcap.messages import Messages, count_first


@given(st.text(), st.lists(st.binary()), st.text(), st.integers(0, 2**64 - 1))
def test_an_attachment_is_written_as_by_the_library(name, parts, media_type, time):
    builder = RecordBuilder()
    Attachment(time, 7, name, media_type, b"".join(parts)).write(builder)
    stored = Stored(name, tuple(parts), media_type, time, 7)
    assert b"".join(stored.record()) == builder.end()


LARGE = bytes(3 << 20)


@pytest.mark.parametrize("parts", [(b"x", b"y" + LARGE[:-5], LARGE[:5]), (b"xy" + LARGE, b"")])
def test_stored_files_are_equal_however_they_lie_in_pieces(parts):
    assert Stored("a", (b"xy", memoryview(LARGE))) == Stored("a", parts)


@pytest.mark.parametrize("change", [{"name": "b"}, {"parts": (b"x" + LARGE, b"z")},
    {"parts": (b"x", LARGE)}, {"media_type": ""}, {"create_time": 1}, {"log_time": 1}])  # fmt: skip
def test_stored_files_that_differ_are_not_equal(change):
    stored = Stored("a", (b"x", LARGE, b"y"))
    assert stored != replace(stored, **change) and stored == replace(stored)


@pytest.mark.parametrize("events", [example(), example_drives()])
def test_arrays_are_stored_as_numpy_saves_them(events):
    run = events[0]
    for stored, array in zip(
        description.attachments(run), (run.problem.map.weights, run.optimal_path), strict=True
    ):
        file = io.BytesIO()
        np.save(file, array)
        assert b"".join(stored.parts) == file.getvalue()


@pytest.mark.parametrize("parts", [(b"",), (LARGE,), (b"ab", memoryview(LARGE), b"c")])
def test_a_file_that_was_packed_comes_back(parts):
    stored = Stored("map.npy", parts, "text", 3, 4)
    packed = stored.packed()
    assert packed.unpacked(stored.size) == stored
    assert (packed.name, packed.size < 1000) == ("map.npy.zst" if stored.size else "map.npy", True)


def test_what_packing_hardly_makes_smaller_stays_as_it_is():
    noise = Stored("map.npy", (np.random.default_rng(1).bytes(2 << 20),))
    assert noise.packed() is noise


@pytest.mark.parametrize("size", [0, len(LARGE) - 1, len(LARGE) + 1])
def test_a_packed_file_says_what_it_takes_and_no_more(size):
    packed = Stored("map.npy", (LARGE,)).packed()
    with pytest.raises(InputError, match=r"attachment map\.npy\.zst: got 3145728 bytes in it"):
        packed.unpacked(len(LARGE) - 1)
    head = bytearray(packed.parts[0])
    at = bytes(head).index(len(LARGE).to_bytes(4, "little"))
    head[at : at + 4] = size.to_bytes(4, "little")
    with pytest.raises((InputError, zstandard.ZstdError)):
        replace(packed, parts=(bytes(head),)).unpacked(1 << 30)


@pytest.mark.parametrize("some", [slice(None), slice(0)])
def test_the_first_messages_are_counted_without_making_them(some):
    run = example()[0]
    run = replace(run, optimal_path=run.optimal_path[some])
    for form in (Form(LOG_VERSION, 1), earlier("6")):
        assert count_first(run, form) == sum(1 for _ in Messages(run, form).records(run))


SIDE = 2000
FIELDS = SIDE * SIDE


@pytest.fixture
def large():
    """A run on a map of four million fields, its events without a trial."""
    weights = np.random.default_rng(4).random((SIDE, SIDE))
    weights[0, 0] = weights[-1, -1] = 0.5
    run = example()[0]
    grid = GridMap("large", weights)
    problem = Problem(grid, (0, 0), (SIDE - 1, SIDE - 1))
    assert grid.table.size == problem.map.obstacles.size == FIELDS  # planners need them anyway
    return [replace(run, problem=problem), RunFinished(0, 0, 0)]


def bytes_a_field(do):
    """Peak of what Python and NumPy hold meanwhile, beyond what there was."""
    tracemalloc.start()
    try:
        result = do()
        return tracemalloc.get_traced_memory()[1] / FIELDS, result
    finally:
        tracemalloc.stop()


def test_a_large_map_is_not_copied_to_be_written_or_read(large, tmp_path):
    written, log = bytes_a_field(lambda: write(large, tmp_path))
    read, run = bytes_a_field(lambda: next(mcap.read_events(log)))
    assert run.problem.map.weights.tobytes() == large[0].problem.map.weights.tobytes()
    same, found = bytes_a_field(lambda: mcap.compare(log, lambda _: iter(large), mcap.USUAL))
    assert (found.difference, found.byte) == ("", None)
    saved = tmp_path / "saved.mcap"
    salvaged, _ = bytes_a_field(lambda: mcap.salvage(log, saved))
    assert saved.read_bytes() == log.read_bytes()
    assert written < 5 and read < 13 and same < 18 and salvaged < 15


def test_a_map_of_one_weight_is_read_however_tightly_it_is_packed(tmp_path):
    grid = GridMap("flat", np.zeros((1500, 2000)))
    run = replace(example()[0], problem=Problem(grid, (0, 0), (1999, 1499)))
    log = write([run, RunFinished(0, 0, 0)], tmp_path)
    assert log.stat().st_size < 20_000
    first, _ = mcap.read_events(log, mcap.USUAL)
    assert np.array_equal(first.problem.map.weights, grid.weights)

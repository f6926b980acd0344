"""The log's file: the same bytes as the MCAP library writes, and large maps are not copied."""

import io
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from log_events import example, example_drives, write
from mcap.data_stream import RecordBuilder
from mcap.records import Attachment

from gapath.events import RunFinished
from gapath.grid import GridMap
from gapath.problem import Problem
from gapath.recorders import mcap
from gapath.recorders.mcap import description
from gapath.recorders.mcap.file.stored import Stored
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


@pytest.mark.parametrize("some", [slice(None), slice(0)])
def test_the_first_messages_are_counted_without_making_them(some):
    run = example()[0]
    run = replace(run, optimal_path=run.optimal_path[some])
    assert count_first(run) == sum(1 for _ in Messages(run).records(run))


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

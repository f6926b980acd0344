"""Logs that were cut off or damaged, that lie, or are none."""

import struct
import tracemalloc
import zlib
from collections import Counter

import numpy as np
import pytest
import zstandard
from log_events import example, example_drives, logged, plain, write
from mcap.reader import make_reader
from mcap.records import Chunk
from mcap.writer import CompressionType, Writer

from gapath.errors import InputError
from gapath.recorders import mcap
from gapath.recorders.mcap.file.walk import inflated


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    return write(example(), tmp_path_factory.mktemp("log"), chunk_messages=5)


def test_a_log_cut_anywhere_gives_a_prefix(log, tmp_path):
    whole, events = log.read_bytes(), list(map(plain, example()))
    rng, cut, seen = np.random.default_rng(1), tmp_path / "run.mcap.part", set()
    for length in [0, 1, 8, *rng.integers(0, len(whole), 150).tolist(), len(whole) - 1]:
        cut.write_bytes(whole[:length])
        with pytest.raises(InputError, match=r"run\.mcap\.part"):
            list(mcap.read_events(cut))
        try:
            prefix = list(map(plain, mcap.read_prefix(cut)))
        except InputError:
            prefix = []
        assert prefix == events[: len(prefix)]
        seen.add(len(prefix))
    assert {0, len(events)} < seen


def test_a_log_of_drives_cut_anywhere_is_salvaged(tmp_path):
    whole = write(example_drives(), tmp_path, chunk_messages=5).read_bytes()
    events = [plain(logged(event)) for event in example_drives()]
    cut, output, seen = tmp_path / "cut.mcap.part", tmp_path / "out.mcap", set()
    for length in np.random.default_rng(3).integers(0, len(whole), 40).tolist():
        cut.write_bytes(whole[:length])
        try:
            saved = mcap.salvage(cut, output)
        except InputError:
            continue
        there = list(map(plain, mcap.read_events(output)))
        assert there == events[: len(there)]
        assert not saved.lost.messages
        output.unlink()
        seen.add(saved.messages)
    assert len(seen) > 5


def test_a_flipped_bit_never_changes_an_event_silently(log, tmp_path):
    whole, events = log.read_bytes(), list(map(plain, example()))
    rng, path = np.random.default_rng(2), tmp_path / "run.mcap"
    refused = 0
    for bit in rng.integers(0, 8 * len(whole), 400):
        flipped = bytearray(whole)
        flipped[bit // 8] ^= 1 << (bit % 8)
        path.write_bytes(flipped)
        try:
            assert list(map(plain, mcap.read_events(path))) == events
        except InputError:
            refused += 1
        try:
            prefix = list(map(plain, mcap.read_prefix(path)))
        except InputError:
            prefix = []
        assert prefix == events[: len(prefix)]
    assert refused > 200


@pytest.mark.parametrize("place", ["first chunk", "middle chunk", "message index", "data end"])
def test_a_record_of_an_unknown_kind_is_not_skipped(place, log, tmp_path):
    with log.open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
        file.seek(-8 - 20, 2)  # the footer's contents, the magic number
        data_end = struct.unpack("<Q", file.read(8))[0] - 13
    chunks = summary.chunk_indexes
    middle = chunks[len(chunks) // 2]
    offset = {
        "first chunk": chunks[0].chunk_start_offset,
        "middle chunk": middle.chunk_start_offset,
        "message index": middle.chunk_start_offset + middle.chunk_length,
        "data end": data_end,
    }[place]
    kinds = {"first chunk": 6, "middle chunk": 6, "message index": 7, "data end": 15}
    changed = bytearray(log.read_bytes())
    assert changed[offset] == kinds[place]
    changed[offset] = 0x7F
    path = tmp_path / "run.mcap"
    path.write_bytes(changed)
    with pytest.raises(InputError):
        list(mcap.read_events(path))
    events, prefix = list(map(plain, example())), list(map(plain, mcap.read_prefix(path)))
    assert prefix == events[: len(prefix)]
    assert (len(prefix) < len(events)) == (place != "data end")


def test_salvage_writes_a_whole_log(log, tmp_path):
    cut = tmp_path / "run.mcap.part"
    cut.write_bytes(log.read_bytes()[:6500])
    prefix = list(map(plain, mcap.read_prefix(cut)))
    assert 1 < len(prefix) < len(example())
    output = tmp_path / "run.mcap"
    assert mcap.salvage(cut, output).messages > len(prefix)
    assert list(map(plain, mcap.read_events(output))) == prefix
    with pytest.raises(InputError, match="exists"):
        mcap.salvage(cut, output)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run.mcap", "run.mcap.part"]


def test_a_killed_run_loses_no_more_than_a_chunk(tmp_path, monkeypatch):
    monkeypatch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 10)
    events = example(trials=40)
    recorder = mcap.Recorder(step_s=0.1)
    recorder.open(str(tmp_path))
    for event in events:
        recorder.record(event)
    prefix = list(mcap.read_prefix(tmp_path / "run.mcap.part"))  # neither closed nor flushed
    assert len(prefix) >= len(events) - 10
    recorder.abort()
    recorder.abort()
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == ["run.mcap.part"]


def foreign(path, profile="ros2", library="gapath", metadata=None):
    """Write a log by hand, to leave something out or say something else."""
    with path.open("wb") as file:
        writer = Writer(file, compression=CompressionType.NONE)
        writer.start(profile=profile, library=library)
        if metadata is not None:
            writer.add_metadata("gapath", metadata)
            writer.add_attachment(0, 0, "optimal_path.npy", "", b"")
        channel = writer.register_channel("/a", "cdr", 0)
        writer.add_message(channel, 0, b"", 0)
        writer.finish()


def bomb(path, log, claimed, compressed):
    """Put a chunk of other contents into a log that has been cut off."""
    with log.open("rb") as file:
        start = (
            make_reader(file, validate_crcs=True).get_summary().chunk_indexes[0].chunk_start_offset
        )
    head = struct.pack("<QQQII4sQ", 0, 0, claimed, 0, 4, b"zstd", len(compressed))
    record = struct.pack("<BQ", 6, len(head) + len(compressed)) + head + compressed
    path.write_bytes(log.read_bytes()[:start] + record)


def look(path):
    return mcap.look(path, mcap.USUAL, Counter())


BAD = {
    "empty": (lambda path, log: path.write_bytes(b""), "those of MCAP"),
    "text": (lambda path, log: path.write_text("seed: 7\n" * 9), "those of MCAP"),
    "folder": (lambda path, log: path.mkdir(), "readable file"),
    "missing": (lambda path, log: None, "readable file"),
    "library": (lambda path, log: foreign(path, library="rosbag2 1.0"), "rosbag2"),
    "profile": (lambda path, log: foreign(path, profile="x-robot"), "x-robot"),
    "no metadata": (lambda path, log: foreign(path), "a run's description"),
    "version": (
        lambda path, log: foreign(path, metadata={"gapath_log_version": "99"}),
        "gapath_log_version: got 99, expected one of 4, 5, 6, 7",
    ),
    "entries missing": (
        lambda path, log: foreign(path, metadata={"gapath_log_version": "5"}),
        "sha256: got None",
    ),
}


@pytest.mark.parametrize(("make", "message"), BAD.values(), ids=BAD)
@pytest.mark.parametrize(
    "read", [mcap.read_events, mcap.read_prefix, look], ids=lambda f: f.__name__
)
def test_what_is_no_log_is_refused(make, message, read, tmp_path, log):
    path = tmp_path / "some.mcap"
    make(path, log)
    with pytest.raises(InputError) as refused:
        list(read(path))
    assert "some.mcap" in str(refused.value) and message in str(refused.value)


@pytest.mark.parametrize("claimed", [100, 1 << 31, 1 << 63])
def test_nothing_is_inflated_beyond_what_is_allowed(claimed, tmp_path, log):
    path = tmp_path / "bomb.mcap"
    bomb(path, log, claimed, zstandard.compress(bytes(1 << 26)))
    assert path.stat().st_size < 20_000
    tracemalloc.start()
    assert list(map(plain, mcap.read_prefix(path))) == [plain(example()[0])]
    with pytest.raises(InputError, match=r"bomb\.mcap"):
        list(mcap.read_events(path))
    assert tracemalloc.get_traced_memory()[1] < 1 << 24
    tracemalloc.stop()


def chunk(data, compressed, size=None, crc=None):
    crc = zlib.crc32(data) if crc is None else crc
    return Chunk("zstd", compressed, 0, 0, crc, len(data) if size is None else size)


def test_a_chunk_that_lies_is_refused():
    data = bytes(1000)
    short = bytearray(zstandard.compress(data))
    short[5:7] = struct.pack("<H", 500 - 256)  # the frame says 500 bytes
    assert zstandard.frame_content_size(bytes(short)) == 500
    unsized = zstandard.ZstdCompressor(write_content_size=False).compress(data)
    assert inflated(chunk(data, zstandard.compress(data))) == data
    for wrong in (chunk(data, bytes(short), size=500), chunk(data, zstandard.compress(data) * 2)):
        with pytest.raises(zstandard.ZstdError):
            inflated(wrong)
    for wrong in (
        chunk(data, unsized),
        chunk(data, zstandard.compress(data), size=999),
        chunk(data, zstandard.compress(data), crc=0),
    ):
        with pytest.raises(InputError):
            inflated(wrong)

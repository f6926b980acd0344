"""A log that was altered by somebody who knows the format is never called reproduced.

Whatever a log has is altered, a thing at a time, and every checksum made anew.
"""

import re
import struct
from dataclasses import replace

import numpy as np
import pytest
from altering import alterations
from logs_of_runs import BROKEN, OF_FILES, RUNS, chunks_of, log_of, told
from mcap.records import Message, Metadata
from mcap.writer import CompressionType, IndexType
from scale import rounds
from taking_apart import Parts, put_together, taken_apart

from gapath.recorders import mcap
from gapath.recorders.mcap import description
from gapath.recorders.mcap.format import earlier
from gapath.running import verify


@pytest.fixture(scope="module", params=[*RUNS, *OF_FILES, *BROKEN])
def log(request, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        if request.param in BROKEN:
            patch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 4)
        yield log_of(request.param, tmp_path_factory.mktemp("runs"))


@pytest.fixture
def wrong(log, capsys):
    """What was said of alterations that is wrong, and how to find that; `log` must be right."""
    code, line = verified(log, capsys)
    assert (code, "equal so far" in line) in [(0, False), (3, True)]
    assert code == 0 or log.name == "saved.mcap"
    own = "is what the log has of" in line
    messages = messages_of(taken_apart(log))

    def say(path, what, names):
        found, told = verified(path, capsys)
        named = any(name.removeprefix("version/") in told for name in names)
        named |= own and found == 1 and TAKEN_OVER.search(what) is not None  # by what shows it
        word = what.startswith(("Metadata: version/", "everywhere: method"))
        taken = own and TAKEN_OVER.search(what) and "is what the log has of" in told
        if (named and (found not in (0, code) or word)) or taken:
            return ""
        if found == code == 3 and "interrupted" in told and is_prefix(path, messages):
            return ""  # there is less of it, which is said
        return f"{what}: {found} {told}"

    return say


TAKEN_OVER = re.compile(r"(map|known_map)(_resolution|_origin|_start|_target|\.npy)|queries\.npy")
"""What only a file of somebody's own could tell."""


def messages_of(parts):
    return [(e.log_time, e.data) for e in parts.entries if isinstance(e, Message)]


def is_prefix(path, messages):
    there = messages_of(taken_apart(path))
    return there == messages[: len(there)] and len(there) < len(messages)


@pytest.fixture(autouse=True)
def made_once(monkeypatch):
    """Make a run of the same settings once: that takes most of the time, and depends on no more."""
    make, made = verify.made_again, {}

    def once(logged, kernels):
        key = description.metadata(logged, earlier("6"))["sha256"]
        if key not in made:
            made[key] = make(logged, kernels)
        return made[key]

    monkeypatch.setattr(verify, "made_again", once)


def with_other_versions(parts):
    """Let a log say that it was made with others: then its bytes need not be the same."""
    return Parts([
        replace(e, metadata=e.metadata | {"version/numpy": "0.0"})
        if isinstance(e, Metadata) and e.name == description.NAME else e for e in parts.entries
    ], parts.ends)  # fmt: skip


def verified(path, capsys):
    code, out, err = told(capsys, "verify", path)
    assert (out + err).count("\n") == 1
    return code, (out + err).removeprefix(f"gapath-log: {path}: ")


def test_put_together_as_it_was_it_is_reproduced(log, tmp_path, capsys):
    path = tmp_path / "run.mcap"
    put_together(taken_apart(log), path)
    assert path.read_bytes() == log.read_bytes()
    code, line = verified(path, capsys)
    assert code in (0, 3) and "byte for byte" in line


def test_whatever_is_altered_is_named(log, wrong, tmp_path, capsys):
    every = list(alterations(taken_apart(log)))
    chosen = np.random.default_rng(17).permutation(len(every))[: rounds(60, len(every))]
    path, missed = tmp_path / "run.mcap", []
    for number in chosen:
        what, names, parts = every[number]
        put_together(parts if number % 2 else with_other_versions(parts), path)
        missed.append(wrong(path, what, names))
    missed = list(filter(None, missed))
    with capsys.disabled():
        print(f"\n{len(chosen)} of {len(every)} alterations, {len(missed)} not named")
    assert not missed, "\n".join(missed)


def record(opcode, data=b""):
    return struct.pack("<BQ", opcode, len(data)) + data


APPENDED = {
    "a zero": b"\0",
    "zeros": bytes(1000),
    "a record of zeros": record(0, bytes(9)),
    "magic": b"\x89MCAP0\r\n",
    "text": b"made by nobody\n",
    "an unknown record": record(0x80, b"by nobody"),
    "a data end": record(0x0F, bytes(4)),
    "itself": None,
}

WRITTEN = {
    "one chunk": {"ends": set()},
    "a chunk a message": {"ends": set(range(10**4))},
    "not compressed": {"compression": CompressionType.NONE},
    "no chunks": {"use_chunking": False},
    "no index of messages": {"index_types": IndexType.ALL & ~IndexType.MESSAGE},
    "no index of chunks": {"index_types": IndexType.ALL & ~IndexType.CHUNK},
    "no index of attachments": {"index_types": IndexType.ALL & ~IndexType.ATTACHMENT},
    "no index of metadata": {"index_types": IndexType.ALL & ~IndexType.METADATA},
    "no channels at the end": {"repeat_channels": False},
    "no schemas at the end": {"repeat_schemas": False},
    "no statistics": {"use_statistics": False},
    "no offsets": {"use_summary_offsets": False},
    "no CRC": {"enable_crcs": False},
    "no CRC of the data": {"enable_data_crcs": False},
}


def test_another_layout_or_more_bytes_are_noticed(log, wrong, tmp_path):
    path, missed, parts, whole = tmp_path / "run.mcap", [], taken_apart(log), log.read_bytes()
    for what, data in APPENDED.items():
        for place in (len(whole), len(whole) - 8, 8, len(whole) // 2):
            path.write_bytes(whole[:place] + (whole if data is None else data) + whole[place:])
            missed.append(wrong(path, f"{what} at {place}", ("",)))
    for what, given in WRITTEN.items():
        options = {name: value for name, value in given.items() if name != "ends"}
        put_together(Parts(parts.entries, given.get("ends", parts.ends)), path, **options)
        missed.append(wrong(path, what, ("",)))
        if options:
            put_together(with_other_versions(parts), path, **options)
            missed.append(wrong(path, f"{what}, other versions", ("",)))
    assert not list(filter(None, missed))


def test_a_log_has_the_same_bytes_however_it_is_recorded(tmp_path):
    ways = [[], ["recorder=[mcap,rerun]"], ["recorder=[rerun,mcap]", "recorder.rerun.trials=[1]"],
            ["threads=2"], ["kernels=scalar"]]  # fmt: skip
    logs = {
        log_of("plan", tmp_path / str(number), *words).read_bytes()
        for number, words in enumerate(ways)
    }
    assert len(logs) == 1


def test_a_message_that_is_said_to_be_lost_is_told(log, tmp_path, capsys):
    parts, path = taken_apart(log), tmp_path / "run.mcap"
    numbers = [e.sequence for e in parts.entries if isinstance(e, Message)]
    trials = {tuple(map(str, which)) for which in ((), (0,), (0, 1))}
    for number in numbers[:-1] if len(numbers) < 20 else numbers[:-1:9]:
        rest = [e for e in parts.entries if getattr(e, "sequence", None) != number]
        for which in trials:
            text = {"messages": f"{number}-{number}", "trials": " ".join(which)}
            lost = [rest[0], rest[1], Metadata(description.LOST, text), *rest[2:]]
            put_together(Parts(lost, parts.ends), path)
            code, line = verified(path, capsys)
            assert code and (code < 3 or f"lost: messages {number}-{number}" in line), line


@pytest.fixture
def short(monkeypatch, tmp_path):
    """A log of many chunks, and where they begin."""
    monkeypatch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 4)
    log = log_of("plan", tmp_path, "trials=6")
    return log, chunks_of(log.read_bytes())


def test_a_log_that_breaks_off_is_interrupted(short, tmp_path, capsys):
    log, places = short
    whole, part, rng = log.read_bytes(), tmp_path / "run.mcap.part", np.random.default_rng(3)
    for more in (0, 1, 60):
        place = places[len(places) // 2]
        part.write_bytes(whole[: place + more])
        code, line = verified(part, capsys)
        assert code == 3 and ": interrupted after trial" in line, line
        assert "equal so far, byte for byte" in line
        assert (f"its last {more} bytes are of no whole chunk" in line) == (more > 0)
    for length in rng.integers(places[1], places[-1] + 99, rounds(9, 300)).tolist():
        part.write_bytes(whole[:length])
        code, line = verified(part, capsys)
        assert code == 3 and "equal so far, byte for byte" in line, line
        data = bytearray(whole[: max(place for place in places if place <= length)])
        data[rng.integers(len(data))] ^= 1 << rng.integers(8)
        part.write_bytes(data)
        assert verified(part, capsys)[0] in (1, 2)
    for length in (0, 5, places[0] - 1, places[0] + 40, len(whole) - 1, len(whole) - 200):
        part.write_bytes(whole[:length])
        assert verified(part, capsys)[0] == 2


def test_a_log_under_way_or_ended_early_is_interrupted(short, tmp_path, capsys):
    events, folder = list(mcap.read_events(short[0])), tmp_path / "under way"
    folder.mkdir()
    recorder = mcap.Recorder(step_s=0.1)
    recorder.open(str(folder))
    for event in events[:12]:
        recorder.record(event)
    for _ in range(2):  # as it is written, and when that was ended
        code, line = verified(folder / "run.mcap.part", capsys)
        assert (code, "equal so far, byte for byte" in line) == (3, True), line
        recorder.abort()

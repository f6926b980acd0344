"""What can be saved of a damaged log: all but what is in the damaged chunk."""

import numpy as np
import pytest
from mcap.reader import make_reader
from recorders.log_events import example, example_drives, example_memetic, logged, plain, write
from scale import rounds

from gapath.errors import InputError
from gapath.events import Finished, RunStarted, TrialStarted
from gapath.recorders import mcap

RUNS = {"plans": example, "drives": example_drives, "memetic": example_memetic}


@pytest.fixture(autouse=True)
def short_chunks(monkeypatch):
    monkeypatch.setattr("gapath.recorders.mcap.log.CHUNK_MESSAGES", 10)


@pytest.fixture(params=RUNS)
def run(request, tmp_path):
    events = list(map(logged, RUNS[request.param](trials=9)))
    return events, write(events, tmp_path, chunk_messages=10)


def chunks_of(path):
    with path.open("rb") as file:
        summary = make_reader(file, validate_crcs=True).get_summary()
    return summary.chunk_indexes, summary.statistics.message_count


def check_saved(events, saved, path):
    """What was saved is a whole log, equal as far as it goes; its trials are told whole."""
    told = list(map(plain, mcap.read_events(path)))
    trial = [getattr(event, "trial", None) for event in events]
    there = [plain(e) for e, t in zip(events, trial, strict=True) if t not in saved.lost.trials]
    assert told == there[: len(told)]
    found = mcap.compare(path, lambda logged: iter(events), mcap.USUAL)
    assert (found.difference, found.byte, found.messages) == ("", None, saved.messages)
    return told


def test_a_damaged_chunk_costs_what_is_in_it(run, tmp_path):
    events, log = run
    whole, (chunks, total) = log.read_bytes(), chunks_of(log)
    for number, chunk in enumerate(chunks):
        damaged, output = tmp_path / "damaged.mcap", tmp_path / f"{number}.mcap"
        data = bytearray(whole)
        data[chunk.chunk_start_offset + chunk.chunk_length - 3] ^= 1
        damaged.write_bytes(data)
        saved = mcap.salvage(damaged, output)
        assert 0 < total - saved.messages <= 10
        told = check_saved(events, saved, output)
        starts = sum(isinstance(event, TrialStarted) for event in events)
        ends = sum(isinstance(event, Finished) for event in events)
        assert starts == ends == 9
        assert len(told) > 1 and len(saved.lost.trials) <= 9


def test_flips_and_cuts_cost_a_chunk_at_most(run, tmp_path, capsys):
    events, log = run
    whole, (chunks, total) = log.read_bytes(), chunks_of(log)
    begin = chunks[0].chunk_start_offset
    rng, worst, tried = np.random.default_rng(8), 0, 0
    damaged, output = tmp_path / "damaged.mcap", tmp_path / "saved.mcap"
    for place in rng.integers(begin, len(whole), rounds(30, 500)).tolist():
        data = bytearray(whole)
        data[place] ^= 1 << rng.integers(8)
        ends = [c.chunk_start_offset + c.chunk_length for c in chunks]
        for content, least in ((data, total - 10), (whole[:place], sum(e <= place for e in ends))):
            damaged.write_bytes(content)
            output.unlink(missing_ok=True)
            try:
                saved = mcap.salvage(damaged, output)
            except InputError as error:
                assert "nothing whole in it" in str(error) and not least
                continue
            least = least if content is data else min(total, 10 * (least - 2))
            assert saved.messages >= least
            check_saved(events, saved, output)
            tried += 1
            worst = max(worst, total - saved.messages if content is data else 0)
    with capsys.disabled():
        print(f"\n{tried} damaged logs saved; a flip cost {worst} of {total} messages at most")


def test_a_killed_run_has_something_whole_from_its_first_moment_on(tmp_path):
    events = example()
    recorder = mcap.Recorder(step_s=0.1)
    (tmp_path / "run").mkdir()
    part, output = tmp_path / "run.mcap.part", tmp_path / "out.mcap"
    part.write_bytes(b"\x89MCAP")
    with pytest.raises(InputError, match="nothing whole in it"):
        mcap.salvage(part, output)
    recorder.open(str(tmp_path / "run"))
    part = tmp_path / "run" / "run.mcap.part"
    recorder.record(events[0])
    assert isinstance(next(mcap.read_prefix(part)), RunStarted)
    assert mcap.salvage(part, output).messages == 6
    recorder.abort()


def test_what_is_recorded_is_on_the_disk_when_a_run_is_interrupted(tmp_path):
    events = example()
    recorder = mcap.Recorder(step_s=0.1)
    recorder.open(str(tmp_path))
    for event in events[:7]:
        recorder.record(event)
    recorder.abort()
    assert len(list(mcap.read_prefix(tmp_path / "run.mcap.part"))) == 7

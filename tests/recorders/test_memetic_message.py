"""The log of what a population took in: it comes back, it is small, and a wrong one is refused."""

import dataclasses
from collections import Counter

import numpy as np
import pytest
from log_events import example_memetic, plain, write

from gapath.errors import InputError
from gapath.events import Evolved
from gapath.history.evolution import Evolution, Population
from gapath.recorders import mcap
from gapath.recorders.mcap import format as log_format
from gapath.recorders.mcap.cdr import Record
from gapath.recorders.mcap.memetic_message import memetic_run, read_memetic_run

TYPES = log_format.TYPES


def evolved():
    return next(event for event in example_memetic() if isinstance(event, Evolved))


def test_a_run_comes_back_with_its_population(tmp_path):
    events = example_memetic()
    populations = [e.evolution.population for e in events if isinstance(e, Evolved)]
    assert all(len(population.epochs) > 6 for population in populations)
    path = write(events, tmp_path)
    assert list(map(plain, mcap.read_events(path))) == list(map(plain, events))
    list(mcap.look(path, mcap.USUAL, messages := Counter()))
    assert messages["/memetic_run"] == len(populations)
    assert "/ga_run" not in messages


def test_such_a_log_cut_anywhere_is_salvaged(tmp_path):
    whole = write(example_memetic(9), tmp_path, chunk_messages=3).read_bytes()
    events = list(map(plain, example_memetic(9)))
    cut, output, seen = tmp_path / "cut.mcap.part", tmp_path / "out.mcap", set()
    for length in np.random.default_rng(3).integers(0, len(whole), 40).tolist():
        cut.write_bytes(whole[:length])
        try:
            seen.add(mcap.salvage(cut, output).messages)
        except InputError:
            continue
        there = list(map(plain, mcap.read_events(output)))
        assert there == events[: len(there)]
        output.unlink()
    assert len(seen) > 3


def many_vertices(individuals=8, vertices=2000, changes=400, epochs=400):
    """Long polygons, a vertex of one moved at each change; individual 0 stays the best."""
    rng = np.random.default_rng(4)
    polygons = list(rng.integers(0, 2000, (individuals, vertices, 2)).astype(np.int32))
    now = polygons.copy()
    who = rng.integers(1, individuals, changes, dtype=np.int32)
    for i in who:
        now[i] = now[i].copy()
        now[i][rng.integers(1, vertices - 1)] = rng.integers(0, 2000, 2)
        polygons.append(now[i])
    first, m = np.zeros(individuals, np.int32), individuals + changes
    number = np.arange(1, changes + 1, dtype=np.int32)
    population = Population(
        np.concatenate([first + 1, np.minimum(number + 1, epochs)]),
        np.concatenate([np.arange(individuals, dtype=np.int32), who]),
        np.zeros(m, np.int32), np.zeros(m), np.zeros(m),
        np.arange(1, m + 1, dtype=np.int32) * vertices,
        np.concatenate(polygons), ("any",), (0.0,),
    )  # fmt: skip
    way_points = np.repeat(polygons[0][None], epochs, 0)
    numbers = np.zeros(epochs)
    genes = way_points.reshape(epochs, -1)
    return Evolved(0, 0, 0, Evolution(numbers, numbers, genes, way_points, "polygon", population))


def test_a_change_is_as_long_as_what_it_changed():
    event = many_vertices()
    record = memetic_run(event, event.evolution.population, 0)
    everything = event.evolution.population.vertices.nbytes + event.evolution.way_points.nbytes
    assert everything > 12_000_000
    assert len(record.data) < 8 * 2000 * 8 + 400 * (8 * 8 + 40) + 500 * 40
    message = TYPES.deserialize_cdr(record.data, log_format.TOPICS[record.topic])
    assert plain(read_memetic_run(0, message)) == plain(event)


LIES = {
    "epochs fall": ("epochs", lambda a: a[::-1].copy(), "numbers from 1 to 12 that do not fall"),
    "epochs from 0": ("epochs", lambda a: a - 1, "numbers from 1 to 12 that do not fall"),
    "epochs after the last": ("epochs", lambda a: a + 12, "numbers from 1 to 12 that do not fall"),
    "an epoch less": ("epochs", lambda a: a[:-1], "parts of one length"),
    "a gain less": ("gains", lambda a: a[:-1], "parts of one length"),
    "a mean less": ("mean", lambda a: a[:-1], "parts of one length"),
    "no such operator": ("operators", lambda a: a + 3, "numbers of names"),
    "negative operator": ("operators", lambda a: a - 1, "numbers of names"),
    "a share less": ("shares", lambda a: a[:-1], "a share each"),
    "heads of nothing": ("heads", lambda a: a + 9, "parts of the one before"),
    "negative tails": ("tails", lambda a: a - 9, "parts of the one before"),
    "a vertex less": ("vertices", lambda a: a[:-2], "its end"),
    "half a vertex": ("vertices", lambda a: a[:-1], "reshape"),
    "no such leader": ("leaders", lambda a: a + 10**6, "changes"),
    "negative leader": ("leaders", lambda a: a - 10**6, "changes"),
    "narrow rows": ("way_points_count", lambda n: 2, "vertices"),
    "wide rows": ("way_points_count", lambda n: 2**32 - 1, "at most 33554432"),
}


@pytest.mark.parametrize(("field", "change", "expected"), LIES.values(), ids=LIES)
def test_a_message_that_lies_is_refused(field, change, expected, tmp_path, monkeypatch):
    name = log_format.TOPICS["/memetic_run"]
    event = evolved()
    data = memetic_run(event, event.evolution.population, 0).data
    message = TYPES.deserialize_cdr(data, name)
    changed = change(getattr(message, field))
    lie = dataclasses.replace(message, **{field: changed})
    record = bytes(TYPES.serialize_cdr(lie, name, little_endian=True))
    monkeypatch.setattr(
        "gapath.recorders.mcap.messages.memetic_run",
        lambda event, population, time: Record("/memetic_run", time, record),
    )
    path = write(example_memetic(), tmp_path)
    with pytest.raises(InputError, match=expected) as refused:
        list(mcap.read_events(path))
    assert "run.mcap" in str(refused.value)


def test_a_population_that_took_nothing_in_is_refused():
    event = evolved()
    message = TYPES.deserialize_cdr(
        memetic_run(event, event.evolution.population, 0).data, log_format.TOPICS["/memetic_run"]
    )
    arrays = {n: v[:0] for n, v in vars(message).items() if isinstance(v, np.ndarray)}
    with pytest.raises(InputError, match="got no changes, expected at least one"):
        read_memetic_run(0, dataclasses.replace(message, **arrays | {"names": []}))


def test_what_repeats_itself_without_end_is_not_put_together():
    """A few bytes a change would become a polygon of a thousand vertices each."""
    event = many_vertices(2, 1000, 10, 5)
    record = memetic_run(event, event.evolution.population, 0)
    message = TYPES.deserialize_cdr(record.data, log_format.TOPICS[record.topic])
    m = 50_000
    many = {
        n: np.repeat(getattr(message, n)[:1], m) for n in ("epochs", "individuals", "operators")
    }
    many |= {n: np.zeros(m) for n in ("gains", "costs")}
    many |= {"heads": np.full(m, 1000, np.int32), "tails": np.zeros(m, np.int32)}
    many["heads"][0] = 0
    ends, vertices = np.full(m, 1000, np.int32), message.vertices[:2000]
    lie = dataclasses.replace(message, **many, ends=ends, vertices=vertices)
    with pytest.raises(InputError, match="vertices, expected at most 33554432"):
        read_memetic_run(0, lie)


ODD = {
    "other rows": (lambda e, p: (e._replace(way_points=e.way_points + 1), p), "a change left"),
    "other genes": (lambda e, p: (e._replace(chromosomes=e.chromosomes + 1), p), "a change left"),
    "a share less": (lambda e, p: (e, p._replace(shares=(1.0,))), "a share each"),
    "epoch 1 without": (lambda e, p: (e, p._replace(epochs=np.maximum(p.epochs, 2))), "left"),
    "a gain less": (lambda e, p: (e, p._replace(gains=p.gains[1:])), "parts of one length"),
    "an end less": (lambda e, p: (e, p._replace(ends=p.ends[:-1])), "parts of one length"),
    "a vertex less": (lambda e, p: (e, p._replace(vertices=p.vertices[1:])), "do not fall"),
    "ends that fall": (lambda e, p: (e, p._replace(ends=p.ends[::-1].copy())), "do not fall"),
    "negative ends": (lambda e, p: (e, p._replace(ends=p.ends - p.ends[0] - 1)), "do not fall"),
}


@pytest.mark.parametrize(("change", "expected"), ODD.values(), ids=ODD)
def test_an_evolution_at_odds_with_its_population_is_not_logged(change, expected):
    event = evolved()
    lie, population = change(event.evolution, event.evolution.population)
    with pytest.raises(InputError, match=expected):
        memetic_run(dataclasses.replace(event, evolution=lie), population, 0)


def test_what_could_not_be_read_is_not_written(monkeypatch):
    monkeypatch.setattr("gapath.recorders.mcap.memetic_message.MAX_CHUNK", 1 << 10)
    event = evolved()
    with pytest.raises(InputError, match="fewer epochs"):
        memetic_run(event, event.evolution.population, 0)

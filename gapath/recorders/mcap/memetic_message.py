"""What a memetic algorithm's population took in as a message, and back."""

import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gapath.errors import require
from gapath.events import Evolved
from gapath.history.evolution import Evolution, Population
from gapath.kernels.history.polygon_changes import leaders, restored, shortened, whole_ends
from gapath.recorders.mcap.cdr import COUNT, Record, arrays_cdr, strings_cdr
from gapath.recorders.mcap.format import MAX_CHUNK

TOPIC = "/memetic_run"

_HEAD = struct.Struct("<QQI")
_INT32, _FLOAT64 = np.dtype("<i4"), np.dtype("<f8")


def memetic_run(event: Evolved, population: Population, time: int) -> Record:
    """Write an evolution that has a population.

    Parameters
    ----------
    event : Evolved
        The event.
    population : Population
        Its evolution's.
    time : int
        Its log time, in nanoseconds.

    Returns
    -------
    Record
        The message.

    Raises
    ------
    InputError
        If the population's parts do not fit one another, an epoch's best individual is not as one
        of the changes left it, or what comes back from the message would be too large to read.
    """
    evolution = event.evolution
    rows = np.ascontiguousarray(evolution.way_points, np.int32)
    _check(population, len(rows))
    led = leaders(population.epochs, population.ends, population.vertices, rows)
    same = np.array_equal(evolution.chromosomes.ravel(), rows.ravel())
    _fit(same and (led >= 0).all(), "a best polygon", "one that a change left")
    size = rows.nbytes + population.vertices.nbytes
    require(size <= MAX_CHUNK // 2, "recorder.mcap", f"polygons of {size} bytes", _FEWER)
    heads, tails, ends, vertices = shortened(
        _slots(population.individuals), population.ends, population.vertices
    )
    changes = (population.epochs, population.individuals, population.operators, heads, tails, ends)
    floats = (evolution.best, evolution.mean, population.gains, population.costs)
    data = arrays_cdr(
        _HEAD.pack(event.trial, event.call, rows.shape[1]),
        *(np.asarray(each, _INT32) for each in (led, *changes, vertices)),
        *(np.asarray(each, _FLOAT64) for each in (*floats, population.shares)),
    )
    names = COUNT.pack(len(population.names)) + strings_cdr(*population.names, evolution.genotype)
    return Record(TOPIC, time, data + names)


_FEWER = f"at most {MAX_CHUNK // 2} bytes of vertices: fewer epochs"


def read_memetic_run(step: int, m: Any) -> Evolved:
    """Read such a message, which may come from anywhere.

    Parameters
    ----------
    step : int
        Its log time as a step.
    m : object
        The message, as `rosbags` has it.

    Returns
    -------
    Evolved
        The event that was written.

    Raises
    ------
    InputError
        If its parts do not fit one another.
    """
    slots, heads, tails = _slots(m.individuals), _whole(m.heads), _whole(m.tails)
    ends, vertices, led = _whole(m.ends), _whole(m.vertices).reshape(-1, 2), _whole(m.leaders)
    count, epochs = len(slots), len(led)
    of_changes = (m.epochs, m.operators, heads, tails, ends, m.gains, m.costs)
    _fit(len({count, *map(len, of_changes)}) == 1, "changes", "parts of one length")
    _fit(epochs == len(m.best) == len(m.mean), "epochs", "parts of one length")
    whole = whole_ends(slots, heads, tails, ends)
    _fit(len(whole) == count, f"polygon {len(whole)}", "parts of the one before")
    _fit(len(vertices) == (ends[-1] if count else 0), f"{len(vertices)} vertices", "its end")
    total = (int(whole[-1]) if count else 0) + epochs * m.way_points_count
    _fit(8 * total <= MAX_CHUNK, f"{total} vertices", f"at most {MAX_CHUNK // 8}")
    population = Population(
        epochs=_whole(m.epochs),
        individuals=_whole(m.individuals),
        operators=_whole(m.operators),
        gains=np.array(m.gains, dtype=np.float64),
        costs=np.array(m.costs, dtype=np.float64),
        ends=whole.astype(np.int32),
        vertices=restored(slots, heads, tails, vertices, whole),
        names=tuple(m.names),
        shares=tuple(m.shares.tolist()),
    )
    _check(population, epochs)
    way_points = np.empty((epochs, m.way_points_count, 2), dtype=np.int32)
    for row, leader in zip(way_points, led.tolist(), strict=True):
        _fit(0 <= leader < count, f"leader {leader}", f"one of {count} changes")
        polygon = population.polygon(leader)
        _fit(0 < len(polygon) <= len(row), f"leader {leader}", f"1 to {len(row)} vertices")
        row[: len(polygon)], row[len(polygon) :] = polygon, polygon[-1]
    best, mean = (np.array(each, dtype=np.float64) for each in (m.best, m.mean))
    chromosomes = way_points.reshape(epochs, 2 * m.way_points_count).copy()
    evolution = Evolution(best, mean, chromosomes, way_points, m.genotype, population)
    return Evolved(step, m.trial, m.call, evolution)


def _check(population: Population, count: int) -> None:
    """Refuse what kernels would read past, and what nobody could show."""
    epochs, operators, ends = population.epochs, population.operators, population.ends
    _fit(len(epochs), "no changes", "at least one")
    _fit(len({len(part) for part in population[:6]}) == 1, "changes", "parts of one length")
    vertices = len(population.vertices)
    in_order = (np.diff(ends, prepend=0) >= 0).all() and ends[-1] == vertices
    _fit(in_order, "ends", f"numbers that do not fall, the last one {vertices}")
    in_order = (
        len(epochs) and epochs[0] >= 1 and epochs[-1] <= count and (np.diff(epochs) >= 0).all()
    )
    _fit(in_order, "epochs", f"numbers from 1 to {count} that do not fall")
    known = (operators >= 0) & (operators < len(population.names))
    _fit(known.all(), "operators", "numbers of names")
    _fit(len(population.names) == len(population.shares), "names", "a share each")


def _slots(individuals: NDArray[np.int32]) -> NDArray[np.int32]:
    """Give individuals numbers from 0 without gaps."""
    return np.unique(individuals, return_inverse=True)[1].astype(np.int32)


def _whole(numbers: NDArray[np.int32]) -> NDArray[np.int32]:
    """Copy numbers, which a message holds read-only."""
    return np.array(numbers, dtype=np.int32)


def _fit(good: object, found: object, expected: str) -> None:
    require(bool(good), TOPIC, found, expected)

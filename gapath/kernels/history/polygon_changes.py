"""A population's polygons as what changed of each, for logs: a change seldom moves all vertices."""

import numpy as np
from numpy.typing import NDArray

from gapath.kernels.jit import kernel


@kernel
def shortened(
    slots: NDArray[np.int32], ends: NDArray[np.int32], vertices: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]:
    """Leave out of each polygon the vertices with which the one before it begins and ends.

    Parameters
    ----------
    slots : (m,) int32
        Whose polygon each is, from 0; the one before it is the last one of the same slot.
    ends : (m,) int32
        Where each one's vertices end, not falling.
    vertices : (ends[-1], 2) int32
        The vertices.

    Returns
    -------
    heads, tails : (m,) int32
        Vertices left out at the beginning, as many as can be, and of the others at the end.
    new_ends : (m,) int32
        Where what is left of each ends in the new vertices.
    new_vertices : (new_ends[-1], 2) int32
        What is left.
    """
    m = slots.shape[0]
    heads, tails, new_ends = np.zeros_like(slots), np.zeros_like(slots), np.zeros_like(slots)
    new_vertices = np.empty_like(vertices)
    before = np.zeros((slots.max() + 1 if m else 0, 2), dtype=np.int64)
    begin = total = 0
    for i in range(m):
        end, slot = ends[i], slots[i]
        first, last = before[slot, 0], before[slot, 1]
        shorter = min(last - first, end - begin)
        head = tail = 0
        while head < shorter and _same(vertices, first + head, begin + head):
            head += 1
        while tail < shorter - head and _same(vertices, last - 1 - tail, end - 1 - tail):
            tail += 1
        for k in range(begin + head, end - tail):
            new_vertices[total] = vertices[k]
            total += 1
        heads[i], tails[i], new_ends[i] = head, tail, total
        before[slot, 0], before[slot, 1] = begin, end
        begin = end
    return heads, tails, new_ends, new_vertices[:total].copy()


@kernel
def whole_ends(
    slots: NDArray[np.int32],
    heads: NDArray[np.int32],
    tails: NDArray[np.int32],
    ends: NDArray[np.int32],
) -> NDArray[np.int64]:
    """Give where the vertices of each polygon end that `shortened` shortened.

    Parameters
    ----------
    slots, heads, tails, ends : (m,) int32
        As `shortened` takes and gives them, or anything.

    Returns
    -------
    (m,) int64
        Ends; fewer than m if the next one is wrong: it leaves out more than there was, or ends
        before it begins.
    """
    m = slots.shape[0]
    whole = np.empty(m, dtype=np.int64)
    lengths = np.zeros(slots.max() + 1 if m else 0, dtype=np.int64)
    begin = total = 0
    for i in range(m):
        left_out, new = np.int64(heads[i]) + np.int64(tails[i]), ends[i] - begin
        if heads[i] < 0 or tails[i] < 0 or new < 0 or left_out > lengths[slots[i]]:
            return whole[:i]
        lengths[slots[i]] = left_out + new
        total += left_out + new
        whole[i] = total
        begin = ends[i]
    return whole


@kernel
def restored(
    slots: NDArray[np.int32],
    heads: NDArray[np.int32],
    tails: NDArray[np.int32],
    vertices: NDArray[np.int32],
    whole: NDArray[np.int64],
) -> NDArray[np.int32]:
    """Put polygons together again that `shortened` shortened.

    Parameters
    ----------
    slots, heads, tails : (m,) int32
        As `shortened` takes and gives them.
    vertices : (n, 2) int32
        What was left of each.
    whole : (m,) int64
        As `whole_ends` gives it, for all of them.

    Returns
    -------
    (whole[-1], 2) int32
        The vertices that `shortened` was given.
    """
    m = slots.shape[0]
    found = np.empty((whole[m - 1] if m else 0, 2), dtype=np.int32)
    before = np.zeros((slots.max() + 1 if m else 0, 2), dtype=np.int64)
    begin = taken = 0
    for i in range(m):
        end, slot = whole[i], slots[i]
        first, last = before[slot, 0], before[slot, 1]
        for k in range(heads[i]):
            found[begin + k] = found[first + k]
        for k in range(begin + heads[i], end - tails[i]):
            found[k] = vertices[taken]
            taken += 1
        for k in range(1, tails[i] + 1):
            found[end - k] = found[last - k]
        before[slot, 0], before[slot, 1] = begin, end
        begin = end
    return found


@kernel
def leaders(
    epochs: NDArray[np.int32],
    ends: NDArray[np.int32],
    vertices: NDArray[np.int32],
    rows: NDArray[np.int32],
) -> NDArray[np.int32]:
    """Find each epoch's best polygon among the population's.

    Parameters
    ----------
    epochs : (m,) int32
        Epoch of each polygon, from 1, not falling.
    ends : (m,) int32
        Where each one's vertices end.
    vertices : (ends[-1], 2) int32
        The vertices.
    rows : (E, n, 2) int32
        The best polygon of each epoch, its last vertex repeated.

    Returns
    -------
    (E,) int32
        Number of the last polygon, not of a later epoch, that is the row's; -1 where none is.
    """
    found = np.full(rows.shape[0], -1, dtype=np.int32)
    for e in range(rows.shape[0]):
        i = np.searchsorted(epochs, e + 1, side="right") - 1
        while i >= 0 and not _is_row(rows[e], ends[i - 1] if i else 0, ends[i], vertices):
            i -= 1
        found[e] = i
    return found


@kernel(inner=True)
def _same(vertices: NDArray[np.int32], i: int, k: int) -> bool:
    return bool(vertices[i, 0] == vertices[k, 0] and vertices[i, 1] == vertices[k, 1])


@kernel(inner=True)
def _is_row(row: NDArray[np.int32], begin: int, end: int, vertices: NDArray[np.int32]) -> bool:
    """Tell whether a row has the vertices from begin to end, the last one repeated."""
    if end == begin or end - begin > row.shape[0]:
        return False
    for k in range(row.shape[0]):
        vertex = vertices[min(begin + k, end - 1)]
        if row[k, 0] != vertex[0] or row[k, 1] != vertex[1]:
            return False
    return True

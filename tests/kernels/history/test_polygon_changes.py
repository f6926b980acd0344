"""What changed of a population's polygons: by hand, and against the obvious twin."""

import naive_polygons as naive
import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from gapath.kernels.history.polygon_changes import leaders, restored, shortened, whole_ends

VERTEX = st.tuples(st.integers(0, 1), st.just(7))  # two of them: polygons often begin alike
POLYGONS = st.lists(
    st.tuples(st.integers(0, 2), st.lists(VERTEX, max_size=6)), max_size=8
)  # (slot, vertices)


def packed(polygons):
    """Give ends and vertices."""
    ends = np.cumsum([len(polygon) for polygon in polygons], dtype=np.int32)
    vertices = [vertex for polygon in polygons for vertex in polygon]
    return ends, np.array(vertices, dtype=np.int32).reshape(-1, 2)


def unpacked(ends, vertices):
    parts = np.split(vertices, ends[:-1]) if len(ends) else []
    return [list(map(tuple, part.tolist())) for part in parts]


def numbers(values):
    return np.array(list(values), dtype=np.int32)


def test_an_insertion_is_one_vertex_by_hand():
    old, new = [(0, 0), (9, 9)], [(0, 0), (3, 5), (9, 9)]
    heads, tails, ends, vertices = shortened(numbers([0, 1, 0]), *packed([old, old, new]))
    assert (heads.tolist(), tails.tolist(), ends.tolist()) == ([0, 0, 1], [0, 0, 1], [2, 4, 5])
    assert vertices[4:].tolist() == [[3, 5]]


@given(POLYGONS)
def test_what_changed_is_the_twins_and_comes_back(drawn):
    slots, polygons = numbers(slot for slot, _ in drawn), [polygon for _, polygon in drawn]
    heads, tails, ends, vertices = shortened(slots, *packed(polygons))
    parts = list(zip(heads.tolist(), tails.tolist(), unpacked(ends, vertices), strict=True))
    assert parts == naive.shortened(slots.tolist(), polygons)
    whole = whole_ends(slots, heads, tails, ends)
    assert whole.tolist() == packed(polygons)[0].tolist()
    assert unpacked(whole, restored(slots, heads, tails, vertices, whole)) == polygons
    moved = restored(slots, heads, tails, vertices + 9, whole)  # nothing is left from before
    assert (moved - 9).tolist() == [list(vertex) for polygon in polygons for vertex in polygon]


@given(
    st.lists(
        st.tuples(
            st.integers(0, 2), st.integers(-1, 3), st.integers(-1, 3), st.lists(VERTEX, max_size=3)
        ),
        max_size=8,
    )
)
def test_what_cannot_be_put_together_ends_there(drawn):
    slots, heads, tails = (numbers(each[k] for each in drawn) for k in range(3))
    ends, vertices = packed([each[3] for each in drawn])
    expected = naive.restored(slots.tolist(), [each[1:] for each in drawn])
    whole = whole_ends(slots, heads, tails, ends)
    assert whole.tolist() == packed(expected)[0].tolist()
    if len(whole) == len(drawn):
        assert unpacked(whole, restored(slots, heads, tails, vertices, whole)) == expected


def test_ends_that_fall_end_there():
    ends = whole_ends(numbers([0, 1, 0]), numbers([0] * 3), numbers([0] * 3), numbers([2, 1, 4]))
    assert ends.tolist() == [2]


@given(POLYGONS, st.data())
def test_leaders_are_the_twins(drawn, data):
    polygons = [polygon for _, polygon in drawn]
    epochs = sorted(data.draw(st.integers(1, 4)) for _ in polygons)
    width = max((len(polygon) for polygon in polygons), default=0) + 1
    known = [polygon + polygon[-1:] * (width - len(polygon)) for polygon in polygons if polygon]
    rows = data.draw(
        st.lists(
            st.lists(VERTEX, min_size=width, max_size=width)
            | (st.sampled_from(known) if known else st.nothing()),
            max_size=5,
        )
    )
    found = leaders(
        numbers(epochs), *packed(polygons), np.array(rows, np.int32).reshape(-1, width, 2)
    )
    expected = [naive.leader(epochs, polygons, e + 1, row) for e, row in enumerate(rows)]
    assert found.tolist() == expected

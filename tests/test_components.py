"""Settings mean the same, however they are written: found for every component."""

from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.components import build, normalised, typed
from gapath.discovery import OFFERS, yaml_names, yaml_values
from gapath.errors import InputError
from gapath.store.settings import flatten, text_of

EVERY = [(group, name) for group in sorted(OFFERS.keys() - {"task"}) for name in yaml_names(group)]


def loosened(value, how):
    """Write every number another way."""
    if isinstance(value, dict):
        return {k: loosened(v, how) for k, v in value.items()}
    if isinstance(value, list):
        return [loosened(item, how) for item in value]
    return how(value) if isinstance(value, int | float) and not isinstance(value, bool) else value


@pytest.mark.parametrize("how", [str, lambda v: v + 0.0, lambda v: int(v) if v == int(v) else v])
@pytest.mark.parametrize(("group", "name"), EVERY)
def test_one_value_is_written_one_way(group, name, how):
    values = yaml_values(group, name)
    values |= {
        k: v for k, v in {"start": [1, 2], "target": [3, 4], "path": "m"}.items() if k in values
    }
    plain, loose = (normalised(group, v, group) for v in (values, loosened(values, how)))
    assert text_of(flatten(loose)) == text_of(flatten(plain))
    assert plain.keys() == values.keys()
    assert normalised(group, plain, group) == plain
    assert repr(build(group, loose, group)) == repr(build(group, plain, group))


@dataclass
class Inner:
    side: int


@dataclass
class Numbers:
    one: int
    some: list[int] | None
    share: float
    word: str | int
    level: str | float
    inner: Inner


GOOD: dict[str, Any] = {"one": 1, "some": None, "share": 0, "word": "a", "level": "b",
                        "inner": {"side": 3}}  # fmt: skip


@given(st.integers(-(2**53) + 1, 2**53 - 1))
def test_whole_numbers_of_every_kind_of_field(n):
    for whole in (n, float(n), str(n)):
        loose = {"one": whole, "some": [whole], "share": whole, "inner": {"side": whole}}
        made = typed(Numbers, GOOD | loose, "x")
        assert made == Numbers(n, [n], float(n), "a", "b", Inner(n))
        assert list(map(type, (made.one, made.some[0], made.share))) == [int, int, float]
    for whole in (n, float(n), str(n), f"{n}.0"):
        made = typed(Numbers, GOOD | {"word": whole, "level": whole}, "x")
        assert [(type(v), v) for v in (made.word, made.level)] == [(int, n), (float, n)]


@pytest.mark.parametrize("word", ["", "a", "nan", "inf", "-infinity", "0x1", "1 2"])
def test_words_stay_words(word):
    made = typed(Numbers, GOOD | {"word": word, "level": word}, "x")
    assert (made.word, made.level) == (word, word)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"word": 1.5}, "x.word: got 1.5, expected a value of type str | int"),
        ({"one": 1.5}, "x.one: got 1.5, expected a value of type int"),
        ({"one": 1e300}, "x.one: got 1e+300, expected a value of type int"),
        ({"one": float("inf")}, "x.one: got inf"),
        ({"one": float("nan")}, "x.one: got nan"),
        ({"one": True}, "x.one: got True"),
        ({"one": "1.0"}, "x.one: got '1.0'"),
        ({"some": [1, 2.5]}, "x.some[1]: got [1, 2.5]"),
        ({"share": "half"}, "x.share: got 'half', expected a value of type float"),
        ({"inner": {"side": 0.5}}, "x.inner.side: got 0.5, expected a value of type int"),
        ({"inner": {"colour": 1}}, "x.inner.colour: got an unknown name, expected one of side"),
        ({"inner": None}, "x.inner: got None, expected settings: side"),
        ({"inner": {}}, "x.inner.side: got nothing, expected a value"),
    ],
)
def test_what_is_no_such_number_is_refused(values, message):
    with pytest.raises(InputError) as caught:
        typed(Numbers, GOOD | values, "x")
    assert message in str(caught.value)

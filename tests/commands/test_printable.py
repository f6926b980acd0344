"""Bad input is told in one line that does nothing to the terminal that shows it."""

import copy

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gapath.errors import InputError, printable


@pytest.mark.parametrize(
    ("text", "seen"),
    [
        ("plain, größer, 道 🙂 a\\b", "plain, größer, 道 🙂 a\\b"),
        ("\x1b[2J", r"\x1b[2J"),
        ("\x9b2J\x07\x7f", r"\x9b2J\x07\x7f"),
        ("a\tb\nc\rd", r"a\x09b\x0ac\x0dd"),
        ("\u202eevil\u2066\u2028", r"\u202eevil\u2066\u2028"),
        ("\udc80", r"\udc80"),
    ],
)
def test_what_a_terminal_obeys_is_seen_instead(text, seen):
    assert printable(text) == seen


@given(st.text(st.characters(), max_size=40))
def test_printable_text_is_one_line_that_can_be_written(text):
    seen = printable(text)
    assert seen.isascii() or seen.encode()
    assert len(seen.splitlines()) <= 1
    assert not any(ord(c) < 32 or 127 <= ord(c) < 160 for c in seen)
    assert printable(seen) == seen


def test_an_error_is_one_short_printable_line():
    error = InputError("a\x1b[31m.png", "no\n  such\x07" + "x" * 10**6, "an\nexisting file")
    line = str(error)
    assert line.startswith(r"a\x1b[31m.png: got no such\x07xx")
    assert line.endswith("(999608 characters more), expected an existing file")
    assert error.where == "a\x1b[31m.png"
    assert str(copy.copy(error)) == line  # as it is made again in another process

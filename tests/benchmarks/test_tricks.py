"""What tricks are worth: both ways are timed, and give the same."""

import pytest

from benchmarks.questions.kg18 import tricks


def test_every_trick_is_timed_with_and_without():
    rows = tricks.measure(quick=True)
    assert len(rows) == len({row["what"] for row in rows}) == 6
    for row in rows:
        assert all(row[name].lower > 0 for name in ("with", "without", "without / with"))


def test_another_result_is_noticed(monkeypatch):
    monkeypatch.setattr(tricks, "sort_all", lambda keys, best: best.fill(0))
    with pytest.raises(RuntimeError, match="not all sorted: another result without it"):
        tricks.ranking(rounds=1)

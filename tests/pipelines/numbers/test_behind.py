import pandas as pd
import pytest

from gapath.errors import InputError
from gapath.pipelines.numbers.behind import keys_behind
from gapath.pipelines.page.section import Table

TRIALS = pd.DataFrame({
    "map": ["a", "a", "b", "a", "a"],
    "size": [1, 1, 1, 2, 1],
    "key": ["k2", "k2", "k3", "k4", "k1"],
})  # fmt: skip


def test_each_row_has_the_runs_whose_trials_it_is_made_of():
    rows = pd.DataFrame({"map": ["b", "a", "a", "c"], "size": [1.0, 1.0, 2.0, 1.0]})
    assert keys_behind(TRIALS, ["map", "size"], rows) == (("k3",), ("k1", "k2"), ("k4",), ())
    assert keys_behind(TRIALS, ["map"], rows)[1] == ("k1", "k2", "k4")


def test_a_table_leads_each_row_or_none_to_its_runs():
    data = pd.DataFrame({"map": ["b", "a"]})
    table = Table("t", "Maps.", data, data, heads=1)
    assert table.runs == ()
    assert table.with_runs(TRIALS, ["map"]).runs == (("k3",), ("k1", "k2", "k4"))
    with pytest.raises(InputError, match=r"table t, runs: got 1, expected one entry a row, 2"):
        Table("t", "Maps.", data, data, runs=(("k",),))

import math
import re

import pandas as pd
import pytest

from gapath.pipelines.kg18 import table1, table_classes
from gapath.pipelines.numbers.grouped import Groups
from gapath.pipelines.numbers.statistics import wilson
from gapath.pipelines.numbers.summary import summarise, summarise_by
from gapath.pipelines.page.section import Table
from gapath.pipelines.papers.kg18 import SECONDS, implied_epochs
from gapath.pipelines.papers.names import label, rank
from gapath.store.records import find_runs

from .conftest import collect


def trials(**columns):
    frame = pd.DataFrame(columns)
    defaults = {
        "map": "m", "map_source": "array", "map_instance": 0, "planner": "ga1", "plan_time_s": 0.5,
        "optimality_ratio": 1.0, "length_ratio": math.nan, "evaluations": 10,
        "epochs": 1, "feasible": True,
    }  # fmt: skip
    defaults["key"] = [f"run {i}" for i in range(len(frame))]
    return frame.assign(**{k: v for k, v in defaults.items() if k not in frame})


def only(summary, frame):
    """Give the row that a frame of one group comes to."""
    return {name: values[0] for name, values in summary(frame, Groups.one(len(frame))).items()}


def test_a_summary_worked_by_hand():
    row = only(
        summarise,
        trials(
            feasible=[True, True, True, False],
            epochs=[1, 2, 3, 500],
            evaluations=[40, 70, 100, 15010],
            plan_time_s=[0.1, 0.2, 0.3, 1.4],
            optimality_ratio=[1.0, 1.2, 1.1, math.nan],
        ),
    )
    assert (row["n"], row["found"], row["success"]) == (4, 3, 0.75)
    assert (row["success_low"], row["success_high"]) == wilson(0.75, 4)
    assert (row["found_epochs_q1"], row["found_epochs_median"]) == (1.5, 2)
    assert (row["epochs_q1"], row["epochs_median"], row["epochs_q3"]) == (1.75, 2.5, 127.25)
    assert row["optimality_ratio_median"] == 1.1
    assert row["ert_evaluations"] == pytest.approx(15220 / 3)
    assert row["ert_seconds"] == pytest.approx(2 / 3)


def test_nothing_found_is_expected_never():
    row = only(summarise, trials(feasible=[False, False], optimality_ratio=math.nan))
    assert row["ert_evaluations"] == row["ert_seconds"] == math.inf
    assert math.isnan(row["optimality_ratio_median"])


def test_a_graph_search_has_no_epochs_and_no_interval():
    row = only(summarise, trials(epochs=[0, 0], evaluations=0))
    for name in ("epochs_median", "evaluations_q1", "ert_evaluations", "success_low"):
        assert math.isnan(row[name])
    assert row["ert_seconds"] == 0.5


def test_rows_come_in_the_papers_order():
    names = ["dijkstra", "zzz", "ga2", "astar", "ga1"]
    rows = summarise_by(trials(planner=names), ["planner"])
    assert list(rows["planner"]) == ["ga1", "ga2", "astar", "dijkstra", "zzz"]


def test_the_papers_seconds_as_epochs():
    def band(name, planner):
        epochs = implied_epochs(name, planner)
        return (min(epochs), max(epochs)) if epochs else None

    bands = {
        1: [(1, 1), (1, 1), (1, 1)],
        2: [(3, 7), (1, 2), (2, 2)],
        3: [(26, 37), (11, 49), (7, 17)],
        4: [None, None, None],
    }
    for number, expected in bands.items():
        name = f"kg18_test{number}"
        assert [band(name, planner) for planner in ("ga1", "ga2", "ga3")] == expected
    assert implied_epochs("kg18_test1", "dijkstra") == []
    assert len(SECONDS) == 16


def test_table1_puts_the_paper_beside_ours(outputs):
    frame = collect(outputs).trials["plan"]
    mine = frame[frame["experiment"] == "table1"]
    section = table1.section(mine, [])
    beside, effort = section.tables
    assert len(beside.shown) == len(effort.shown) == 20
    row = beside.shown.set_index(["Map", "Planner"]).loc[("Map 3 (reconstructed)", "GA 1")]
    assert row["Paper: time, s"] == "1.10, 0.77, N.F."
    assert row["Paper: found"] == "2 of 3"
    assert row["Paper: epochs"] == "26 to 37"
    found = mine[(mine["map"] == "kg18_test3") & (mine["planner"] == "ga1")]["feasible"].mean()
    assert float(row["Found, %"]) == pytest.approx(100 * found)
    last = effort.shown.set_index(["Map", "Planner"]).loc[("Map 4 (reconstructed)", "GA 3")]
    assert last["Expected evaluations"] == last["Expected time, ms"] == "∞"
    assert any("Dijkstra" in remark and "ms" in remark for remark in section.remarks)


def test_table1_without_dijkstra_claims_nothing_about_it():
    mine = trials(planner=["ga1"], map="kg18_test1")
    remarks = table1.section(mine, []).remarks
    assert not any(" ms" in remark for remark in remarks)


def test_other_instances_stay_out_of_table1():
    mine = trials(map_instance=[0, 0, 5], map="kg18_test1", feasible=[True, True, False])
    assert list(table1.section(mine, []).tables[0].data["n"]) == [2]


def test_other_instances_alone_make_no_table1():
    assert table1.section(trials(map_instance=[3, 5], map="kg18_test1"), []) is None


def test_classes_count_instances_not_trials():
    mine = trials(
        map="kg18_test3",
        map_instance=[0, 0, 0, 0, 1, 1, 2, 2],
        feasible=[True, True, True, True, True, False, False, False],
        epochs=[1, 1, 1, 1, 5, 9, 9, 9],
    )
    row = only(table_classes.summarise_class, mine)
    assert row["success"] == pytest.approx((1 + 0.5 + 0) / 3)
    assert (row["success_low"], row["success_high"]) == pytest.approx(wilson(0.5, 3))
    assert (row["instances"], row["n"], row["always"], row["never"]) == (3, 8, 1, 1)
    assert row["epochs_median"] == 3


def test_the_three_forms_of_a_table():
    shown = pd.DataFrame({"A_b": ["x & y", "∞"], "B, %": ["1\u202f000", "< 0.1"]})
    table = Table("name", "100 % of it", pd.DataFrame({"a": [1.5, math.inf]}), shown)
    assert table.csv() == "a\n1.5\ninf\n"
    markdown = table.markdown()
    assert "x & y" in markdown
    assert "1\u202f000" in markdown
    latex = table.latex()
    for text in (r"A\_b", r"x \& y", r"$\infty$", r"1\,000", "$<$ 0.1", r"100 \% of it", "toprule"):
        assert text in latex
    assert latex.isascii()


def test_a_bar_ends_no_cell_of_markdown():
    shown = pd.DataFrame({"a | b": ["x || y"], "c": ["1"]})
    head, _, row = Table("name", "It.", shown, shown).markdown().splitlines()[:3]
    cells = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)] for line in (head, row)]
    assert cells == [["", r"a \| b", "c", ""], ["", r"x \|\| y", "1", ""]]


def test_of_very_many_rows_people_are_shown_the_first_and_told_so():
    data = pd.DataFrame({"planner": [f"p{i}" for i in range(2500)], "n": 1})
    frame = data.assign(key=[f"k{i}" for i in range(2500)])
    table = Table("name", "All of them.", data, data.astype(str)).with_runs(frame, ["planner"])
    assert len(table.csv().splitlines()) == 2501
    assert len(table.shown) == len(table.runs) == 1000
    assert table.runs[-1] == ("k999",)
    said = "All of them. The first 1000 of 2500 rows; the CSV file has all."
    assert table.caption.replace("\u202f", "") == said
    assert "p999" in table.markdown() and "p1000" not in table.markdown() + table.latex()
    small = Table("name", "All of them.", data[:1000], data[:1000].astype(str))
    assert small.caption == "All of them."


def test_every_latex_table_is_ascii(outputs):
    frame = collect(outputs).trials["plan"]
    for module in (table1, table_classes):
        for table in module.section(frame, find_runs(outputs)).tables:
            assert table.latex().isascii()


def test_labels_carry_the_mark():
    assert label("kg18_test2", "reconstructed") == "Map 2 (reconstructed)"
    assert label("arena", "movingai") == "arena"
    assert label("astar") == "A*"
    assert label("kg18[sensor.range=8]") == "KG18 [sensor.range=8]"
    assert label("s04_sp07", "reconstructed") == "SPSet07 (reconstructed)"
    assert label("x[y=1]") == "x [y=1]"


def test_what_differs_from_a_yaml_stands_beside_it():
    names = ["zzz", "sedighi", "ga2", "ga1[population=60]", "ga1"]
    assert sorted(names, key=rank) == ["ga1", "ga1[population=60]", "ga2", "sedighi", "zzz"]

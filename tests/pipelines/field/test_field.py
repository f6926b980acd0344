"""The sections on many problems a map: their numbers by hand, from runs of two small scenarios."""

from pathlib import Path

import numpy as np
import pytest

from gapath.pipelines.field import figure_lengths, table_lengths, table_maps
from gapath.pipelines.field.problems import asked, summarised, without_a_way
from gapath.pipelines.reading.collect import read_trials
from gapath.pipelines.report.report import make_report
from gapath.store.records import find_runs

BOX = [".........", ".@@@@....", ".@..@....", ".@@@@....", ".........", "........."]
MAP = "type octile\nheight 6\nwidth 9\nmap\n" + "\n".join(BOX)
ROWS = ("1 m.map 9 6 0 0 8 5 9.49", "0 m.map 9 6 2 2 3 2 1", "1 m.map 9 6 0 0 2 2 5",
        "1 m.map 9 6 1 1 8 5 8", "1 m.map 9 6 8 0 0 5 9.07", "2 m.map 9 6 8 5 8 0 5")  # fmt: skip


@pytest.fixture
def runs(gapath, tmp_path):
    """Two planners on a scenario of which two rows have no way, and A* on a map of its own."""
    Path("m.map").write_text(MAP)
    Path("m.map.scen").write_text("\n".join(["version 1", *ROWS]))
    common = ("task=scenario", "name=field", "recorder=none", "trials=2")
    here = ("map=movingai", "map.path=m.map", "map.scenario=m.map.scen", "corner_cutting=forbid")
    few = ("planner.max_epochs=2", "planner.population=8")
    assert gapath(*common, *here, "planner=astar")[0] == 0
    assert gapath(*common, *here, "planner=ga1", *few)[0] == 0
    drawn = ("map=kg18_test3", "map.instance=2", "scenario.drawn=5", "scenario.every=2")
    assert gapath(*common, *drawn, "planner=astar")[0] == 0
    return tmp_path / "out"


def test_the_numbers_are_those_of_the_trials(runs):
    collected = read_trials(find_runs(runs))
    trials, used = collected.trials["scenario"], collected.runs
    known = asked(trials, used)
    assert without_a_way(trials) == "Problems without any way: 2; they are left out."
    assert without_a_way(known) == "All problems have a way."
    assert set(known["method"]) == {"astar", "ga1[max_epochs=2,population=8]"}
    assert set(known["place"]) == {"m", "kg18_test3 #2"}
    bands = known[known["place"] == "m"].groupby("row")[["length_from", "length_to"]].first()
    assert bands.to_numpy().tolist() == [[4, 8], [0, 4], [4, 8], [8, 16]]
    rows = summarised(known, ["family", "place"]).set_index(["place", "method"])
    assert rows.loc[("m", "astar"), ["problems", "n", "success", "ratio_max"]].tolist() == [
        4,
        8,
        1,
        1,
    ]
    assert rows.loc[("kg18_test3 #2", "astar"), ["problems", "n"]].tolist() == [3, 6]
    ga = rows.loc[("m", "ga1[max_epochs=2,population=8]")]
    mine = trials[(trials["planner"] != "astar[corner_cutting=forbid]") & (trials["map"] == "m")]
    mine = mine[np.isfinite(mine["optimal_cost"])]
    found = mine[mine["feasible"]]
    assert (ga["n"], ga["success"]) == (8, len(found) / 8) and 0 < ga["success"] < 1
    ratios = (found["cost"] / found["optimal_cost"]).to_numpy()
    assert ga["ratio_mean"] == pytest.approx(ratios.mean())
    assert ga["ratio_p99"] == pytest.approx(np.quantile(ratios, 0.99))
    assert ga["seconds_total"] == pytest.approx(mine["plan_time_s"].sum())  # failures included
    exact = rows.loc[("m", "astar"), "seconds_mean"]
    assert ga["times_exact"] == pytest.approx(exact / mine["plan_time_s"].mean())
    assert rows.loc[("m", "astar"), "length_ratio_median"] > 0


def test_the_sections_name_their_source_and_lead_to_the_runs(runs):
    collected = read_trials(find_runs(runs))
    trials, used = collected.trials["scenario"], collected.runs
    lengths, maps = table_lengths.section(trials, used), table_maps.section(trials, used)
    (table,) = lengths.tables
    assert "Sturtevant 2012" in lengths.text[0] and "failures" in table.caption
    assert "Problems without any way: 2" in lengths.remarks[0]
    head = table.shown.iloc[0].to_dict()
    assert head["Maps"] == "KG18's classes (reconstructed)"
    assert all(len(keys) == 1 for keys in table.runs)
    order = table.data[table.data["family"] == "MovingAI"]["length_from"].tolist()
    assert order == sorted(order) and len(table.shown) == len(table.data)
    assert maps.tables[0].shown["AOL, rad / field"].ne("").all()
    figures = figure_lengths.section(trials, used).figures
    assert [figure.name for figure in figures] == [
        "field_lengths_kg18_s_classes_reconstructed", "field_lengths_movingai"
    ]  # fmt: skip
    assert "Sturtevant 2012" in figures[1].caption and "A* found 100 %" in figures[1].alt
    for figure, (_, rows) in zip(figures, table.data.groupby("family", sort=True), strict=True):
        assert figure.png.startswith(b"\x89PNG")
        least = max(rows["length_from"].min(), 2)  # an axis says where it begins
        assert f"<!-- {least} -->".encode() in figure.svg


def test_generated_maps_of_one_size_are_a_family(gapath, tmp_path):
    common = ("task=scenario", "name=field", "recorder=none", "planner=astar", "scenario.drawn=2")
    for width in (40, 60):
        assert gapath(*common, "map=field_clutter", f"map.width={width}", "map.height=20")[0] == 0
    collected = read_trials(find_runs(tmp_path / "out"))
    known = asked(collected.trials["scenario"], collected.runs)
    assert set(known["family"]) == {"generated, 40 x 20", "generated, 60 x 20"}


def test_where_no_problem_has_a_way_there_is_nothing_to_show(runs):
    collected = read_trials(find_runs(runs))
    trials, used = collected.trials["scenario"], collected.runs
    none = trials[~np.isfinite(trials["optimal_cost"])]
    assert len(none) > 0
    for module in (table_lengths, table_maps, figure_lengths):
        assert module.section(none, used) is None


@pytest.mark.usefixtures("undrawn")
def test_the_report_has_them_of_a_scenario_of_ones_own_too(gapath, runs, tmp_path):
    mine = ("task=scenario", "name=mine", "recorder=none", "planner=astar", "map=movingai")
    assert gapath(*mine, "map.path=m.map", "map.scenario=m.map.scen")[0] == 0
    made, _ = make_report(runs, tmp_path / "report")
    names = {path.name for path in made}
    for experiment in ("field", "field_mine"):
        own = {"lengths.csv", "maps.csv", "lengths_movingai.png"}
        assert {f"{experiment}_{name}" for name in own} <= names
    page = (tmp_path / "report" / "index.html").read_text()
    for title in ("Many problems on a map, by length", "Many problems on a map, map by map"):
        assert f"{title}</h" in page and f"{title}: mine</h" in page

"""Planners in the field: answers are judged, times are of the same problems, gaps say why."""

import numpy as np
import pytest

from benchmarks import field, posed
from benchmarks.field import Heat, compared, contenders, least_times, race, summary, verdict
from benchmarks.measure import make_planner, make_problem
from benchmarks.posed import evenly, random_problems, scenario_problems, scenarios
from benchmarks.questions.field import (
    field_ablation,
    field_calls,
    field_drives,
    field_found,
    field_large,
    field_movingai,
    field_test4,
)
from gapath.grid import GridMap
from gapath.kernels.rng import stream
from gapath.mapio.movingai import read_scenario
from gapath.planning.shortest_path import shortest_path
from gapath.problem import CornerCutting, Plan, PlanStatus, Problem

THERE = ("astar", "ga3", "nobody")
NOBODY = "skipped: there is no planner nobody"
FEW = {
    field_movingai: "PLANNERS",
    field_test4: "PLANNERS",
    field_large: "PLANNERS",
    field_found: "PLANNERS",
    field_calls: "PLANNERS",
}


@pytest.fixture
def stand_ins(monkeypatch):
    """Planners that are there, and one that is not."""
    for question, name in FEW.items():
        monkeypatch.setattr(question, name, THERE)


@pytest.fixture
def scenario(tmp_path, monkeypatch):
    """A folder of data with one MovingAI map: two rooms, in one of them water."""
    folder = tmp_path / "movingai" / "small"
    folder.mkdir(parents=True)
    rows = ["....@...", "....@.W.", "........", "....@.W.", "@@@@@@W@", "........"]
    head = f"type octile\nheight {len(rows)}\nwidth 8\nmap\n"
    (folder / "hut.map").write_text(head + "\n".join(rows) + "\n")
    ends = [(0, 0, 7, 0), (0, 3, 5, 0), (0, 0, 0, 5), (6, 3, 6, 4), (1, 1, 2, 2)]
    lines = ["version 1", *("\t".join(map(str, (0, "hut.map", 8, 6, *e, 1.0))) for e in ends)]
    (folder / "hut.map.scen").write_text("\n".join(lines) + "\n")
    monkeypatch.setenv("GAPATH_DATA", str(tmp_path))
    return folder / "hut.map.scen"


def wall(gap):
    weights = np.full((5, 7), 0.5)
    weights[:, 3] = 1.0
    if gap:
        weights[2, 3] = 0.5
    return Problem(GridMap("wall", weights), (0, 2), (6, 2))


LINE = np.array([(x, 2) for x in range(7)], dtype=np.int32)
ROUND = np.array([(0, 2), (1, 1), (2, 2), (2, 1), *((x, 2) for x in range(3, 7))], dtype=np.int32)


@pytest.mark.parametrize(
    ("gap", "plan", "expected"),
    [
        (True, Plan(PlanStatus.FOUND, LINE, 3.5), "found"),
        (True, Plan(PlanStatus.FOUND, LINE, 3.0), "false"),  # it costs something else
        (True, Plan(PlanStatus.FOUND, LINE[:-1], 3.0), "false"),
        (False, Plan(PlanStatus.FOUND, LINE, 3.5), "false"),
        (True, Plan(PlanStatus.OPTIMAL, LINE, 3.5), "found"),
        (True, Plan(PlanStatus.OPTIMAL, ROUND, 4.0), "false"),  # not the cheapest
        (True, Plan(PlanStatus.INFEASIBLE), "false"),
        (False, Plan(PlanStatus.INFEASIBLE), "proved"),
        (True, Plan(PlanStatus.NOT_FOUND), "missed"),
        (False, Plan(PlanStatus.NOT_FOUND), "missed"),
    ],
)
def test_answers_are_judged(gap, plan, expected):
    assert verdict(wall(gap), plan) == expected


class Fixed:
    """Gives one path, whatever is asked."""

    minimises = "weights"

    def __init__(self, path, cost):
        self.answer = Plan(PlanStatus.FOUND, path, cost)

    def plan(self, problem, stream):
        return self.answer


@pytest.mark.parametrize(("name", "judged"), [("jps", "false"), ("memetic", "found")])
def test_a_dearer_path_is_false_only_of_a_planner_whose_paths_are_the_cheapest(name, judged):
    heat = race(wall(True), {name: Fixed(ROUND, 4.0)})[name]
    assert (heat.verdict, heat.ratio) == (judged, 8 / 7)
    assert set(heat.times) == {"A*", "A*, kernel", name} and min(heat.times.values()) > 0


@pytest.mark.parametrize("name", ["astar", "dijkstra", "jps", "memetic_quality"])
def test_a_kernel_alone_finds_what_the_planner_finds(name):
    problem = make_problem("kg18_test3")
    planner = make_planner(name)
    found = field.KERNELS[type(planner)](planner, problem, stream(3))()
    path = found[1] if isinstance(found, tuple) else found
    assert path.tolist() == planner.plan(problem, stream(3)).path.tolist()


def test_the_least_of_several_times_counts_and_rivals_take_turns():
    order = []
    clock = iter([0, 5000, 0, 900, 0, 3000, 0, 1000, 0, 4000, 0, 2000])

    def make():
        return {name: (lambda name=name: order.append(name) or name) for name in "ab"}

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(field.time, "thread_time_ns", lambda: next(clock))
        times, results = least_times(make)
    took = {name: [] for name in "ab"}
    for name, spent in zip(order, (5, 0.9, 3, 1, 4, 2), strict=True):
        took[name].append(spent)
    assert all(len(spent) == 3 for spent in took.values())
    assert times == {name: min(spent) for name, spent in took.items()}
    assert results == {"a": "a", "b": "b"}


def test_totals_and_ratios_are_summed_up():
    heats = [
        Heat("found", 1.0, {"A*": 10.0, "x": 2.0, "jps": 4.0}),
        Heat("found", 1.5, {"A*": 50.0, "x": 10.0, "jps": 4.0}),
        Heat("missed", np.nan, {"A*": 30.0, "x": 18.0, "jps": 4.0}),
    ]
    row = summary("x", heats)
    assert (row["problems"], row["found"], row["false"]) == (3, 2, 0)
    assert row["found %"] == pytest.approx(200 / 3)
    assert (row["dearer %"], row["dearer %, most"]) == (25, 50)
    assert row["dearer %, 90th"] == pytest.approx(45)
    assert row["A* / planner"] == pytest.approx(90 / 30)
    assert row["A* / planner, a problem"].median == 5
    assert row["jps / planner"] == pytest.approx(12 / 30)
    assert "A* / kernel" not in row


def test_who_is_not_there_or_does_not_suit_says_why():
    made = contenders(["astar", "nobody", "less"], {"less": {"base": "ga3", "population": 20}})
    assert made["nobody"] == NOBODY
    assert made["less"].population == 20
    weights = np.full((4, 9), 0.5)
    oblong = Problem(GridMap("oblong", weights), (0, 0), (8, 3))
    square = Problem(GridMap("square", weights[:, :4]), (0, 0), (3, 3))
    made |= contenders(["sedighi"])
    given = dict(compared([square, oblong], made))
    assert given["nobody"] == NOBODY
    assert given["sedighi"].startswith("skipped: map: got 9 x 4 fields")
    assert [len(given[name]) for name in ("astar", "less")] == [2, 2]


@pytest.mark.parametrize(("count", "most", "rows"), [(10, 3, [1, 5, 8]), (3, 9, [0, 1, 2])])
def test_rows_are_chosen_evenly(count, most, rows):
    assert evenly(range(count), most) == rows


def test_problems_of_a_scenario_are_on_ground_or_water_and_can_be_solved(scenario):
    ((path, rows),) = scenarios(scenario.parent)
    assert (path.name, len(rows)) == ("hut.map", 5)
    assert rows == read_scenario(str(scenario))
    posed = scenario_problems(path, rows, CornerCutting.ALLOW)
    assert [p.start for p in posed] == [(0, 0), (0, 3), (6, 3), (1, 1)]  # one is in another room
    assert all(shortest_path(problem).feasible for problem in posed)
    ground, afloat = posed[0].map, posed[2].map
    assert posed[1].map is ground and afloat is not ground
    assert afloat.obstacles.sum() == 48 - 3


def test_random_problems_are_between_free_fields_and_the_same_again():
    grid = wall(True).map
    problems = random_problems(grid, 50, 3, CornerCutting.FORBID)
    ends = [(p.start, p.target) for p in problems]
    assert len(set(ends)) > 30
    assert ends == [(p.start, p.target) for p in random_problems(grid, 50, 3, CornerCutting.FORBID)]
    assert ends != [(p.start, p.target) for p in random_problems(grid, 50, 4, CornerCutting.FORBID)]


def test_movingai_has_a_row_a_map_and_rule_and_one_for_all(scenario, stand_ins):
    rows = field_movingai.measure(quick=True)
    assert [row["planner"] for row in rows] == [*THERE, *THERE, "astar", "ga3", "astar", "ga3"]
    assert [row["map"] for row in rows] == ["hut"] * 6 + ["all"] * 4
    for row in rows:
        if row["planner"] == "nobody":
            assert row["problems"] == NOBODY
        else:
            assert row["problems"] == 2 and row["false"] == 0
        if row["planner"] == "astar":
            assert (row["found"], row["dearer %"]) == (2, 0)
            assert row["A* kernel ms"] > 0 and row["kernel ms"] > 0


def test_without_real_maps_the_reason_is_stated(tmp_path, monkeypatch, stand_ins):
    monkeypatch.setenv("GAPATH_DATA", str(tmp_path / "none"))
    assert field_movingai.measure(quick=True) == [{"map": "all", "planner": posed.NO_DATA}]
    rows = field_found.measure(quick=True)
    reasons = {row["source"]: row["problems"] for row in rows if row["planner"] == "astar"}
    assert {reasons[name] for name in field_found.REAL} == {posed.NO_DATA}
    assert reasons["random maps"] == 4
    monkeypatch.setattr(field_ablation, "PLANNERS", ("nobody",))
    assert field_ablation.measure(quick=True)[-1]["problems"] == posed.NO_DATA


def test_all_that_can_be_solved_is_counted(stand_ins, scenario):
    rows = {(row["source"], row["planner"]): row for row in field_found.measure(quick=True)}
    own = rows["movingai", "astar"]
    assert (own["problems"], own["solvable"], own["found %"], own["missed"]) == (4, 4, 100, 0)
    walled = rows["kg18_enclosed", "ga3"]
    assert (walled["not solvable"], walled["proved %"], walled["not proved"]) == (2, 0, 2)
    assert rows["kg18_enclosed", "astar"]["proved %"] == 100
    total = rows["all", "astar"]
    assert (total["found %"], total["false"], total["proved %"]) == (100, 0, 100)
    asked = [r["problems"] for (_, n), r in rows.items() if n == "astar" and "solvable" in r]
    assert total["solvable"] + total["not solvable"] == total["problems"] < sum(asked) + 3
    assert rows["random maps", "nobody"]["problems"] == NOBODY


def test_small_maps_are_of_all_rules_and_their_ends_free():
    problems = list(field_found.small_maps(40))
    assert {p.corner_cutting for p in problems} == set(CornerCutting)
    assert [len(np.unique(p.map.weights[~p.map.obstacles])) for p in problems[::2]] == [1] * 20
    assert max(len(np.unique(p.map.weights)) for p in problems[1::2]) == 7
    solved = sum(shortest_path(problem).feasible for problem in problems)
    assert 10 < solved < 40


def test_large_maps_have_two_problems_each(stand_ins):
    rows = [row for row in field_large.measure(quick=True) if row["planner"] == "astar"]
    assert [(row["class"], row["ends"]) for row in rows] == [
        *((name, ends) for name in field_large.CLASSES for ends in ("across", "diagonal")),
        ("field_rooms[size=8]", "random"),
    ]
    assert all(row["dearer %"] == 0 and row["found %"] == 100 for row in rows)


def test_test_map_4_is_tried_by_seeds(stand_ins):
    exact, ga3, nobody = field_test4.measure(quick=True)
    assert (exact["problems"], exact["found %"], exact["dearer %"]) == (3, 100, 0)
    assert (ga3["found %"], ga3["false"]) == (0, 0) and "dearer %" not in ga3
    assert nobody["problems"] == NOBODY


def test_calls_are_timed_beyond_their_kernel(stand_ins):
    rows = {(row["work"], row["planner"]): row for row in field_calls.measure(quick=True)}
    assert rows["a call", "astar"]["kernel us"].lower > 0
    assert "gapath.plan - planner.plan us" in rows["a call", "ga3"]
    memory = rows["memory", "astar"]["bytes a field"]
    assert str(memory).startswith("skipped") or 0 < memory < 40
    assert rows["a call", "nobody"]["planner.plan us"] == NOBODY


def test_parts_are_left_out_by_settings(monkeypatch, scenario):
    monkeypatch.setattr(field_ablation, "PLANNERS", ("ga3",))
    monkeypatch.setattr(field_ablation, "PARTS", {"whole": {}, "one epoch": {"max_epochs": 1}})
    rows = field_ablation.measure(quick=True)
    assert [(row["maps"], row["part"]) for row in rows] == [
        (maps, part) for maps in ("kg18_test4", "MovingAI") for part in ("whole", "one epoch")
    ]
    assert all(row["problems"] for row in rows)


def test_navigators_drive_in_turn_on_the_same_maps(monkeypatch):
    monkeypatch.setattr(field_drives, "NAVIGATORS", ("nobody", "replan_astar", "dstar_lite"))
    problem = make_problem("kg18_map1")
    names = field_drives.NAVIGATORS
    rows = field_drives.of_map({"range": 4}, names, [problem], 2, 1)
    assert rows[0]["drives"] == "skipped: there is no navigator nobody"
    repeated, incremental = rows[1:]
    assert repeated["drives"] == 2 and repeated["reached %"] == 100
    assert repeated["steps / replan_astar"] == 1 and "time / replan_astar" not in repeated
    assert incremental["time / replan_astar"] == pytest.approx(1 / repeated["time / dstar_lite"])
    assert 1 <= incremental["steps / shortest"] < 1.2
    assert min(row["steps / the better"] for row in (repeated, incremental)) == 1
